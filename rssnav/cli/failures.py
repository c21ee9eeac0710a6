"""Errors as people meet them: one line on standard error and an exit code, no traceback."""

import sys

from rssnav.messages import describe

COULD_NOT = 1
INTERRUPTED = 130

NOTHING_HALF = "interrupted; files are written whole or not at all, so nothing is left half-done"

REMEDIES = {
    "make_map": "`rssnav map PLAN -o {path}`",
    "replace_file": "--force",
    "unit": "--unit UNIT",
    "level": "--level LEVEL",
    "scale_m": "--scale M",
    "height_m": "--height M",
    "layers": "--layer NAME=KIND",
    "install_ifc": 'pip install "rssnav[ifc]"',
}
"""What a user of the command does, by the key `remedy` that the libraries give an error."""


def is_anticipated(error: Exception) -> bool:
    """Tell whether the user, not the program, can put an error right."""
    from floorplans import PlanError
    from raytrace import MapFileError, SceneError
    from rssnav import ResultFileError, WorldError

    anticipated = (PlanError, SceneError, MapFileError, WorldError, ResultFileError, OSError)
    return isinstance(error, anticipated) and not isinstance(error, BrokenPipeError)


def complain(message: str) -> None:
    """Write a line to standard error, with the program's name before it."""
    print(f"rssnav: {message}", file=sys.stderr)


def with_remedy(error: Exception) -> str:
    """Say what went wrong, and which command or option helps, on one line."""
    text, remedy = describe(error), getattr(error, "remedy", None)
    if remedy is None:
        return text
    return f"{text}; use {REMEDIES[remedy].format(path=getattr(error, 'path', None) or 'FILE')}"
