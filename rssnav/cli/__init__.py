"""The command line ``rssnav``.

Each command has a module, listed in `rssnav.cli.commands`. Results go to standard output, progress
and notes to standard error; exit codes are 0 success, 1 failure, 2 wrong usage, 130 interrupted by
Ctrl-C, 143 by SIGTERM.
"""

from importlib.metadata import version
from typing import Annotated

import typer

from rssnav.cli.commands import Commands, list_in
from rssnav.cli.options import examples

app = typer.Typer(
    cls=Commands,
    rich_markup_mode="rich",
    no_args_is_help=True,
    pretty_exceptions_show_locals=False,
    context_settings={"help_option_names": ["-h", "--help"]},
    epilog=examples(
        "rssnav plan show scenario1",
        "rssnav map scenario1 -o s1.h5 --picture s1.png",
        "rssnav train scenario1 --map s1.h5 --runs 10",
        "rssnav experiments --quick",
    ),
)
list_in(app)


def _print_version(wanted: bool) -> None:
    if wanted:
        print(f"rssnav {version('rssnav')}")
        raise typer.Exit


@app.callback()
def main(
    _version: Annotated[
        bool,
        typer.Option(
            "--version", callback=_print_version, is_eager=True, help="Print the version."
        ),
    ] = False,
) -> None:
    """Complete indoor radio maps by ray tracing, and UAVs that learn to navigate by them."""
