"""Errors for users: one line on standard error and an exit code, no traceback."""

import sys
import warnings
from collections.abc import Collection, Generator
from contextlib import contextmanager
from typing import Any

from rssnav.messages import describe, printable

EXIT_FAILURE = 1
INTERRUPTED = 130

REMEDIES = {
    "make_map": "`rssnav map PLAN -o {path}`",
    "replace_file": "--force",
    "unit": "--unit UNIT",
    "level": "--level LEVEL",
    "scale_m": "--scale M",
    "height_m": "--height M",
    "layers": "--layer NAME=KIND",
    "close_gaps_m": "--close-gaps M",
    "install_ifc": 'pip install "rssnav[ifc]"',
}
"""What a user of the command does, by the key `remedy` that the libraries give an error."""

LESS_MEMORY = ("--reflections", "--transmissions", "--cell-size", "--threads", "--max-memory")
"""Options for the remedy "less_memory", of which a command has some."""


def is_anticipated(error: Exception) -> bool:
    """Return whether the user can correct an error, so that it needs no traceback."""
    from floorplans import PlanError
    from raytrace import AntennaError, MapFileError, MemoryLimitError, SceneError
    from rssnav import ResultFileError, WorldError
    from rssnav.benchmark.errors import BenchmarkError
    from rssnav.datasets.errors import DatasetError
    from rssnav.measurements.survey import SurveyError

    unusable = (PlanError, SceneError, AntennaError, MapFileError, WorldError, ResultFileError)
    anticipated = (*unusable, BenchmarkError, SurveyError, DatasetError, MemoryLimitError, OSError)
    return isinstance(error, anticipated) and not isinstance(error, BrokenPipeError)


def print_error(message: str) -> None:
    """Write a line to standard error, prefixed with the program's name."""
    print(f"rssnav: {printable(message)}", file=sys.stderr)


@contextmanager
def warnings_as_lines() -> Generator[None]:
    """Write warnings like errors, without the place in the code that they come from."""
    with warnings.catch_warnings():
        warnings.showwarning = _show_as_line
        yield


def _show_as_line(message: Warning | str, *_: Any) -> None:
    print_error(f"warning: {message}")


def with_remedy(error: Exception, options: Collection[str] = ()) -> str:
    """Return an error's message on one line, with the command or option that helps.

    `options` are those of the command that has failed.
    """
    text, remedy = describe(error), getattr(error, "remedy", None)
    if remedy is None:
        return text
    if remedy == "less_memory":
        words = " or ".join(option for option in LESS_MEMORY if option in options)
    else:
        words = REMEDIES[remedy].format(path=getattr(error, "path", None) or "FILE")
    return f"{text}; use {words}" if words else text
