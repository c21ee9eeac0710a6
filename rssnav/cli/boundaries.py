"""Checks of the values of all options and arguments, before a command does any work.

Ranges of numbers stand with the options. What holds for every command is here: no number is NaN, no
value is empty, and what is written is a file or folder that can be written and is not read as well.
"""

import math
import os
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import typer

OUTPUT_FILES = ("output", "picture", "report", "save_layers")
OUTPUT_FOLDERS = ("out",)
INPUTS = (
    "plan", "map_file", "trainings", "file", "layers", "survey", "transmitters", "antenna",
    "receive_antenna", "spec", "dataset",
)  # fmt: skip
"""Names of the parameters that are files and folders."""


def check_before_work(command: Any) -> None:
    """Make a command, or all below a group, check the values it is given when it is called."""
    for below in getattr(command, "commands", {}).values():
        check_before_work(below)
    if not hasattr(command, "commands"):
        command.parse_args = _without_empty(command.parse_args)
        command.invoke = _checked(command.invoke)


def _without_empty(parse: Callable[[Any, list[str]], Any]) -> Callable[[Any, list[str]], Any]:
    """Reject empty values as they are given: a path would make the current folder of them."""

    def check_and_parse(context: Any, words: list[str]) -> Any:
        for word in words:
            name, _, value = word.rpartition("=") if word.startswith("--") else ("", "", word)
            if not value.strip():
                raise typer.BadParameter("it is empty.", param_hint=name or "a value")
        return parse(context, words)

    return check_and_parse


def _checked(invoke: Callable[[Any], Any]) -> Callable[[Any], Any]:
    def check_and_invoke(context: Any) -> Any:
        for parameter in context.command.params:
            for value in _values(context, parameter.name):
                if (problem := _problem(parameter.name, value)) is not None:
                    raise typer.BadParameter(problem, param_hint=_hint(parameter))
        _check_overwriting(context)
        return invoke(context)

    return check_and_invoke


def _hint(parameter: Any) -> str:
    """Name of a parameter in messages: its longest option, or the metavariable of an argument."""
    name = max(parameter.opts, key=len)
    return name if name.startswith("-") else parameter.metavar or name.upper()


def _values(context: Any, name: str) -> list[Any]:
    """Values of a parameter that were given or are its defaults."""
    value = context.params.get(name)
    values = value if isinstance(value, list | tuple) else [value]
    return [value for value in values if value is not None]


def _problem(name: str, value: Any) -> str | None:
    """What is wrong with a value; None if nothing is."""
    if isinstance(value, float) and math.isnan(value):
        return "it is not a number (NaN)."
    if not isinstance(value, str | os.PathLike):
        return None
    text = os.fspath(value)
    if "\0" in text:
        return f"{text!r} holds a NUL character."
    if name in OUTPUT_FILES:
        return _file_problem(Path(text))
    return _folder_problem(Path(text)) if name in OUTPUT_FOLDERS else None


def _file_problem(path: Path) -> str | None:
    if os.path.isdir(path):
        return f"{path} is a folder; name a file in it."
    if os.path.exists(path) and not os.path.isfile(path):
        return f"{path} is not a regular file; name another one."
    return _folder_problem(Path(os.path.realpath(path)).parent)


def _folder_problem(path: Path) -> str | None:
    """What is wrong with a folder to write into; missing ones will be made."""
    folder = next(p for p in (path, *path.absolute().parents) if os.path.exists(p))
    if not os.path.isdir(folder):
        return f"{folder} is not a folder; give another place."
    if not os.access(folder, os.W_OK | os.X_OK):
        return f"the folder {folder} cannot be written; give another place."
    return None


def _check_overwriting(context: Any) -> None:
    """Reject an output that is also read, or written twice."""
    if context.command.name == "check":  # a repair replaces the plan, and keeps the old one
        return
    read = list(_existing(context, INPUTS))
    for parameter in context.command.params:
        if parameter.name not in OUTPUT_FILES:
            continue
        for value in _values(context, parameter.name):
            path = os.path.realpath(value)
            if path in read:
                raise typer.BadParameter(
                    f"{value} is read or written as well; name another file.",
                    param_hint=_hint(parameter),
                )
            read.append(path)


def _existing(context: Any, names: tuple[str, ...]) -> Iterator[str]:
    for name in names:
        for value in _values(context, name):
            if os.path.exists(value):
                yield os.path.realpath(value)
