"""The inside of a column is no cell of a map, no state of a world, and blank in pictures."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.figure import Figure
from small_plans import box, ring

from floorplans import Opening, Wall
from raytrace import RadioMap, TraceConfig
from raytrace.results.layers import EMPTY
from rssnav import GridWorld
from rssnav.maps import cells_inside, make_map
from rssnav.pictures.radio_map import draw_radio_map
from rssnav.reachability import reach_by_speed

COLUMN = ring([(2.2, 2.2), (2.8, 2.2), (2.8, 2.8), (2.2, 2.8)], "plasterboard")
CLOSED = Wall((5.0, 0.0), (5.0, 4.0), "concrete", 0.1, 3.0)
PLAN = box((*COLUMN, CLOSED), start=(4.5, 2.5))
INSIDE = (2, 2)  # the cell in the column


@pytest.fixture(scope="module")
def radio_map():
    """A map whose waves pass through walls: something would arrive within the column."""
    return make_map(PLAN, config=TraceConfig(1, 0, max_transmissions=1))


def test_nothing_is_received_in_a_column(radio_map, tmp_path) -> None:
    radio_map.save(tmp_path / "map.h5")
    radio_map = RadioMap.load(tmp_path / "map.h5")
    assert not cells_inside(PLAN, radio_map.grid)[INSIDE]
    assert cells_inside(PLAN, radio_map.grid).sum() == 23
    for name, layer in radio_map.layers.items():
        assert layer[INSIDE] == EMPTY[name]
    beside = tuple(replace(wall, height_m=1.0) for wall in COLUMN)
    over = make_map(box((*beside, CLOSED)), config=TraceConfig(1, 0, max_transmissions=1))
    assert np.isfinite(over.rss_dbm[INSIDE])  # receivers above a low one


def test_flights_pass_a_column_and_do_not_miss_it(radio_map) -> None:
    world = GridWorld.from_map(PLAN, radio_map)
    assert (2, 2) not in {tuple(cell) for cell in world.cell}
    reach = reach_by_speed(PLAN, (1,))[0]
    assert reach.n_cells == 23
    assert len(reach.missed) == 4  # behind the wall at x = 5, and not within the column


def test_column_and_outside_are_not_hatched() -> None:
    radio_map = make_map(PLAN, config=TraceConfig(0, 0))
    uncovered = np.isneginf(radio_map.rss_dbm)
    assert uncovered[INSIDE]
    assert uncovered[0, 5]
    ax = Figure().add_subplot()
    draw_radio_map(PLAN, radio_map, ax)
    artists = {artist.get_gid(): artist for artist in ax.collections}
    centres = {
        tuple(np.floor(path.vertices[:4].mean(axis=0)).astype(int))
        for path in artists["no path"].get_paths()
    }
    dark = uncovered & cells_inside(PLAN, radio_map.grid)
    assert centres == {(x, y) for y, x in np.argwhere(dark)}
    assert (2, 2) not in centres
    assert len(artists["columns"].get_paths()) == 1


def test_cells_outside_an_outline_that_is_no_rectangle_are_blank() -> None:
    door = Opening(0.5, 1.0, 0.0, 2.2, "door")
    corners = [(0.0, 0.0), (6.0, 0.0), (6.0, 2.0), (3.0, 2.0), (3.0, 4.0), (0.0, 4.0)]
    wing = Wall((3.0, 2.0), (3.0, 0.0), "concrete", 0.1, 3.0, (replace(door, material="metal"),))
    plan = replace(
        PLAN, outline=type(PLAN.outline)(corners), walls=(*ring(corners, "concrete"), wing),
        start=(2.5, 3.5),
    )  # fmt: skip
    radio_map = make_map(plan, config=TraceConfig(0, 0))
    ax = Figure().add_subplot()
    draw_radio_map(plan, radio_map, ax)
    (hatched,) = (artist for artist in ax.collections if artist.get_gid() == "no path")
    assert len(hatched.get_paths()) == 6  # the wing, without the quarter that is outside
