"""``--from`` and its companions: which transmitter, what it sends with, and which preset."""

from __future__ import annotations

import json

import numpy as np
import pytest
from cli_plans import ROOM, done, fault, room_file, run

import floorplans
from raytrace import HalfWaveDipole, Isotropic, RadioMap, TraceConfig, TransmitterMaps

ACCESS_POINTS = """
[[transmitters]]
id = "west"
position = [1, 3, 2.5]
power_dbm = 20

[[transmitters]]
id = "east"
position = [5, 3, 2]
frequency_hz = 5.2e9
antenna = "dipole"
"""
HEAD, WALLS = ROOM.split("\n[[walls]]", 1)
NO_FLIGHT = "\n".join(
    line for line in HEAD.splitlines() if not line.startswith(("source", "start"))
)
SURVEYED = f"{NO_FLIGHT}\n{ACCESS_POINTS}\n[[walls]]{WALLS}"
BY_LOSS = TraceConfig(1, 0, None, -120.0, dynamic_range_db=15.0)
"""The limits of the preset `building`, with those of `QUICK`."""

UNKNOWN = Isotropic(polarisation="mean")
QUICK = ("--reflections", "1", "--diffractions", "0")


@pytest.fixture
def plan(tmp_path):
    return room_file(tmp_path, SURVEYED)


def test_all_transmitters_of_a_plan_without_source_are_mapped(plan, tmp_path) -> None:
    target, picture = tmp_path / "maps.h5", tmp_path / "maps.svg"
    facts = json.loads(done("map", plan, "-o", target, "--picture", picture, *QUICK, "--json"))
    assert facts["transmitters"] == {"west": [1, 3, 2.5], "east": [5, 3, 2]}
    maps = TransmitterMaps.load(target)
    assert maps.names == ("west", "east")
    west, east = (one.transmitter for one in maps.values())
    assert (west.power_dbm, west.frequency_hz, west.antenna) == (20.0, 2.4e9, UNKNOWN)
    assert (east.power_dbm, east.frequency_hz, east.antenna) == (25.0, 5.2e9, HalfWaveDipole())
    assert maps.first.config == BY_LOSS
    assert maps.first.receive_antenna == UNKNOWN
    assert picture.read_text().count('id="transmitter"') >= 2
    again = run("map", plan, "-o", target, *QUICK)
    assert f"{target} is up to date" in again.stderr
    assert "west, east" in again.stdout
    flying = fault("train", plan, "--map", target)
    assert "holds maps of transmitters, expected the map of one" in flying


def test_one_is_chosen_by_id_or_by_its_place(plan, tmp_path) -> None:
    target = tmp_path / "map.h5"
    done("map", plan, "-o", target, "--from", "east", "--power", "3", *QUICK)
    radio_map = RadioMap.load(target)
    assert radio_map.transmitter.position == (5.0, 3.0, 2.0)
    assert radio_map.transmitter.power_dbm == 3.0
    options = ("--frequency", "3.5", "--antenna", "dipole", "--receive-antenna", "isotropic")
    done("map", plan, "-o", target, "--from", "2,1.5,1", *options, *QUICK)
    radio_map = RadioMap.load(target)
    assert radio_map.transmitter.position == (2.0, 1.5, 1.0)
    assert radio_map.transmitter.frequency_hz == 3.5e9
    assert radio_map.transmitter.antenna == HalfWaveDipole()
    place = "5,3,2"
    by_id, by_place = (
        json.loads(done("paths", plan, "--from", name, "--to", "1,1", "--json", *QUICK,
                        "--frequency", "2", "--antenna", "isotropic", "--power", "0"))
        for name in ("east", place)
    )  # fmt: skip
    assert by_id == by_place
    assert by_id["transmitter_m"] == [5, 3, 2]
    assert any("T" in row["interactions"] for row in by_id["strongest"])


@pytest.mark.parametrize(
    ("command", "options", "message"),
    [
        ("map", ("--from", "north"), "no transmitter 'north': it has west, east"),
        ("map", ("--from", "9,9,1"), "(9, 9, 1) is not inside"),
        ("map", ("--antenna", "yagi"), "'yagi' is not isotropic, unpolarised, dipole, monopole"),
        ("paths", (), "choose one of the transmitters west, east"),
        ("paths", ("--from", "all"), "choose one of the transmitters west, east"),
    ],
)
def test_wrong_choices_are_wrong_usage(plan, tmp_path, command, options, message) -> None:
    where = ("-o", tmp_path / "map.h5") if command == "map" else ("--to", "1,1")
    result = run(command, plan, *where, *options)
    assert result.exit_code == 2
    assert message in " ".join(result.stderr.replace("│", " ").split())
    assert not (tmp_path / "map.h5").exists()


def test_a_plan_without_any_transmitter_says_what_to_give(tmp_path) -> None:
    bare = room_file(tmp_path, SURVEYED.replace(ACCESS_POINTS, ""))
    result = run("map", bare, "-o", tmp_path / "map.h5")
    assert result.exit_code == 2
    text = " ".join(result.stderr.replace("│", " ").split())
    assert "neither a source nor transmitters" in text
    assert "[[transmitters]] in the plan" in text
    assert "--from X,Y,Z" in text
    done("map", bare, "-o", tmp_path / "map.h5", "--from", "1,1,1", *QUICK)


def test_an_antenna_file_that_is_wrong_is_named(plan, tmp_path) -> None:
    text = fault("map", plan, "-o", tmp_path / "map.h5", "--antenna", tmp_path / "no.csv")
    assert f"{tmp_path / 'no.csv'}: the file cannot be read" in text


def test_presets_follow_the_plan_and_single_options_override_them(tmp_path) -> None:
    target = tmp_path / "map.h5"
    done("map", "flat", "-o", target, *QUICK, "--cell-size", "3")
    assert RadioMap.load(target).config == TraceConfig(1, 0, 0)
    assert RadioMap.load(target).receive_antenna == HalfWaveDipole()
    done("map", room_file(tmp_path), "-o", target, *QUICK, "--transmissions", "2", "--force")
    assert RadioMap.load(target).config == TraceConfig(1, 0, 2)
    assert RadioMap.load(target).transmitter.position == floorplans.loads(ROOM).source


def test_transmissions_may_be_limited_by_loss(tmp_path) -> None:
    plan, target = room_file(tmp_path), tmp_path / "map.h5"
    done("map", plan, "-o", target, *QUICK, "--transmissions", "none")
    assert RadioMap.load(target).config == BY_LOSS
    done("map", plan, "-o", target, *QUICK, "--preset", "building", "--force")
    assert RadioMap.load(target).config == BY_LOSS
    done(
        "map", plan, "-o", target, *QUICK, "--preset", "building", "--transmissions", "2", "--force"
    )
    assert RadioMap.load(target).config == TraceConfig(1, 0, 2)
    limits = ("--min-power", "-90", "--dynamic-range", "12")
    done("map", plan, "-o", target, *QUICK, "--transmissions", "none", *limits, "--force")
    by_loss = TraceConfig(1, 0, None, -90.0, dynamic_range_db=12.0)
    assert RadioMap.load(target).config == by_loss
    text = run("map", plan, "-o", target, "--transmissions", "many").stderr
    assert "'many' is neither an integer" in text


def test_dark_cells_behind_walls_say_what_to_do(tmp_path) -> None:
    plan = room_file(tmp_path, ROOM.replace("openings = [{", "# openings = [{"))
    target = tmp_path / "map.h5"
    dark = run("map", plan, "-o", target, "--preset", "paper", *QUICK)
    assert "no path reaches 12 cells inside the building: try --preset building" in dark.stderr
    assert "--transmissions none" in dark.stderr
    assert np.isneginf(RadioMap.load(target).rss_dbm).sum() == 12
    lit = run("map", plan, "-o", target, *QUICK)
    assert "no path reaches" not in lit.stderr


def test_limits_are_checked_at_random_cells_of_each_map(plan, tmp_path) -> None:
    target = tmp_path / "maps.h5"
    arguments = ("map", plan, "-o", target, *QUICK, "--dynamic-range", 5, "--check-limits", 4)
    facts = json.loads(done(*arguments, "--json"))["left_out"]
    assert list(facts) == ["west", "east"]
    for sample in facts.values():
        assert sample["cells"] == 4
        assert 0.0 <= sample["median_db"] <= sample["largest_db"]
        assert sample["share_of_all_cells"] == pytest.approx(0.05**0.25)
    printed = run(*arguments).stdout
    assert "left out, west" in printed
    assert "in 4 random cells above -100 dBm" in printed
    assert "no more in 47% of all such cells, with 95% confidence" in printed


def test_a_check_of_limits_needs_limits_by_power(plan, tmp_path) -> None:
    arguments = ("map", plan, "-o", tmp_path / "m.h5", "--preset", "paper", *QUICK)
    result = run(*arguments, "--check-limits", 4)
    assert result.exit_code == 2
    assert "--check-limits" in result.stderr
    assert not (tmp_path / "m.h5").exists()


def test_dark_maps_are_not_checked(plan, tmp_path) -> None:
    arguments = ("map", plan, "-o", tmp_path / "m.h5", *QUICK, "--power", -200, "--min-power", -900)
    shown = run(*arguments, "--check-limits", 4)
    assert "left out" not in shown.stdout
    assert "no cell of west has more than -100 dBm" in shown.stderr
