"""Command lines with absurd options and arguments, run in this process.

Work that options rightly ask for is interrupted after a moment, as by Ctrl-C.
"""

from __future__ import annotations

import os
import shutil
import signal
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path
from typing import Any

from cli_plans import all_commands
from hypothesis import strategies as st
from typer.testing import CliRunner

from fuzz import samples
from rssnav.cli import app

RIGHT_CODES = (0, 1, 2, 130)
INTERRUPT_AFTER_S, INTERRUPT_AGAIN_S = 0.5, 2.0

ABSURD = (
    "", " ", "-1", "0", "1", "2", "-0.0", "1e-9", "1e308", "-1e308", "1e999", "nan", "inf", "-inf",
    "9" * 30,
    "9" * 5000, "1,2", "1,2,3", "nan,nan", "inf,1,1", "1e308,1e308", "1,2,3,4", ",", "12x9", "0x0",
    "infxinf",
    "1e9x1e9", "--", "-", "*", "[/]", "[bold]", "$", "é", "\x00", "\x1b[31m", "a\nb", "..", ".",
    "/", "/dev/null",
    "/dev/full", "/proc/self/mem", "nowhere/out.h5", "room.toml", "room.h5", "result.h5", "folder",
    "out.h5",
    "out.toml", "out.png", "out.svg", "out.gif", "out.html", "out.glb", "out.xml", "out.geojson",
    "out.dxf",
    "out.yaml", "out.txt", "x" * 300, "P.2040-4", "P.2040-0", "location", "paper",
    "WALL=wall:gold", "=", "*=wall",
    "glass", "mm", "flat", "scenario1", "18446744073709551616", "localhost:99999",
)  # fmt: skip

PLAN, MAP = "room.toml", "room.h5"
QUICK = {"--reflections": "0", "--diffractions": "0"}
RIGHT: dict[str, dict[str, str]] = {
    "map": {"plan": PLAN, "--output": "out.h5", **QUICK},
    "maps": {"--out": "out"},
    "paths": {"plan": PLAN, "--to": "2,2,1.5", **QUICK},
    "validate": {"plan": PLAN, "survey": "survey.csv", "--transmitters": "transmitters.csv"},
    "calibrate": {
        "plan": PLAN,
        "survey": "survey.csv",
        "--transmitters": "transmitters.csv",
        "--output": "out.toml",
    },
    "example": {},
    "train": {"plan": PLAN, "--map": MAP, "--runs": "1", "--episodes": "2", "--agent": "location"},
    "fly": {"plan": PLAN, "trainings": "result.h5", "--map": MAP, "--output": "out.gif"},
    "explore": {"plan": PLAN, "--port": "0"},
    "experiments": {"--out": "out", "--runs": "1"},
    "report": {"--out": "folder"},
    "plan new": {"--output": "out.toml"},
    "plan generate": {"kind": "flat", "--output": "out.toml"},
    "plan import": {"file": "room.geojson", "--output": "out.toml"},
    "plan check": {"plan": PLAN},
    "plan export": {"plan": PLAN, "--output": "out.geojson"},
    "plan show": {"plan": PLAN},
    "plan list": {},
    "doctor": {},
}
"""Arguments and options that each command is given before some are replaced."""


@cache
def _parameters() -> dict[str, tuple[tuple[str, bool], ...]]:
    """Name and kind of all parameters of a command: whether a value follows."""
    return {
        words: tuple(
            (parameter.opts[-1] if parameter.opts[-1].startswith("--") else parameter.name,
             not getattr(parameter, "is_flag", False))
            for parameter in command.params
            if parameter.name not in ("help", "install_completion", "show_completion")
        )
        for words, command in all_commands().items()
    }  # fmt: skip


@st.composite
def _lines(draw: st.DrawFn) -> bytes:
    words = draw(st.sampled_from(sorted(_parameters())))
    values: dict[str, str | None] = dict(RIGHT.get(words, {}))
    for _ in range(draw(st.integers(1, 3)) if _parameters()[words] else 0):
        name, takes_value = draw(st.sampled_from(_parameters()[words]))
        values[name] = draw(st.sampled_from(ABSURD)) if takes_value else None
    given = [f"{name}={value}" for name, value in values.items() if value is not None]
    flags = [name for name, value in values.items() if value is None]
    return "\n".join([words, *(_escaped(line) for line in (*given, *flags))]).encode()


def cases() -> st.SearchStrategy[bytes]:
    """Draw command lines with up to three absurd values."""
    return _lines()


def _escaped(text: str) -> str:
    return text.encode("unicode_escape").decode()


def run(path: Path) -> None:
    """Run the command that a file describes; only its own messages and exit codes are right."""
    words, *lines = path.read_text().splitlines()
    arguments = words.split()
    for line in lines:
        text = line.encode().decode("unicode_escape")
        is_option = text.startswith("--")
        arguments.append(text if is_option else text.partition("=")[2])
    with _own_folder(path.parent), _interrupted():
        _check(CliRunner().invoke(app, arguments))


def _check(result: Any) -> None:
    error = result.exception
    if error is not None and not isinstance(error, SystemExit):
        raise error.with_traceback(error.__traceback__)
    assert result.exit_code in RIGHT_CODES, f"exit code {result.exit_code}"
    assert "Traceback" not in _own(result.output), result.output
    if result.exit_code == 1:
        lines = result.stderr.splitlines()
        assert lines or result.stdout, "no message"
        assert any(line.startswith("rssnav: ") for line in lines) or result.stdout, lines[-1]


def _own(output: str) -> str:
    """Output without what an interrupt leaves in hypothesis, which watches the collector."""
    head, ignored, rest = output.partition("Exception ignored in: <function gc_cumulative_time")
    return head + rest.partition("KeyboardInterrupt")[2] if ignored else output


@contextmanager
def _own_folder(folder: Path) -> Iterator[None]:
    """Work in a folder with right files of every kind."""
    work = folder / "work"
    shutil.rmtree(work, ignore_errors=True)
    work.mkdir()
    (work / "folder").mkdir()
    for name, content in _files().items():
        (work / name).write_bytes(content)
    back = os.getcwd()
    os.chdir(work)
    try:
        yield
    finally:
        os.chdir(back)
        shutil.rmtree(work, ignore_errors=True)


@cache
def _files() -> dict[str, bytes]:
    from fuzz.text_formats import json_text

    return {
        PLAN: samples.plan_text().encode(),
        MAP: samples.map_file(),
        "result.h5": samples.result_file("rss"),
        "room.geojson": json_text(samples.geojson()),
        "survey.csv": samples.survey_text().encode(),
        "transmitters.csv": samples.transmitters_text().encode(),
    }


@contextmanager
def _interrupted() -> Iterator[None]:
    """Send SIGINT to this process after a moment, and again: libraries drop some interrupts.

    The explorer's server handles SIGINT in its own way if it is interrupted while it starts.
    """
    signal.signal(signal.SIGINT, signal.default_int_handler)
    signal.signal(signal.SIGALRM, lambda *_: signal.raise_signal(signal.SIGINT))
    signal.setitimer(signal.ITIMER_REAL, INTERRUPT_AFTER_S, INTERRUPT_AGAIN_S)
    try:
        with suppress(KeyboardInterrupt):
            yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
