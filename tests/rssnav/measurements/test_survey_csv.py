"""Surveys are read strictly: what is wrong is named with its row and column."""

from __future__ import annotations

import numpy as np
import pytest
from small_surveys import HEADING, TRANSMITTERS, room, survey_rows, written

from rssnav.measurements.survey import SurveyError, SurveyTransmitter
from rssnav.measurements.survey_csv import read_survey, read_transmitters

PLAN = room()


def refused(tmp_path, lines: list[str], heading: str = HEADING) -> str:
    path = written(tmp_path / "survey.csv", [heading, *lines])
    with pytest.raises(SurveyError) as caught:
        read_survey(path, PLAN, TRANSMITTERS)
    assert caught.value.path == path
    return str(caught.value).removeprefix(f"{path}: ")


def with_line(k: int, line: str) -> list[str]:
    lines = survey_rows()
    lines[k] = line
    return lines


def test_all_columns_are_read(tmp_path) -> None:
    heading = "device,below_sensitivity,tx,x,y,z,rss_dbm,n,std_db,frequency_hz"
    rows = [f"phone,0,{line},5,1.5,2.4e9" for line in survey_rows()]
    rows[3] = rows[3].replace("phone,0", " tablet ,yes")
    survey = read_survey(written(tmp_path / "s.csv", [heading, *rows]), PLAN, TRANSMITTERS)
    assert survey.devices == ("phone", "tablet")
    assert np.flatnonzero(survey.device).tolist() == [3]
    assert np.flatnonzero(survey.is_censored).tolist() == [3]
    assert survey.frequency_hz == 2.4e9
    assert survey.n_samples is not None
    assert set(survey.n_samples) == {5.0}
    assert survey.transmitters == TRANSMITTERS
    assert survey.distance_m[0] == pytest.approx(
        np.linalg.norm(survey.points[0] - TRANSMITTERS[0].position)
    )


def test_comments_blank_lines_and_a_byte_order_mark_are_skipped(tmp_path) -> None:
    path = tmp_path / "s.csv"
    path.write_text("\ufeff# made by hand\n\n" + "\n".join([HEADING, *survey_rows(), ""]))
    assert len(read_survey(path, PLAN, TRANSMITTERS)) == len(survey_rows())


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("A,9.5,1,1.5,-50", "row 4, column x = '9.5': (9.5, 1) is outside the plan 'room'"),
        ("A,1,9.5,1.5,-50", "row 4, column y = '9.5': (1, 9.5) is outside the plan 'room'"),
        ("A,1,1,3.5,-50", "row 4, column z = '3.5': expected a height above 0 and below 3 m"),
        ("A,1,1,1.5,nan", "row 4, column rss_dbm = 'nan': expected a finite number"),
        ("A,1,inf,1.5,-50", "row 4, column y = 'inf': expected a finite number of metres"),
        ("A,1,1,1.5,", "row 4, column rss_dbm = '': expected a finite number"),
        ("A,1,1,1.5,-250", "row 4, column rss_dbm = '-250': expected a power in dBm between"),
        ("C,1,1,1.5,-50", "row 4, column tx = 'C': no such transmitter: known: A, B"),
        ("A,1,1,1.5", "row 4: 4 values: expected 5, as in the heading"),
    ],
)
def test_a_wrong_value_is_located(tmp_path, line, message) -> None:
    assert refused(tmp_path, with_line(2, line)).startswith(message)


@pytest.mark.parametrize(
    ("scale", "unit"), [(100.0, "centimetres"), (1000.0, "millimetres"), (1 / 0.3048, "feet")]
)
def test_other_units_of_length_are_named(tmp_path, scale, unit) -> None:
    lines = [",".join([t, *(repr(float(c) * scale) for c in (x, y)), z, rss])
             for t, x, y, z, rss in (line.split(",") for line in survey_rows())]  # fmt: skip
    message = refused(tmp_path, lines)
    assert message.startswith("row ")
    assert f"these seem to be {unit}" in message


def test_degrees_are_named(tmp_path) -> None:
    lines = [f"A,52.{k:06},21.{k:06},1.5,{-50 - k}" for k in range(12)]
    assert "these seem to be degrees" in refused(tmp_path, lines)
    lines = [f"A,2.{k:06},1.{k:06},1.5,{-50 - k}" for k in range(12)]
    assert "degrees?" in refused(tmp_path, lines)


@pytest.mark.parametrize(
    ("powers", "message"),
    [
        ([10.0 ** (-8 - k / 10) for k in range(12)], "all values seem to be in W"),
        ([50.0 - k for k in range(12)], "is their minus sign missing?"),
        ([-60.0] * 12, "all readings are -60 dBm: expected different ones"),
    ],
)
def test_powers_of_another_kind_are_named(tmp_path, powers, message) -> None:
    lines = [
        f"{line.rpartition(',')[0]},{p!r}" for line, p in zip(survey_rows(), powers, strict=True)
    ]
    assert message in refused(tmp_path, lines)


def test_a_repeated_place_names_both_rows(tmp_path) -> None:
    lines = survey_rows()
    message = refused(tmp_path, [*lines, lines[1]])
    assert message.startswith("row 14, column x = '1.5': the same place and transmitter as row 3")


def test_mixed_frequencies_are_refused(tmp_path) -> None:
    lines = [f"{line},2.4e9" for line in survey_rows()]
    lines[4] = lines[4].replace("2.4e9", "5.2e9")
    message = refused(tmp_path, lines, f"{HEADING},frequency_hz")
    assert message.startswith("row 6, column frequency_hz = '5.2e9': expected 2.4e+09 as in row 2")
    lines[4] = lines[4].replace("5.2e9", "2.4")
    message = refused(tmp_path, lines, f"{HEADING},frequency_hz")
    assert message.startswith("row 6, column frequency_hz = '2.4': expected a frequency in Hz")


def test_a_frequency_differs_from_that_of_the_transmitters(tmp_path) -> None:
    at_5_ghz = [SurveyTransmitter(t.name, t.position, 0.0, 5.2e9) for t in TRANSMITTERS]
    lines = [f"{line},2.4e9" for line in survey_rows()]
    path = written(tmp_path / "s.csv", [f"{HEADING},frequency_hz", *lines])
    with pytest.raises(SurveyError, match=r"row 2, .* expected 5.2e\+09 of its transmitters"):
        read_survey(path, PLAN, at_5_ghz)


@pytest.mark.parametrize(
    ("heading", "message"),
    [
        ("tx;x;y;z;rss_dbm", "row 1: columns separated by semicolons"),
        ("tx,x,y,z,rssi", "row 1: unknown column 'rssi': expected the columns tx, x, y, z"),
        ("tx,x,y,z,z", "row 1: the column z stands there twice"),
        ("tx,x,y,rss_dbm,n", "row 1: no column z"),
    ],
)
def test_a_wrong_heading_is_refused(tmp_path, heading, message) -> None:
    assert refused(tmp_path, survey_rows(), heading).startswith(message)


def test_files_that_are_no_surveys_are_refused(tmp_path) -> None:
    assert refused(tmp_path, []).startswith("no readings")
    assert refused(tmp_path, survey_rows()[:4]).startswith("4 readings above the sensitivity")
    path = tmp_path / "survey.csv"
    for content in (b"\xff\xfe\x00", b"tx\0"):
        path.write_bytes(content)
        with pytest.raises(SurveyError, match="expected CSV"):
            read_survey(path, PLAN, TRANSMITTERS)
    assert "not CSV" in refused(tmp_path, ['A,"1'])


def test_transmitters_are_read_and_checked(tmp_path) -> None:
    path = written(tmp_path / "t.csv", ["tx,x,y,z,power_dbm", "A,1,1,2,4", "B,5,3,2,7"])
    assert read_transmitters(path, PLAN) == (
        SurveyTransmitter("A", (1.0, 1.0, 2.0), 4.0),
        SurveyTransmitter("B", (5.0, 3.0, 2.0), 7.0),
    )
    for line, message in (
        ("A,2,2,2", "row 3, column tx = 'A': the transmitter stands in row 2 too"),
        (",2,2,2", "row 3, column tx = '': expected a name"),
        ("B,2,2,4", "row 3, column z = '4': expected a height"),
    ):
        written(path, ["tx,x,y,z", "A,1,1,2", line])
        with pytest.raises(SurveyError) as caught:
            read_transmitters(path, PLAN)
        assert message in str(caught.value)
