"""The result of a training, :class:`TrainingResult`."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rssnav.agent_description import same_agent
from rssnav.agents import Agent
from rssnav.learning_parameters import QLearning
from rssnav.result_file import read_result_file, write_result_file
from rssnav.schedule import Schedule
from rssnav.world import GridWorld


@dataclass(frozen=True, eq=False)
class TrainingResult:
    """Finished realisations (R of them) of one agent in one world.

    Visits and trajectories refer to the C cells of the world (the rows of its arrays), Q to the S
    states of the agent's decision process.

    Attributes
    ----------
    run_ids : (R,) int64
        Numbers of the realisations, ascending; fewer than ``schedule.runs`` after an interrupt.
    steps : (R, E) int32
        Steps of each episode; -1 after a run's last.
    diagonal_steps : (R, E) int32
        How many of them were diagonal; -1 after a run's last.
    truncated : (R, E) bool
        Episodes truncated at ``learning.max_steps``.
    episodes_flown : (R,) int64
        Episodes of each run.
    cell_of_state : (S,) int32
        Cell of each state.
    visit_counts : (K, C) int64
        Visits of each cell, summed over the runs, up to each of the K snapshot episodes; the
        start counts as visited when an episode begins.
    converged_episode : (R,) int64
        Episodes flown when the run converged; -1 where it did not.
    converged_steps : (R,) int64
        Steps flown by then, equal to the flight time [s]; -1 where it did not.
    converged_cpu_s : (R,) float64
        CPU time by then [s]; of the whole run where it did not.
    cpu_s : (R,) float64
        CPU time of the run [s].
    trajectories : (R, T) int32
        Cells of the final greedy flight, padded with -1.
    reached : (R,) bool
        Whether that flight reaches the transmitter; otherwise it ends where it starts to repeat.
    path_steps : (R,) int64
        Steps of that flight.
    path_length_m : (R,) float64
        Its length [m].
    n_discrete_states : (R,) int64
        Number of discrete states that the agent distinguished in the end.
    q : (R, S, 8) float64 or None
        Final Q of each state (of its reading without fluctuation), with ``keep_q``.
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
    cell_of_state: NDArray[np.int32]
    visit_counts: NDArray[np.int64]
    converged_episode: NDArray[np.int64]
    converged_steps: NDArray[np.int64]
    converged_cpu_s: NDArray[np.float64]
    cpu_s: NDArray[np.float64]
    trajectories: NDArray[np.int32]
    reached: NDArray[np.bool_]
    path_steps: NDArray[np.int64]
    path_length_m: NDArray[np.float64]
    n_discrete_states: NDArray[np.int64]
    q: NDArray[np.float64] | None = None

    def __repr__(self) -> str:
        """Agent, runs and success in one line."""
        return (
            f"<TrainingResult: {self.agent.name} in {self.world.plan_name!r}, "
            f"{np.count_nonzero(self.reached)} of {len(self.run_ids)} runs reach the transmitter>"
        )

    @property
    def complete(self) -> bool:
        """Whether all realisations of the schedule are present."""
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
        cells = self.trajectories[index]
        return self.world.position[cells[cells >= 0]]

    def save(self, path: str | Path) -> None:
        """Write to an HDF5 file, replacing it only once it is complete."""
        write_result_file(self, Path(path))

    @staticmethod
    def load(path: str | Path, agents: Sequence[type] = ()) -> TrainingResult:
        """Read from an HDF5 file.

        Parameters
        ----------
        path : str or Path
            The file.
        agents : sequence of class
            Agent classes of your own, and classes of their fields. A file names the class of its
            agent, but loading imports no module. The agent of a class not given here is an
            :class:`~rssnav.agent_description.AgentDescription`: its name and parameters.

        Raises
        ------
        FileNotFoundError
            When there is no such file.
        ResultFileError
            When the file is damaged, of another format or version, or does not fit the class.
        """
        return TrainingResult(**read_result_file(Path(path), agents))

    def check_same_training(
        self, world: GridWorld, agent: Agent, learning: QLearning, schedule: Schedule
    ) -> None:
        """Check that this result comes from the same training.

        Parameters
        ----------
        world : GridWorld
        agent : Agent
        learning : QLearning
        schedule : Schedule
            What another training has.

        Raises
        ------
        ValueError
            With what is different.
        """
        for name, mine, other in (
            ("plan", self.world.plan_sha256, world.plan_sha256),
            ("speed", self.world.speed, world.speed),
            ("radio map", self.world.rss_dbm.tobytes(), world.rss_dbm.tobytes()),
            ("agent", same_agent(self.agent, agent), True),
            ("learning", self.learning, learning),
            ("schedule", self.schedule, schedule),
        ):
            if mine != other:
                raise ValueError(
                    f"the earlier result was trained with a different {name}: train from the "
                    "beginning, or with the same settings"
                )

    def merged(self, other: TrainingResult) -> TrainingResult:
        """Combine the realisations of two results of the same training.

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
    "n_discrete_states",
)


def median_run(result: TrainingResult) -> int | None:
    """Return the index of the run whose flight is of median length; None if none arrives."""
    arrived = np.flatnonzero(result.reached)
    if arrived.size == 0:
        return None
    by_length = arrived[np.argsort(result.path_length_m[arrived], kind="stable")]
    return int(by_length[(arrived.size - 1) // 2])


def padded(rows: list[NDArray[Any]], fill: int) -> NDArray[Any]:
    """Stack rows of different lengths; shorter ones are filled at their end."""
    table = np.full((len(rows), max(row.size for row in rows)), fill, dtype=rows[0].dtype)
    for target, row in zip(table, rows, strict=True):
        target[: row.size] = row
    return table
