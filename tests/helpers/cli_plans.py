"""A room of 6 m x 4 m as text, and ways to run the command line on it."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import typer
from typer.testing import CliRunner, Result

from rssnav.cli import app
from rssnav.cli.commands import COMMANDS, Commands

ROOM = """
name = "room"
format = 1
height_m = 3
floor_material = "concrete"
ceiling_material = "ceiling_board"
source = [1.2, 1.1, 1.5]
start = [5.5, 3.5]
outline = [[0, 0], [6, 0], [6, 4], [0, 4], [0, 0]]

[[walls]]
points = [[0, 0], [6, 0], [6, 4], [0, 4], [0, 0]]
material = "concrete"
thickness_m = 0.2

[[walls]]
points = [[3, 0], [3, 4]]
material = "plasterboard"
thickness_m = 0.1
openings = [{ kind = "door", offset_m = 1, width_m = 1, head_m = 2.4 }]
"""

QUICK = ("--preset", "paper", "--reflections", "1", "--diffractions", "0")
"""Few enough paths for a test; cells behind the partition have none."""

ESCAPE = re.compile(r"\x1b\[")


def edited(old: str, new: str) -> str:
    """Return ROOM with its one occurrence of `old` replaced."""
    assert ROOM.count(old) == 1, f"{old!r} is not once in ROOM"
    return ROOM.replace(old, new)


def run(*arguments: object) -> Result:
    """Run ``rssnav`` in this process."""
    return CliRunner().invoke(app, [str(argument) for argument in arguments])


def whole_group() -> Commands:
    """Return the group of all commands, each of them loaded."""
    group = typer.main.get_command(app)
    assert isinstance(group, Commands)
    for name in COMMANDS:
        group.load(name)
    return group


def all_commands() -> dict[str, Any]:
    """Return every command by the words that call it."""

    def below(group: Any, words: tuple[str, ...]) -> dict[str, Any]:
        found: dict[str, Any] = {}
        for name, command in group.commands.items():
            if hasattr(command, "commands"):
                found |= below(command, (*words, name))
            else:
                found[" ".join((*words, name))] = command
        return found

    return below(whole_group(), ())


def done(*arguments: object) -> str:
    """Run ``rssnav``, which must succeed; return its standard output."""
    result = run(*arguments)
    assert result.exit_code == 0, result.output
    return result.stdout


def fault(*arguments: object) -> str:
    """Run ``rssnav``, which must fail with one line on standard error; return the line."""
    result = run(*arguments)
    assert result.exit_code == 1, result.output
    assert "Traceback" not in result.output
    *notes, line = result.stderr.splitlines()
    assert line.startswith("rssnav: ")
    assert not [note for note in notes if note.startswith("rssnav: ")]
    assert result.stdout == ""
    return line


def room_file(folder: Path, text: str = ROOM) -> Path:
    """Write a plan beside the test's other files."""
    path = folder / "room.toml"
    path.write_text(text, encoding="utf-8")
    return path
