"""``rssnav example``: a measured flat to try the commands on surveys with."""

from importlib.resources import files
from pathlib import Path
from typing import Annotated

import typer

from atomicfiles import atomic_write_all
from rssnav.cli.console import say
from rssnav.cli.options import Force, examples

FOLDER = Path("measured-flat")


def add_to(parent: typer.Typer) -> None:
    """Add the command ``example``."""
    parent.command("example", epilog=examples("rssnav example", "rssnav example --out flat"))(
        write_example
    )


def write_example(
    out: Annotated[Path, typer.Option(metavar="FOLDER", help="Output folder.")] = FOLDER,
    force: Force = False,
) -> None:
    """Write an example data set: a flat's plan, a survey of measured RSS, and a licence."""
    source = files("rssnav.measurements") / "measured_flat"
    contents = {out / file.name: file.read_bytes() for file in source.iterdir()}
    for path in contents:
        if path.exists() and not force:
            raise FileExistsError(17, "already exists; use --force to overwrite", str(path))
    atomic_write_all(contents)
    for path in sorted(contents):
        say(f"wrote {path}")
