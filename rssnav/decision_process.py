"""The decision process an agent makes of a world: what planning solves and training samples.

A state of the process need not be a cell of the world: a heading, a battery level or a door may be
part of it. The table ``cell_of_state`` says in which cell each state lies; visits, flights and
lengths go through it.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from rssnav.world import ACTION_NAMES, GridWorld, WorldError

if TYPE_CHECKING:
    from rssnav.discrete_states import ReadingStates


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
    readings : ReadingStates or None
        For an agent that sees RSS readings and not the state: how readings become discrete states.
    """

    next_state: NDArray[np.int32]
    reward: NDArray[np.float64]
    terminal: NDArray[np.bool_]
    start: int
    cell_of_state: NDArray[np.int32] = field(default_factory=_no_table)
    readings: ReadingStates | None = None

    def __post_init__(self) -> None:
        if not self.cell_of_state.size:
            object.__setattr__(self, "cell_of_state", np.arange(self.n_states, dtype=np.int32))

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
