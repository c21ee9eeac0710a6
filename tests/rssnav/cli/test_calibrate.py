"""``rssnav calibrate`` writes a plan that is better, and nothing otherwise."""

from __future__ import annotations

import json
import re

import numpy as np
import pytest
from cli_plans import done, edited, fault, room_file, run
from small_surveys import HEADING, written

import floorplans
from floorplans import FloorPlan
from raytrace import TraceConfig, Transmitter, received_power
from rssnav.scenes import scene_of

PLACES = {"A": (1.2, 1.1, 2.0), "B": (5.0, 3.0, 2.0)}
QUICK = ("--reflections", 1, "--diffractions", 0, "--transmissions", 1)


LOSSY, CLEAR = "concrete", "wood"


def partition_of(material: str) -> FloorPlan:
    """Return the room with a partition of another material."""
    return floorplans.loads(edited('material = "plasterboard"', f'material = "{material}"'))


def rows(white: FloorPlan, black: FloorPlan) -> list[str]:
    """Readings that the tracer makes in two buildings, on the two colours of a chequerboard."""
    random = np.random.default_rng(5)
    x, y = np.meshgrid(np.arange(0.3, 5.8, 0.45), np.arange(0.3, 3.8, 0.45))
    points = np.column_stack([x.ravel(), y.ravel(), np.full(x.size, 1.5)])
    is_white = np.floor(points[:, :2]).sum(axis=1) % 2 == 0
    found: list[str] = []
    for name, position in PLACES.items():
        powers = [
            received_power(scene_of(plan), Transmitter(position), points, TraceConfig(1, 0, 1))
            for plan in (white, black)
        ]
        power = np.where(is_white, *powers) + random.normal(0.0, 0.5, len(points))
        found += [
            f"{name},{px},{py},{pz},{p}" for (px, py, pz), p in zip(points, power, strict=True)
        ]
    return found


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """Readings in a room whose partition is lossy; the plan takes it for plasterboard."""
    folder = tmp_path_factory.mktemp("room")
    lossy = partition_of(LOSSY)
    survey = written(folder / "survey.csv", [HEADING, *rows(lossy, lossy)])
    transmitters = [f"{name},{x},{y},{z}" for name, (x, y, z) in PLACES.items()]
    places = written(folder / "tx.csv", ["tx,x,y,z", *transmitters])
    return room_file(folder), survey, places


def test_a_better_plan_is_written_with_its_report(files, tmp_path) -> None:
    plan, survey, places = files
    out, page = tmp_path / "out.toml", tmp_path / "page.html"
    text = done("calibrate", plan, survey, "--transmitters", places, *QUICK, "--antenna", "dipole",
                "-o", out, "--report", page, "--json")  # fmt: skip
    found = json.loads(text)
    assert found["written"]
    sigma = found["held_out_sigma_db"]["space"]
    assert sigma["after"] < sigma["before"] - 0.5
    fitted = next(row for row in found["fitted"] if row["property"] == "conductivity")
    assert fitted["material"] == "plasterboard"
    assert fitted["after"] > 2.0 * fitted["before"]
    assert out.read_text().startswith("# fitted to survey.csv by rssnav calibrate")
    validated = json.loads(done("validate", out, survey, "--transmitters", places, *QUICK,
                                "--antenna", "dipole", "--json"))  # fmt: skip
    after = validated["models"]["tracer"]["held_out_by_space"]["sigma_db"]
    assert after == pytest.approx(sigma["after"], abs=0.3)
    assert "data:image/png" in page.read_text(encoding="utf-8")


def test_a_plan_that_is_no_better_is_kept(files, tmp_path) -> None:
    """Each half of the readings is of another building, and tells the wrong about the other."""
    plan, _, places = files
    lines = rows(partition_of(LOSSY), partition_of(CLEAR))
    survey = written(tmp_path / "s.csv", [HEADING, *lines])
    out = tmp_path / "out.toml"
    result = run("calibrate", plan, survey, "--transmitters", places, *QUICK, "--antenna",
                 "dipole", "-o", out)  # fmt: skip
    assert result.exit_code == 1
    assert re.search(r"does not improve held-out readings, .*; \S+ is not written", result.stderr)
    assert not out.exists()


def test_a_wrong_survey_writes_nothing(files, tmp_path) -> None:
    plan, _, places = files
    survey = written(tmp_path / "s.csv", [HEADING, "A,1,1,1.5,x"])
    line = fault("calibrate", plan, survey, "--transmitters", places, "-o", tmp_path / "out.toml")
    assert "row 2, column rss_dbm = 'x': expected a finite number" in line
    assert [path.name for path in tmp_path.iterdir()] == ["s.csv"]


def test_the_suffix_is_that_of_a_plan(files, tmp_path) -> None:
    plan, survey, places = files
    result = run("calibrate", plan, survey, "--transmitters", places, "-o", tmp_path / "out.json")
    assert result.exit_code == 2
