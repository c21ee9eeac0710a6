"""Transmitters of plans: read, written, checked, and optional like source and start."""

from __future__ import annotations

from dataclasses import replace

import pytest

import floorplans
from floorplans import FloorPlan, PlanError, PlanTransmitter
from floorplans.geojson_plan import plan_from_geojson, plan_to_geojson

FLAT = floorplans.load("flat")
ACCESS_POINTS = (
    PlanTransmitter("hall", (6.0, 4.7, 2.4)),
    PlanTransmitter("study", (10.0, 8.0, 1.0), 17.5, 5.2e9, "dipole", (1.0, 0.0, 2.0)),
    PlanTransmitter(
        "Küche", (1.0, 1.0, 2.0), -3.0, 2.437e9, "patterns/patch.csv", (0.0, -1.0, 0.0)
    ),
)


def with_transmitters(*transmitters: PlanTransmitter) -> FloorPlan:
    return replace(FLAT, transmitters=transmitters)


def test_transmitters_come_back_from_toml_and_geojson() -> None:
    plan = with_transmitters(*ACCESS_POINTS)
    assert floorplans.loads(floorplans.dumps(plan)) == plan
    assert plan_from_geojson(plan_to_geojson(plan)) == plan
    assert plan.sha256 != FLAT.sha256


@pytest.mark.parametrize("missing", [("source",), ("start",), ("source", "start")])
def test_source_and_start_are_optional(missing: tuple[str, ...]) -> None:
    plan = replace(FLAT, **dict.fromkeys(missing))
    assert floorplans.loads(floorplans.dumps(plan)) == plan
    assert plan_from_geojson(plan_to_geojson(plan)) == plan
    for key, require in (("source", plan.require_source), ("start", plan.require_start)):
        if key in missing:
            with pytest.raises(PlanError, match=f"^{key}: plan 'flat' has no {key}"):
                require()
        else:
            assert require() == getattr(plan, key)


HALL = ACCESS_POINTS[0]


@pytest.mark.parametrize(
    ("wrong", "place"),
    [
        ((HALL, HALL), "transmitters[1].id"),
        ((replace(HALL, id=""),), "transmitters[0].id"),
        ((replace(HALL, id="all"),), "transmitters[0].id"),
        ((replace(HALL, id="1,2,3"),), "transmitters[0].id"),
        ((replace(HALL, id="two\nlines"),), "transmitters[0].id"),
        ((replace(HALL, id=7),), "transmitters[0].id"),
        ((HALL, replace(HALL, id="b", position=(6.0, 4.7, 2.6))), "transmitters[1].position"),
        ((replace(HALL, position=(-1.0, 4.7, 1.0)),), "transmitters[0].position"),
        ((replace(HALL, position=(6.0, 4.0, 1.0)),), "transmitters[0].position"),
        ((replace(HALL, position=(6.0, float("nan"), 1.0)),), "transmitters[0].position[1]"),
        ((replace(HALL, position=(6.0, 1.0)),), "transmitters[0].position"),
        ((replace(HALL, power_dbm=201.0),), "transmitters[0].power_dbm"),
        ((replace(HALL, power_dbm="20"),), "transmitters[0].power_dbm"),
        ((replace(HALL, frequency_hz=2.4),), "transmitters[0].frequency_hz"),
        ((replace(HALL, antenna="yagi"),), "transmitters[0].antenna"),
        ((replace(HALL, antenna="isotropic", direction=(0.0, 0.0, 1.0)),), "direction"),
        ((replace(HALL, antenna="dipole", direction=(0.0, 0.0, 0.0)),), "direction"),
        (("hall",), "transmitters[0]"),
    ],
)
def test_a_wrong_transmitter_is_named(wrong: tuple[PlanTransmitter, ...], place: str) -> None:
    with pytest.raises(PlanError) as caught:
        with_transmitters(*wrong)
    assert place in str(caught.value)


def test_errors_in_a_file_name_it() -> None:
    text = floorplans.dumps(with_transmitters(*ACCESS_POINTS))
    with pytest.raises(PlanError, match=r"^flat.toml: transmitters\[1\].power_dbm = \"high\""):
        floorplans.loads(text.replace("power_dbm = 17.5", 'power_dbm = "high"'), origin="flat.toml")
    with pytest.raises(PlanError, match=r"transmitters\[0\].hight: unknown key"):
        floorplans.loads(text.replace('id = "hall"', 'id = "hall"\nhight = 2'))
    with pytest.raises(PlanError, match=r"transmitters\[0\].id: the key is missing"):
        floorplans.loads(text.replace('id = "hall"\n', ""))
