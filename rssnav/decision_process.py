"""The decision process an agent makes of a world: what planning solves and training samples.

A state of the process need not be a cell of the world: a heading, a battery level or a door may be
part of it. The table ``cell_of_state`` says in which cell each state lies; visits, flights and
lengths go through it.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from rssnav.discrete_states import ExactStates, heard
from rssnav.missions.observation import Observation
from rssnav.missions.tables import SensorTables, sensor_tables
from rssnav.missions.task import ReadingAbove, Task, Within
from rssnav.world import ACTION_NAMES, GridWorld, WorldError


def _no_table() -> NDArray[np.int32]:
    return np.empty(0, dtype=np.int32)


@dataclass(frozen=True, eq=False)
class DecisionProcess:
    """A world with rewards and terminal states.

    Attributes
    ----------
    next_state : (S, 8) int32
        State after each action, -1 where it is impossible.
    reward : (S, 8) float64
        Reward of each step, the goal reward included; 0 where the step is impossible.
    terminal : (S,) bool
        States that end an episode.
    start : int
        State an episode begins in.
    cell_of_state : (S,) int32
        Cell of each state: the row of the world's arrays. Action ``a`` must lead from cell ``c``
        to cell ``world.next_state[c, a]``. Left out, state ``k`` is cell ``k``.
    readings : SensorTables or None
        For an agent that sees RSS readings and not the state: how readings become discrete states.
    """

    next_state: NDArray[np.int32]
    reward: NDArray[np.float64]
    terminal: NDArray[np.bool_]
    start: int
    cell_of_state: NDArray[np.int32] = field(default_factory=_no_table)
    readings: SensorTables | None = None

    def __post_init__(self) -> None:
        if not self.cell_of_state.size:
            object.__setattr__(self, "cell_of_state", np.arange(self.n_states, dtype=np.int32))

    def __repr__(self) -> str:
        """Numbers of states and goals in one line."""
        n = self.terminal.size
        return f"<DecisionProcess: {n} states, {np.count_nonzero(self.terminal)} of them terminal>"

    @property
    def n_states(self) -> int:
        """Number S of states."""
        return self.next_state.shape[0]

    @cached_property
    def action_mask(self) -> NDArray[np.bool_]:
        """Possible actions of each state, shape (S, 8); read-only."""
        mask = self.next_state >= 0
        mask.flags.writeable = False
        return mask

    def per_cell(self, counts: NDArray[np.int32], n_cells: int) -> NDArray[np.int32]:
        """Sum counts per state (S,) over the states of each cell, shape (n_cells,)."""
        return np.bincount(self.cell_of_state, counts, n_cells).astype(np.int32)

    def check(self, world: GridWorld) -> None:
        """Raise WorldError unless this is a process of a world that can be flown in.

        Parameters
        ----------
        world : GridWorld
            Gives the cells and the steps between them.
        """
        self._check_shapes()
        for name, table, low, size in (
            ("next_state", self.next_state, -1, self.n_states),
            ("cell_of_state", self.cell_of_state, 0, world.n_states),
            ("start", np.array([self.start]), 0, self.n_states),
        ):
            if table.size and not (low <= table.min() and table.max() < size):
                raise WorldError(
                    f"decision process: {name} holds {table.min()} to {table.max()}, outside "
                    f"{low} to {size - 1}"
                )
        self._check_steps(world)

    def _check_shapes(self) -> None:
        s = self.n_states
        for name, shape in (
            ("next_state", (s, len(ACTION_NAMES))),
            ("reward", (s, len(ACTION_NAMES))),
            ("terminal", (s,)),
            ("cell_of_state", (s,)),
        ):
            found = getattr(self, name).shape
            if found != shape:
                raise WorldError(f"decision process: {name} has shape {found}, expected {shape}")

    def _check_steps(self, world: GridWorld) -> None:
        """Check that steps follow the world's, and that no state entered lacks an action."""
        state, action = np.nonzero(self.action_mask)
        arrived = self.next_state[state, action]
        flown = world.next_state[self.cell_of_state[state], action]
        wrong = np.flatnonzero(self.cell_of_state[arrived] != flown)
        if wrong.size:
            s, a = int(state[wrong[0]]), int(action[wrong[0]])
            raise WorldError(
                f"decision process: action {a} ({ACTION_NAMES[a]}) leads from state {s} (cell "
                f"{self.cell_of_state[s]}) to cell {self.cell_of_state[self.next_state[s, a]]}, "
                f"in the world to {world.next_state[self.cell_of_state[s], a]}; next_state must "
                "follow world.next_state, or be -1"
            )
        entered = np.union1d(arrived, self.start)
        stuck = entered[~self.terminal[entered] & ~self.action_mask[entered].any(axis=1)]
        if stuck.size:
            raise WorldError(
                f"decision process: state {stuck[0]} can be entered, has no possible action and "
                "is not terminal; make it terminal or give it an action"
            )


def process_of(world: GridWorld, task: Task, observation: Observation) -> DecisionProcess:
    """Apply a task and an observation to a world.

    Where an agent can tell all cells apart, by the cell or by readings that all differ, a state is
    a cell; elsewhere readings make the rows of Q (`DecisionProcess.readings`).

    Raises
    ------
    WorldError
        When no reachable cell is a goal, or the start is one.
    """
    mission = world.mission()
    terminal = task.check(mission)[0]
    possible, arrives = world.action_mask, terminal[world.next_state]
    heard_dbm = heard(world.rss_dbm, observation.sensitivity_dbm)
    if task.reward == "closeness":
        step_reward = (1.0 / world.distance_m)[world.next_state]
    elif task.reward == "rss":
        step_reward = heard_dbm[world.next_state] - heard_dbm[:, None]
    else:
        step_reward = np.zeros(possible.shape)
    kept = 0.0 if task.goal_reward_is == "instead" else step_reward
    with_goal = np.where(arrives, kept + task.goal_reward, step_reward)
    reward = np.where(possible, with_goal + task.per_second, 0.0)
    readings = (
        None
        if _is_told_apart(world, task, observation)
        else sensor_tables(mission, task, observation)
    )
    return DecisionProcess(world.next_state, reward, terminal, world.start_state, readings=readings)


def _is_told_apart(world: GridWorld, task: Task, observation: Observation) -> bool:
    """Whether a row of Q per cell, with a table of rewards, is all that there is to learn."""
    steady = observation.fluctuation.sigma_db == 0.0 or isinstance(task.goal, Within)
    if observation.heading or task.energy is not None or not steady:
        return False
    if isinstance(task.goal, ReadingAbove) and task.goal.confirmations > 1:
        return False
    if observation.reading is None:
        return observation.cell
    heard_dbm = heard(world.rss_dbm, observation.sensitivity_dbm)
    differ = np.unique(heard_dbm).size == world.n_states
    return isinstance(observation.reading, ExactStates) and (differ or observation.cell)
