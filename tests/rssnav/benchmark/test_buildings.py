"""Buildings of the benchmark that are one's own, and where flights begin in them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import floorplans
from raytrace import Grid
from rssnav.benchmark.buildings import FEWEST_STEPS, GOAL, LEAST_STEPS, Building, own
from rssnav.benchmark.protocol import FULL, extent_of
from rssnav.maps import CELL_SIZE_M, HEIGHT_M
from rssnav.missions import Layout, Task
from rssnav.policies import Hypotheses

ROOM = """
name = "room"
format = 1
height_m = 3
floor_material = "concrete"
ceiling_material = "concrete"
outline = {corners}
[[walls]]
points = {corners}
material = "concrete"
thickness_m = 0.2
"""


def place_of(building, cell):
    x, y = building.layout.position[cell].tolist()
    return (x + 0.1, y + 0.1, 1.2)


def in_rooms(width_m, height_m=3.0, cells=(0,)):
    """Return a building of one room of a plan of one's own, with transmitters in some cells."""
    corners = [[0, 0], [width_m, 0], [width_m, height_m], [0, height_m], [0, 0]]
    plan = floorplans.loads(ROOM.format(corners=corners))
    grid = Grid.over(plan.bounds, CELL_SIZE_M, HEIGHT_M)
    building = Building("own", 0, plan, Layout.of_plan(plan, grid), ())
    return replace(building, places=tuple(place_of(building, cell) for cell in cells))


@pytest.mark.parametrize("width_m", [9.0, 12.0, 15.0, 20.0])
def test_flights_begin_ten_steps_away_or_in_the_farthest_cells(width_m):
    """Steps are counted cell by cell to where the RSS is above the level."""
    building = in_rooms(width_m)
    mission = building.mission()
    found = GOAL.cells(mission)[0]
    position = building.layout.position
    apart = np.abs(position[:, None] - position[found]).max(
        axis=-1
    )  # king's moves, no wall between
    steps = np.round(apart.min(axis=1)).astype(int)
    assert steps.max() >= FEWEST_STEPS
    expected = np.flatnonzero(steps >= min(LEAST_STEPS, steps.max()))
    assert mission.starts.tolist() == expected.tolist()


def test_a_building_in_which_every_cell_is_near_is_refused():
    with pytest.raises(ValueError, match=r"own-000 \(plan 'room'\): .*a larger building"):
        in_rooms(5.0).mission()
    with pytest.raises(ValueError, match="a larger building is needed"):
        in_rooms(9.0, cells=(0, 8)).mission()  # far from one, near the other


def test_plans_of_ones_own_have_transmitters_in_reach(tmp_path):
    file = tmp_path / "mine.toml"
    file.write_text(
        floorplans.dumps(floorplans.generate("office", 5, area_m2=400.0, n_transmitters=0))
    )
    (building,) = own((file,))
    mission = building.mission()
    assert mission.n_modes == 3
    assert Hypotheses.of_mission(mission, Task(GOAL)).hops.max() < 1000


def test_plans_of_ones_own_are_compared_by_content(tmp_path):
    text = floorplans.dumps(floorplans.load("flat"))
    one, other = tmp_path / "one.toml", tmp_path / "other.toml"
    one.write_text(text)
    other.write_text(text)
    extents = [extent_of(FULL, "test", 0, (file,)) for file in (one, other, "flat")]
    assert extents[0] == extents[1] == extents[2]
    assert extents[0].written == extents[1].written
    other.write_text(text.replace('"brick"', '"concrete"'))
    assert extent_of(FULL, "test", 0, (other,)) != extents[0]
