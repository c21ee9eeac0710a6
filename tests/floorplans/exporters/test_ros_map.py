"""Occupancy grids of plans: pixels where walls are, and walls again where pixels are."""

from dataclasses import replace
from math import pi

import numpy as np
import pytest
import shapely
import yaml
from PIL import Image
from shapely.geometry import LineString
from small_plans import box

import floorplans
from floorplans import Opening, PlanError, Wall
from floorplans.exporters import ExportOptions, export
from floorplans.importers import import_plan


def grid_of(plan, tmp_path, **options):
    files = export(plan, tmp_path / "map.yaml", options=ExportOptions(**options))
    facts = yaml.safe_load(files[0].read_text())
    return facts, np.asarray(Image.open(files[1]))[::-1]


def test_pixels_are_those_of_walls_inside_and_outside(tmp_path) -> None:
    facts, values = grid_of(box(), tmp_path, resolution_m=0.1)
    assert (facts["resolution"], facts["negate"], facts["image"]) == (0.1, 0, "map.pgm")

    def value(x: float, y: float) -> int:
        x0, y0, _ = facts["origin"]
        return int(values[int((y - y0) / 0.1), int((x - x0) / 0.1)])

    assert (value(3, 2), value(-0.4, 2), value(0, 2), value(-0.05, -0.05)) == (254, 205, 0, 0)
    area_m2 = float((values == 0).sum()) * 0.01
    assert area_m2 == pytest.approx(0.2 * 20, rel=0.03)


def test_the_cut_is_at_the_height_asked_for(tmp_path) -> None:
    low = Wall((3.0, 1.0), (3.0, 3.0), "wood", 0.2, 0.8)
    window = Opening(0.5, 1.0, 1.0, 2.0, "window")
    high = Wall((4.0, 1.0), (4.0, 3.0), "wood", 0.2, 3.0, (window,))
    counts = [
        int((grid_of(box((low, high)), tmp_path, slice_height_m=height)[1] == 0).sum())
        for height in (0.5, 0.9, 1.5)
    ]
    per_metre = 0.2 / 0.05**2
    assert counts[0] - counts[1] == pytest.approx(2 * per_metre, rel=0.05)
    assert counts[1] - counts[2] == pytest.approx(1 * per_metre, rel=0.05)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"resolution_m": 0.0}, "above 0"),
        ({"resolution_m": float("nan")}, "above 0"),
        ({"resolution_m": 1e-5}, "larger than"),
        ({"slice_height_m": 9.0}, "expected 0 to 3"),
    ],
)
def test_invalid_options_are_rejected(options, message: str, tmp_path) -> None:
    with pytest.raises(PlanError, match=message):
        grid_of(box(), tmp_path, **options)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("resolution_m", [0.02, 0.05])
@pytest.mark.parametrize("name", ["flat", "scenario1"])
def test_the_grid_imports_as_the_walls_it_was_made_of(name, resolution_m, tmp_path) -> None:
    if (name, resolution_m) == ("scenario1", 0.02):
        resolution_m = 0.1
    plan = floorplans.load(name)
    path, _ = export(plan, tmp_path / "map.yaml", options=ExportOptions(resolution_m=resolution_m))
    again = import_plan(path).plan
    x, y = plan.bounds[:2]
    drawn = shapely.union_all([LineString(segment) for segment in plan.solid_segments(1.0)])
    found = shapely.union_all([LineString([w.start, w.end]) for w in again.walls])
    assert again.outline.area == pytest.approx(plan.outline.area, rel=0.01)
    assert found.length == pytest.approx(drawn.length, rel=0.03)
    moved = shapely.affinity.translate(found, x - again.bounds[0], y - again.bounds[1])
    assert shapely.hausdorff_distance(moved, drawn) < 2 * resolution_m + 0.05
    thick = max(w.thickness_m for w in plan.walls)
    assert max(w.thickness_m for w in again.walls) == pytest.approx(thick, abs=resolution_m)


def test_yaw_turns_the_map(tmp_path) -> None:
    path, _ = export(box(), tmp_path / "map.yaml")
    facts = yaml.safe_load(path.read_text())
    path.write_text(yaml.safe_dump(facts | {"origin": [1.0, 2.0, pi / 6]}))
    turned = import_plan(path).plan
    assert turned.outline.area == pytest.approx(24.0, rel=0.02)
    sides = {
        round(np.degrees(np.arctan2(*np.subtract(w.end, w.start)[::-1])) % 90) % 90
        for w in turned.walls
    }
    assert sides == {0}
    assert turned.frame.rotation_deg == pytest.approx(30.0, abs=0.1)
    margin = np.array([facts["origin"][:2]])  # the picture begins at (1, 2), before the building
    assert turned.frame.to_drawing(margin)[0] == pytest.approx((1.0, 2.0), abs=0.05)


def test_plan_of_any_name_is_written(tmp_path) -> None:
    plan = replace(floorplans.load("flat"), name="Büro 東京")
    assert import_plan(export(plan, tmp_path / "büro.pgm")[0]).plan.outline.area == pytest.approx(
        108, rel=0.01
    )
