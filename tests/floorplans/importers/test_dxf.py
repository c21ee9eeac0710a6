"""One flat, drawn in many ways, becomes the same plan; bad drawings are refused with a reason."""

from __future__ import annotations

import random
from collections.abc import Callable
from contextlib import suppress
from itertools import pairwise
from math import atan, cos, pi, radians, sin
from pathlib import Path

import dxf_drawings as draw
import pytest
from ezdxf.document import Drawing
from shapely.geometry import LineString, Point

from floorplans import FloorPlan, PlanError
from floorplans.importers import Imported, ImportOptions, import_plan
from floorplans.importers.dxf import drawing as dxf_drawing
from floorplans.importers.dxf import reader as dxf
from floorplans.importers.dxf.curves import chord_step_deg
from floorplans.importers.layer_names import Meaning, meaning_of
from floorplans.importers.progress import Step
from floorplans.walls import Opening, Wall

INCH = 1 / 0.0254


def imported(doc: Drawing, folder: Path, **options: object) -> Imported:
    return import_plan(draw.save(doc, folder), ImportOptions(**options))  # type: ignore[arg-type]


def refusal(doc: Drawing, folder: Path, **options: object) -> str:
    with pytest.raises(PlanError) as caught:
        imported(doc, folder, **options)
    return str(caught.value)


def partition(plan: FloorPlan) -> Wall:
    """The wall inside the outline."""
    (inner,) = (
        wall
        for wall in plan.walls
        if plan.outline.boundary.distance(Point(wall.point_at(wall.length_m / 2))) > 0.1
    )
    return inner


def openings(plan: FloorPlan) -> list[tuple[Wall, Opening]]:
    return [(wall, opening) for wall in plan.walls for opening in wall.openings]


def middle(wall: Wall, opening: Opening) -> tuple[float, float]:
    return wall.point_at(opening.offset_m + opening.width_m / 2)


def assert_is_the_flat(plan: FloorPlan, thick: bool = True) -> None:
    """Centre lines 7.7 m x 5.7 m, partition at x = 4.85 from the south-west corner's."""
    assert plan.bounds == pytest.approx((0, 0, 7.7, 5.7), abs=0.01)
    assert plan.outline.area == pytest.approx(7.7 * 5.7, rel=0.005)
    assert len(plan.walls) == 5
    inner = partition(plan)
    assert {round(inner.start[0], 2), round(inner.end[0], 2)} == {4.85}
    assert inner.length_m == pytest.approx(5.7, abs=0.01)
    if thick:
        assert inner.thickness_m == pytest.approx(0.1, abs=0.005)
        assert {round(w.thickness_m, 2) for w in plan.walls if w is not inner} == {0.3}
    kinds = sorted(
        (opening.kind, round(opening.width_m, 2), *(round(c, 1) for c in middle(wall, opening)))
        for wall, opening in openings(plan)
    )
    assert kinds == [
        ("door", 0.9, 4.8, 2.3), ("door", 1.0, 1.4, 0.0), ("window", 1.5, 2.6, 5.7)
    ]  # fmt: skip


@pytest.mark.parametrize(
    "drawing", [draw.flat_of_bodies, draw.flat_of_line_pairs, draw.flat_of_two_rings]
)
def test_the_flat_comes_out_of_every_habit(drawing: Callable[[], Drawing], tmp_path: Path):
    assert_is_the_flat(imported(drawing(), tmp_path).plan)


@pytest.mark.parametrize("piece_mm", [30, 50, 300])
def test_faces_in_pieces_are_whole_faces(piece_mm: float, tmp_path: Path):
    doc = draw.flat_of_line_pairs()
    space = doc.modelspace()
    for line in list(space.query("LINE")):
        start, step = line.dxf.start, line.dxf.end - line.dxf.start
        n = max(round(step.magnitude / piece_mm), 1)
        points = [start + step * (k / n) for k in range(n + 1)]
        for a, b in pairwise(points):
            ends = [(round(p.x), round(p.y)) for p in (b, a)]
            space.add_line(*ends, dxfattribs={"layer": line.dxf.layer})
        space.delete_entity(line)
    assert_is_the_flat(imported(doc, tmp_path).plan)


def test_single_lines_get_the_default_thickness(tmp_path: Path):
    result = imported(draw.flat_of_single_lines(), tmp_path)
    assert_is_the_flat(result.plan, thick=False)
    assert {wall.thickness_m for wall in result.plan.walls} == {0.1}
    assert "wall thickness_m" in {assumption.key for assumption in result.assumed}
    given = imported(draw.flat_of_single_lines(), tmp_path, wall_thickness_m=0.2)
    assert {wall.thickness_m for wall in given.plan.walls} == {0.2}


def test_nested_turned_and_scaled_blocks_are_exploded(tmp_path: Path):
    plan = imported(draw.flat_in_nested_blocks(), tmp_path).plan
    assert plan.bounds == pytest.approx((0, 0, 5.7, 7.7), abs=0.01)
    assert sorted(opening.kind for _, opening in openings(plan)) == ["door", "door", "window"]


@pytest.mark.parametrize(("code", "k"), [(1, INCH), (5, 100.0), (6, 1.0), (2, INCH / 12)])
def test_the_header_states_the_unit(code: int, k: float, tmp_path: Path):
    assert_is_the_flat(imported(draw.flat_of_bodies(code, k), tmp_path).plan)


@pytest.mark.parametrize("k", [1000.0, 100.0, 1.0, INCH])
def test_a_missing_unit_is_inferred_from_building_and_doors(k: float, tmp_path: Path):
    result = imported(draw.flat_of_bodies(0, k), tmp_path)
    assert_is_the_flat(result.plan)
    assert any("doors say" in note for note in result.notes)


def test_a_missing_unit_that_could_be_two_is_asked_for(tmp_path: Path):
    doc = draw.new(0)
    draw.add_rings(doc.modelspace(), draw.bodies(), "wall")
    message = refusal(doc, tmp_path)
    assert "does not state its unit" in message
    assert "give the unit: mm for 8 m x 6 m" in message
    assert_size = imported(doc, tmp_path, unit="mm").plan.bounds
    assert assert_size == pytest.approx((0, 0, 7.7, 5.7), abs=0.01)


def test_a_building_of_kilometres_is_rejected_with_the_unit_that_fits(tmp_path: Path):
    message = refusal(draw.flat_of_bodies(6, 1000.0), tmp_path)
    assert "8 km x 6 km" in message
    assert "give the unit: mm for 8 m x 6 m" in message


def test_doors_inside_are_open_and_those_in_the_outline_are_closed(tmp_path: Path):
    plan = imported(draw.flat_of_bodies(), tmp_path).plan
    doors = {wall is partition(plan): o.material for wall, o in openings(plan) if o.kind == "door"}
    assert doors == {True: None, False: "wood"}


def test_double_doors_are_one_opening(tmp_path: Path):
    doc = draw.new()
    space = doc.modelspace()
    rings = [*draw.bodies()[:-2], draw.rectangle(4.95, 0.3, 5.05, 2),
             draw.rectangle(4.95, 3.8, 5.05, 5.7)]  # fmt: skip
    draw.add_rings(space, rings, "wall")
    draw.add_openings(doc)
    door = {"layer": "A-DOOR", "rotation": -90, "yscale": -1}
    space.add_blockref("DOOR90", (4950, 3800), dxfattribs=door)
    plan = imported(doc, tmp_path).plan
    (opening,) = partition(plan).openings
    assert opening.width_m == pytest.approx(1.8, abs=0.01)


def test_lines_of_windows_are_openings_in_walls_and_panes_otherwise(tmp_path: Path):
    doc = draw.new()
    space = doc.modelspace()
    draw.add_rings(space, draw.bodies(), "wall")
    for y in (5.7, 5.85, 6):
        draw.add_lines(space, [((2, y), (3.5, y))], "window")
    draw.add_lines(space, [((5, 3.5), (7.85, 3.5))], "window")
    draw.add_openings(doc)
    plan = imported(doc, tmp_path).plan
    (pane,) = (wall for wall in plan.walls if wall.material == "glass")
    assert pane.length_m == pytest.approx(2.85, abs=0.05)
    assert [o.width_m for _, o in openings(plan) if o.kind == "window"] == pytest.approx([1.5])


@pytest.mark.parametrize("angle", [0, 33])
def test_a_door_of_two_unequal_leaves_is_one_as_wide_as_both(tmp_path: Path, angle: float):
    doc = draw.new()
    block = doc.blocks.new("STOREY")
    draw.add_rings(block, [*draw.bodies()[1:], draw.rectangle(0, 0, 0.4, 0.3)], "WALL")
    for hinge, radius, begin in ((0.4, 1.2, 0), (2.0, 0.4, 90)):
        attributes = {"layer": "DOOR"}
        ends = (1000 * hinge, 300), (1000 * hinge, 300 + 1000 * radius)
        block.add_line(*ends, dxfattribs=attributes)
        block.add_arc(ends[0], 1000 * radius, begin, begin + 90, dxfattribs=attributes)
    doc.modelspace().add_blockref("STOREY", (0, 0), dxfattribs={"rotation": angle})
    plan = imported(doc, tmp_path).plan
    (door,) = (opening for _, opening in openings(plan) if opening.kind == "door")
    assert door.width_m == pytest.approx(1.6, abs=0.02)


@pytest.mark.parametrize("angle", [0, 33])
def test_glazing_at_the_end_of_a_corridor_is_no_deeper_than_a_wall(tmp_path: Path, angle: float):
    doc = draw.new()
    block = doc.blocks.new("STOREY")
    rings = [(0, 0, 12, 0.2), (0, 5.8, 12, 6), (0, 0.2, 0.2, 2), (0, 4, 0.2, 5.8)]
    rings += [(11.8, 0.2, 12, 5.8), (0.1, 2, 11.8, 2.15), (0.1, 3.85, 11.8, 4)]
    draw.add_rings(block, [draw.rectangle(*ring) for ring in rings], "WALL")
    for x in (0.05, 0.1, 0.15):
        draw.add_lines(block, [((x, 2.15), (x, 3.85))], "GLAZING")
    doc.modelspace().add_blockref("STOREY", (0, 0), dxfattribs={"rotation": angle})
    plan = imported(doc, tmp_path).plan
    assert max(wall.thickness_m for wall in plan.walls) == pytest.approx(0.2, abs=0.01)
    (pane,) = (opening for _, opening in openings(plan) if opening.kind == "window")
    assert pane.width_m == pytest.approx(1.7, abs=0.02)
    assert plan.outline.area == pytest.approx(11.8 * 5.8, rel=0.01)


def test_curved_glazing_beside_curved_walls_loses_nothing(tmp_path: Path):
    doc = draw.new()
    space = doc.modelspace()
    for begin, end in ((130, 360 + 50), (50, 130)):
        glazed = begin == 50
        for radius in (5300, 5350) if glazed else (5000, 5300):
            layer = "GLAZING" if glazed else "WALL"
            space.add_arc((0, 0), radius, begin, end, dxfattribs={"layer": layer})
    for angle in (50, 130):
        ends = [5 * cos(radians(angle)), 5 * sin(radians(angle))]
        draw.add_lines(space, [(tuple(ends), tuple(1.06 * x for x in ends))], "WALL")
    result = imported(doc, tmp_path)
    glass_m = sum(w.length_m for w in result.plan.walls if w.material == "glass")
    solid_m = sum(w.length_m for w in result.plan.walls if w.material != "glass")
    assert glass_m == pytest.approx(radians(80) * 5.325, rel=0.05)
    assert solid_m == pytest.approx(radians(280) * 5.15, rel=0.05)
    assert result.plan.outline.area == pytest.approx(pi * 5.2**2, rel=0.03)


def test_windows_drawn_over_a_curved_wall_lose_no_glass(tmp_path: Path):
    doc = draw.new()
    space = doc.modelspace()
    for radius in (7000, 7300):
        space.add_circle((0, 0), radius, dxfattribs={"layer": "WALL"})
    for radius in (7000, 7150, 7300):
        space.add_arc((0, 0), radius, 20, 110, dxfattribs={"layer": "WINDOW"})
    plan = imported(doc, tmp_path).plan
    glazed_m = sum(o.width_m for _, o in openings(plan) if o.kind == "window")
    assert glazed_m == pytest.approx(radians(90) * 7.15, rel=0.03)
    assert plan.outline.area == pytest.approx(pi * 7.15**2, rel=0.02)


@pytest.mark.parametrize("radii_m", [(9.0,), (8.97, 9.03), (8.9, 9.0, 9.1)])
@pytest.mark.parametrize("interrupted", [False, True])
def test_curved_windows_with_mullions_lose_no_glass(
    radii_m: tuple[float, ...], interrupted: bool, tmp_path: Path
):
    doc = draw.new(6)
    space = doc.modelspace()
    sections = [(0, 20), (100, 120)] if interrupted else [(0, 120)]
    for radius in (8.9, 9.1):
        for begin, end in sections:
            space.add_arc((0, 0), radius, begin, end, dxfattribs={"layer": "A-WALL"})
    sides = LineString([(9, 0), (0.5, 0.9), (-4.5, 9 * sin(radians(120)))])
    body = sides.buffer(0.1, cap_style="flat", join_style="mitre").exterior.coords[:-1]
    space.add_lwpolyline(list(body), close=True, dxfattribs={"layer": "A-WALL"})
    for begin in (20, 40, 60, 80):
        for radius in radii_m:
            ends = (begin + 0.3, begin + 19.7)
            space.add_arc((0, 0), radius, *ends, dxfattribs={"layer": "A-GLAZ"})
        for angle in (radians(begin + 0.3), radians(begin + 19.7)):
            cap = [(r * cos(angle), r * sin(angle)) for r in (8.9, 9.1)]
            space.add_line(*cap, dxfattribs={"layer": "A-GLAZ"})
    plan = imported(doc, tmp_path, keep_axes=True).plan
    glass_m = sum(w.length_m for w in plan.walls if w.material == "glass")
    glass_m += sum(o.width_m for _, o in openings(plan) if o.kind == "window")
    assert glass_m == pytest.approx(radians(80) * 9, rel=0.05)


def test_a_hatch_leaves_its_holes_free(tmp_path: Path):
    doc = draw.new()
    hatch = doc.modelspace().add_hatch(dxfattribs={"layer": "WALL"})
    for ring in ((0, 0, 15, 10), (0.3, 0.3, 7, 9.7), (7.2, 0.3, 14.7, 9.7)):
        points = [(1000 * x, 1000 * y) for x, y in draw.rectangle(*ring)]
        hatch.paths.add_polyline_path(points, is_closed=True)
    plan = imported(doc, tmp_path).plan
    assert plan.outline.area == pytest.approx(14.7 * 9.7, rel=1e-3)
    assert sorted(round(w.thickness_m, 3) for w in plan.walls) == [0.2, 0.3, 0.3, 0.3, 0.3]


def test_a_hatch_with_a_thick_part_is_masonry_and_one_of_a_floor_is_reported(tmp_path: Path):
    doc = draw.new()
    space = doc.modelspace()
    tower = [(0.6, 0.6), (13.4, 0.6), (13.4, 8.4), (2.2, 8.4), (2.2, 7.1), (0.6, 7.1)]
    floor = draw.rectangle(20, 0, 26, 5)
    for rings in ([draw.rectangle(0, 0, 14, 9), tower], [floor]):
        hatch = space.add_hatch(dxfattribs={"layer": "A-WALL-MASN"})
        for ring in rings:
            hatch.paths.add_polyline_path([(1000 * x, 1000 * y) for x, y in ring], is_closed=True)
    result = imported(doc, tmp_path)
    thick = [round(w.thickness_m, 2) for w in result.plan.walls if w.thickness_m > 0.55]
    assert thick == [0.6] * 4
    assert {wall.material for wall in result.plan.walls} == {"brick"}
    assert result.plan.outline.area == pytest.approx(13.4 * 8.4, rel=0.05)
    (note,) = (line for line in result.report if "taken for floors" in line)
    assert "30 m²" in note
    assert "(23.00, 2.50)" in note


def test_objects_without_valid_lines_are_told(tmp_path: Path):
    doc = draw.new()
    space = doc.modelspace()
    draw.add_rings(space, draw.bodies(), "WALL")
    draw.add_openings(doc)
    space.add_blockref("DOOR90", (float("inf"), 0), dxfattribs={"layer": "A-DOOR"})
    space.add_line((0, 0), (float("nan"), 0), dxfattribs={"layer": "WALL"})
    result = imported(doc, tmp_path)
    assert_is_the_flat(result.plan)
    (note,) = (line for line in result.notes if "invalid coordinates" in line)
    assert note == "2 objects left out, empty or with invalid coordinates: 1 on A-DOOR, 1 on WALL"


@pytest.mark.parametrize("flag", [0, 32])
def test_a_boundary_of_a_hatch_that_encloses_nothing_is_no_wall(tmp_path: Path, flag: int):
    doc = draw.new()
    draw.add_rings(doc.modelspace(), draw.bodies(), "WALL")
    draw.add_openings(doc)
    hatch = doc.modelspace().add_hatch(dxfattribs={"layer": "WALL"})
    for ring in draw.bodies():
        hatch.paths.add_polyline_path([(1000 * x, 1000 * y) for x, y in ring], is_closed=True)
    stray = hatch.paths.add_edge_path(flags=1 + flag)
    for start, end in (((300, 200), (300, 900)), ((7800, 5700), (7800, 5000))):
        stray.add_line(start, end)
    assert_is_the_flat(imported(doc, tmp_path).plan)


def test_a_fill_between_the_outlines_of_filled_walls_is_a_floor(tmp_path: Path):
    doc = draw.new()
    space = doc.modelspace()
    draw.add_rings(space, draw.bodies(), "WALL")
    draw.add_openings(doc)
    for ring in (*draw.bodies(), draw.rectangle(5.05, 4.9, 7.7, 5.7)):
        hatch = space.add_hatch(dxfattribs={"layer": "WALL"})
        hatch.paths.add_polyline_path([(1000 * x, 1000 * y) for x, y in ring], is_closed=True)
    result = imported(doc, tmp_path)
    assert_is_the_flat(result.plan)
    (note,) = (line for line in result.report if "taken for floors" in line)
    assert "1 filled area left out" in note
    assert "2.12 m²" in note


@pytest.mark.parametrize("scale", [1.0, 0.5])
def test_a_polyline_with_a_width_is_a_wall_as_thick(tmp_path: Path, scale: float):
    doc = draw.new()
    block = doc.blocks.new("STOREY")
    for points, closed, width in (
        ([(0, 0), (12, 0), (12, 8), (0, 8)], True, 300),
        ([(5, 0), (5, 8)], False, 120),
    ):
        corners = [(1000 * x / scale, 1000 * y / scale) for x, y in points]
        outline = {"layer": "WALL", "const_width": width / scale}
        block.add_lwpolyline(corners, close=closed, dxfattribs=outline)
    doc.modelspace().add_blockref("STOREY", (0, 0), dxfattribs={"xscale": scale, "yscale": scale})
    plan = imported(doc, tmp_path).plan
    assert plan.outline.area == pytest.approx(12 * 8, rel=1e-3)
    assert sorted(round(w.thickness_m, 3) for w in plan.walls) == [0.12, 0.3, 0.3, 0.3, 0.3]


def test_a_drawing_whose_walls_are_in_another_file_is_not_its_frame(tmp_path: Path):
    doc = draw.new()
    doc.add_xref_def("storey.dwg", "storey")
    doc.modelspace().add_blockref("storey", (0, 0))
    draw.add_rings(doc.modelspace(), [draw.rectangle(0, 0, 20, 12)], "PLANRAHMEN")
    with pytest.raises(PlanError, match="blocks storey are in other files: bind these"):
        imported(doc, tmp_path)


def test_round_walls_become_chords_within_the_tolerance(tmp_path: Path):
    doc = draw.new()
    for radius in (5000, 5300):
        doc.modelspace().add_circle((0, 0), radius, dxfattribs={"layer": "WALL"})
    plan = imported(doc, tmp_path).plan
    assert plan.outline.area == pytest.approx(pi * 5.15**2, rel=0.02)
    assert all(wall.thickness_m == pytest.approx(0.3, abs=0.01) for wall in plan.walls)
    centre = plan.outline.centroid
    lines = [LineString([wall.start, wall.end]) for wall in plan.walls]
    assert all(5.15 - 0.05 <= line.distance(centre) <= 5.15 + 0.02 for line in lines)


def test_bulges_are_followed(tmp_path: Path):
    doc = draw.new()
    points = [(0, 0, 0.0), (8000, 0, 0.4), (8000, 6000, 0.0), (0, 6000, 0.0)]
    line = doc.modelspace().add_lwpolyline(points, format="xyb", close=True)
    line.dxf.layer = "wall"
    plan = imported(doc, tmp_path).plan
    radius, half_angle = (3**2 + 1.2**2) / 2.4, 2 * atan(0.4)
    segment = radius**2 * (half_angle - sin(half_angle) * cos(half_angle))
    assert plan.outline.area == pytest.approx(48 + segment, abs=0.05)
    assert plan.bounds[2] == pytest.approx(8 + 0.4 * 3, abs=0.02)


@pytest.mark.parametrize(("radius", "tolerance"), [(5000, 20), (300, 20), (1.0, 0.02)])
def test_chords_stay_within_the_tolerance(radius: float, tolerance: float):
    step = chord_step_deg(radius, tolerance)
    assert radius * (1 - cos(radians(step / 2))) <= tolerance


def test_furniture_and_text_are_left_out_and_reported(tmp_path: Path):
    doc = draw.flat_of_bodies()
    space = doc.modelspace()
    draw.add_rings(space, [draw.rectangle(1, 1, 2, 2)], "A-FURN")
    space.add_text("Kitchen", dxfattribs={"layer": "A-WALL"}).set_placement((2000, 2000))
    draw.add_rings(space, [draw.rectangle(6, 3, 6.2, 4)], "misc")
    result = imported(doc, tmp_path)
    assert_is_the_flat(result.plan)
    became = {use.name: use.became for use in result.layers}
    assert became["A-FURN"] == "left out"
    assert "unknown name" in became["misc"]
    assert became["A-WALL"] == "walls"
    assert became["A-DOOR"] == "2 blocks of doors and windows"


def test_layers_are_what_the_user_says(tmp_path: Path):
    doc = draw.new()
    draw.add_rings(doc.modelspace(), draw.bodies()[:-2], "layer7")
    draw.add_rings(doc.modelspace(), draw.bodies()[-2:], "0")
    draw.add_openings(doc)
    plan = imported(doc, tmp_path, layers={"LAYER?": "wall:brick", "0": "wall:wood"}).plan
    assert_is_the_flat(plan)
    assert partition(plan).material == "wood"
    assert {wall.material for wall in plan.walls} == {"wood", "brick"}


def test_layers_of_unknown_names_are_walls_where_no_other_is(tmp_path: Path):
    doc = draw.new()
    draw.add_rings(doc.modelspace(), draw.bodies(), "0")
    draw.add_openings(doc)
    result = imported(doc, tmp_path)
    assert_is_the_flat(result.plan)
    assert [use.became for use in result.layers if use.name == "0"] == [
        "walls (no layer is named like walls)"
    ]


@pytest.mark.parametrize(("layers", "depth_m"), [({}, 5.7), ({"0": "wall"}, 7.5)])
def test_dimension_lines_on_the_only_layer_are_no_walls(
    layers: dict[str, str], depth_m: float, tmp_path: Path
):
    doc = draw.new()
    space = doc.modelspace()
    for ring in (draw.OUTER, draw.INNER):
        draw.add_rings(space, [ring], "0")
    draw.add_lines(space, [((0, -1.5), (8, -1.5)), ((8, -1.6), (8, -1.4))], "0")
    result = imported(doc, tmp_path, layers=layers)
    assert result.plan.bounds[3] == pytest.approx(depth_m, abs=0.3)
    assert any("touch no wall" in line for line in result.report) == (not layers)


def test_a_door_on_the_only_layer_is_a_door_and_not_an_arc_of_wall(tmp_path: Path):
    doc = draw.new()
    draw.add_rings(doc.modelspace(), [draw.OUTER, draw.INNER], "0")
    for x in (4.95, 5.05):
        for y0, y1 in ((0.3, 2.0), (2.9, 5.7)):
            draw.add_lines(doc.modelspace(), [((x, y0), (x, y1))], "0")
    doc.modelspace().add_arc((5000, 2000), 900, 0, 90, dxfattribs={"layer": "0"})
    plan = imported(doc, tmp_path).plan
    ((_, door),) = openings(plan)
    assert (door.kind, round(door.width_m, 2)) == ("door", 0.9)
    assert len(plan.walls) == 5


def test_layers_that_are_off_are_left_out(tmp_path: Path):
    doc = draw.flat_of_bodies()
    doc.layers.add("WALL-OLD").off()
    draw.add_rings(doc.modelspace(), [draw.rectangle(2, 1, 3, 1.2)], "WALL-OLD")
    result = imported(doc, tmp_path)
    assert_is_the_flat(result.plan)
    assert "left out (off or frozen in the drawing)" in {use.became for use in result.layers}


@pytest.mark.parametrize(
    ("name", "meaning"),
    [
        ("A-WALL-FULL", Meaning("wall")),
        ("Außenwand_Beton", Meaning("wall", "concrete")),
        ("MURS PORTEURS", Meaning("wall")),
        ("WALL-CHIPBOARD", Meaning("wall", "chipboard")),
        ("Wall ceiling_board", Meaning("wall", "ceiling_board")),
        ("Tabiques yeso", Meaning("wall", "plasterboard")),
        ("I-GLAZ", Meaning("wall", "glass")),
        ("Türen", Meaning("door")),
        ("PORTE", Meaning("door")),
        ("A-WINDOW", Meaning("window")),
        ("Fenêtres", Meaning("window")),
        ("A-WALL-FULL-N", Meaning("wall")),
        ("S-COLS", Meaning("wall")),
        ("A-GLAZ", Meaning("window")),
        ("A-GLAZ-SILL", Meaning("window")),
        ("A-WALL-GLAZ", Meaning("wall", "glass")),
        ("A-DOOR-FULL", Meaning("door")),
        ("A-DOOR-IDEN", Meaning("ignore")),
        ("A-OPENING", Meaning("passage")),
        ("S-STEM-WALL", Meaning(None)),
        ("A-FLOR-OVHD", Meaning("ignore")),
        ("A-WALL-DEMO", Meaning("ignore")),
        ("Mauerwerk", Meaning("wall", "brick")),
        ("Stützmauer", Meaning("wall")),
        ("Ständerwand", Meaning("wall", "plasterboard")),
        ("Metal stud wall", Meaning("wall", "plasterboard")),
        ("A-WALL-WOOD-STUD", Meaning("wall", "plasterboard")),
        ("A-WALL-METAL", Meaning("wall", "metal")),
        ("Haustüren", Meaning("door")),
        ("TÜREN", Meaning("door")),
        ("TÜRRAHMEN", Meaning("door")),
        ("AUSSENWÄNDE", Meaning("wall")),
        ("FENÊTRES", Meaning("window")),
        ("MÖBLIERUNG", Meaning("ignore")),
        ("METALLSTÄNDERWAND", Meaning("wall", "plasterboard")),
        ("PLANRAHMEN", Meaning("ignore")),
        ("TÜRKIS", Meaning(None)),
        ("Struktur", Meaning(None)),
        ("Dachfenster", Meaning("ignore")),
        ("Wandöffnungen", Meaning("passage")),
        ("Deckenöffnung", Meaning("ignore")),
        ("mur", Meaning("wall")),
        ("Cloisons", Meaning("wall")),
        ("Menuiseries", Meaning("door")),
        ("Trémie", Meaning("ignore")),
        ("muro de ladrillo", Meaning("wall", "brick")),
        ("PAREDES", Meaning("wall")),
        ("puertas", Meaning("door")),
        ("ventanas", Meaning("window")),
        ("Hueco", Meaning("passage")),
        ("Pareti", Meaning("wall")),
        ("Væg", Meaning("wall")),
        ("Стены", Meaning("wall")),
        ("floor_opening", Meaning("ignore")),
        ("roof_opening", Meaning("ignore")),
        ("ShaftOpening", Meaning("ignore")),
        ("GO_PAROI_MOULEE", Meaning("wall")),
        ("CERRAMIENTO EXTERIOR", Meaning("wall")),
        ("ACRISTALAMIENTO", Meaning("window")),
        ("Écriture", Meaning("ignore")),
        ("AIR", Meaning(None)),
        ("DoorText", Meaning("ignore")),
        ("A-FURN", Meaning("ignore")),
        ("Ground floor walls", Meaning("wall")),
        ("0", Meaning(None)),
        ("portrait", Meaning(None)),
    ],
)
def test_names_of_layers_in_many_languages(name: str, meaning: Meaning):
    assert meaning_of(name) == meaning


@pytest.mark.parametrize(
    ("layers", "said"),
    [
        ({"x": "wal"}, 'layers.x = "wal": unknown kind of layer; did you mean "wall"?'),
        ({"*": "wall:gold"}, "unknown material"),
        ({"x": "wall:steel"}, 'unknown material; did you mean "metal"?'),
        ({"x": "wall:drywall"}, 'unknown material; did you mean "plasterboard"?'),
        ({"x": "Tür"}, 'unknown kind of layer; did you mean "door"?'),
    ],
)
def test_wrong_meanings_are_reported(layers: dict[str, str], said: str, tmp_path: Path):
    doc = draw.flat_of_bodies()
    draw.add_rings(doc.modelspace(), [draw.rectangle(1, 1, 2, 2)], "x")
    assert said in refusal(doc, tmp_path, layers=layers)


def test_a_layer_the_user_misspells_is_reported(tmp_path: Path):
    result = imported(draw.flat_of_bodies(), tmp_path, layers={"A-WAL": "wall:brick"})
    assert 'nothing in the file is called "A-WAL"; did you mean "A-WALL"?' in result.notes


def test_lines_of_openings_are_doorways_without_glass(tmp_path: Path):
    doc = draw.new()
    draw.add_rings(doc.modelspace(), draw.bodies(), "A-WALL")
    gaps = [(4.95, 2, 5.05, 2.9), (1, 0, 2, 0.3), (2, 5.7, 3.5, 6)]
    draw.add_rings(doc.modelspace(), [draw.rectangle(*gap) for gap in gaps], "A-OPENING")
    draw.add_rings(doc.modelspace(), [draw.rectangle(6, 2, 7, 3)], "A-OPENING")
    plan = imported(doc, tmp_path).plan
    found = sorted(
        (o.kind, o.material, round(o.width_m, 2)) for _, o in openings(plan) if o.material
    )
    assert found == [("door", "wood", 1.0), ("door", "wood", 1.5)]
    assert [(o.kind, o.material) for w, o in openings(plan) if w is partition(plan)] == [
        ("door", None)
    ]
    assert "glass" not in {wall.material for wall in plan.walls}


def test_foundations_are_walls_only_where_no_others_are(tmp_path: Path):
    doc = draw.flat_of_bodies()
    draw.add_rings(doc.modelspace(), [draw.rectangle(-1, -1, 9, -0.8)], "S-STEM-WALL")
    result = imported(doc, tmp_path)
    assert_is_the_flat(result.plan)
    (use,) = (use for use in result.layers if use.name == "S-STEM-WALL")
    assert (use.became, use.is_unknown) == ("left out (a foundation)", False)
    alone = draw.new()
    draw.add_rings(alone.modelspace(), draw.bodies(), "S-STEM-WALL")
    assert len(imported(alone, tmp_path, unit="mm").plan.walls) >= 5


def test_an_empty_drawing_is_rejected(tmp_path: Path):
    assert "the drawing is empty" in refusal(draw.new(), tmp_path)


def test_a_library_of_blocks_is_rejected_with_what_to_do(tmp_path: Path):
    doc = draw.new()
    draw.door_block(doc, 900.0, "DOOR90")
    message = refusal(doc, tmp_path)
    assert "it only defines blocks (DOOR90); insert the one of the storey" in message


def test_a_drawing_on_a_sheet_is_rejected_with_what_to_do(tmp_path: Path):
    doc = draw.new()
    draw.add_rings(doc.layout("Layout1"), draw.bodies(), "A-WALL")
    assert "are on the sheet 'Layout1'; move them to model space" in refusal(doc, tmp_path)


def test_external_references_are_reported(tmp_path: Path):
    doc = draw.new()
    doc.add_xref_def("walls.dwg", "WALLS-XREF")
    doc.modelspace().add_blockref("WALLS-XREF", (0, 0))
    assert "bind these external references" in refusal(doc, tmp_path)
    draw.add_rings(doc.modelspace(), draw.bodies(), "A-WALL")
    draw.add_openings(doc)
    assert any("WALLS-XREF" in note for note in imported(doc, tmp_path).notes)


@pytest.mark.parametrize("name", ["plan.dwg", "plan.DWG", "plan.dxf"])
def test_a_dwg_drawing_says_what_to_do(name: str, tmp_path: Path):
    path = tmp_path / name
    path.write_bytes(b"AC1032" + bytes(100))
    with pytest.raises(PlanError, match="a DWG drawing; save it as DXF"):
        import_plan(path)


def test_a_drawing_of_text_is_rejected(tmp_path: Path):
    doc = draw.new()
    doc.modelspace().add_text("nothing but words", dxfattribs={"layer": "notes"})
    assert "no lines of walls were found" in refusal(doc, tmp_path)
    assert "'notes'" in refusal(doc, tmp_path)


def test_walls_that_close_nothing_are_rejected(tmp_path: Path):
    doc = draw.new()
    draw.add_lines(doc.modelspace(), [((0, 0), (30, 0)), ((0, 20), (30, 20))], "wall")
    assert "the building is open: 20.00 m" in refusal(doc, tmp_path)


def test_another_kind_of_file_is_rejected(tmp_path: Path):
    path = tmp_path / "plan.dxf"
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + bytes(100))
    with pytest.raises(PlanError, match="does not begin like a DXF drawing; it looks like a ROS"):
        import_plan(path)


def test_a_file_that_is_not_there_is_reported(tmp_path: Path):
    with pytest.raises(PlanError, match="cannot be read"):
        import_plan(tmp_path / "missing.dxf")


def test_blocks_that_explode_without_end_are_rejected_before_work(tmp_path: Path):
    doc = draw.flat_of_bodies()
    doc.blocks.new("B0").add_line((0, 0), (1, 0))
    for level in range(1, 30):
        block = doc.blocks.new(f"B{level}")
        for _ in range(3):
            block.add_blockref(f"B{level - 1}", (0, 0))
    doc.modelspace().add_blockref("B29", (0, 0))
    assert "objects, more than 500000; save one storey" in refusal(doc, tmp_path)


def test_too_many_objects_are_rejected_before_work(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(dxf_drawing, "MAX_RECORDS", 50)
    assert "objects, more than 50" in refusal(draw.flat_of_bodies(), tmp_path)


def test_more_lines_than_a_storey_has_are_rejected_before_work(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr(dxf, "MAX_LINES", 20)
    assert "hold 32 lines, more than the 20" in refusal(draw.flat_of_bodies(), tmp_path)


def test_a_block_within_itself_does_no_harm(tmp_path: Path):
    doc = draw.flat_of_bodies()
    block = doc.blocks.new("SELF")
    block.add_blockref("SELF", (1, 1))
    doc.modelspace().add_blockref("SELF", (0, 0), dxfattribs={"layer": "A-WALL"})
    assert_is_the_flat(imported(doc, tmp_path).plan)


@pytest.mark.parametrize("scale", [1e308, 1e200, 0.0])
def test_door_blocks_scaled_out_of_any_drawing_are_left_out(scale: float, tmp_path: Path):
    doc = draw.flat_of_bodies()
    block = doc.blocks.new("DOOR")
    block.add_arc((0, 0), 900, 0, 90)
    block.add_line((0, 0), (0, 900))
    attributes = {"layer": "A-DOOR", "xscale": scale, "yscale": scale}
    doc.modelspace().add_blockref("DOOR", (5000, 2000), dxfattribs=attributes)
    assert import_plan(draw.save(doc, tmp_path)).plan.outline.area == pytest.approx(7.7 * 5.7)


def test_a_truncated_file_is_read_as_far_as_it_goes_or_rejected(tmp_path: Path):
    text = draw.save(draw.flat_of_bodies(), tmp_path).read_bytes()
    cut = tmp_path / "cut.dxf"
    cut.write_bytes(text[: len(text) // 2])
    with pytest.raises(PlanError):
        import_plan(cut)


EXTREMES = ("0", "-1", "1e308", "nan", "inf", "1e-300", "5000", "1e9", "")
ENTITIES = ("LINE", "ARC", "INSERT", "SPLINE", "ELLIPSE", "CIRCLE", "HATCH", "MLINE", "POLYLINE")


def mutated(text: str, rng: random.Random) -> str:
    """Text of a drawing with values replaced, and records dropped, doubled and renamed."""
    rows = text.split("\n")
    begin = rows.index("BLOCKS") // 2
    for _ in range(rng.choice((1, 5, 20))):
        at = 2 * rng.randrange(begin, len(rows) // 2 - 40)
        match rng.randrange(5):
            case 0:
                rows[at + 1] = rng.choice(EXTREMES)
            case 1:
                rows[at + 1] = rng.choice(ENTITIES)
            case 2:
                del rows[at : at + 2 * rng.randrange(1, 12)]
            case 3:
                rows[at:at] = rows[at : at + 2 * rng.randrange(1, 30)]
            case _:
                rows[at] = str(rng.choice((10, 20, 40, 41, 42, 50, 51, 2, 8, 70, 210, 230)))
    return "\n".join(rows)


@pytest.mark.filterwarnings("ignore")  # the library warns of some damage before it raises
@pytest.mark.parametrize("seed", range(12))
def test_mutated_drawings_raise_nothing_but_plan_errors(seed: int, tmp_path: Path):
    rng = random.Random(seed)
    drawings = (draw.flat_of_line_pairs, draw.flat_in_nested_blocks, draw.flat_of_single_lines)
    path = draw.save(drawings[seed % 3](), tmp_path)
    path.write_text(mutated(path.read_text(), rng))
    with suppress(PlanError):
        import_plan(path)


def test_any_bytes_after_the_first_raise_nothing_but_plan_errors(tmp_path: Path):
    rng = random.Random(3)
    data = draw.save(draw.flat_of_bodies(), tmp_path).read_bytes()
    for _ in range(10):
        at = rng.randrange(20, len(data))
        (tmp_path / "broken.dxf").write_bytes(data[:at] + rng.randbytes(40) + data[at + 40 :])
        with suppress(PlanError):
            import_plan(tmp_path / "broken.dxf")


def test_progress_counts_the_steps_of_an_import(tmp_path: Path) -> None:
    seen: list[tuple[int, int]] = []
    path = draw.save(draw.flat_of_bodies(), tmp_path)
    import_plan(path, progress=lambda done, total: seen.append((done, total)))
    assert seen == [(done, max(Step)) for done in Step]
