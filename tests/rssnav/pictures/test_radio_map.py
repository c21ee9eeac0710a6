"""The picture of a map shows every reading in its place, and no reading where there is no path."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from cli_plans import ROOM
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure

import floorplans
from raytrace import Grid, TraceConfig
from rssnav.maps import make_map
from rssnav.pictures.radio_map import draw_radio_map, map_figure, save_map_picture
from rssnav.pictures.style import COLUMN_IN, INK, PAGE_IN, chosen_style

DARK = (2, 4)


@pytest.fixture(scope="module")
def plan():
    return floorplans.loads(ROOM)


@pytest.fixture(scope="module")
def whole(plan):
    """A map in which every cell has a reading."""
    radio_map = make_map(plan, config=TraceConfig(1, 0))
    ramp = np.linspace(-60.0, -20.0, radio_map.rss_dbm.size).reshape(radio_map.rss_dbm.shape)
    return replace(radio_map, rss_dbm=ramp)


@pytest.fixture(scope="module")
def with_a_dark_cell(whole):
    rss_dbm = whole.rss_dbm.copy()
    rss_dbm[DARK] = -np.inf
    return replace(whole, rss_dbm=rss_dbm)


def by_gid(ax) -> dict[str, object]:
    return {artist.get_gid(): artist for artist in ax.get_children() if artist.get_gid()}


def test_readings_lie_on_their_cells(plan, whole) -> None:
    ax = Figure().add_subplot()
    image = draw_radio_map(plan, whole, ax)
    assert image.get_extent() == [0.0, 6.0, 0.0, 4.0]
    assert image.origin == "lower"
    assert np.array_equal(image.get_array(), whole.rss_dbm)
    assert image.get_clim() == (-60.0, -20.0)
    assert "no path" not in by_gid(ax)
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("$x$ [m]", "$y$ [m]")
    assert ax.get_aspect() == 1.0


def test_cell_without_a_path_is_hatched_and_has_no_colour(plan, with_a_dark_cell) -> None:
    ax = Figure().add_subplot()
    image = draw_radio_map(plan, with_a_dark_cell, ax)
    assert np.argwhere(np.ma.getmaskarray(image.get_array())).tolist() == [list(DARK)]
    assert np.isfinite(image.get_clim()).all()
    hatched = by_gid(ax)["no path"]
    assert isinstance(hatched, PolyCollection)
    assert hatched.get_hatch()
    (cell,) = hatched.get_paths()
    assert cell.get_extents().bounds == (4.0, 2.0, 1.0, 1.0)


def test_the_star_is_at_the_transmitter_of_the_map(plan, whole) -> None:
    moved = replace(whole, transmitter=replace(whole.transmitter, position=(1.25, 2.5, 1.0)))
    ax = Figure().add_subplot()
    draw_radio_map(replace(plan, start=None), moved, ax)
    marks = by_gid(ax)
    assert marks["transmitter"].get_xydata().tolist() == [[1.25, 2.5]]
    assert not {"source", "start"} & set(marks)


def test_source_start_and_walls_are_where_the_plan_has_them(plan, whole) -> None:
    ax = Figure().add_subplot()
    draw_radio_map(plan, whole, ax)
    marks = by_gid(ax)
    assert marks["source"].get_xydata().tolist() == [list(plan.source[:2])]
    assert marks["start"].get_xydata().tolist() == [list(plan.start)]
    solid = marks["solid walls"]
    assert isinstance(solid, LineCollection)
    assert np.array_equal(np.array(solid.get_segments()), plan.solid_segments(2.0))


def test_range_of_colours_can_be_shared_between_maps(plan, whole) -> None:
    image = draw_radio_map(plan, whole, Figure().add_subplot(), rss_range_dbm=(-90.0, -10.0))
    assert image.get_clim() == (-90.0, -10.0)


def test_map_without_any_path_can_be_drawn(plan, whole) -> None:
    dark = replace(whole, rss_dbm=np.full(whole.rss_dbm.shape, -np.inf))
    ax = Figure().add_subplot()
    draw_radio_map(plan, dark, ax)
    assert len(by_gid(ax)["no path"].get_paths()) == dark.rss_dbm.size


def test_saved_picture_names_units_and_explains_the_hatching(
    plan, whole, with_a_dark_cell, tmp_path
) -> None:
    save_map_picture(plan, with_a_dark_cell, tmp_path / "dark.svg")
    save_map_picture(plan, whole, tmp_path / "whole.svg")
    text = (tmp_path / "dark.svg").read_text()
    for words in ("RSS [dBm]", "[m]", "room: 25 dBm at 2.4 GHz", "wall at 2 m", "no path"):
        assert words in text
    assert ">no path<" not in (tmp_path / "whole.svg").read_text()
    assert sorted(file.name for file in tmp_path.iterdir()) == ["dark.svg", "whole.svg"]


def test_a_small_plan_fills_a_column_and_a_long_one_the_page(plan, whole) -> None:
    assert map_figure(plan, whole).get_figwidth() == COLUMN_IN
    long = floorplans.load("scenario1")
    grid = Grid.over(long.bounds, 1.0, 2.0)
    figure = map_figure(long, replace(whole, grid=grid, rss_dbm=np.zeros(grid.shape)))
    assert figure.get_figwidth() == PAGE_IN


def test_nothing_of_the_picture_is_cut_off_or_overlaps(plan, with_a_dark_cell) -> None:
    figure = map_figure(plan, with_a_dark_cell)
    renderer = FigureCanvasAgg(figure).get_renderer()
    figure.draw(renderer)
    parts = [figure._suptitle, *figure.axes, *figure.legends]
    boxes = [part.get_tightbbox(renderer) for part in parts]
    for k, box in enumerate(boxes):
        assert figure.bbox.containsx(box.x0)
        assert figure.bbox.containsx(box.x1)
        assert figure.bbox.containsy(box.y0)
        assert figure.bbox.containsy(box.y1)
        assert not any(box.overlaps(other) for other in boxes[:k])


def test_a_chosen_style_is_laid_over_the_projects_own(plan, whole, tmp_path) -> None:
    own = tmp_path / "own.mplstyle"
    own.write_text("font.size: 11\naxes.labelcolor: ff0000\n")
    with chosen_style(str(own)):
        figure = map_figure(plan, whole)
    assert figure.axes[0].xaxis.label.get_color() == "#ff0000"
    assert map_figure(plan, whole).axes[0].xaxis.label.get_color() == INK


@pytest.mark.parametrize("style", ["gray scale", "https://example.org/a.mplstyle", "no.such"])
def test_a_style_that_there_is_not_is_refused(style) -> None:
    refusal = r"is not a matplotlib style; .*ggplot"
    with pytest.raises(ValueError, match=refusal), chosen_style(style):
        pytest.fail("a style that does not exist was taken")


def test_pdf_embeds_its_fonts(plan, whole, tmp_path) -> None:
    save_map_picture(plan, whole, tmp_path / "map.pdf")
    assert b"/FontFile2" in (tmp_path / "map.pdf").read_bytes()
