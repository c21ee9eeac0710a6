"""The world a UAV learns in: floor plan + radio map + speed -> :class:`GridWorld`.

The UAV flies at constant height from cell centre to cell centre of the radio map's grid, by the
steps of a :class:`~rssnav.missions.layout.Layout`. States are the cells that can be reached from
the start, numbered breadth first from the start (state 0), so that the table rows of neighbouring
cells lie close in memory.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from rssnav.missions.layout import ACTION_NAMES, ACTIONS, Layout, WorldError, check_speed
from rssnav.missions.mission import Mission
from rssnav.missions.modes import ModeProcess
from rssnav.missions.task import GOAL_DISTANCE_M

if TYPE_CHECKING:
    from floorplans import FloorPlan
    from raytrace import RadioMap

__all__ = ["ACTIONS", "ACTION_NAMES", "GOAL_DISTANCE_M", "GridWorld", "WorldError"]

_SPEEDS_TRIED = range(1, 9)


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

    def __repr__(self) -> str:
        """Plan, cells and speed in one line."""
        return f"<GridWorld of {self.plan_name!r}: {len(self.position)} cells, speed {self.speed}>"

    @classmethod
    def from_map(
        cls,
        plan: FloorPlan,
        radio_map: RadioMap,
        speed: int = 1,
        *,
        goal_distance_m: float = GOAL_DISTANCE_M,
        layout: Layout | None = None,
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
        layout : Layout, optional
            Steps of the same walls, grid and speed, found before for another transmitter or start.

        Raises
        ------
        WorldError
            When the map belongs to another plan, holds NaN or no path at all, or has no cell
            centre at the start; when the speed is not a positive whole number; or when no cell
            near the transmitter can be reached at this speed.
        """
        check_speed(speed)
        _check_map(plan, radio_map)
        if layout is None or layout.speed != speed:
            layout = Layout.of_plan(plan, radio_map.grid, speed)
        source = plan.require_source()
        reached = reached_from_start(layout, plan, radio_map)
        if reached is None or not np.any(reached.distance_m(*source[:2]) < goal_distance_m):
            raise _unreachable(plan, radio_map, speed, goal_distance_m)
        return cls(
            next_state=reached.next_state,
            rss_dbm=reached.on_cells(radio_map.rss_dbm),
            position=reached.position,
            cell=reached.cell,
            distance_m=reached.distance_m(*source[:2]),
            start_state=0,
            speed=reached.speed,
            step_length_m=reached.step_length_m,
            shape=reached.shape,
            source=source,
            plan_name=plan.name,
            plan_sha256=plan.sha256,
        )

    @cached_property
    def layout(self) -> Layout:
        """Steps between the world's cells, without transmitter and start."""
        return Layout(
            self.next_state,
            self.position,
            self.cell,
            self.shape,
            self.speed,
            self.step_length_m,
            self.plan_name,
        )

    def mission(self) -> Mission:
        """Mission of one mode: the transmitter, doors and start of this world."""
        return Mission(
            layouts=(self.layout,),
            layout_of_mode=np.zeros(1, dtype=np.int64),
            rss_dbm=self.rss_dbm[None],
            distance_m=self.distance_m[None],
            modes=ModeProcess.steady(),
            starts=np.array([self.start_state], dtype=np.int32),
            start_probability=np.ones(1),
            source=np.array([self.source[:2]], dtype=np.float64),
            name=self.plan_name,
        )

    @property
    def n_states(self) -> int:
        """Number S of states."""
        return self.next_state.shape[0]

    @property
    def action_mask(self) -> NDArray[np.bool_]:
        """Possible actions of each state, shape (S, 8); read-only."""
        return self.layout.action_mask

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
        return self.layout.on_grid(values, fill)


def reached_from_start(layout: Layout, plan: FloorPlan, radio_map: RadioMap) -> Layout | None:
    """Cells reachable from the start, breadth first from it; None if it has no possible step.

    Raises
    ------
    WorldError
        When the map has no cell centre at the start.
    """
    i_y, i_x = np.divmod(_start_cell(plan, radio_map), radio_map.grid.x.size)
    start = np.flatnonzero(np.all(layout.cell == (i_y, i_x), axis=1))
    return layout.part(layout.reachable(int(start[0]))) if start.size else None


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
    """Build the error for an unreachable transmitter."""
    return WorldError(
        f"plan {plan.name!r}: at speed {speed} no cell nearer than {goal_distance_m:g} m to the "
        f"source {plan.source} can be reached from the start {plan.start}; "
        f"{speeds_that_can(plan, radio_map, goal_distance_m)}"
    )


def speeds_that_can(
    plan: FloorPlan, radio_map: RadioMap, goal_distance_m: float = GOAL_DISTANCE_M
) -> str:
    """Say at which speeds a cell near the transmitter can be reached from the start."""
    working: list[int] = []
    for other in _SPEEDS_TRIED:
        reached = reached_from_start(Layout.of_plan(plan, radio_map.grid, other), plan, radio_map)
        near = reached and reached.distance_m(*plan.require_source()[:2]) < goal_distance_m
        if near is not None and near.any():
            working.append(other)
    if not working:
        return f"no speed from 1 to {_SPEEDS_TRIED[-1]} can: open a way in the plan"
    return f"speeds that can: {', '.join(map(str, working))}"
