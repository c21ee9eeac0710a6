"""Exploration of the nearest frontier, drawn to where readings are high."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass

import numpy as np
from numpy.typing import NDArray

from rssnav.arguments import is_finite, require
from rssnav.missions.layout import Layout
from rssnav.missions.policy import Seen
from rssnav.policies.step_memory import StepMemory, any_step


@dataclass(eq=False)
class FrontierSearch:
    """Fly to the best cell that is next to visited ones: high readings there, and a short way.

    Frontiers are those of Yamauchi (1997, doi:10.1109/CIRA.1997.613851), chosen by information
    against cost as by Gonzalez-Banos and Latombe (2002, doi:10.1177/0278364902021010834).

    Parameters
    ----------
    layout : Layout
        Building, of which only size, speed and the UAV's own cells are used.
    steps_per_db : float
        Steps of detour that a reading higher by 1 dB is worth; 0 explores the nearest.

    Raises
    ------
    ValueError
        For a number out of range.
    """

    layout: Layout
    _: KW_ONLY
    steps_per_db: float = 1.0
    name: str = "frontier search"

    def __post_init__(self) -> None:
        holds = self.steps_per_db >= 0.0 and is_finite(self.steps_per_db)
        require(holds, "steps_per_db", self.steps_per_db, "a number that is not negative")
        self._steps = StepMemory(self.layout, plan_known=False)
        self._beside_dbm = np.empty(self._steps.visited.size)

    def begin(self, generator: np.random.Generator) -> None:
        """Forget the last flight."""
        self._generator = generator
        self._steps.begin()
        self._beside_dbm[:] = -np.inf

    def act(self, observation: Seen, mask: NDArray[np.bool_]) -> int:
        """Fly a step of the way to the best frontier cell; see `rssnav.missions.Policy.act`."""
        steps = self._steps
        here = steps.see(observation.cell, mask)
        beside = steps.beside(here)
        self._beside_dbm[beside] = np.maximum(self._beside_dbm[beside], observation.reading_dbm)
        frontier = ~steps.visited & (steps.hops > 0) & (self._beside_dbm > -np.inf)
        if not frontier.any():
            return any_step(self._generator, mask)
        cells = np.flatnonzero(frontier)
        value = self.steps_per_db * self._beside_dbm[cells] - steps.hops[cells]
        return int(steps.first[cells[np.argmax(value)]])
