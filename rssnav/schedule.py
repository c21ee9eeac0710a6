"""How many realisations are trained, and for how long."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

MAX_RUNS = 1_000_000
MAX_EPISODES = 10**9
NO_STEP_LIMIT = int(np.iinfo(np.int64).max)


@dataclass(frozen=True)
class Schedule:
    """How many realisations are trained, and for how long.

    Attributes
    ----------
    runs : int
        Number of realisations.
    episodes : int
        Episodes of each; with ``until_converged`` the largest number.
    seed : int
        Seed of all of them.
    until_converged : bool
        Whether a run stops at convergence.
    min_episodes : int
        Episodes that a run flies even when it converges earlier.
    snapshot_episodes : tuple of int
        Episodes after which visit counts are stored.
    max_total_steps : int
        Steps after which a run starts no further episode.
    """

    runs: int
    episodes: int
    seed: int
    until_converged: bool
    min_episodes: int
    snapshot_episodes: tuple[int, ...]
    max_total_steps: int = NO_STEP_LIMIT

    @property
    def guaranteed_episodes(self) -> int:
        """Episodes that every run flies without a step limit."""
        return min(self.episodes, self.min_episodes) if self.until_converged else self.episodes
