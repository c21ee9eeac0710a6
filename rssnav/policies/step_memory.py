"""What a UAV knows of the steps in a building, and the shortest ways over it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rssnav.arguments import require
from rssnav.kernels.grid_search import explore
from rssnav.missions.layout import ACTIONS, Layout


class StepMemory:
    """Steps that are known to be possible, or may be.

    Without a plan every step inside the grid may be possible until the UAV is at one of its ends
    and sees that it is not: ways lead straight through what is unknown (the free-space assumption:
    Koenig, Tovey and Smirnov, Artificial Intelligence 147, 2003, pages 253 to 279).

    Parameters
    ----------
    layout : Layout
        Size of the grid, cells and speed; its steps are used only if the plan is known.
    plan_known : bool
        Whether all steps are known from the begin.
    remembers : bool
        Whether steps that were seen to be impossible stay so; otherwise only those at the UAV's
        cell are known to be.

    Attributes
    ----------
    shape : (int, int)
        Rows and columns of the grid.
    grid_cell : (S,) int64
        Grid cell, row by row, of each cell of the layout.
    visited : (C,) bool
        Grid cells visited in this flight.
    hops, first : (C,)
        Fewest steps from the UAV to each grid cell (-1: no way), and the first action there.
    """

    def __init__(self, layout: Layout, *, plan_known: bool, remembers: bool = True) -> None:
        self.shape, n_x = layout.shape, layout.shape[1]
        count = self.shape[0] * n_x
        self.grid_cell = (layout.cell[:, 0] * n_x + layout.cell[:, 1]).astype(np.int64)
        self._neighbour = _neighbours(self.shape, layout.speed)
        self._remembers = remembers
        self._assumed = self._neighbour >= 0
        if plan_known:
            self._assumed = np.zeros((count, 8), dtype=np.bool_)
            self._assumed[self.grid_cell] = layout.action_mask
        self.possible = self._assumed.copy()
        self.visited = np.zeros(count, dtype=np.bool_)
        self.hops = np.full(count, -1, dtype=np.int32)
        self.first = np.full(count, -1, dtype=np.int8)
        self._queue = np.empty(count, dtype=np.int32)

    def begin(self) -> None:
        """Forget what was seen in the last flight."""
        self.possible[:], self.visited[:] = self._assumed, False

    def see(self, cell: int, mask: NDArray[np.bool_]) -> int:
        """Note the possible actions ``mask`` (8,) in a cell of the layout; return its grid cell.

        Raises
        ------
        ValueError
            When the cell was not observed.
        """
        require(cell >= 0, "cell", cell, "the UAV's own; fly with an Observation(..., cell=True)")
        here = int(self.grid_cell[cell])
        self.visited[here] = True
        if not self._remembers:
            self.possible[:] = self._assumed
        self.possible[here] = mask
        there = self._neighbour[here]
        inside = there >= 0
        # A step back along the same segment is possible if and only if the step is.
        self.possible[there[inside], (np.flatnonzero(inside) + 4) % 8] = mask[inside]
        explore(self._neighbour, self.possible, here, self.hops, self.first, self._queue)
        return here

    def beside(self, here: int) -> NDArray[np.int32]:
        """Grid cells (k,), up to 8, that are a possible step from one."""
        return self._neighbour[here][self.possible[here]]


def _neighbours(shape: tuple[int, int], speed: int) -> NDArray[np.int32]:
    """Grid cell after each action, shape (C, 8); -1 off the grid."""
    rows, columns = np.divmod(np.arange(shape[0] * shape[1])[:, None], shape[1])
    to_row, to_column = rows + speed * ACTIONS[:, 1], columns + speed * ACTIONS[:, 0]
    inside = (to_row >= 0) & (to_row < shape[0]) & (to_column >= 0) & (to_column < shape[1])
    return np.where(inside, to_row * shape[1] + to_column, -1).astype(np.int32)


def any_step(generator: np.random.Generator, mask: NDArray[np.bool_]) -> int:
    """Draw a possible action, where a searcher has no better idea."""
    return int(generator.choice(np.flatnonzero(mask)))
