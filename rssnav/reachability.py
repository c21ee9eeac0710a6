"""What a flight from a plan's start can reach at each speed; depends on the walls alone."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy import ndimage

from floorplans import FloorPlan
from floorplans.checks.inspection import Finding
from raytrace import Grid, RadioMap, TraceConfig, Transmitter
from rssnav.maps import CELL_SIZE_M, HEIGHT_M, cells_inside
from rssnav.missions.layout import Layout
from rssnav.optimal_flights import shortest_path
from rssnav.world import GOAL_DISTANCE_M, GridWorld, reached_from_start, speeds_that_can

SPEEDS = (1, 2, 4)


@dataclass(frozen=True)
class Reach:
    """What a flight can reach at one speed.

    Attributes
    ----------
    speed : int
        Cells along an axis in a step.
    steps : int or None
        Fewest from the start to the transmitter; None if it cannot be reached.
    length_m : float or None
        Length of that flight [m].
    missed : (n, 2) float64
        Centres (x, y) [m] of free cells on the lattice of steps that cannot be reached because of
        walls; empty if the transmitter cannot be reached.
    n_cells : int
        Number of free cells on the lattice of steps.
    """

    speed: int
    steps: int | None
    length_m: float | None
    missed: NDArray[np.float64]
    n_cells: int


def reach_by_speed(plan: FloorPlan, speeds: tuple[int, ...] = SPEEDS) -> tuple[Reach, ...]:
    """Find what a flight can reach, at each speed.

    Raises
    ------
    WorldError
        When the start is not at the centre of a cell.
    """
    radio_map = _map_without_readings(plan)
    return tuple(_reach(plan, radio_map, speed) for speed in speeds)


def _reach(plan: FloorPlan, radio_map: RadioMap, speed: int) -> Reach:
    layout = Layout.of_plan(plan, radio_map.grid, speed)
    reached = reached_from_start(layout, plan, radio_map)
    source = plan.require_source()
    if reached is None or not (reached.distance_m(*source[:2]) < GOAL_DISTANCE_M).any():
        return Reach(speed, None, None, np.empty((0, 2)), 0)
    world = GridWorld.from_map(plan, radio_map, speed, layout=layout)
    path = shortest_path(world, world.distance_m < GOAL_DISTANCE_M)
    return Reach(speed, path.steps, path.length_m, *_missed(plan, world, radio_map.grid))


def source_unreached(plan: FloorPlan, flights: Sequence[Reach]) -> Finding | None:
    """Report a transmitter that none of the flights reaches; None if one does, or there is none."""
    if not flights or any(reach.steps is not None for reach in flights):
        return None
    x, y, _ = plan.require_source()
    return Finding(
        "warning",
        "source not reached",
        f"at speeds {', '.join(str(reach.speed) for reach in flights)} no cell nearer than "
        f"{GOAL_DISTANCE_M:g} m to the source can be reached from the start {plan.start}; "
        f"{speeds_that_can(plan, _map_without_readings(plan))}",
        (x, y),
    )


def unreached(reach: Reach) -> Finding | None:
    """Report cells that cannot be reached, at their largest area; None if all can."""
    if not len(reach.missed):
        return None
    step_m = CELL_SIZE_M * reach.speed
    cells = np.rint((reach.missed - reach.missed.min(axis=0)) / step_m).astype(np.int64)
    raster = np.zeros(cells.max(axis=0) + 1, dtype=bool)
    raster[tuple(cells.T)] = True
    areas = np.zeros(raster.shape, dtype=np.int64)
    ndimage.label(raster, structure=np.ones((3, 3)), output=areas)
    area_of = areas[tuple(cells.T)]
    largest = int(np.bincount(area_of).argmax())
    x, y = reach.missed[area_of == largest].mean(axis=0)
    percent = 100 * len(reach.missed) / reach.n_cells
    return Finding(
        "warning",
        "not reached",
        f"at speed {reach.speed}, {len(reach.missed)} of {reach.n_cells} cells ({percent:.0f} %) "
        f"cannot be reached from the start; {(area_of == largest).sum()} of them lie around here",
        (float(x), float(y)),
    )


def _missed(plan: FloorPlan, world: GridWorld, grid: Grid) -> tuple[NDArray[np.float64], int]:
    """Centres of free cells on the start's lattice that are not reached; number of free cells."""
    i_x, i_y = np.meshgrid(np.arange(len(grid.x)), np.arange(len(grid.y)))
    start_y, start_x = world.cell[world.start_state]
    on_lattice = ((i_x - start_x) % world.speed == 0) & ((i_y - start_y) % world.speed == 0)
    x, y = np.meshgrid(grid.x, grid.y)
    walls = shapely.multilinestrings(list(plan.solid_segments(grid.height_m)))
    free = (
        cells_inside(plan, grid) & ~shapely.dwithin(shapely.points(x, y), walls, 1e-6) & on_lattice
    )
    missed = free.copy()
    missed[tuple(world.cell.T)] = False
    return np.column_stack([x[missed], y[missed]]), int(free.sum())


def _map_without_readings(plan: FloorPlan) -> RadioMap:
    """Make a map of 0 dBm everywhere, for worlds of which only the walls matter."""
    grid = Grid.over(plan.bounds, CELL_SIZE_M, min(HEIGHT_M, 0.5 * plan.height_m))
    zeros = np.zeros(grid.shape)
    return RadioMap(
        rss_dbm=zeros,
        rss_coherent_dbm=zeros,
        path_count=zeros.astype(np.int64),
        grid=grid,
        transmitter=Transmitter(plan.require_source()),
        config=TraceConfig(),
        plan_sha256=plan.sha256,
    )
