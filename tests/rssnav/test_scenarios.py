"""The reconstructed floor plans keep what the paper fixes, and its flights exist in them."""

from dataclasses import replace
from functools import cache
from itertools import product

import numpy as np
import pytest
import shapely
from shapely.geometry import LineString, MultiLineString
from shapely.geometry.base import BaseGeometry

import floorplans
from floorplans import FloorPlan
from raytrace import Grid, RadioMap, TraceConfig, Transmitter
from rssnav import GridWorld
from rssnav.experiments.studies.plan_search.constraints import (
    allows_printed_flights,
    arrivals,
)
from rssnav.experiments.studies.plan_search.families import draw

FLYING_HEIGHT_M = 2.0
GOAL_DISTANCE_M = 2.0

# What the paper states: floor area [m], source [m], and the index of the cell the search begins in.
STATED = {
    "scenario1": ((96.0, 26.0), (5.0, 14.0, 1.5), (93, 2)),
    "scenario2": ((76.0, 58.0), (4.0, 4.0, 1.5), (74, 55)),
}

# Block and number of the drawing in the search for floor plans, with seed 0.
DRAWN_AS = {"scenario1": (11, 130), "scenario2": (13, 214)}

scenarios = pytest.mark.parametrize("name", sorted(STATED))


@cache
def world_without_radio(name: str, speed: int) -> GridWorld:
    """Steps do not depend on the radio: any map over the plan's grid will do."""
    plan = floorplans.load(name)
    grid = Grid.over(plan.bounds, 1.0, FLYING_HEIGHT_M)
    flat = np.zeros(grid.shape)
    radio_map = RadioMap(
        rss_dbm=flat,
        rss_coherent_dbm=flat,
        path_count=np.ones(grid.shape, dtype=np.int64),
        grid=grid,
        transmitter=Transmitter(position=plan.source),
        config=TraceConfig(),
    ).with_plan(floorplans.dumps(plan), plan.sha256)
    return GridWorld.from_map(plan, radio_map, speed=speed)


@scenarios
def test_size_source_and_start_are_the_papers(name: str) -> None:
    plan = floorplans.load(name)
    size, source, (i_x, i_y) = STATED[name]
    assert plan.bounds == (0.0, 0.0, *size)
    assert plan.outline.area == pytest.approx(size[0] * size[1])
    assert plan.source == source
    assert plan.start == (i_x + 0.5, i_y + 0.5)


@scenarios
def test_walls_are_3_m_high_and_their_openings_are_doors_of_2_70_m(name: str) -> None:
    plan = floorplans.load(name)
    assert plan.height_m == 3.0
    assert {wall.height_m for wall in plan.walls} == {3.0}
    doors = {(o.kind, o.sill_m, o.head_m, o.material) for w in plan.walls for o in w.openings}
    assert doors == {("door", 0.0, 2.7, None)}


@scenarios
def test_walls_and_door_jambs_stand_on_whole_metres(name: str) -> None:
    ends = floorplans.load(name).solid_segments(FLYING_HEIGHT_M).reshape(-1, 2)
    np.testing.assert_allclose(ends, np.round(ends), rtol=0.0, atol=1e-9)


@scenarios
def test_a_uav_keeps_half_a_metre_from_every_wall(name: str) -> None:
    plan = floorplans.load(name)
    walls = MultiLineString(list(plan.solid_segments(FLYING_HEIGHT_M)))
    centres = Grid.over(plan.bounds, 1.0, FLYING_HEIGHT_M).points()[:, :2]
    assert shapely.distance(shapely.points(centres), walls).min() == pytest.approx(0.5)


@scenarios
def test_twelve_cells_are_nearer_than_2_m_to_the_source(name: str) -> None:
    plan = floorplans.load(name)
    world = world_without_radio(name, 1)
    near = world.position[world.distance_m < GOAL_DISTANCE_M] - plan.source[:2]
    ring = {-1.5, -0.5, 0.5, 1.5}
    expected = {(x, y) for x, y in product(ring, ring) if abs(x) + abs(y) < 3}
    assert {(float(x), float(y)) for x, y in near} == expected
    assert len(near) == 12


@scenarios
def test_a_uav_can_fly_into_every_room(name: str) -> None:
    plan = floorplans.load(name)
    n_cells = len(Grid.over(plan.bounds, 1.0, FLYING_HEIGHT_M).points())
    assert world_without_radio(name, 1).n_states == n_cells


@scenarios
def test_the_printed_flights_exist_and_none_is_shorter(name: str) -> None:
    assert allows_printed_flights(floorplans.load(name), int(name[-1]))


@scenarios
def test_the_plan_is_the_one_that_the_search_draws(name: str) -> None:
    block, number = DRAWN_AS[name]
    scenario = int(name[-1])
    rng = np.random.default_rng((0, scenario, block))
    for _ in range(number + 1):
        plan = draw(scenario, rng)
    assert plan is not None
    assert drawing(plan) == drawing(floorplans.load(name))


def drawing(plan: FloorPlan) -> tuple[dict[str, BaseGeometry], set[tuple[object, ...]]]:
    """Lines of each material, whatever walls they are divided into, and where all doors are."""
    lines: dict[str, list[LineString]] = {}
    doors: set[tuple[object, ...]] = set()
    for wall in plan.walls:
        lines.setdefault(wall.material, []).append(LineString([wall.start, wall.end]))
        for o in wall.openings:
            jambs = (wall.point_at(at) for at in (o.offset_m, o.offset_m + o.width_m))
            doors.add((*sorted(jambs), o.sill_m, o.head_m))
    merged = {name: shapely.normalize(union_of(parts)) for name, parts in lines.items()}
    return merged, doors


def union_of(lines: list[LineString]) -> BaseGeometry:
    """One geometry of lines, without the points at which they only continue."""
    return shapely.simplify(shapely.line_merge(shapely.union_all(lines)), 0.0)


def test_only_at_1_and_2_m_s_the_way_through_the_compartment_is_faster() -> None:
    """What docs/paper_statements.md says of Scenario 2."""
    plan = floorplans.load("scenario2")
    walls = [replace(w, openings=()) if min(w.start[1], w.end[1]) > 30 else w for w in plan.walls]
    closed = replace(plan, walls=tuple(walls))
    least = [[arrivals(p, v, 110).least_steps for v in (1, 2, 4)] for p in (plan, closed)]
    assert least == [[100, 52, 28], [106, 54, 28]]


def test_scenario_1_is_the_simpler_one() -> None:
    simple, complex_ = (rooms(floorplans.load(name)) for name in sorted(STATED))
    assert simple < complex_ <= 25


def rooms(plan: FloorPlan) -> int:
    """Spaces left when every door is closed."""
    closed = shapely.linestrings([[wall.start, wall.end] for wall in plan.walls])
    return len(shapely.get_parts(shapely.polygonize([shapely.union_all(closed)])))
