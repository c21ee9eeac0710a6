"""What training gives: :class:`TrainingResult`, and the schedule it was made by."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rssnav.agents import Agent, QLearning
from rssnav.world import GridWorld

NO_STEP_LIMIT = int(np.iinfo(np.int64).max)


@dataclass(frozen=True)
class Schedule:
    """How many realisations are trained, and for how long.

    Attributes
    ----------
    runs : int
        Realisations asked for.
    episodes : int
        Episodes of each; with ``until_converged`` the most it may take.
    seed : int
        Seed of all of them.
    until_converged : bool
        Whether a run stops at convergence.
    min_episodes : int
        Episodes that a run flies even when it converges earlier.
    snapshot_episodes : tuple of int
        Episodes after which visit counts are kept.
    max_total_steps : int
        Steps after which a run flies no further episodes.
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
        """Episodes that every run flies when no step limit ends it."""
        return min(self.episodes, self.min_episodes) if self.until_converged else self.episodes


@dataclass(frozen=True, eq=False)
class TrainingResult:
    """Finished realisations (R of them) of one agent in one world.

    Attributes
    ----------
    run_ids : (R,) int64
        Which realisations these are, ascending; fewer than ``schedule.runs`` after an interrupt.
    steps : (R, E) int32
        Steps of each episode; -1 after a run's last.
    diagonal_steps : (R, E) int32
        How many of them were diagonal; -1 after a run's last.
    truncated : (R, E) bool
        Episodes cut at ``learning.max_steps``.
    episodes_flown : (R,) int64
        Episodes of each run.
    visit_counts : (K, S) int64
        Visits of each state, summed over the runs, up to each of the K snapshot episodes; the
        start counts as visited when an episode begins.
    converged_episode : (R,) int64
        Episodes flown when the run converged; -1 where it did not.
    converged_steps : (R,) int64
        Steps flown by then, so its flight time [s]; -1 where it did not.
    converged_cpu_s : (R,) float64
        CPU time by then [s]; of the whole run where it did not.
    cpu_s : (R,) float64
        CPU time of the run [s].
    trajectories : (R, T) int32
        States of the final greedy flight, padded with -1.
    reached : (R,) bool
        Whether that flight reaches the source; otherwise it ends where it began to repeat.
    path_steps : (R,) int64
        Steps of that flight.
    path_length_m : (R,) float64
        Its length [m].
    n_labels : (R,) int64
        States the agent told apart in the end.
    q : (R, S, 8) float64 or None
        Final Q of each cell's steady reading, if it was asked for.
    """

    world: GridWorld
    agent: Agent
    learning: QLearning
    schedule: Schedule
    run_ids: NDArray[np.int64]
    steps: NDArray[np.int32]
    diagonal_steps: NDArray[np.int32]
    truncated: NDArray[np.bool_]
    episodes_flown: NDArray[np.int64]
    visit_counts: NDArray[np.int64]
    converged_episode: NDArray[np.int64]
    converged_steps: NDArray[np.int64]
    converged_cpu_s: NDArray[np.float64]
    cpu_s: NDArray[np.float64]
    trajectories: NDArray[np.int32]
    reached: NDArray[np.bool_]
    path_steps: NDArray[np.int64]
    path_length_m: NDArray[np.float64]
    n_labels: NDArray[np.int64]
    q: NDArray[np.float64] | None = None

    @property
    def complete(self) -> bool:
        """Whether all realisations asked for are here."""
        return self.run_ids.size == self.schedule.runs

    @property
    def visits(self) -> NDArray[np.float64]:
        """Mean visits of each cell per run up to each snapshot, shape (K, n_y, n_x)."""
        return self.world.on_grid(self.visit_counts / self.run_ids.size)

    @property
    def episode_length_m(self) -> NDArray[np.float64]:
        """Length flown in each episode [m], shape (R, E); 0 after a run's last."""
        flown = self.steps >= 0
        straight_m, diagonal_m = self.world.step_length_m[:2]
        straight = np.where(flown, self.steps - self.diagonal_steps, 0)
        return straight * straight_m + np.where(flown, self.diagonal_steps, 0) * diagonal_m

    def trajectory_m(self, index: int) -> NDArray[np.float64]:
        """Positions (n + 1, 2) [m] of the final flight of the run at an index of ``run_ids``."""
        states = self.trajectories[index]
        return self.world.position[states[states >= 0]]

    def save(self, path: str | Path) -> None:
        """Write to an HDF5 file, replacing it only once it is complete."""
        from rssnav.result_file import save_result

        save_result(self, path)

    @staticmethod
    def load(path: str | Path) -> TrainingResult:
        """Read from an HDF5 file; raises :class:`~rssnav.result_file.ResultFileError`."""
        from rssnav.result_file import load_result

        return load_result(path)

    def check_same_training(
        self, world: GridWorld, agent: Agent, learning: QLearning, schedule: Schedule
    ) -> None:
        """Raise ValueError unless this result comes from the same training."""
        for name, mine, other in (
            ("plan", self.world.plan_sha256, world.plan_sha256),
            ("speed", self.world.speed, world.speed),
            ("radio map", self.world.rss_dbm.tobytes(), world.rss_dbm.tobytes()),
            ("agent", self.agent, agent),
            ("learning", self.learning, learning),
            ("schedule", self.schedule, schedule),
        ):
            if mine != other:
                raise ValueError(
                    f"the earlier result was trained with another {name}: train from the "
                    "beginning, or with the settings it was made by"
                )

    def merged(self, other: TrainingResult) -> TrainingResult:
        """Realisations of both results, which must share a training and no realisation.

        Raises
        ------
        ValueError
            When the trainings differ or a realisation is in both.
        """
        self.check_same_training(other.world, other.agent, other.learning, other.schedule)
        run_ids = np.concatenate((self.run_ids, other.run_ids))
        if np.unique(run_ids).size < run_ids.size:
            raise ValueError("a realisation is in both results; merge results of different runs")
        order = np.argsort(run_ids)
        fields: dict[str, object] = {
            name: padded([*getattr(self, name), *getattr(other, name)], fill)[order]
            for name, fill in _PER_RUN_ROWS.items()
        }
        for name in _PER_RUN:
            fields[name] = np.concatenate((getattr(self, name), getattr(other, name)))[order]
        if self.q is not None and other.q is not None:
            fields["q"] = np.concatenate((self.q, other.q))[order]
        else:
            fields["q"] = None
        return dataclasses.replace(
            self, **fields, visit_counts=self.visit_counts + other.visit_counts
        )


_PER_RUN_ROWS = {"steps": -1, "diagonal_steps": -1, "truncated": False, "trajectories": -1}
_PER_RUN = (
    "run_ids",
    "episodes_flown",
    "converged_episode",
    "converged_steps",
    "converged_cpu_s",
    "cpu_s",
    "reached",
    "path_steps",
    "path_length_m",
    "n_labels",
)


def median_run(result: TrainingResult) -> int | None:
    """Return the index of the run whose flight is of median length; None if none arrives."""
    arrived = np.flatnonzero(result.reached)
    if arrived.size == 0:
        return None
    by_length = arrived[np.argsort(result.path_length_m[arrived], kind="stable")]
    return int(by_length[(arrived.size - 1) // 2])


def padded(rows: list[NDArray[Any]], fill: int) -> NDArray[Any]:
    """Stack rows of different lengths, shorter ones filled at their end."""
    table = np.full((len(rows), max(row.size for row in rows)), fill, dtype=rows[0].dtype)
    for target, row in zip(table, rows, strict=True):
        target[: row.size] = row
    return table
