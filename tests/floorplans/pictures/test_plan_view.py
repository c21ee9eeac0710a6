"""Pictures hold what the plan holds; artists are looked at, not pixels."""

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d.art3d import Poly3DCollection
from shapely.geometry import Polygon
from small_plans import box

import floorplans
from floorplans import MATERIAL_COLOURS, FloorPlan, Opening, Wall
from floorplans.pictures.axonometric import draw_plan_3d
from floorplans.pictures.plan_view import draw_plan, save_plan_picture


def drawn(plan: FloorPlan) -> Axes:
    ax = Figure().add_subplot()
    draw_plan(plan, ax)
    return ax


def artists(ax: Axes, gid: str) -> list:
    return ax.findobj(lambda artist: artist.get_gid() == gid, include_self=False)


def legend_texts(ax: Axes) -> list[str]:
    return [text.get_text() for text in ax.get_legend().get_texts()]


def test_strips_have_length_and_thickness_of_the_walls() -> None:
    door = Opening(1.0, 0.9, 0.0, 2.0, "door")
    ax = drawn(box((Wall((3.0, 0.0), (3.0, 4.0), "brick", 0.4, 3.0, (door,)),)))
    (brick,) = artists(ax, "walls:brick")
    area = sum(Polygon(path.vertices).area for path in brick.get_paths())
    assert area == pytest.approx((4 - 0.9) * 0.4)
    assert to_hex(brick.get_facecolor()[0]) == MATERIAL_COLOURS["brick"]


def test_corners_are_filled() -> None:
    (sides,) = artists(drawn(box()), "walls:concrete")
    outer = Polygon([(-0.1, -0.1), (6.1, -0.1), (6.1, 4.1), (-0.1, 4.1)])
    union = Polygon()
    for path in sides.get_paths():
        union = union.union(Polygon(path.vertices))
    assert union.area == pytest.approx(outer.area - 5.8 * 3.8)


def test_thin_walls_stay_visible() -> None:
    ax = drawn(box((Wall((3.0, 0.0), (3.0, 4.0), "brick", 1e-3, 3.0),)))
    (brick,) = artists(ax, "walls:brick")
    assert np.ptp(brick.get_paths()[0].vertices[:, 0]) == pytest.approx(0.004 * 6)


def test_wide_door_has_two_leaves_and_opens_into_the_larger_room() -> None:
    doors = (Opening(0.5, 0.8, 0.0, 2.0, "door"), Opening(2.0, 1.6, 0.0, 2.0, "door"))
    ax = drawn(box((Wall((2.0, 0.0), (2.0, 4.0), "brick", 0.1, 3.0, doors),)))
    (symbols,) = artists(ax, "openings:door")
    shapes = [path.vertices for path in symbols.get_paths()]
    assert len(shapes) == 2 + 4
    assert all(shape[:, 0].min() >= 2 for shape in shapes)
    assert max(shape[:, 0].max() for shape in shapes) == pytest.approx(2.8)


def test_flat_shows_every_opening_filling_and_mark() -> None:
    plan = floorplans.load("flat")
    ax = drawn(plan)
    openings = [o for wall in plan.walls for o in wall.openings]
    for kind, shapes_each in (("door", 2), ("window", 2), ("passage", 2)):
        (symbols,) = artists(ax, f"openings:{kind}")
        assert len(symbols.get_paths()) == shapes_each * sum(o.kind == kind for o in openings)
    (glass,) = artists(ax, "fillings:glass")
    assert len(glass.get_paths()) == sum(o.material == "glass" for o in openings)
    assert len(artists(ax, "low walls:chipboard")) == 1
    (source,), (start,) = artists(ax, "source"), artists(ax, "start")
    assert (*source.get_data()[0], *source.get_data()[1]) == plan.source[:2]
    assert (*start.get_data()[0], *start.get_data()[1]) == plan.start


def test_legend_names_what_is_there_and_nothing_else() -> None:
    assert legend_texts(drawn(box())) == ["source (phone)", "start", "concrete"]
    texts = legend_texts(drawn(floorplans.load("flat")))
    assert texts[:2] == ["source (phone)", "start"]
    assert {"brick", "glass", "wall 1 m high", "door", "window", "passage"} <= set(texts)


@pytest.mark.parametrize("name", floorplans.builtin_names())
def test_legend_and_scale_bar_lie_outside_the_plan(name: str) -> None:
    plan = floorplans.load(name)
    figure = Figure(layout="constrained")
    ax = figure.add_subplot()
    draw_plan(plan, ax)
    figure.draw_without_rendering()
    legend = ax.get_legend().get_window_extent().transformed(ax.transData.inverted())
    assert legend.y1 < plan.bounds[1]
    for part in artists(ax, "scale bar"):
        extent = part.get_window_extent().transformed(ax.transData.inverted())
        assert extent.y0 > plan.bounds[3]


def test_scale_bar_is_as_long_as_it_says() -> None:
    ax = drawn(floorplans.load("scenario1"))
    *halves, label = sorted(artists(ax, "scale bar"), key=lambda part: hasattr(part, "get_text"))
    length = sum(half.get_width() for half in halves)
    assert label.get_text() == f"{length:g} m" == "10 m"


def test_axes_are_in_metres_with_ticks_inside_the_plan() -> None:
    ax = drawn(floorplans.load("scenario1"))
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("x [m]", "y [m]")
    assert ax.get_aspect() == 1
    assert ax.get_yticks().tolist() == [0, 10, 20]


def test_3d_view_holds_every_panel_and_no_ceiling() -> None:
    plan = floorplans.load("flat")
    ax = Figure(figsize=(9, 6)).add_subplot(projection="3d")
    draw_plan_3d(plan, ax)
    (walls,), (floor,) = artists(ax, "walls"), artists(ax, "floor")
    assert isinstance(walls, Poly3DCollection)
    assert isinstance(floor, PolyCollection)
    ax.figure.draw_without_rendering()
    assert len(walls.get_paths()) == sum(len(floorplans.panels(wall)) for wall in plan.walls)
    assert legend_texts(ax)[:2] == ["source (phone)", "start"]


@pytest.mark.parametrize("name", floorplans.builtin_names())
def test_3d_view_fits_into_its_axes(name: str) -> None:
    figure = Figure(figsize=(9, 6))
    ax = figure.add_subplot(projection="3d")
    draw_plan_3d(floorplans.load(name), ax)
    figure.draw_without_rendering()
    (floor,) = artists(ax, "floor")
    corners = np.concatenate([path.vertices for path in floor.get_paths()])
    inches = ax.transData.transform(corners) / figure.dpi
    room = ax.get_position(original=True)
    assert inches[:, 0].min() > 9 * room.x0
    assert inches[:, 0].max() < 9 * room.x1
    assert inches[:, 1].min() > 6 * room.y0
    assert inches[:, 1].max() < 6 * room.y1


@pytest.mark.parametrize("layout", ["constrained", "tight", "none"])
def test_layouts_know_how_far_the_3d_view_reaches(layout: str) -> None:
    figure = Figure(figsize=(9, 5), layout=layout)
    ax = figure.add_subplot(projection="3d")
    draw_plan_3d(floorplans.load("scenario1"), ax)
    figure.draw_without_rendering()
    extent = ax.get_tightbbox()
    (walls,) = artists(ax, "walls")
    corners = np.concatenate([path.vertices for path in walls.get_paths()])
    pixels = ax.transData.transform(corners)
    assert np.all(pixels > extent.min)
    assert np.all(pixels < extent.max)


@pytest.mark.parametrize(("suffix", "head"), [("png", b"\x89PNG"), ("svg", b"<?xml")])
def test_picture_file_has_the_format_of_its_suffix(suffix, head, tmp_path) -> None:
    path = tmp_path / f"flat.{suffix}"
    save_plan_picture(floorplans.load("flat"), path)
    assert path.read_bytes().startswith(head)
