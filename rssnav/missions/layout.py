"""Where a UAV can fly at one speed: the steps between the cells of a plan.

A layout knows walls and grid, but neither transmitter nor start. Its cells are numbered row by row
of the grid, so one table of steps serves all places of the transmitter and all starts.

At speed ``v`` one step (1 s) moves the UAV ``v`` cells along each axis it moves on, so a diagonal
step is ``sqrt(2)`` times as long as a straight one. A step is impossible when its straight segment,
ends included, touches a wall that is solid at the flying height or leaves the outline: passing
exactly through the end of a wall is a crash. The intersection tests are those of GEOS, whose
orientation predicate is robust, so they need no tolerance.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import breadth_first_order

if TYPE_CHECKING:
    from floorplans import FloorPlan
    from raytrace import Grid

ACTION_NAMES = ("E", "NE", "N", "NW", "W", "SW", "S", "SE")
"""The eight actions, counter-clockwise from +x; their index is the column of every action table."""

ACTIONS: NDArray[np.int64] = np.array(
    [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)], dtype=np.int64
)
"""Cells moved along (x, y) by each action at speed 1, shape (8, 2)."""

MAX_SPEED = 1_000_000


class WorldError(ValueError):
    """A plan, a radio map and a speed (or an agent) make no world to learn in."""


@dataclass(frozen=True, eq=False)
class Layout:
    """Cells of a plan and the steps between them at one speed.

    Attributes
    ----------
    next_state : (S, 8) int32
        Cell after each action of :data:`ACTIONS`; -1 where the step would crash.
    position : (S, 2) float64
        Cell centre (x, y) [m].
    cell : (S, 2) int32
        Indices (i_y, i_x) of the cell in the grid.
    shape : (int, int)
        Shape (n_y, n_x) of the grid.
    speed : int
        Cells moved along an axis in one step.
    step_length_m : (8,) float64
        Length of each action's step [m].
    plan_name : str
        The plan it was made from.
    """

    next_state: NDArray[np.int32]
    position: NDArray[np.float64]
    cell: NDArray[np.int32]
    shape: tuple[int, int]
    speed: int
    step_length_m: NDArray[np.float64]
    plan_name: str

    def __repr__(self) -> str:
        """Plan, cells and speed in one line."""
        return f"<Layout of {self.plan_name!r}: {self.n_states} cells, speed {self.speed}>"

    @classmethod
    def of_plan(cls, plan: FloorPlan, grid: Grid, speed: int = 1) -> Layout:
        """Find the steps between the cells of a grid inside a plan's outline.

        Parameters
        ----------
        plan : FloorPlan
            Gives walls and outline.
        grid : Grid
            Gives cells and flying height.
        speed : int
            Cells moved along an axis in one step, at least 1.

        Raises
        ------
        WorldError
            When the speed is not a positive whole number.
        """
        check_speed(speed)
        next_cell = _next_cells(plan, grid, speed)
        centres = _cell_centres(grid)
        shapely.prepare(plan.outline)
        kept = np.flatnonzero(shapely.contains_properly(plan.outline, shapely.points(centres)))
        n_x = grid.x.size
        return cls(
            next_state=_renumbered(next_cell, kept),
            position=centres[kept],
            cell=np.column_stack(np.divmod(kept, n_x)).astype(np.int32),
            shape=(grid.y.size, n_x),
            speed=int(speed),
            step_length_m=grid.cell_size_m * speed * np.hypot(ACTIONS[:, 0], ACTIONS[:, 1]),
            plan_name=plan.name,
        )

    @property
    def n_states(self) -> int:
        """Number S of cells."""
        return self.next_state.shape[0]

    @cached_property
    def action_mask(self) -> NDArray[np.bool_]:
        """Possible actions of each cell, shape (S, 8); read-only."""
        mask = self.next_state >= 0
        mask.flags.writeable = False
        return mask

    def nearest(self, x_m: float, y_m: float) -> int:
        """Cell whose centre is nearest to the point (x_m, y_m) [m]."""
        return int(np.argmin(np.hypot(*(self.position - (x_m, y_m)).T)))

    def reachable(self, start: int) -> NDArray[np.int64]:
        """Cells (k,) that can be reached from a start, breadth first."""
        state, action = np.nonzero(self.action_mask)
        size = self.n_states
        moves = coo_array(
            (np.ones(state.size), (state, self.next_state[state, action])), shape=(size, size)
        ).tocsr()
        return breadth_first_order(moves, start, return_predecessors=False).astype(np.int64)

    def part(self, states: NDArray[np.int64]) -> Layout:
        """Layout of some cells (k,) alone, numbered in their order."""
        return Layout(
            next_state=_renumbered(self.next_state.astype(np.int64), states),
            position=self.position[states],
            cell=self.cell[states],
            shape=self.shape,
            speed=self.speed,
            step_length_m=self.step_length_m,
            plan_name=self.plan_name,
        )

    def on_cells(self, values: NDArray[np.generic]) -> NDArray[np.float64]:
        """Values (..., n_y, n_x) of a map at the cells, shape (..., S)."""
        return np.ascontiguousarray(values[..., self.cell[:, 0], self.cell[:, 1]], np.float64)

    def on_grid(self, values: NDArray[np.generic], fill: float = 0.0) -> NDArray[np.float64]:
        """Spread values (..., S) over the grid, shape (..., n_y, n_x)."""
        grid = np.full((*values.shape[:-1], *self.shape), fill)
        grid[..., self.cell[:, 0], self.cell[:, 1]] = values
        return grid

    def distance_m(self, x_m: float, y_m: float) -> NDArray[np.float64]:
        """Horizontal distance of every cell to a point [m], shape (S,)."""
        offset = self.position - np.array((x_m, y_m))
        return np.hypot(offset[:, 0], offset[:, 1])


def _cell_centres(grid: Grid) -> NDArray[np.float64]:
    """Centres (x, y) [m] of all cells in row-major order, shape (n_y * n_x, 2)."""
    x, y = np.meshgrid(grid.x, grid.y)
    return np.column_stack((x.reshape(-1), y.reshape(-1)))


def _next_cells(plan: FloorPlan, grid: Grid, speed: int) -> NDArray[np.int64]:
    """Flat index of the cell each step leads to, shape (n_y * n_x, 8); -1 where it crashes."""
    n_y, n_x = grid.y.size, grid.x.size
    i_y, i_x = np.divmod(np.arange(n_y * n_x)[:, None], n_x)
    to_x, to_y = i_x + speed * ACTIONS[:, 0], i_y + speed * ACTIONS[:, 1]
    on_map = (to_x >= 0) & (to_x < n_x) & (to_y >= 0) & (to_y < n_y)
    to_cell = np.where(on_map, to_y * n_x + to_x, -1)
    cell, action = np.nonzero(on_map)
    centres = _cell_centres(grid)
    segments = np.stack((centres[cell], centres[to_cell[on_map]]), axis=1)
    crash = _crashes(plan, grid.height_m, segments)
    to_cell[cell[crash], action[crash]] = -1
    return to_cell


def _crashes(plan: FloorPlan, height_m: float, segments: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Whether each segment (n, 2, 2) touches a wall or does not stay inside the outline."""
    steps = np.array(shapely.linestrings(segments), dtype=np.object_)
    walls = np.array(shapely.linestrings(plan.solid_segments(height_m)), dtype=np.object_)
    shapely.prepare(plan.outline)
    crash = ~np.array(shapely.contains_properly(plan.outline, steps))
    touching, _ = shapely.STRtree(walls).query(steps, predicate="intersects")
    crash[touching] = True
    return crash


def _renumbered(next_cell: NDArray[np.int64], kept: NDArray[np.int64]) -> NDArray[np.int32]:
    """Step table in terms of the kept cells, numbered in their order, shape (S, 8)."""
    state_of_cell = np.full(next_cell.shape[0] + 1, -1, dtype=np.int32)
    state_of_cell[kept] = np.arange(kept.size, dtype=np.int32)
    return state_of_cell[next_cell[kept]]  # index -1 reads the extra row at the end


def check_speed(speed: object) -> None:
    """Raise WorldError unless a speed is a positive whole number."""
    if (
        isinstance(speed, bool)
        or not isinstance(speed, int | np.integer)
        or not 1 <= speed <= MAX_SPEED
    ):
        raise WorldError(
            f"speed: {speed!r} is not a positive whole number of cells a step; use 1, 2, 4, ... "
            f"up to {MAX_SPEED}"
        )
