"""Errors as people meet them: one line on standard error and an exit code, no traceback."""

import sys

from rssnav.messages import describe

COULD_NOT = 1
INTERRUPTED = 130

NOTHING_HALF = "interrupted; files are written whole or not at all, so nothing is left half-done"

HINTS = {
    "missing-map": "`rssnav map PLAN -o {path}` makes one",
    "damaged-map": "`rssnav map PLAN -o {path}` does",
    "other-plan": "`rssnav map PLAN -o {path}` makes the map of PLAN",
    "occupied": "on the command line, --force does",
}
"""What the command adds to an error, by the attribute `kind` that the libraries give it."""


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


def with_hint(error: Exception) -> str:
    """Say what went wrong, and which command or option puts it right, on one line."""
    hint = HINTS.get(getattr(error, "kind", ""))
    text = describe(error)
    if hint is None:
        return text
    return f"{text}; {hint.format(path=getattr(error, 'path', None) or 'FILE')}"
