"""Plans that go through TOML and GeoJSON come back equal."""

import json
from dataclasses import replace

import numpy as np
import pytest
from documents import ROOT
from hypothesis import given, settings
from hypothesis import strategies as st
from small_plans import box_around_courtyard, plans

import floorplans
from floorplans import FloorPlan, GeoOrigin, PlanError
from floorplans.exporters import export
from floorplans.geojson_plan import MEMBER, dumps_geojson, plan_from_geojson, plan_to_geojson
from floorplans.importers import ImportOptions, import_plan

ORIGIN = GeoOrigin(-2.9783, 56.4601, 12.0)

origins = st.builds(GeoOrigin, st.floats(-180, 180), st.floats(-89, 89), st.floats(-360, 360))


@settings(max_examples=20)
@given(plan=plans(), origin=st.none() | origins)
def test_text_and_geojson_read_back_exactly(plan: FloorPlan, origin: GeoOrigin | None) -> None:
    plan = replace(plan, origin=origin)
    assert floorplans.loads(floorplans.dumps(plan)) == plan
    assert plan_from_geojson(json.loads(dumps_geojson(plan))) == plan


@pytest.mark.parametrize("name", floorplans.builtin_names())
def test_exported_file_imports_as_the_same_plan(name: str, tmp_path) -> None:
    plan = floorplans.load(name)
    (path,) = export(plan, tmp_path / "plan.geojson")
    imported = import_plan(path)
    assert imported.plan == plan
    assert floorplans.loads(imported.toml()) == plan
    assert imported.assumed == ()


def test_courtyard_reads_back() -> None:
    plan = replace(box_around_courtyard(), origin=ORIGIN)
    assert plan_from_geojson(plan_to_geojson(plan)) == plan


def test_options_go_before_an_exported_file(tmp_path) -> None:
    (path,) = export(floorplans.load("flat"), tmp_path / "plan.geojson")
    options = ImportOptions(name="mine", source=(1.5, 1.5, 1.0), start=(10.5, 6.5))
    plan = import_plan(path, options).plan
    assert (plan.name, plan.source, plan.start) == ("mine", (1.5, 1.5, 1.0), (10.5, 6.5))


def test_degrees_are_those_of_the_place() -> None:
    plan = replace(floorplans.load("flat"), origin=GeoOrigin(10.0, 50.0))
    outline = plan_to_geojson(plan)["features"][0]["geometry"]["coordinates"][0]
    assert outline[0] == pytest.approx([10.0, 50.0], abs=1e-9)
    degree_of_longitude_m = 111_319.49 * 0.6441  # cos of the latitude, on the ellipsoid
    assert outline[1][0] - 10.0 == pytest.approx(12.0 / degree_of_longitude_m, rel=2e-3)


@pytest.mark.parametrize("origin", [None, ORIGIN])
def test_a_wall_that_was_moved_stays_moved(origin: GeoOrigin | None) -> None:
    plan = replace(floorplans.load("flat"), origin=origin)
    collection = plan_to_geojson(plan)
    counter = collection["features"][-3]
    assert counter["properties"]["material"] == "chipboard"
    end = np.array([[4.6, 1.5]])
    counter["geometry"]["coordinates"][1:] = (origin.to_degrees(end) if origin else end).tolist()
    assert plan_from_geojson(collection).walls[-1].end == pytest.approx((4.6, 1.5), abs=1e-6)


def test_materials_of_a_plan_read_back() -> None:
    page = (ROOT / "docs" / "plan_format.md").read_text("utf-8")
    plan = floorplans.loads(page.split("```toml\n")[1].split("```")[0])
    assert plan.materials
    assert plan_from_geojson(json.loads(dumps_geojson(plan))) == plan
    assert plan_from_geojson(json.loads(dumps_geojson(replace(plan, origin=None)))).origin is None


@pytest.mark.parametrize(
    "spoil",
    [
        lambda c: c["features"].pop(0),
        lambda c: c["features"][1]["properties"].pop("kind"),
        lambda c: c["features"][1].update(geometry=None),
        lambda c: c[MEMBER].update(height_m="high"),
        lambda c: c[MEMBER].update(origin={"longitude": 3}),
        lambda c: c["features"][1]["properties"].update(wall=[1]),
        lambda c: c["features"][1]["geometry"].update(coordinates=[]),
        lambda c: c.update(features={"a": 1}),
    ],
)
def test_a_spoiled_export_is_a_plan_error(spoil) -> None:
    collection = json.loads(dumps_geojson(floorplans.load("flat")))
    spoil(collection)
    with pytest.raises(PlanError):
        plan_from_geojson(collection)
