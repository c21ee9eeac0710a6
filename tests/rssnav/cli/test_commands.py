"""Each command does what it says, for people and for programs."""

from __future__ import annotations

import io
import json
import re
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from cli_plans import ESCAPE, QUICK, done, edited, room_file, run

import floorplans
import rssnav.experiments.paper
from raytrace import RadioMap, TraceConfig
from rssnav import TrainingResult
from rssnav.cli import experiments
from rssnav.cli.plan_sketch import sketch
from rssnav.experiments.paper.counting import Count
from rssnav.experiments.paper.scenarios import PLANS

COMMANDS = (
    (),
    ("plan",),
    ("plan", "list"),
    ("plan", "show"),
    ("plan", "check"),
    ("plan", "export"),
    ("map",),
    ("maps",),
    ("paths",),
    ("validate",),
    ("calibrate",),
    ("example",),
    ("train",),
    ("dataset",),
    ("dataset", "make"),
    ("dataset", "check"),
    ("dataset", "info"),
    ("dataset", "show"),
    ("dataset", "export"),
    ("dataset", "baselines"),
    ("explore",),
    ("experiments",),
    ("report",),
    ("doctor",),
)


@pytest.fixture(scope="module")
def room(tmp_path_factory):
    """The room's plan without its partition, so that every cell has a path; and its map."""
    folder = tmp_path_factory.mktemp("room")
    text = edited("points = [[3, 0], [3, 4]]", "points = [[3, 0], [3, 2.5]]")
    plan, target = room_file(folder, text), folder / "room.h5"
    done("map", plan, "-o", target)
    return plan, target


@pytest.mark.parametrize("command", COMMANDS, ids=" ".join)
def test_help_has_an_example_that_parses(command, monkeypatch) -> None:
    monkeypatch.setenv("COLUMNS", "100")
    text = done(*command, "--help")
    assert not re.search(r"<(bool|str|list.*)>", text)  # a flag takes no value
    lines = re.findall(r"^ +(rssnav .*?) *$", text.split("Examples:")[1], re.MULTILINE)
    assert lines
    for line in lines:
        name, *_ = line.split()[1:]
        assert name in {first for first, *_ in COMMANDS[1:]}


def test_version() -> None:
    assert re.fullmatch(r"rssnav \d+\.\d+\.\d+\S*\n", done("--version"))


def test_list_names_every_built_in_plan() -> None:
    listed = json.loads(done("plan", "list", "--json"))
    assert tuple(plan["name"] for plan in listed) == floorplans.builtin_names()
    table = done("plan", "list")
    assert [line.split()[0] for line in table.splitlines()[1:]] == [*floorplans.builtin_names()]
    assert not ESCAPE.search(table)


def test_show_draws_into_a_file(room, tmp_path) -> None:
    for view, file in (("2d", "above.png"), ("3d", "oblique.svg")):
        done("plan", "show", room[0], "--view", view, "-o", tmp_path / file)
    assert (tmp_path / "above.png").read_bytes().startswith(b"\x89PNG")
    assert "<svg" in (tmp_path / "oblique.svg").read_text()
    assert sorted(file.name for file in tmp_path.iterdir()) == ["above.png", "oblique.svg"]


def test_sketch_has_source_start_walls_and_gaps_in_place(room) -> None:
    lines = sketch(floorplans.load(room[0]), columns=60).splitlines()[:-1]
    dots_per_m = 119 / 6

    def at(x: float, y: float) -> str:
        """Characters around a point [m]; a character is 2 dots wide and 4 high."""
        column = int(x * dots_per_m / 2)
        return lines[int((4 - y) * dots_per_m / 4)][column - 1 : column + 2]

    assert len(lines) == 20
    assert "S" in at(1.2, 1.1)
    assert "U" in at(5.5, 3.5)
    for y, solid in ((3.25, False), (2.25, True), (1.5, False), (0.5, True)):
        assert bool(at(3.0, y).strip()) == solid, f"partition at y = {y}"


def test_sketch_falls_back_to_plain_characters(room, monkeypatch) -> None:
    monkeypatch.setattr("sys.stdout", io.TextIOWrapper(io.BytesIO(), encoding="ascii"))
    lines = sketch(floorplans.load(room[0]), columns=30).splitlines()
    assert lines[0] == 30 * "#"
    assert set("".join(lines[:-1])) == set("# SU")


def test_show_without_a_file_prints_sketch_and_facts(room) -> None:
    text = done("plan", "show", room[0])
    assert "S source, U where the UAV starts" in text
    assert "size       6 x 4 m, 3 m high, 24 m²" in text


def test_check_gives_the_shortest_flights(room) -> None:
    facts = json.loads(done("plan", "check", room[0], "--json"))
    assert [flight["speed"] for flight in facts["flights"]] == [1, 2, 4]
    assert facts["flights"][0]["steps"] >= 3
    assert facts["walls"] == 5


@pytest.mark.parametrize("suffix", ["glb", "ply", "stl", "obj"])
def test_exported_mesh_has_the_plans_area(room, tmp_path, suffix) -> None:
    target = tmp_path / f"room.{suffix}"
    done("plan", "export", room[0], "-o", target)
    mesh = trimesh.load_mesh(target)
    assert mesh.area == pytest.approx(floorplans.load(room[0]).to_mesh().mesh.area)
    assert [file.name for file in tmp_path.iterdir()] == [target.name]


def test_map_reports_what_the_file_holds(room, tmp_path) -> None:
    plan, target = room
    picture = tmp_path / "room.png"
    result = run("map", plan, "-o", target, "--picture", picture, "--json")
    facts, radio_map = json.loads(result.stdout), RadioMap.load(target)
    assert result.stderr == f"{target} is up to date\n"
    assert facts["shape"] == [4, 6]
    assert facts["cells_without_path"] == 0
    assert facts["rss_dbm_max"] == radio_map.rss_dbm.max()
    assert facts["paths"] == radio_map.path_count.sum()
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_room_behind_a_shut_door_has_no_path(tmp_path) -> None:
    shut = edited("head_m = 2.4", 'head_m = 2.4, material = "metal"')
    shut = shut.replace("start = [5.5, 3.5]", "start = [0.5, 3.5]")
    target = tmp_path / "shut.h5"
    facts = json.loads(done("map", room_file(tmp_path, shut), "-o", target, *QUICK, "--json"))
    assert facts["cells_without_path"] == 12


def test_maps_makes_both_scenarios_once(tmp_path, monkeypatch) -> None:
    monkeypatch.setattr("rssnav.experiments.paper.scenarios.PLANS", ("flat",))
    out = tmp_path / "maps"
    files = done("maps", "--out", out).split()
    assert files == [str(out / "flat.h5"), str(out / "flat.png")]
    times = [Path(file).stat().st_mtime_ns for file in files]
    assert run("maps", "--out", out).stderr == f"{out / 'flat.h5'} is up to date\n"
    assert [Path(file).stat().st_mtime_ns for file in files] == times
    (out / "flat.png").unlink()
    done("maps", "--out", out)
    assert (out / "flat.png").exists()


def test_paths_add_up_to_the_map(room) -> None:
    plan, target = room
    radio_map = RadioMap.load(target)
    found = json.loads(done("paths", plan, "--to", "4.5,2.5", "--top", "3", "--json"))
    assert found["receiver_m"] == [4.5, 2.5, 2.0]
    assert found["paths"] == radio_map.path_count[2, 4]
    assert found["rss_dbm"] == pytest.approx(radio_map.rss_dbm[2, 4], abs=1e-9)
    assert found["rss_coherent_dbm"] == pytest.approx(radio_map.rss_coherent_dbm[2, 4], abs=1e-6)
    powers = [path["power_dbm"] for path in found["strongest"]]
    assert powers == sorted(powers, reverse=True)
    for path in found["strongest"]:
        legs = np.diff(np.array(path["vertices_m"]), axis=0)
        assert np.linalg.norm(legs, axis=1).sum() == pytest.approx(path["length_m"])
        interactions = path["interactions"].replace("LOS", "")
        assert len(interactions) == len(path["vertices_m"]) - 2


def test_paths_are_a_table_for_people(room) -> None:
    lines = done("paths", room[0], "--to", "4.5,2.5,1.5", "--top", "2", *QUICK).splitlines()
    assert lines[0].split("  ")[-1] == "interactions"
    assert "power [dBm]" in lines[0]
    assert lines[1].split()[0] == "1"
    assert lines[3].startswith("all paths")


def train_room(room, *options: object) -> dict:
    plan, target = room
    return json.loads(
        done("train", plan, "--map", target, "--runs", 4, "--episodes", 300, *options, "--json")
    )


@pytest.mark.parametrize("agent", ["rss", "location"])
def test_trained_agents_reach_the_source(room, agent) -> None:
    facts = train_room(room, "--agent", agent)
    assert facts["agent"] == agent
    assert facts["runs"] == facts["reached_runs"] == 4
    assert facts["path_steps"]["min"] >= facts["fewest_steps"]
    assert facts["path_length_m"]["min"] >= facts["shortest_length_m"] - 1e-9


def test_training_until_convergence_tells_when(room) -> None:
    facts = train_room(room, "--agent", "location", "--until-converged", "--episodes", "20000")
    assert facts["converged_runs"] == 4
    assert facts["converged_flight_s"]["min"] > facts["converged_episode"]["min"]


def test_coarse_states_are_fewer(room) -> None:
    exact = train_room(room)["labels"]["max"]
    assert train_room(room, "--tolerance", 3)["labels"]["max"] < exact
    assert train_room(room, "--interval", 3)["labels"]["max"] < exact


def test_threads_do_not_change_a_training(room) -> None:
    one, two = (train_room(room, "--threads", n) for n in (1, 2))
    for facts in (one, two):
        del facts["cpu_s"], facts["converged_cpu_s"]
    assert one == two


def test_finished_training_is_not_repeated(room, tmp_path) -> None:
    plan, target = room
    kept = tmp_path / "result.h5"
    arguments = ("train", plan, "--map", target, "--runs", 3, "--episodes", 50, "-o", kept)
    done(*arguments)
    before = kept.read_bytes()
    again = run(*arguments)
    assert again.stderr == f"{kept} holds 3 of 3 runs\n"
    assert kept.read_bytes() == before
    other = run(*arguments, "--seed", 1)
    assert other.exit_code == 1
    assert f"{kept}: the earlier result was trained with a different schedule" in other.stderr
    done(*arguments, "--seed", 1, "--force")
    assert TrainingResult.load(kept).schedule.seed == 1


def test_training_for_people_is_plain_when_piped(room) -> None:
    plan, target = room
    text = done("train", plan, "--map", target, "--runs", 2, "--episodes", 50)
    assert "final flight  " in text
    assert "fewest possible" in text
    assert not ESCAPE.search(text)


def test_doctor_finds_nothing_wrong() -> None:
    facts = json.loads(done("doctor", "--json"))
    assert facts["faults"] == []
    assert facts["threads"] >= 1
    assert "self-test         passed" in done("doctor")


def test_doctor_ends_with_1_when_the_tracer_is_wrong(monkeypatch) -> None:
    monkeypatch.setattr("rssnav.cli.doctor.TraceConfig", lambda *_, **__: TraceConfig(2, 0))
    result = run("doctor")
    assert result.exit_code == 1
    assert "expected 1 + 6 images" in result.stderr
    assert "self-test         failed" in result.stdout


@dataclass
class PaperRun:
    """A stand-in for a run of the paper that stores its options."""

    out: Path | None = None
    options: dict | None = None
    report: Path = Path("results/report.html")
    findings: tuple = ()

    def __call__(self, out, *, progress, notice, **options):
        self.out, self.options = out, options
        progress("training", 1, 2)
        notice("a map is up to date")
        return self


def test_the_plans_of_the_experiments_are_the_built_in_ones() -> None:
    assert experiments.OUR_PLANS == PLANS


def test_experiments_passes_its_options_on(monkeypatch, tmp_path) -> None:
    paper = PaperRun()
    monkeypatch.setattr(rssnav.experiments.paper, "run_paper", paper)
    result = run(
        "experiments", "--quick", "--out", tmp_path, "--runs", 3, "--seed", 5, "--no-resume",
        "--plans", "flat", "mine.toml",
    )  # fmt: skip
    assert result.exit_code == 0
    assert "report: results/report.html" in result.stdout
    assert result.stderr.endswith("a map is up to date\n")
    assert paper.out == tmp_path
    assert paper.options == {
        "quick": True, "runs": 3, "seed": 5, "threads": None, "max_memory_bytes": None,
        "resume": False, "count": Count.WITHOUT_LAST, "plans": ("flat", "mine.toml"),
    }  # fmt: skip


def test_a_study_is_run_and_its_files_are_named(monkeypatch, tmp_path) -> None:
    from rssnav.experiments import studies

    asked = {}

    def run_study(study, out, **options):
        asked.update(study=study, out=out, **options)
        return studies.StudyResult((), (tmp_path / "tables" / "noise.csv",))

    monkeypatch.setattr(studies, "run_study", run_study)
    result = run("experiments", "noise", "--quick", "--out", tmp_path, "--seed", 5)
    assert result.exit_code == 0
    assert result.stdout.split() == [str(tmp_path / "tables" / "noise.csv")]
    assert asked["study"] is studies.STUDIES["noise"]
    assert (asked["out"], asked["quick"], asked["seed"]) == (tmp_path, True, 5)


class TraceCalledError(Exception):
    """Raised in place of a trace, with the options it was called with."""


@pytest.mark.parametrize(
    ("module", "function", "arguments"),
    [
        ("rssnav.cli.radio_maps", "make_map", ("map", "flat", "-o", "flat.h5")),
        ("rssnav.cli.radio_maps", "make_map", ("maps",)),
        ("rssnav.cli.paths", "trace_paths", ("paths", "flat", "--to", "2,2")),
        ("rssnav.experiments.paper.scenarios", "make_map", ("experiments",)),
        ("rssnav.experiments.paper.scenarios", "make_map", ("experiments", "noise")),
        ("rssnav.experiments.paper.run", "run_paper", ("report",)),
    ],
)
def test_every_command_that_traces_passes_its_memory_limit_on(
    module, function, arguments, monkeypatch, tmp_path
) -> None:
    def trace(*_: object, max_memory_bytes: int, **__: object) -> None:
        raise TraceCalledError(max_memory_bytes)

    monkeypatch.chdir(tmp_path)
    summary = {
        "run": {
            "seed": 0,
            "runs": 1,
            "quick": True,
            "plans": ["flat", "flat"],
            "count": "all steps",
        }
    }
    (tmp_path / "results").mkdir()
    (tmp_path / "results" / "summary.json").write_text(json.dumps(summary))
    monkeypatch.setattr(f"{module}.{function}", trace)
    result = run(*arguments, "--max-memory", 0.25)
    assert isinstance(result.exception, TraceCalledError)
    assert result.exception.args == (250_000_000,)


@pytest.mark.parametrize(("options", "limit"), [((), 10**9), (("--max-memory", 3), 3 * 10**9)])
def test_the_explorer_limits_the_memory_of_a_tab(options, limit, monkeypatch) -> None:
    def serve(_plan: object, settings: Any, _ready: object) -> None:
        raise TraceCalledError(settings.limits.trace_bytes)

    monkeypatch.setattr(import_module("rssnav.explorer.server"), "serve", serve)
    assert run("explore", "flat", *options).exception.args == (limit,)


def test_a_study_refuses_the_options_of_the_paper(tmp_path) -> None:
    for options in (("--runs", 3), ("--count", "all"), ("--plans", "flat", "flat")):
        assert run("experiments", "noise", *options, "--out", tmp_path).exit_code == 2


def test_report_without_a_run_says_how_to_make_one(tmp_path) -> None:
    result = run("report", "--out", tmp_path)
    assert result.exit_code == 1
    assert "`rssnav experiments` makes one" in result.stderr
