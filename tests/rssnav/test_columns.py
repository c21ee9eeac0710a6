"""The inside of a column is no cell of a map, no state of a world, and blank in pictures."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from cli_plans import done
from matplotlib.figure import Figure
from small_plans import box, ring

import floorplans
from floorplans import Opening, Wall
from raytrace import RadioMap, TraceConfig
from raytrace.results.layers import EMPTY
from rssnav import GridWorld
from rssnav.explorer.map_figure import MapFigure
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


def test_explorer_hatches_the_same_cells() -> None:
    radio_map = make_map(PLAN, config=TraceConfig(0, 0))

    def ignore(*_: object) -> None:
        pass

    figure = MapFigure(PLAN, 2.0, on_move=ignore, on_drag=ignore, on_tap=ignore, on_step=ignore)
    figure.show_map(radio_map)
    (hatched,) = (
        r for r in figure.model.renderers if getattr(r.glyph, "hatch_pattern", None) == "cross"
    )
    shown = np.column_stack([hatched.data_source.data[axis] for axis in "xy"])
    dark = np.isneginf(radio_map.rss_dbm) & cells_inside(PLAN, radio_map.grid)
    assert np.allclose(shown, radio_map.grid.points()[dark.ravel(), :2])


def test_summary_of_a_map_counts_what_is_outside_apart(tmp_path) -> None:
    floorplans.save(PLAN, tmp_path / "a.toml")
    options = ("--reflections", "0", "--diffractions", "0", "--json")
    told = json.loads(done("map", tmp_path / "a.toml", "-o", tmp_path / "a.h5", *options))
    radio_map = RadioMap.load(tmp_path / "a.h5")
    assert told["cells_outside"] == 1
    assert told["cells_without_path"] == np.isneginf(radio_map.rss_dbm).sum() - 1
