"""Errors as people meet them: one line on standard error and an exit code, no traceback."""

import sys

COULD_NOT = 1
INTERRUPTED = 130

NOTHING_HALF = "interrupted; files are written whole or not at all, so nothing is left half-done"


def is_anticipated(error: Exception) -> bool:
    """Tell whether the user, not the program, can mend an error."""
    from floorplans import PlanError
    from raytrace import MapFileError, SceneError
    from rssnav import ResultFileError, WorldError

    mendable = (PlanError, SceneError, MapFileError, WorldError, ResultFileError, OSError)
    return isinstance(error, mendable) and not isinstance(error, BrokenPipeError)


def complain(message: str) -> None:
    """Write a line to standard error, with the program's name before it."""
    print(f"rssnav: {message}", file=sys.stderr)


def describe(error: Exception) -> str:
    """Say what went wrong, on one line; for the system's errors: which file, and what of it."""
    if isinstance(error, OSError) and error.strerror:
        text = f"{error.filename}: {error.strerror}" if error.filename else error.strerror
    else:
        text = str(error)
    return " ".join(text.split())
