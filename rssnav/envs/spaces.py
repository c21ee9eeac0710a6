"""Spaces of actions and observations.

RSS is float64: in float32 some cells of the paper's maps would read the same.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from rssnav.envs.options import EnvOptions
from rssnav.missions import Mission

_LOUDEST_DBM = 100.0
_NOISE_RANGE = 9.0  # standard deviations; Box-Muller from 53 bits ends at 8.6


def action_space(options: EnvOptions) -> spaces.Discrete:
    """Eight directions and, where it is allowed, hovering."""
    return spaces.Discrete(9 if options.hover else 8)


def observation_space(options: EnvOptions, mission: Mission) -> spaces.Space[Any]:
    """Space of a single environment's observations."""
    low, high = options.sensitivity_dbm, _LOUDEST_DBM + _NOISE_RANGE * options.sigma_db
    if options.observation == "cell":
        return spaces.Discrete(mission.n_states)
    if options.observation == "history":
        return spaces.Box(low, high, (options.history,), np.float64)
    reading = spaces.Box(low, high, (1,), np.float64)
    if options.observation == "rss":
        return reading
    position = mission.layout.position
    return spaces.Dict(
        rss=reading,
        position=spaces.Box(position.min(axis=0), position.max(axis=0), (2,), np.float64),
        action_mask=spaces.MultiBinary(int(action_space(options).n)),
    )


def depth(options: EnvOptions) -> int:
    """Readings that are kept."""
    return options.history if options.observation == "history" else 1


def observed(
    options: EnvOptions,
    mission: Mission,
    history: NDArray[np.float64],
    cells: NDArray[np.int64],
    masks: NDArray[np.int8],
) -> Any:
    """Observations of N environments, copied, from histories (N, k), cells (N,), masks (N, 8)."""
    if options.observation == "cell":
        return cells.copy()
    if options.observation != "dict":
        return history.copy()
    return {
        "rss": history.copy(),
        "position": mission.layout.position[cells],
        "action_mask": masks.copy(),
    }
