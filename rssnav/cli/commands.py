"""The table of commands; a command's module is imported when the command is called.

So the list of commands and the shell's completion wait for no library.
"""

from importlib import import_module
from typing import Any, NamedTuple

import typer
from typer.core import TyperGroup
from typer.main import get_group

from rssnav.cli.failures import (
    COULD_NOT,
    INTERRUPTED,
    NOTHING_HALF,
    complain,
    is_anticipated,
    with_hint,
)


class Entry(NamedTuple):
    """A command in the list of commands.

    Attributes
    ----------
    modules
        Those below `rssnav.cli` whose ``add_to`` adds it to a `typer.Typer`.
    summary
        The first sentence of its help.
    """

    modules: tuple[str, ...]
    summary: str


COMMANDS = {
    "plan": Entry(("plan",), "Look at floor plans, check them, export them."),
    "map": Entry(
        ("radio_maps",),
        "Trace the radio map of a plan: RSS in every cell, from every path of bounded order.",
    ),
    "maps": Entry(
        ("radio_maps",),
        "Make the radio maps of the paper's two scenarios, with a picture each.",
    ),
    "paths": Entry(
        ("paths",),
        "Trace every path from a plan's source to a receiver and print the strongest.",
    ),
    "train": Entry(
        ("train",),
        "Train an agent to fly from a plan's start to its source, many times over.",
    ),
    "fly": Entry(
        ("fly",),
        "Show how a trained UAV flies: its way over the map, and the RSS it reads, step by step.",
    ),
    "explore": Entry(
        ("explore",),
        "Open the explorer in the browser: drag the source, see its map, train a UAV.",
    ),
    "experiments": Entry(
        ("experiments",),
        "Run the whole paper, or a study beyond it: maps, trainings, figures, tables, a report.",
    ),
    "report": Entry(
        ("experiments",),
        "Make figures, tables and report again from the maps and trainings of an earlier run.",
    ),
    "doctor": Entry(
        ("doctor",),
        "Print versions, threads and the state of the compiled kernels, and test the program.",
    ),
}


def list_in(app: typer.Typer) -> None:
    """Put every command into an application, by name and summary only."""
    for name, entry in COMMANDS.items():
        app.command(name, help=entry.summary)(_unloaded)


def _unloaded() -> None:
    """Stand for a command until `Commands` puts the real one in its place."""


class Commands(TyperGroup):
    """A group of commands that end with 0 done, 1 could not be done, 2 wrong usage, 130 Ctrl-C."""

    def load(self, name: str) -> None:
        """Put a real command into its place."""
        part = typer.Typer()
        for module in COMMANDS[name].modules:
            import_module(f"rssnav.cli.{module}").add_to(part)
        self.commands[name] = get_group(part).commands[name]

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """Find the command that is called, and load it."""
        if args and args[0] in COMMANDS:
            self.load(args[0])
        return super().resolve_command(ctx, args)

    def invoke(self, ctx: Any) -> Any:
        """Run the command; turn anticipated errors into a message and an exit code."""
        try:
            return super().invoke(ctx)
        except KeyboardInterrupt as interrupt:
            complain(str(interrupt) or NOTHING_HALF)
            raise typer.Exit(INTERRUPTED) from interrupt
        except Exception as error:
            if not is_anticipated(error):
                raise
            complain(with_hint(error))
            raise typer.Exit(COULD_NOT) from error
