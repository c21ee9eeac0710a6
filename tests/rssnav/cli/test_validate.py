"""The commands on surveys, on the measured flat."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from cli_plans import done, fault, room_file, run
from small_surveys import HEADING, survey_rows, written

from raytrace import AntennaError, PatternTable
from raytrace.radio import pattern_table
from rssnav.measurements import csv_table
from rssnav.measurements.survey import SurveyError


@pytest.fixture(scope="module")
def flat(tmp_path_factory):
    """The files of the measured flat, as arguments."""
    folder = tmp_path_factory.mktemp("flat") / "flat"
    done("example", "--out", folder)
    return folder / "flat.toml", folder / "survey.csv"


def sigma(flat, *options: object) -> dict[str, float]:
    found = json.loads(done("validate", *flat, *options, "--json"))
    assert found["readings"] == 660
    return {name: row["held_out_by_space"]["sigma_db"] for name, row in found["models"].items()}


def test_published_figures_of_the_measured_flat(flat) -> None:
    """Figures of an independent evaluation with the same halves and one offset."""
    by_model = sigma(flat, "--antenna", "dipole")
    assert by_model["constant"] == pytest.approx(7.0, abs=0.05)
    assert by_model["free space"] == pytest.approx(5.6, abs=0.05)
    assert by_model["log-distance"] == pytest.approx(5.6, abs=0.05)
    assert by_model["log-distance and walls"] == pytest.approx(4.3, abs=0.05)
    assert by_model["tracer"] == pytest.approx(3.9, abs=0.05)
    no_transmission = ("--antenna", "dipole", "--reflections", 6, "--transmissions", 0)
    assert sigma(flat, *no_transmission)["tracer"] == pytest.approx(10.5, abs=0.05)


def test_report_is_one_page_with_everything_in_it(flat, tmp_path) -> None:
    text = done("validate", *flat, "--reflections", 1, "--report", tmp_path / "page.html")
    assert re.search(r"^tracer +\d+\.\d\d", text, re.MULTILINE)
    page = (tmp_path / "page.html").read_text(encoding="utf-8")
    assert page.count("data:image/png;base64,") == 2
    assert not re.search(r"(?:src|href)=\"(?!data:)", page)
    assert "log-distance and walls" in page
    assert [path.name for path in tmp_path.iterdir()] == ["page.html"]


def test_a_wrong_survey_writes_nothing(tmp_path) -> None:
    plan = room_file(tmp_path)
    lines = survey_rows()
    lines[2] = "A,250,150,1.5,-60"
    survey = written(tmp_path / "survey.csv", [HEADING, *lines])
    places = written(tmp_path / "tx.csv", ["tx,x,y,z", "A,1.2,1.1,2", "B,5,3,2"])
    before = sorted(tmp_path.iterdir())
    line = fault(
        "validate", plan, survey, "--transmitters", places, "--report", tmp_path / "page.html"
    )
    assert line.startswith(f"rssnav: {survey}: row 4, column x = '250': (250, 150) is outside")
    assert sorted(tmp_path.iterdir()) == before


def test_a_frequency_that_the_survey_denies_is_wrong_usage(flat) -> None:
    result = run("validate", *flat, "--frequency", "5.2")
    assert result.exit_code == 2
    assert "the survey was made at 2.44e+09 Hz" in " ".join(result.output.split())


def test_a_transmitter_in_a_wall_is_named(flat, tmp_path) -> None:
    inside = written(tmp_path / "tx.csv", ["tx,x,y,z", *(f"{k},2.64,5,2" for k in range(1, 7))])
    line = fault("validate", *flat, "--transmitters", inside)
    assert "transmitter '1': the transmitter at (2.64, 5.0, 2.0) stands in the wall" in line


def test_example_is_not_overwritten_unless_forced(tmp_path) -> None:
    out = tmp_path / "flat"
    done("example", "--out", out)
    (out / "flat.toml").write_text("mine")
    assert "already exists" in fault("example", "--out", out)
    assert (out / "flat.toml").read_text() == "mine"
    done("example", "--out", out, "--force")
    assert "Kolakowski" in (out / "README.md").read_text(encoding="utf-8")


@pytest.mark.skipif(not Path("/dev/zero").exists(), reason="no file without end")
def test_files_without_end_are_refused(tmp_path, monkeypatch) -> None:
    monkeypatch.setattr(csv_table, "MAX_CHARACTERS", 1000)
    monkeypatch.setattr(pattern_table, "MAX_CHARACTERS", 1000)
    with pytest.raises(SurveyError, match="more than 1000 characters"):
        csv_table.read_table(Path("/dev/zero"), ("tx",), ())
    with pytest.raises(AntennaError, match="more than 1000 characters"):
        PatternTable.from_csv("/dev/zero")
