"""``rssnav plan new``, ``check`` and ``--fix``: what is told, what is written, exit codes."""

from __future__ import annotations

import json

import numpy as np
import pytest
from cli_plans import ROOM, done, edited, fault, room_file, run

import floorplans
from rssnav.reachability import reach_by_speed, source_unreached, unreached

CLOSET = "[[4, 0], [4, 2], [6, 2]]"
PARTITION = "points = [[3, 0], [3, 4]]"
DOOR = '{ kind = "door", offset_m = 1, width_m = 1, head_m = 2.4 }'
SHORT = edited(PARTITION, "points = [[3, 0.03], [3, 3.96]]")


def test_new_plan_passes_the_check_and_is_not_overwritten(tmp_path) -> None:
    target = tmp_path / "my.toml"
    assert done("plan", "new", "--size", "40x25", "-o", target).startswith(f"wrote {target}")
    assert floorplans.load(target).bounds == (0.0, 0.0, 40.0, 25.0)
    assert done("plan", "check", target).endswith("my.toml is valid\n")
    before = target.read_text()
    assert "use --force to overwrite" in fault("plan", "new", "-o", target)
    assert target.read_text() == before
    done("plan", "new", "--size", "7 x 6.5", "-o", target, "--force")
    assert floorplans.load(target).bounds == (0.0, 0.0, 7.0, 6.5)


def test_what_concerns_a_map_is_apart_from_what_concerns_a_flight(tmp_path) -> None:
    closet = ROOM + f'\n[[walls]]\npoints = {CLOSET}\nmaterial = "wood"\nthickness_m = 0.1\n'
    text = done("plan", "check", room_file(tmp_path, closet))
    before, after = text.split("\nfor a flight, ")
    assert "no door" in after
    assert "no door" not in before
    without = "".join(
        line for line in closet.splitlines(keepends=True) if not line.startswith("start")
    )
    text = done("plan", "check", room_file(tmp_path, without))
    assert "not checked, because the plan has no start" in text
    assert text.endswith("is valid\n")
    report = json.loads(done("plan", "check", room_file(tmp_path, without), "--json"))
    assert report["start_m"] is None
    assert report["flights"] == report["findings"] == []


@pytest.mark.parametrize("size", ["40", "40xx25", "4x25", "40x2500"])
def test_size_that_is_none_is_wrong_usage(tmp_path, size) -> None:
    assert run("plan", "new", "--size", size, "-o", tmp_path / "my.toml").exit_code == 2
    assert list(tmp_path.iterdir()) == []


def test_warnings_are_told_with_their_places_and_end_well(tmp_path) -> None:
    text = done("plan", "check", room_file(tmp_path, SHORT))
    assert "warning  (3.000, 0.030)  almost meets: an end of walls[1] is 0.03 m from" in text
    assert "warning  (3.000, 3.960)  almost meets" in text
    assert text.endswith("room.toml is valid, but see 2 warnings above\n")


def test_several_errors_are_all_told(tmp_path) -> None:
    text = edited("start = [5.5, 3.5]", "start = [5.5, -3.5]").replace(
        "[1.2, 1.1, 1.5]", "[7, 1, 1]"
    )
    result = run("plan", "check", room_file(tmp_path, text))
    assert result.exit_code == 1
    lines = result.stdout.splitlines()
    assert lines[0].startswith("error  (7.000, 1.000)  source = [7.0, 1.0, 1.0]: the source is out")
    assert lines[1].startswith("error  (5.500, -3.500)  start = [5.5, -3.5]: the start is outside")
    assert result.stderr.startswith(f"rssnav: {tmp_path / 'room.toml'}: source = ")


def test_json_has_findings_also_where_the_plan_is_unusable(tmp_path) -> None:
    told = json.loads(done("plan", "check", room_file(tmp_path, SHORT), "--json"))
    assert [f["kind"] for f in told["findings"]] == ["almost meets", "almost meets"]
    assert told["findings"][0]["at"] == [3.0, 0.03]
    result = run("plan", "check", room_file(tmp_path, edited("[5.5, 3.5]", "[9, 9]")), "--json")
    assert result.exit_code == 1
    assert [f["severity"] for f in json.loads(result.stdout)["findings"]] == ["error"]


def test_fix_mends_in_place_and_keeps_what_was(tmp_path) -> None:
    path = room_file(tmp_path, SHORT)
    result = run("plan", "check", path, "--fix")
    assert result.exit_code == 0
    assert result.stderr.count("repaired (3, ") == 2
    assert (tmp_path / "room.toml.bak").read_text() == SHORT
    assert result.stdout.endswith("room.toml is valid\n")
    assert path.read_text().startswith("# Repaired:")
    assert floorplans.load(path) == floorplans.load(path)
    again = run("plan", "check", path, "--fix")
    assert "no safe repairs found" in again.stderr


def test_fix_into_another_file_leaves_the_plan_alone(tmp_path) -> None:
    path, target = room_file(tmp_path, SHORT), tmp_path / "repaired.toml"
    done("plan", "check", path, "--fix", "-o", target)
    assert path.read_text() == SHORT
    assert sorted(file.name for file in tmp_path.iterdir()) == ["repaired.toml", "room.toml"]
    told = json.loads(done("plan", "check", target, "--json"))
    assert told["findings"] == []


def test_fix_of_wrong_numbers_writes_nothing(tmp_path) -> None:
    path = room_file(tmp_path, edited("thickness_m = 0.1", "thickness_m = -0.1"))
    assert "expected a finite number" in fault("plan", "check", path, "--fix")
    assert [file.name for file in tmp_path.iterdir()] == ["room.toml"]


def test_fix_of_a_builtin_plan_and_output_without_fix_are_wrong_usage(tmp_path) -> None:
    assert run("plan", "check", "flat", "--fix").exit_code == 2
    assert run("plan", "check", "flat", "-o", tmp_path / "flat.toml").exit_code == 2


def test_cells_behind_a_shut_door_are_told(tmp_path) -> None:
    shut = f'{ROOM}\n[[walls]]\npoints = {CLOSET}\nmaterial = "brick"\nthickness_m = 0.1\n'
    plan = floorplans.load(room_file(tmp_path, shut))
    one, two, _ = reach_by_speed(plan)
    assert sorted(map(tuple, one.missed.tolist())) == [
        (x, y) for x in (4.5, 5.5) for y in (0.5, 1.5)
    ]
    assert one.n_cells == 24
    finding = unreached(one)
    assert finding is not None
    assert "at speed 1, 4 of 24 cells (17 %) cannot be reached" in finding.text
    assert finding.at == (5.0, 1.0)
    assert np.isin(two.missed, one.missed).all()


def test_a_plan_whose_source_no_flight_reaches_is_good_for_maps(tmp_path) -> None:
    path = room_file(tmp_path, edited(DOOR, ""))
    before, after = done("plan", "check", path).split("\nfor a flight, ")
    assert "warning" not in before
    assert "warning  (1.200, 1.100)  source not reached: at speeds 1, 2, 4 no cell" in after
    assert "no speed from 1 to 8 can: open a way in the plan" in after
    told = json.loads(done("plan", "check", path, "--json"))
    assert [reach["steps"] for reach in told["flights"]] == [None, None, None]
    assert {f["concerns"] for f in told["findings"]} == {"flight"}


def test_a_repair_keeps_a_plan_whose_source_no_flight_reaches(tmp_path) -> None:
    path = room_file(tmp_path, SHORT.replace(DOOR, ""))
    done("plan", "check", path, "--fix")
    assert path.read_text().startswith("# Repaired:")


def test_a_speed_at_which_no_step_is_possible_is_one_row(tmp_path) -> None:
    low = ROOM.replace("[6, 4], [0, 4]", "[6, 3], [0, 3]").replace("[3, 4]", "[3, 3]")
    low = low.replace("start = [5.5, 3.5]", "start = [5.5, 2.5]")
    plan = floorplans.load(room_file(tmp_path, low))
    reaches = reach_by_speed(plan, (1, 4))
    assert [reach.steps is None for reach in reaches] == [False, True]
    assert source_unreached(plan, reaches) is None


def test_every_cell_of_an_open_hall_is_reached() -> None:
    hall = floorplans.load("scenario2")
    assert [len(reach.missed) for reach in reach_by_speed(hall)[:1]] == [0]
    assert unreached(reach_by_speed(hall)[0]) is None


@pytest.mark.parametrize("suffix", ["html", "glb"])
def test_show_writes_views_in_three_dimensions(tmp_path, suffix) -> None:
    target = tmp_path / f"flat.{suffix}"
    assert done("plan", "show", "flat", "-o", target) == f"wrote {target}\n"
    assert target.stat().st_size > 5000
    assert run("plan", "show", "flat", "-o", target, "--view", "2d").exit_code == 2
