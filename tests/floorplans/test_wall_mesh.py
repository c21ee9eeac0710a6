"""Wall meshes: areas are exact, materials are right, and files keep them."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from shapely.geometry import Polygon
from small_plans import ROOM, box, box_around_courtyard, plans

import floorplans
from floorplans import MATERIAL_COLOURS, FloorPlan, Opening, SheetMaterial, Wall


def sheet_area(plan: FloorPlan) -> float:
    """Area of walls minus unfilled openings, and of floor and ceiling, by formula [m²]."""
    area = 2 * plan.outline.area
    for wall in plan.walls:
        area += wall.length_m * wall.height_m
        unfilled = [o for o in wall.openings if o.material is None]
        area -= sum(o.width_m * (o.head_m - o.sill_m) for o in unfilled)
    return area


def area_by_material(plan: FloorPlan) -> dict[SheetMaterial, float]:
    walls = plan.to_mesh()
    sums = np.bincount(walls.face_material, walls.mesh.area_faces)
    return dict(zip(walls.materials, sums, strict=True))


@settings(deadline=None, max_examples=40)
@given(plan=plans())
def test_area_is_walls_minus_openings(plan: FloorPlan) -> None:
    assert plan.to_mesh().mesh.area == pytest.approx(sheet_area(plan), rel=1e-9)


def test_area_of_each_material() -> None:
    assert area_by_material(floorplans.loads(ROOM)) == pytest.approx(
        {
            SheetMaterial("concrete", 0.2): 2 * (6 + 4) * 3 + 6 * 4,
            SheetMaterial("plasterboard", 0.1): 4 * 3 - 1 * 2 - 1 * 1.5,
            SheetMaterial("glass", 0.1): 1 * 1.5,
            SheetMaterial("ceiling_board", 0.2): 6 * 4,
        },
        rel=1e-12,
    )


def test_materials_are_in_order_of_first_use() -> None:
    walls = floorplans.load("flat").to_mesh()
    _, first = np.unique(walls.face_material, return_index=True)
    assert len(walls.materials) == len(set(walls.materials)) == len(first)
    assert np.all(np.diff(first) > 0)
    assert walls.face_material.dtype == np.int64


@pytest.mark.parametrize("name", floorplans.builtin_names())
def test_splitting_a_wall_changes_no_area(name: str) -> None:
    plan = floorplans.load(name)
    halves = tuple(half for wall in plan.walls for half in halved(wall))
    assert len(halves) > len(plan.walls)
    split = area_by_material(replace(plan, walls=halves))
    assert split == pytest.approx(area_by_material(plan), rel=1e-12)


def halved(wall: Wall) -> list[Wall]:
    """Split a wall in its middle, unless an opening is there."""
    middle = wall.length_m / 2
    if any(o.offset_m < middle < o.end_m for o in wall.openings):
        return [wall]
    corner = wall.point_at(middle)
    first = tuple(o for o in wall.openings if o.offset_m < middle)
    second = tuple(
        replace(o, offset_m=o.offset_m - middle) for o in wall.openings if o.offset_m >= middle
    )
    return [
        replace(wall, end=corner, openings=first),
        replace(wall, start=corner, openings=second),
    ]


def test_sheets_have_the_corners_of_their_openings() -> None:
    partition = floorplans.loads(ROOM).walls[4]
    rectangles = {(*panel[:4], panel.material) for panel in floorplans.panels(partition)}
    assert rectangles == {
        (0, 1, 0, 3, "plasterboard"),
        (1, 2, 2, 3, "plasterboard"),
        (2, 2.5, 0, 3, "plasterboard"),
        (2.5, 3.5, 0, 1, "plasterboard"),
        (2.5, 3.5, 2.5, 3, "plasterboard"),
        (3.5, 4, 0, 3, "plasterboard"),
        (2.5, 3.5, 1, 2.5, "glass"),
    }


def test_window_above_a_door_leaves_the_band_between_them() -> None:
    stacked = (Opening(1.0, 1.0, 0.0, 2.0, "door"), Opening(1.0, 1.0, 2.2, 2.8, "window"))
    wall = Wall((3.0, 0.0), (3.0, 4.0), "brick", 0.1, 3.0, stacked)
    middle = [panel[2:4] for panel in floorplans.panels(wall) if panel.s_min == 1]
    assert middle == [(2.0, 2.2), (2.8, 3.0)]


def test_walls_are_vertical_and_slabs_face_the_room() -> None:
    plan = floorplans.load("flat")
    mesh = plan.to_mesh().mesh
    z = mesh.triangles[:, :, 2]
    floor, ceiling = np.all(z == 0, axis=1), np.all(z == plan.height_m, axis=1)
    np.testing.assert_allclose(mesh.face_normals[floor], [[0, 0, 1]] * floor.sum(), atol=1e-12)
    np.testing.assert_allclose(mesh.face_normals[ceiling], [[0, 0, -1]] * ceiling.sum(), atol=1e-12)
    np.testing.assert_allclose(mesh.face_normals[~(floor | ceiling), 2], 0, atol=1e-12)


def test_courtyard_has_neither_floor_nor_ceiling() -> None:
    plan = box_around_courtyard()
    assert plan.to_mesh().mesh.area == pytest.approx(sheet_area(plan), rel=1e-12)
    triangles = plan.to_mesh().mesh.triangles
    slabs = triangles[np.ptp(triangles[:, :, 2], axis=1) == 0]
    centres = slabs.mean(axis=1)[:, :2]
    assert not np.any(np.all((centres > (4, 1)) & (centres < (5, 2)), axis=1))


def test_each_face_has_the_colour_of_its_material() -> None:
    walls = floorplans.load("flat").to_mesh()
    for index, material in enumerate(walls.materials):
        colours = walls.mesh.visual.face_colors[walls.face_material == index]
        expected = (*bytes.fromhex(MATERIAL_COLOURS[material.name][1:]), 255)
        assert set(map(tuple, colours.tolist())) == {expected}


@pytest.mark.parametrize("suffix", ["glb", "ply", "stl", "obj"])
def test_export_keeps_faces_and_area(suffix: str, tmp_path) -> None:
    mesh = floorplans.load("flat").to_mesh().mesh
    path = tmp_path / f"flat.{suffix}"
    mesh.export(path)
    again = trimesh.load_mesh(path, process=False)
    assert len(again.faces) == len(mesh.faces)
    assert again.area == pytest.approx(mesh.area, rel=1e-6)
    np.testing.assert_allclose(again.bounds, mesh.bounds, atol=1e-6)


def test_corner_given_many_times_is_one_corner() -> None:
    corners = [(0, 0), *[(6, 0)] * 26, (6, 4), (0, 4)]
    areas = box(outline=Polygon(corners)).to_mesh().mesh.area_faces
    assert areas.sum() == pytest.approx(box().to_mesh().mesh.area_faces.sum())
