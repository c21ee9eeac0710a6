"""Absurd values of any option of any command are wrong usage, before any work.

The cases are made from the commands themselves, so a new option is covered as it is.
"""

from __future__ import annotations

import inspect
import re
from pathlib import Path
from typing import Any, get_args, get_type_hints

import pytest
from cli_plans import all_commands, room_file, run

from rssnav.cli.boundaries import INPUTS, OUTPUT_FILES, OUTPUT_FOLDERS

GIVEN = {
    "plan": "room.toml",
    "map_file": "room.h5",
    "trainings": "result.h5",
    "file": "room.dxf",
    "to": "1,1,1",
    "output": "out",
    "survey": "survey.csv",
    "kind": "flat",
    "spec": "spec.toml",
    "dataset": "dataset",
    "layout": "parquet",
}
SUFFIX = {
    "map": ".h5", "train": ".h5", "fly": ".gif", "plan new": ".toml", "plan generate": ".toml",
    "plan import": ".toml",
    "plan check": ".toml", "plan export": ".glb", "plan show": ".png", "validate": ".html",
    "calibrate": ".toml", "dataset show": ".png",
}  # fmt: skip
NUMBERS = ("nan", "inf", "-inf", "1e308", "-1e308", "1e999", "9" * 30, "9" * 5000, "x", "")
NO_TEXT = ("", "  ")
COMMANDS = all_commands()
OPTIONS = [
    (words, parameter.name)
    for words, command in COMMANDS.items()
    for parameter in command.params
    if parameter.name != "help" and not getattr(parameter, "is_flag", False)
]


def declared(words: str, name: str) -> tuple[set[Any], Any]:
    """Types of a parameter, and what its command declares of it."""
    function = inspect.unwrap(COMMANDS[words].callback)
    kind, info = get_args(get_type_hints(function, include_extras=True)[name])[:2]
    return {kind, *get_args(kind)}, info


def usage_of(words: str, name: str, value: str) -> str:
    """Call a command with a value of a parameter; it must be wrong usage, without any output."""
    options, arguments = [], []
    for parameter in COMMANDS[words].params:
        given = value if parameter.name == name else GIVEN.get(parameter.name)
        if given is None or not (parameter.required or parameter.name == name):
            continue
        if parameter.param_type_name == "argument":
            arguments.append(given)
        else:
            options.append(f"{max(parameter.opts, key=len)}={given}")
    result = run(*words.split(), *options, "--", *arguments)
    assert result.exit_code == 2, (words, name, value[:40], result.output)
    assert "Traceback" not in result.output
    return said(result.output)


def said(output: str) -> str:
    """Return a message without its frame."""
    return " ".join(output.replace("│", " ").replace("|", " ").split())


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    """Work in a folder with a plan."""
    monkeypatch.chdir(tmp_path)
    room_file(tmp_path)
    return tmp_path


@pytest.mark.parametrize(("words", "name"), OPTIONS)
def test_absurd_values(words: str, name: str, folder: Path) -> None:
    kinds, info = declared(words, name)
    if kinds & {int, float}:
        assert info.min is not None, "give the option a least value"
        checked = info.max is not None or info.callback is not None
        assert checked, "give the option a largest value"
        for value in NUMBERS:
            usage_of(words, name, value)
    else:
        for value in NO_TEXT:
            usage_of(words, name, value)
    assert sorted(path.name for path in folder.iterdir()) == ["room.toml"]


OUTPUTS = [(w, n) for w, n in OPTIONS if n in (*OUTPUT_FILES, *OUTPUT_FOLDERS)]


@pytest.mark.parametrize(("words", "name"), OUTPUTS)
def test_outputs_that_cannot_be_written(words: str, name: str, folder: Path) -> None:
    suffix = ".png" if name == "picture" else SUFFIX.get(words, "")
    (folder / f"folder{suffix}").mkdir()
    (folder / "file").touch()
    if name in OUTPUT_FILES:
        assert "is a folder" in usage_of(words, name, f"folder{suffix}")
    assert "is not a folder" in usage_of(words, name, f"file/below/out{suffix}")
    assert (folder / "file").read_bytes() == b""


@pytest.mark.parametrize(
    "words",
    [
        w
        for w, n in OUTPUTS
        if n == "output" and w not in ("plan new", "plan generate", "plan check")
    ],
)
def test_an_output_is_not_an_input(words: str, folder: Path) -> None:
    name = next(p.name for p in COMMANDS[words].params if p.name in INPUTS)
    same = folder / f"same{SUFFIX[words]}"
    same.write_text("kept", encoding="utf-8")
    options = [f"--output={same}", *(["--map=room.h5"] if words in ("fly", "train") else [])]
    arguments = [str(same) if p.name == name else GIVEN[p.name]
                 for p in COMMANDS[words].params if p.param_type_name == "argument"]  # fmt: skip
    result = run(*words.split(), *options, *arguments)
    assert result.exit_code == 2, result.output
    assert "is read or written as well" in said(result.output)
    assert same.read_text(encoding="utf-8") == "kept"


def test_a_bound_of_the_files_alone_is_checked_and_not_in_the_help() -> None:
    for words, option in (
        ("train", "--seed"),
        ("dataset baselines", "--seed"),
        ("map", "--max-paths"),
    ):
        assert re.search(r"\d{16}", said(run(*words.split(), "--help").output)) is None
        result = run(*words.split(), "room.toml", option, str(2**63))
        assert result.exit_code == 2
        assert f"{2**63} is more than" in said(result.output)


def test_every_parameter_that_is_a_path_is_known() -> None:
    known = {*INPUTS, *OUTPUT_FILES, *OUTPUT_FOLDERS}
    paths = {name for words, name in OPTIONS if Path in declared(words, name)[0]}
    assert paths <= known
