"""Errors as people meet them: one line on standard error and an exit code, no traceback."""

import sys
from typing import Any

import typer
from typer.core import TyperGroup

from floorplans import PlanError
from raytrace import MapFileError, SceneError
from rssnav import ResultFileError, WorldError

COULD_NOT = 1
INTERRUPTED = 130

ANTICIPATED = (PlanError, SceneError, MapFileError, WorldError, ResultFileError, OSError)
"""Errors that the user, not the program, can mend."""

NOTHING_HALF = "interrupted; files are written whole or not at all, so nothing is left half-done"


class Commands(TyperGroup):
    """A group of commands that end with 0 done, 1 could not be done, 2 wrong usage, 130 Ctrl-C."""

    def invoke(self, ctx: Any) -> Any:
        """Run the command; turn anticipated errors into a message and an exit code."""
        try:
            return super().invoke(ctx)
        except BrokenPipeError:
            raise
        except ANTICIPATED as error:
            complain(describe(error))
            raise typer.Exit(COULD_NOT) from error
        except KeyboardInterrupt as interrupt:
            complain(str(interrupt) or NOTHING_HALF)
            raise typer.Exit(INTERRUPTED) from interrupt


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
