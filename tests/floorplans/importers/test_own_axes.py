"""A building drawn at an angle is turned to its own axes, and exported where it was drawn."""

from __future__ import annotations

import json
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
import shapely
import trimesh
from hypothesis import given
from hypothesis import strategies as st

import floorplans
from floorplans import FloorPlan, GeoOrigin, PlanError, PlanFrame
from floorplans.exporters import export
from floorplans.geojson_plan import MEMBER, plan_to_geojson
from floorplans.importers import ImportOptions, RawWall, import_plan
from floorplans.importers.own_axes import LEAST_DEG, oblique_deg

FLAT = floorplans.load("flat")
FRAME = PlanFrame(30.0, -20.0, 11.0)
angles = st.floats(-45.0, 45.0).filter(lambda angle: abs(angle) > LEAST_DEG + 1e-3)


def raw_walls(plan: FloorPlan, angle_deg: float) -> list[RawWall]:
    turn = PlanFrame(rotation_deg=angle_deg).to_drawing
    ends = [turn(np.array([wall.start, wall.end])).tolist() for wall in plan.walls]
    return [RawWall((a[0], a[1]), (b[0], b[1])) for a, b in ends]


def drawn(plan: FloorPlan):
    """Centre lines of a plan in the coordinates of its drawing."""
    lines = shapely.multilinestrings([[wall.start, wall.end] for wall in plan.walls])
    return lines if plan.frame is None else shapely.transform(lines, plan.frame.to_drawing)


def places(plan: FloorPlan):
    """Places of the middles of openings, in the coordinates of its drawing."""
    middles = [
        wall.point_at(opening.offset_m + opening.width_m / 2)
        for wall in plan.walls
        for opening in wall.openings
    ]
    points = shapely.multipoints(middles)
    return points if plan.frame is None else shapely.transform(points, plan.frame.to_drawing)


@given(angles)
def test_angle_is_that_of_most_walls(angle_deg) -> None:
    diagonal = RawWall((0.0, 0.0), (3.0, 4.1))
    found = oblique_deg([*raw_walls(FLAT, angle_deg), diagonal])
    assert (found - angle_deg + 45.0) % 90.0 - 45.0 == pytest.approx(0.0, abs=1e-6)


@given(st.floats(-0.499, 0.499))
def test_walls_along_the_axes_are_not_turned(angle_deg) -> None:
    assert oblique_deg(raw_walls(FLAT, angle_deg)) == 0.0


def test_round_building_has_no_axes() -> None:
    corners = [(np.cos(a), np.sin(a)) for a in np.linspace(0.1, 0.1 + 2 * np.pi, 25)]
    assert oblique_deg([RawWall(*ends) for ends in pairwise(corners)]) == 0.0


@given(
    st.floats(-1e7, 1e7), st.floats(-1e7, 1e7), st.floats(-360, 360),
    st.tuples(st.floats(-2000, 2000), st.floats(-2000, 2000)),
)  # fmt: skip
def test_conversions_of_a_frame_are_inverse(x_m, y_m, rotation_deg, point) -> None:
    frame = PlanFrame(x_m, y_m, rotation_deg)
    there = frame.to_drawing(np.array([point]))
    assert np.allclose(frame.to_plan(there), [point], atol=1e-7)
    assert np.allclose(frame.matrix() @ [*point, 0.0, 1.0], [*there[0], 0.0, 1.0], atol=1e-7)


@pytest.fixture(scope="module")
def oblique(tmp_path_factory):
    """A drawing of the flat at 11 degrees, and its import."""
    (path,) = export(replace(FLAT, frame=FRAME), tmp_path_factory.mktemp("drawing") / "flat.dxf")
    return path, import_plan(path)


def test_oblique_drawing_becomes_a_plan_along_its_walls(oblique) -> None:
    _, imported = oblique
    plan = imported.plan
    assert plan.frame.rotation_deg == pytest.approx(11.0, abs=1e-4)
    assert plan.bounds == pytest.approx(FLAT.bounds, abs=1e-3)
    straight = [min(abs(np.subtract(w.end, w.start))) for w in plan.walls]
    assert max(straight) < 1e-4
    where = PlanFrame(*FRAME.to_drawing(np.zeros((1, 2)))[0], 11.0)
    assert (imported.origin.x, imported.origin.y) == pytest.approx((where.x_m, where.y_m), abs=1e-3)
    assert "stand at 11 degrees to the drawing's axes" in imported.notes[-1]
    assert floorplans.loads(imported.toml()) == plan


def test_drawing_is_left_as_it_is_on_request(oblique) -> None:
    path, turned = oblique
    kept = import_plan(path, ImportOptions(keep_axes=True))
    assert kept.plan.frame is None
    assert kept.plan.bounds[2] > FLAT.bounds[2] + 0.5
    corner = np.array([kept.origin.x, kept.origin.y])
    moved = shapely.transform(drawn(kept.plan), lambda p: p + corner)
    assert shapely.hausdorff_distance(moved, drawn(turned.plan)) < 2e-3


def test_building_along_the_axes_is_not_turned(tmp_path) -> None:
    (path,) = export(FLAT, tmp_path / "flat.dxf")
    kept = import_plan(path, ImportOptions(keep_axes=True))
    assert import_plan(path) == kept
    assert kept.plan.frame is None


@pytest.mark.parametrize(
    ("name", "tolerance_m"), [("a.dxf", 2e-3), ("a.geojson", 1e-9), ("a.yaml", 0.12)]
)
def test_export_is_where_the_building_was_drawn(oblique, tmp_path, name, tolerance_m) -> None:
    _, imported = oblique
    path, *_ = export(imported.plan, tmp_path / name)
    again = import_plan(path).plan
    assert again.frame.rotation_deg == pytest.approx(11.0, abs=0.3)
    assert shapely.hausdorff_distance(drawn(again), drawn(imported.plan)) < tolerance_m
    if not name.endswith("yaml"):
        assert shapely.hausdorff_distance(places(again), places(imported.plan)) < tolerance_m


def test_geojson_has_the_coordinates_of_the_drawing(oblique) -> None:
    plan = oblique[1].plan
    features = plan_to_geojson(plan)["features"]
    outline = np.array(features[0]["geometry"]["coordinates"][0])
    assert np.allclose(outline, plan.frame.to_drawing(np.array(plan.outline.exterior.coords)))


@pytest.mark.parametrize("suffix", ["glb", "ply", "stl", "obj"])
def test_meshes_are_where_the_building_was_drawn(tmp_path, suffix) -> None:
    (path,) = export(replace(FLAT, frame=FRAME), tmp_path / f"a.{suffix}")
    vertices = trimesh.load(path, force="mesh").vertices
    if suffix == "glb":  # y is up
        vertices = np.column_stack([vertices[:, 0], -vertices[:, 2], vertices[:, 1]])
    corners = FRAME.to_drawing(np.array(FLAT.outline.exterior.coords))
    hull = shapely.MultiPoint(vertices[:, :2]).convex_hull
    assert hull.symmetric_difference(shapely.Polygon(corners).convex_hull).area < 1e-3


def test_single_precision_leaves_a_far_position_out(tmp_path) -> None:
    far = replace(FLAT, frame=PlanFrame(4e5, 5.3e6, 11.0))
    near = replace(FLAT, frame=PlanFrame(0.0, 0.0, 11.0))
    (far_path,) = export(far, tmp_path / "far.ply")
    (near_path,) = export(near, tmp_path / "near.ply")
    assert far_path.read_bytes() == near_path.read_bytes()


def test_oblique_venue_keeps_its_place_on_the_earth(tmp_path) -> None:
    place = GeoOrigin(11.57, 48.14, 23.0)
    collection = plan_to_geojson(replace(FLAT, origin=place))
    del collection[MEMBER]
    for feature in collection["features"]:
        feature["properties"] = {"feature_type": feature["properties"]["kind"]}
    path = tmp_path / "venue.geojson"
    path.write_text(json.dumps(collection))
    plan = import_plan(path).plan
    assert plan.origin.rotation_deg == pytest.approx(23.0, abs=0.01)
    corners = plan.origin.to_degrees(np.array(plan.outline.exterior.coords))
    expected = place.to_degrees(np.array(FLAT.outline.exterior.coords))
    here = GeoOrigin(11.57, 48.14)
    apart = shapely.Polygon(here.to_plan(corners)).symmetric_difference(
        shapely.Polygon(here.to_plan(expected))
    )
    assert apart.area < 0.1


def test_frame_out_of_range_is_an_error() -> None:
    with pytest.raises(PlanError, match=r"frame.rotation_deg = 400.0: expected a finite number"):
        replace(FLAT, frame=PlanFrame(rotation_deg=400.0))
    with pytest.raises(PlanError, match=r"frame.x_m = NaN"):
        replace(FLAT, frame=PlanFrame(x_m=float("nan")))
