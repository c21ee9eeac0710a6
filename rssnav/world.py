"""The world a UAV learns in: floor plan + radio map + speed -> :class:`GridWorld`.

The UAV flies at constant height from cell centre to cell centre of the radio map's grid. At speed
``v`` one step (1 s) moves it ``v`` cells along each axis it moves on, so a diagonal step is
``sqrt(2)`` times as long as a straight one. A step is impossible when its straight segment, ends
included, touches a wall that is solid at the flying height or leaves the outline: passing exactly
through the end of a wall is a crash. The intersection tests are those of GEOS, whose orientation
predicate is robust, so they need no tolerance.

States are the cells that can be reached from the start by such steps, numbered breadth first from
the start (state 0), so that the table rows of neighbouring cells lie close in memory.
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
    from raytrace import RadioMap

ACTION_NAMES = ("E", "NE", "N", "NW", "W", "SW", "S", "SE")
"""The eight actions, counter-clockwise from +x; their index is the column of every action table."""

ACTIONS: NDArray[np.int64] = np.array(
    [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)], dtype=np.int64
)
"""Cells moved along (x, y) by each action at speed 1, shape (8, 2)."""

GOAL_DISTANCE_M = 2.0
MAX_SPEED = 1_000_000
_SPEEDS_TRIED = range(1, 9)


class WorldError(ValueError):
    """A plan, a radio map and a speed (or an agent) make no world to learn in."""


@dataclass(frozen=True, eq=False)
class GridWorld:
    """Cells a UAV can reach at one speed, and the steps between them.

    Attributes
    ----------
    next_state : (S, 8) int32
        State after each action of :data:`ACTIONS`; -1 where the step would crash.
    rss_dbm : (S,) float64
        Power-sum RSS of the state's cell [dBm]; -inf where the map has no path.
    position : (S, 2) float64
        Cell centre (x, y) [m].
    cell : (S, 2) int32
        Indices (i_y, i_x) of the cell in the map, so ``map[tuple(cell.T)]`` is per state.
    distance_m : (S,) float64
        Horizontal distance to the transmitter [m]. The location-based agent's state is (x, y) and
        it knows where the transmitter is in the plan, so its D is horizontal; in both scenarios of
        the paper D < 2 m then selects the twelve cells with RSS > -21 dBm.
    start_state : int
        State of the start cell.
    speed : int
        Cells moved along an axis in one step.
    step_length_m : (8,) float64
        Length of each action's step [m].
    shape : (int, int)
        Shape (n_y, n_x) of the radio map.
    source : (float, float, float)
        Position of the transmitter, the plan's ``source`` [m].
    plan_name, plan_sha256 : str
        The plan this world was made from.
    """

    next_state: NDArray[np.int32]
    rss_dbm: NDArray[np.float64]
    position: NDArray[np.float64]
    cell: NDArray[np.int32]
    distance_m: NDArray[np.float64]
    start_state: int
    speed: int
    step_length_m: NDArray[np.float64]
    shape: tuple[int, int]
    source: tuple[float, float, float]
    plan_name: str
    plan_sha256: str

    @classmethod
    def from_map(
        cls,
        plan: FloorPlan,
        radio_map: RadioMap,
        speed: int = 1,
        *,
        goal_distance_m: float = GOAL_DISTANCE_M,
    ) -> GridWorld:
        """Build the world of a plan, its radio map and a speed.

        Parameters
        ----------
        plan : FloorPlan
            Gives walls, start and transmitter.
        radio_map : RadioMap
            Gives the cells, their RSS and the flying height; made from the same plan.
        speed : int
            Cells moved along an axis in one step, at least 1.
        goal_distance_m : float
            The transmitter counts as reachable when a cell nearer to it than this is [m].

        Raises
        ------
        WorldError
            When the map belongs to another plan, holds NaN or no path at all, or has no cell
            centre at the start; when the speed is not a positive whole number; or when no cell
            near the transmitter can be reached at this speed.
        """
        _check_speed(speed)
        _check_map(plan, radio_map)
        next_cell = _next_cells(plan, radio_map, speed)
        start_cell = _start_cell(plan, radio_map)
        reached = _reachable_cells(next_cell, start_cell)
        distance_m = _distance_to_transmitter(plan, radio_map)
        if not np.any(distance_m[reached] < goal_distance_m):
            raise _unreachable(plan, radio_map, speed, goal_distance_m)
        n_y, n_x = radio_map.rss_dbm.shape
        return cls(
            next_state=_renumbered(next_cell, reached),
            rss_dbm=radio_map.rss_dbm.reshape(-1)[reached].astype(np.float64),
            position=_cell_centres(radio_map)[reached],
            cell=np.column_stack(np.divmod(reached, n_x)).astype(np.int32),
            distance_m=distance_m[reached],
            start_state=0,
            speed=int(speed),
            step_length_m=_step_lengths(radio_map.grid.cell_size_m * speed),
            shape=(n_y, n_x),
            source=plan.require_source(),
            plan_name=plan.name,
            plan_sha256=plan.sha256,
        )

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

    def on_grid(self, values: NDArray[np.generic], fill: float = 0.0) -> NDArray[np.float64]:
        """Spread per-state values over the radio map's grid.

        Parameters
        ----------
        values : (..., S)
            A value per state.
        fill : float
            Value of the cells that are not a state.

        Returns
        -------
        (..., n_y, n_x) float64
        """
        grid = np.full((*values.shape[:-1], *self.shape), fill)
        grid[..., self.cell[:, 0], self.cell[:, 1]] = values
        return grid


def _step_lengths(straight_m: float) -> NDArray[np.float64]:
    """Length of each action's step [m], shape (8,)."""
    return straight_m * np.hypot(ACTIONS[:, 0], ACTIONS[:, 1])


def _cell_centres(radio_map: RadioMap) -> NDArray[np.float64]:
    """Centres (x, y) [m] of all cells in row-major order, shape (n_y * n_x, 2)."""
    x, y = np.meshgrid(radio_map.grid.x, radio_map.grid.y)
    return np.column_stack((x.reshape(-1), y.reshape(-1)))


def _distance_to_transmitter(plan: FloorPlan, radio_map: RadioMap) -> NDArray[np.float64]:
    """Horizontal distance of every cell to the transmitter [m], shape (n_y * n_x,)."""
    offset = _cell_centres(radio_map) - np.array(plan.require_source()[:2])
    return np.hypot(offset[:, 0], offset[:, 1])


def _next_cells(plan: FloorPlan, radio_map: RadioMap, speed: int) -> NDArray[np.int64]:
    """Flat index of the cell each step leads to, shape (n_y * n_x, 8); -1 where it crashes."""
    n_y, n_x = radio_map.rss_dbm.shape
    i_y, i_x = np.divmod(np.arange(n_y * n_x)[:, None], n_x)
    to_x, to_y = i_x + speed * ACTIONS[:, 0], i_y + speed * ACTIONS[:, 1]
    on_map = (to_x >= 0) & (to_x < n_x) & (to_y >= 0) & (to_y < n_y)
    to_cell = np.where(on_map, to_y * n_x + to_x, -1)
    cell, action = np.nonzero(on_map)
    centres = _cell_centres(radio_map)
    segments = np.stack((centres[cell], centres[to_cell[on_map]]), axis=1)
    crash = _crashes(plan, radio_map.grid.height_m, segments)
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


def _reachable_cells(next_cell: NDArray[np.int64], start_cell: int) -> NDArray[np.int64]:
    """Flat indices of the cells reachable from the start, breadth first."""
    cell, action = np.nonzero(next_cell >= 0)
    size = next_cell.shape[0]
    moves = coo_array(
        (np.ones(cell.size), (cell, next_cell[cell, action])), shape=(size, size)
    ).tocsr()
    return breadth_first_order(moves, start_cell, return_predecessors=False).astype(np.int64)


def _renumbered(next_cell: NDArray[np.int64], reached: NDArray[np.int64]) -> NDArray[np.int32]:
    """Step table in terms of states, given the cell of each state, shape (S, 8)."""
    state_of_cell = np.full(next_cell.shape[0] + 1, -1, dtype=np.int32)
    state_of_cell[reached] = np.arange(reached.size, dtype=np.int32)
    return state_of_cell[next_cell[reached]]  # index -1 reads the extra row at the end


def _start_cell(plan: FloorPlan, radio_map: RadioMap) -> int:
    """Flat index of the cell whose centre is the plan's start."""
    grid, (x, y) = radio_map.grid, plan.require_start()
    i_x = int(np.argmin(np.abs(grid.x - x)))
    i_y = int(np.argmin(np.abs(grid.y - y)))
    centre = (float(grid.x[i_x]), float(grid.y[i_y]))
    if max(abs(centre[0] - x), abs(centre[1] - y)) > 1e-6:
        raise WorldError(
            f"plan {plan.name!r}: the start {plan.start} m is not at a cell centre of the radio "
            f"map; the nearest is {centre} m: move the start there, or make a map whose grid "
            "holds it"
        )
    return i_y * grid.x.size + i_x


def _check_speed(speed: object) -> None:
    if (
        isinstance(speed, bool)
        or not isinstance(speed, int | np.integer)
        or not 1 <= speed <= MAX_SPEED
    ):
        raise WorldError(
            f"speed: {speed!r} is not a positive whole number of cells a step; use 1, 2, 4, ... "
            f"up to {MAX_SPEED}"
        )


def _check_map(plan: FloorPlan, radio_map: RadioMap) -> None:
    """Refuse a map that cannot belong to the plan or has no reading."""
    # for a map without a plan's hash the caller is trusted
    if radio_map.plan_sha256 not in ("", plan.sha256):
        raise WorldError(
            f"the radio map was made for a different plan than {plan.name!r} (sha256 "
            f"{radio_map.plan_sha256[:12]}, the plan has {plan.sha256[:12]}): compute the map again"
        )
    rss_dbm = radio_map.rss_dbm
    undefined = int(np.count_nonzero(np.isnan(rss_dbm)))
    if undefined:
        raise WorldError(
            f"radio map of plan {plan.name!r}: rss_dbm is NaN in {undefined} cells; a cell "
            "without a path must be -inf"
        )
    if not np.any(np.isfinite(rss_dbm)):
        raise WorldError(
            f"radio map of plan {plan.name!r}: no cell has a path (every rss_dbm is -inf); check "
            "the source's position and power"
        )


def _unreachable(
    plan: FloorPlan, radio_map: RadioMap, speed: int, goal_distance_m: float
) -> WorldError:
    """Build the error for an unreachable transmitter; it lists the speeds that do reach it."""
    near = _distance_to_transmitter(plan, radio_map) < goal_distance_m
    start = _start_cell(plan, radio_map)
    working = [
        other
        for other in _SPEEDS_TRIED
        if near[_reachable_cells(_next_cells(plan, radio_map, other), start)].any()
    ]
    remedy = (
        f"speeds that can: {', '.join(map(str, working))}"
        if working
        else f"no speed from 1 to {_SPEEDS_TRIED[-1]} can: open a way in the plan"
    )
    return WorldError(
        f"plan {plan.name!r}: at speed {speed} no cell nearer than {goal_distance_m:g} m to the "
        f"source {plan.source} can be reached from the start {plan.start}; {remedy}"
    )
