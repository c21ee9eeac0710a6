"""The state of N environments, in the terms of the compiled step."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from gymnasium.utils import seeding
from numpy.typing import NDArray

from rssnav.envs.options import EnvOptions
from rssnav.envs.spaces import depth
from rssnav.kernels import fleet as kernel
from rssnav.missions.tables import mission_moves, sensor_tables, steady_tables


class EnvState:
    """Flights of N environments and what their agents see.

    Random numbers of environment i are those of its own xoshiro256++ stream, which its seed starts
    and which goes on from episode to episode.
    """

    def __init__(self, options: EnvOptions, n: int) -> None:
        self.mission, task, senses = options.mission(), options.task(), options.senses()
        task.check(self.mission)
        self.moves = mission_moves(self.mission)
        self.steady = steady_tables(self.mission, task, senses)
        tables = sensor_tables(self.mission, task, senses)
        self.sensor = None if self.steady is not None else tables.of_one_run()
        self.fleet = kernel.Fleet.of_size(n)
        possible = (self.mission.next_state.reshape(-1, 8) >= 0).astype(np.int8)
        self.view = _view(n, depth(options), np.ascontiguousarray(possible).view(np.uint64))
        self._hover = options.hover
        self.seeded = False

    @property
    def masks(self) -> NDArray[np.int8]:
        """Possible actions, (N, actions)."""
        return self.with_hover(self.view.masks)

    def with_hover(self, masks: NDArray[np.uint64]) -> NDArray[np.int8]:
        """Masks of eight bytes (N,) as (N, actions)."""
        eight = masks.view(np.int8).reshape(-1, 8)
        if not self._hover:
            return eight
        return np.hstack((eight, np.ones((eight.shape[0], 1), dtype=np.int8)))

    def seed(self, seeds: Sequence[int | None]) -> None:
        """Start the streams of the environments that get a seed; at first, those of all."""
        for i, seed in enumerate(seeds):
            if seed is not None or not self.seeded:
                generator, _ = seeding.np_random(seed)
                self.start_stream(i, generator)
        self.seeded = True

    def start_stream(self, i: int, generator: np.random.Generator) -> None:
        """Start the stream of an environment."""
        words = generator.integers(0, 2**64 - 1, 4, np.uint64, endpoint=True)
        self.fleet.generator[i], self.fleet.real[i] = words, 0.0
        self.seeded = True

    def reset(self, chosen: NDArray[np.bool_]) -> None:
        """Begin an episode of the chosen environments (N,)."""
        kernel.reset_some(self.moves, self.sensor, self.steady, self.fleet, self.view, chosen)


def _view(n: int, k: int, mask_of: NDArray[np.uint64]) -> kernel.View:
    none = np.empty(0, dtype=np.int64)
    return kernel.View(
        history=np.zeros((n, k)),
        cells=np.zeros(n, dtype=np.int64),
        rows=none,
        masks=np.zeros(n, dtype=np.uint64),
        mask_of=mask_of.reshape(-1),
        final_history=np.zeros((n, k)),
        final_cells=np.zeros(n, dtype=np.int64),
        final_rows=none,
        final_masks=np.zeros(n, dtype=np.uint64),
    )
