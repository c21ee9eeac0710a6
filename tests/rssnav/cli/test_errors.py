"""Whatever is wrong, a command says so in one line with file, key and remedy, and ends with 1."""

from __future__ import annotations

import re
import warnings
from pathlib import Path

import h5py
import pytest
from cli_plans import QUICK, ROOM, done, edited, fault, room_file, run

import floorplans
import raytrace
import rssnav
from raytrace import MemoryLimitError
from rssnav.cli.failures import REMEDIES, with_remedy

DOOR = "offset_m = 1, width_m = 1, head_m = 2.4"
SECOND_DOOR = '{ kind = "door", offset_m = 1.5, width_m = 1, head_m = 2 }'
PARTITION = "points = [[3, 0], [3, 4]]"
SIDES = "points = [[0, 0], [6, 0], [6, 4], [0, 4], [0, 0]]"

PLANS = {
    "malformed TOML": (edited("height_m = 3", "height_m = "), "not valid TOML", "line 4"),
    "unknown material": (
        edited('"plasterboard"', '"plaster"'),
        'walls[1].material = "plaster"',
        'did you mean "plasterboard"',
    ),
    "unknown key": (edited("start = ", "strat = "), "strat: unknown key", 'did you mean "start"'),
    "opening outside its wall": (
        edited(DOOR, "offset_m = 3.5, width_m = 1, head_m = 2.4"),
        "walls[1].openings[0].offset_m = 3.5",
        "expected at most 3",
    ),
    "overlapping openings": (
        edited(" }]", " }, " + SECOND_DOOR + "]"),
        "walls[1].openings[1]: the opening overlaps openings[0]",
        "move or shrink",
    ),
    "wall of no length": (
        edited(PARTITION, "points = [[3, 0], [3, 4], [3, 4]]"),
        "walls[1]: the wall has no length",
        "give two",
    ),
    "open outline": (
        edited(SIDES, "points = [[0, 0], [6, 0], [6, 4], [0, 4]]"),
        "outline: the outline is open from (0, 4) to (0, 0)",
        "put a wall",
    ),
    "source outside": (
        edited("source = [1.2, 1.1, 1.5]", "source = [7, 1.1, 1.5]"),
        "source = [7.0, 1.1, 1.5]: the source is outside",
        "move it into a room",
    ),
    "source in a wall": (
        edited("source = [1.2, 1.1, 1.5]", "source = [3, 0.5, 1.5]"),
        "source = [3.0, 0.5, 1.5]: the source is in a wall",
        "move it into a room",
    ),
    "start outside": (
        edited("start = [5.5, 3.5]", "start = [5.5, -3.5]"),
        "start = [5.5, -3.5]: the start is outside",
        "move it into a room",
    ),
    "start in a wall": (
        edited("start = [5.5, 3.5]", "start = [3, 0.5]"),
        "start = [3.0, 0.5]: the start is in a wall",
        "move it into a room",
    ),
}


@pytest.mark.parametrize(("text", "place", "remedy"), PLANS.values(), ids=PLANS.keys())
@pytest.mark.parametrize("command", ["check", "map"])
def test_wrong_plan(tmp_path, command, text, place, remedy) -> None:
    plan, target = room_file(tmp_path, text), tmp_path / "room.h5"
    arguments = ("plan", "check", plan) if command == "check" else ("map", plan, "-o", target)
    line = fault(*arguments)
    assert line.startswith(f"rssnav: {plan}: ")
    assert place in line
    assert remedy in line
    assert not target.exists()


def test_missing_plan_names_the_built_in_ones(tmp_path) -> None:
    line = fault("plan", "check", tmp_path / "nowhere.toml")
    assert "nowhere.toml: the file cannot be read: No such file" in line
    assert "flat, scenario1, scenario2" in line


def test_plan_in_which_no_speed_reaches_the_source(tmp_path) -> None:
    shut = edited("head_m = 2.4", "head_m = 1.2")  # too low for a flight at 1.5 m and above
    file = room_file(tmp_path, shut)
    assert "is valid, but see 1 warning above" in " ".join(done("plan", "check", file).split())
    done("map", file, "-o", tmp_path / "room.h5", *QUICK)
    line = fault("train", file, "--map", tmp_path / "room.h5", "--runs", "1")
    assert "no cell nearer than 2 m to the source" in line


def test_plan_the_tracer_refuses(tmp_path) -> None:
    thick = edited("thickness_m = 0.1", "thickness_m = 12")
    line = fault("map", room_file(tmp_path, thick), "-o", tmp_path / "room.h5")
    assert "plan 'room': plasterboard of thickness 12.0 m: expected 0 to 10 m" in line


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """The room's plan and map; not to be changed."""
    folder = tmp_path_factory.mktemp("made")
    plan, target = room_file(folder), folder / "room.h5"
    done("map", plan, "-o", target, *QUICK)
    return plan, target


def test_start_that_cannot_reach_the_source_at_the_speed(made) -> None:
    plan, target = made
    line = fault("train", plan, "--map", target, "--speed", 3, "--agent", "location")
    assert "at speed 3 no cell nearer than 2 m to the source" in line
    assert "speeds that can: 1" in line


@pytest.mark.parametrize("fraction", [0.0, 0.01, 0.3, 0.9, 0.98])
def test_truncated_map(made, tmp_path, fraction) -> None:
    plan, target = made
    whole = target.read_bytes()
    cut = tmp_path / "cut.h5"
    cut.write_bytes(whole[: int(fraction * len(whole))])
    line = fault("train", plan, "--map", cut)
    assert line.startswith(f"rssnav: {cut}: ")
    assert f"compute the map again; use `rssnav map PLAN -o {cut}`" in line


def test_map_that_is_a_text_file(made, tmp_path) -> None:
    text = tmp_path / "notes.h5"
    text.write_text("shopping list")
    assert fault("train", made[0], "--map", text).startswith(f"rssnav: {text}: not an HDF5 file")


def test_map_that_is_another_hdf5_file(made, tmp_path) -> None:
    foreign = tmp_path / "foreign.h5"
    with h5py.File(foreign, "w") as file:
        file["temperature"] = [1.0, 2.0]
    line = fault("train", made[0], "--map", foreign)
    assert f"{foreign}: an HDF5 file, but not a radio map" in line


def test_map_of_another_version(made, tmp_path) -> None:
    plan, target = made
    old = tmp_path / "old.h5"
    old.write_bytes(target.read_bytes())
    with h5py.File(old, "r+") as file:
        file.attrs["format_version"] = 0
    line = fault("train", plan, "--map", old)
    assert f"{old}: format_version = 0, expected 1; compute the map again" in line


def test_map_of_another_plan(made, tmp_path) -> None:
    other = room_file(tmp_path, edited("height_m = 3\n", "height_m = 3.1\n"))
    line = fault("train", other, "--map", made[1])
    assert f"{made[1]}: the map was made for a different plan: plan_sha256 = " in line
    assert f"`rssnav map PLAN -o {made[1]}`" in line


def test_missing_map_says_how_to_make_one(made, tmp_path) -> None:
    missing = tmp_path / "none.h5"
    assert f"`rssnav map PLAN -o {missing}`" in fault("train", made[0], "--map", missing)


def test_map_does_not_replace_what_is_no_map(made, tmp_path) -> None:
    letter = tmp_path / "letter.h5"
    letter.write_text("Dear all")
    line = fault("map", made[0], "-o", letter, *QUICK)
    assert f"{letter}: exists but is not a radio map" in line
    assert "--force" in line
    assert letter.read_text() == "Dear all"
    done("map", made[0], "-o", letter, "--force", *QUICK)
    assert h5py.is_hdf5(letter)


def test_folder_that_cannot_be_written(made, tmp_path) -> None:
    (tmp_path / "file").write_text("")
    result = run("plan", "export", made[0], "-o", tmp_path / "file" / "room.glb")
    assert result.exit_code == 2
    assert "is not a folder" in " ".join(result.stderr.replace("│", " ").split())


def test_damaged_training_result_is_not_replaced(made, tmp_path) -> None:
    plan, target = made
    result = tmp_path / "result.h5"
    result.write_text("no result")
    line = fault("train", plan, "--map", target, "--agent", "location", "-o", result)
    assert line.startswith(f"rssnav: {result}: ")
    assert "use --force to overwrite" in line
    assert result.read_text() == "no result"


WRONG_USAGE = {
    "no plan": (("map", "-o", "x.h5"), "PLAN"),
    "no output": (("map", "flat"), "--output"),
    "unknown command": (("fly",), "fly"),
    "height above the ceiling": (("map", "flat", "-o", "x.h5", "--height", "9"), "below 2.6"),
    "too many reflections": (("map", "flat", "-o", "x.h5", "--reflections", "99"), "--reflections"),
    "no threads": (("map", "flat", "-o", "x.h5", "--threads", "0"), "--threads"),
    "suffix of a picture": (("plan", "show", "flat", "-o", "flat.gif"), ".png, .svg, .pdf"),
    "suffix of a mesh": (("plan", "export", "flat", "-o", "flat"), "no suffix"),
    "view without a file": (("plan", "show", "flat", "--view", "3d"), "add -o"),
    "receiver that is none": (("paths", "flat", "--to", "here"), "X,Y or X,Y,Z"),
    "receiver outside": (("paths", "flat", "--to", "13,1"), "not inside flat"),
}


@pytest.mark.parametrize(("arguments", "expected"), WRONG_USAGE.values(), ids=WRONG_USAGE.keys())
def test_wrong_usage_ends_with_2(tmp_path, monkeypatch, arguments, expected) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "300")
    result = run(*arguments)
    assert result.exit_code == 2
    assert result.stdout == ""
    assert expected in " ".join(result.stderr.replace("│", " ").split())
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("options", "expected"),
    [
        (("--tolerance", "1", "--interval", "1"), "not both"),
        (("--agent", "location", "--tolerance", "1"), "use --agent rss"),
        (("--fluctuation", "1"), "ToleranceStates or IntervalStates"),
        (("--interval", "-1"), "0.001"),
        (("--gamma", "1.5"), "Invalid value for '--gamma'"),
        (("--agent", "location", "--goal-distance", "0"), "a positive number"),
    ],
)
def test_options_that_contradict(made, monkeypatch, options, expected) -> None:
    monkeypatch.setenv("COLUMNS", "300")
    plan, target = made
    result = run("train", plan, "--map", target, *options)
    assert result.exit_code == 2
    assert expected in " ".join(result.stderr.replace("│", " ").split())


def test_room_the_cases_are_edits_of_is_itself_in_order(tmp_path) -> None:
    assert done("plan", "check", room_file(tmp_path, ROOM)).endswith("room.toml is valid\n")


def test_command_knows_every_remedy_that_the_libraries_name() -> None:
    text = "".join(
        file.read_text(encoding="utf-8")
        for package in (floorplans, raytrace, rssnav)
        for file in Path(package.__file__).parent.rglob("*.py")
    )
    named = re.findall(r'remedy = "(\w+)"|remedy="(\w+)"', text)
    assert {first or second for first, second in named} <= {*REMEDIES, "less_memory"}
    assert {"make_map", "replace_file", "unit"} <= {first or second for first, second in named}


def test_a_remedy_names_only_options_that_the_command_has() -> None:
    error = MemoryLimitError("the beams", 100, 10)
    assert with_remedy(error, {"--help", "--max-memory"}).endswith("less; use --max-memory")
    assert with_remedy(error).endswith("take less")
    little = ("--max-memory", 0.001, "--reflections", 9)
    failed = run("paths", "flat", "--to", "10.5,1.5", *little)
    assert failed.exit_code == 1
    ends = "use --reflections or --transmissions or --max-memory"
    assert failed.stderr.strip().endswith(ends)


def test_warnings_of_the_libraries_are_plain_lines(tmp_path, monkeypatch) -> None:
    def load(_: str) -> None:
        warnings.warn("kernels are kept elsewhere", RuntimeWarning, stacklevel=1)
        raise floorplans.PlanError("no plan")

    monkeypatch.setattr(floorplans, "load", load)
    with warnings.catch_warnings():
        warnings.simplefilter("always")
        result = run("plan", "show", tmp_path / "room.toml")
    assert result.stderr == "rssnav: warning: kernels are kept elsewhere\nrssnav: no plan\n"
