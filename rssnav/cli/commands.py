"""The table of commands; a command's module is imported when the command is called.

The list of commands and shell completion need no other library, so they are fast.
"""

from collections.abc import Callable, Generator
from contextlib import contextmanager
from importlib import import_module
from typing import Any, NamedTuple

import typer
from typer.core import TyperGroup
from typer.main import get_group

from rssnav.cli.boundaries import check_before_work
from rssnav.cli.failures import (
    EXIT_FAILURE,
    INTERRUPTED,
    is_anticipated,
    print_error,
    warnings_as_lines,
    with_remedy,
)
from rssnav.cli.streams import tolerant_streams
from rssnav.interrupts import INTERRUPTED_TEXT, INTERRUPTS
from rssnav.messages import printable


class Entry(NamedTuple):
    """A command in the list of commands.

    Attributes
    ----------
    modules
        Modules below `rssnav.cli` whose ``add_to`` adds it to a `typer.Typer`.
    summary
        The first sentence of its help.
    """

    modules: tuple[str, ...]
    summary: str


COMMANDS = {
    "plan": Entry(("plan",), "Show, check, import and export floor plans."),
    "map": Entry(
        ("radio_maps",),
        "Compute the radio map of a plan: RSS in every cell, from all paths up to a given order.",
    ),
    "maps": Entry(
        ("radio_maps",),
        "Compute and draw the radio maps of the paper's two scenarios.",
    ),
    "paths": Entry(
        ("paths",),
        "Trace all paths from a transmitter to a receiver and print the strongest.",
    ),
    "validate": Entry(
        ("validate",),
        "Compare traced RSS and empirical models with measured RSS, on held-out readings.",
    ),
    "calibrate": Entry(
        ("calibrate",),
        "Fit a plan's material properties to measured RSS, and report the held-out error.",
    ),
    "example": Entry(
        ("example",),
        "Write an example data set: a flat's plan, a survey of measured RSS, and a licence.",
    ),
    "train": Entry(
        ("train",),
        "Train an agent to fly from a plan's start to its source, in independent realisations.",
    ),
    "fly": Entry(
        ("fly",),
        "Animate a trained UAV's flight: its path over the map, and its RSS readings.",
    ),
    "dataset": Entry(
        ("dataset",),
        "Make, check and export data sets of radio maps.",
    ),
    "explore": Entry(
        ("explore",),
        "Open the explorer in the browser: move the source, see its map, train a UAV.",
    ),
    "experiments": Entry(
        ("experiments",),
        "Reproduce the paper, or run a further study: maps, training, figures, tables, report.",
    ),
    "report": Entry(
        ("experiments",),
        "Regenerate figures, tables and report from the maps and training of an earlier run.",
    ),
    "benchmark": Entry(
        ("benchmark",),
        "Fly policies in buildings that they have not seen, and score them.",
    ),
    "doctor": Entry(
        ("doctor",),
        "Print versions, threads and the state of the compiled kernels, and run a self-test.",
    ),
}


def list_in(app: typer.Typer) -> None:
    """Add every command to an application, by name and summary only."""
    for name, entry in COMMANDS.items():
        app.command(name, help=entry.summary)(_unloaded)


def _unloaded() -> None:
    """Placeholder of a command until `Commands` loads it."""


def _tidy_help(command: Any) -> None:
    """Make each paragraph of a docstring one line, and hide types that say nothing."""
    command.get_params = _without_types(command.get_params)
    paragraphs = (command.help or "").split("\n\n")
    command.help = "\n\n".join(" ".join(paragraph.split()) for paragraph in paragraphs)
    for part in getattr(command, "commands", {}).values():
        _tidy_help(part)


def _without_types(get_params: Callable[[Any], list[Any]]) -> Callable[[Any], list[Any]]:
    """Show no type of a flag ("<bool>") or beside a name of an argument that tells it."""

    def plain(context: Any) -> list[Any]:
        parameters = get_params(context)
        for parameter in parameters:
            named = parameter.param_type_name == "argument" and parameter.metavar
            if named or getattr(parameter, "is_flag", False):
                parameter.display_type_rich = _nothing
        return parameters

    return plain


def _nothing(**_context: Any) -> str:
    return ""


@contextmanager
def _printable_usage() -> Generator[None]:
    """Escape control characters in messages on wrong usage."""
    try:
        yield
    except Exception as error:
        if isinstance(message := getattr(error, "message", None), str):
            error.__dict__["message"] = printable(message)
        raise


class Commands(TyperGroup):
    """A group of commands, loaded when called; exits with 0, 1, 2, or 130 after Ctrl-C."""

    def load(self, name: str) -> None:
        """Replace a command's placeholder by the command."""
        part = typer.Typer()
        for module in COMMANDS[name].modules:
            import_module(f"rssnav.cli.{module}").add_to(part)
        self.commands[name] = get_group(part).commands[name]
        _tidy_help(self.commands[name])
        check_before_work(self.commands[name])

    def get_params(self, ctx: Any) -> list[Any]:
        """Options of the group itself."""
        return _without_types(super().get_params)(ctx)

    def main(self, *args: Any, **kwargs: Any) -> Any:
        """Run a command line, on terminals of any encoding and into pipes that close early."""
        with tolerant_streams(), warnings_as_lines():
            return super().main(*args, **kwargs)

    def make_context(self, *args: Any, **kwargs: Any) -> Any:
        """Read the options before a command's name."""
        with _printable_usage():
            return super().make_context(*args, **kwargs)

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """Load the command that is called."""
        if args and args[0] in COMMANDS:
            self.load(args[0])
        return super().resolve_command(ctx, args)

    def _options_of(self, ctx: Any) -> set[str]:
        """Names of the options of the command that was called."""
        command = self.get_command(ctx, ctx.invoked_subcommand or "")
        return {name for option in getattr(command, "params", ()) for name in option.opts}

    def invoke(self, ctx: Any) -> Any:
        """Run the command; turn anticipated errors into a message and an exit code."""
        try:
            with _printable_usage():
                return super().invoke(ctx)
        except KeyboardInterrupt as interrupt:
            INTERRUPTS.reported()
            print_error(str(interrupt) or INTERRUPTED_TEXT)
            raise typer.Exit(INTERRUPTED) from interrupt
        except Exception as error:
            if not is_anticipated(error):
                raise
            print_error(with_remedy(error, self._options_of(ctx)))
            raise typer.Exit(EXIT_FAILURE) from error
