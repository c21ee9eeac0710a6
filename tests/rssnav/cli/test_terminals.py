"""Names are shown as they are, on terminals of any encoding; closed pipes end a command quietly."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from cli_plans import QUICK, ROOM, all_commands, done, edited, fault, room_file, run
from matplotlib.figure import Figure
from typer.testing import CliRunner

import floorplans
from floorplans.pictures.plan_view import draw_plan, save_plan_picture
from rssnav.cli import app
from rssnav.cli.console import print_table, stage_progress
from rssnav.messages import printable

NAMES = (
    "[bold]",
    "[/red]",
    "[link=x]y[/]",
    "$x^{$",
    "<script>&amp;",
    "50 % {name}",
    "Büro 😀",
    "\\n",
)
CONTROL = "a\x1b[31mb\u202ec\x9bd"


@pytest.mark.parametrize("name", NAMES)
def test_names_are_shown_as_they_are(tmp_path: Path, name: str) -> None:
    path = room_file(
        tmp_path, edited('name = "room"', f"name = {json.dumps(name, ensure_ascii=False)}")
    )
    assert f"plan       {name}\n" in done("plan", "check", path)
    plan = floorplans.load(path)
    axes = Figure().subplots()
    draw_plan(plan, axes)
    save_plan_picture(plan, tmp_path / "room.svg")
    done("plan", "show", path, "-o", tmp_path / "room.html")
    page = (tmp_path / "room.html").read_text(encoding="utf-8")
    assert "<script>&amp;" not in page
    assert json.loads(done("map", path, "-o", tmp_path / "room.h5", *QUICK, "--json"))["cells"]


def test_a_stage_may_have_any_name(monkeypatch, capsys) -> None:
    monkeypatch.setenv("FORCE_COLOR", "1")
    monkeypatch.setenv("TTY_COMPATIBLE", "1")
    with stage_progress() as show:
        for done_steps in range(3):
            show("[/red] [bold]", done_steps, 2)
    assert "[/red] [bold]" in capsys.readouterr().err


def test_control_characters_are_escaped(tmp_path: Path, capsys) -> None:
    assert printable(CONTROL) == r"a\x1b[31mb\u202ec\x9bd"
    assert printable("Büro 😀 👩\u200d💻\u00a0x\n") == "Büro 😀 👩\u200d💻\u00a0x\n"
    assert r"a\x1b[31mb\u202ec\x9bd: the file cannot be read" in fault("plan", "check", CONTROL)
    usage = run("plan", "show", "flat", "--view", CONTROL)
    assert usage.exit_code == 2
    assert "\x1b[31m" not in usage.output
    print_table(("name",), [(CONTROL,)])
    assert "\x1b[31m" not in capsys.readouterr().out
    target = tmp_path / f"{CONTROL}.toml"
    assert "expected one line of printable text" in fault("plan", "new", "-o", target)
    assert not target.exists()


@pytest.mark.parametrize("command", all_commands())
def test_help_in_ascii(command: str) -> None:
    result = CliRunner(charset="ascii").invoke(app, [*command.split(), "--help"])
    assert result.exit_code == 0
    assert result.exception is None


def rssnav(command: str, **options: object) -> subprocess.CompletedProcess[bytes]:
    """Run ``rssnav`` in a process of its own."""
    line = [sys.executable, "-m", "rssnav", *command.split()]
    return subprocess.run(line, check=False, timeout=300, stderr=subprocess.PIPE, **options)


def test_output_in_ascii(tmp_path: Path) -> None:
    path = room_file(tmp_path, edited('name = "room"', 'name = "Büro"'))
    environment = {**os.environ, "PYTHONIOENCODING": "ascii"}
    shown = rssnav(f"plan show {path}", env=environment, stdout=subprocess.PIPE)
    assert shown.returncode == 0
    assert rb"B\xfcro" in shown.stdout
    assert rb"24 m\xb2" in shown.stdout
    found = rssnav(f"plan check {path} --json", env=environment, stdout=subprocess.PIPE)
    assert json.loads(found.stdout)["title"] == "Büro"
    missing = rssnav("plan check ü", env=environment, stdout=subprocess.PIPE)
    assert missing.returncode == 1
    assert b"Traceback" not in missing.stderr


@pytest.mark.parametrize("command", ["plan list", "--help", "plan list --json"])
def test_closed_pipe_ends_quietly(command: str) -> None:
    reading, writing = os.pipe()
    os.close(reading)
    with os.fdopen(writing, "wb") as pipe:
        ended = rssnav(command, stdout=pipe)
    assert (ended.returncode, ended.stderr) == (1, b"")


PRINTING = {
    "few lines": "plan list",
    "many": "paths flat --to 10,1.5 --reflections 2 --diffractions 0 --top 1000 --json",
    "of a file": "plan new --force -o new.toml",
    "of checks": "plan check flat --json",
    "help": "plan --help",
}


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no device that is always full")
@pytest.mark.parametrize("unbuffered", ["", "1"])
@pytest.mark.parametrize("name", PRINTING)
def test_full_disk_under_the_output_is_a_message(name: str, unbuffered: str, tmp_path) -> None:
    environment = os.environ | {"PYTHONUNBUFFERED": unbuffered}
    with open("/dev/full", "wb") as full:
        ended = rssnav(PRINTING[name], stdout=full, cwd=tmp_path, env=environment)
    assert ended.returncode == 1
    lines = [line for line in ended.stderr.decode().splitlines() if "kernels" not in line]
    assert lines == ["rssnav: standard output: No space left on device"]


def test_comments_of_an_import_are_valid_toml(tmp_path: Path) -> None:
    source = tmp_path / f"{CONTROL}.dxf"
    done("plan", "export", room_file(tmp_path, ROOM), "-o", source)
    done("plan", "import", source, "-o", tmp_path / "again.toml", "--name", "room", "--height", 3)
    assert floorplans.load(tmp_path / "again.toml").name == "room"
