"""``rssnav plan new``: write a starter plan."""

import re
from pathlib import Path
from typing import Annotated

import typer

import floorplans
from atomicfiles import atomic_write
from rssnav.cli.console import say
from rssnav.cli.options import check_suffix, examples

_SIZE = re.compile(r"\s*(\d+(?:\.\d+)?)\s*[xX×]\s*(\d+(?:\.\d+)?)\s*")


def add_to(parent: typer.Typer) -> None:
    """Add the command."""
    parent.command(epilog=examples("rssnav plan new --size 40x25 -o my.toml"))(new)


def new(
    output: Annotated[
        Path, typer.Option("-o", "--output", metavar="FILE", help="The .toml file to write.")
    ],
    size: Annotated[
        str, typer.Option(metavar="WxD", help="Extent along x and y in metres.")
    ] = "12x9",
    height: Annotated[
        float, typer.Option(metavar="M", min=2.5, max=50.0, help="From floor to ceiling in metres.")
    ] = 3.0,
    force: Annotated[bool, typer.Option("--force", help="Overwrite FILE if it exists.")] = False,
) -> None:
    """Write a starter plan of three rooms, with comments that explain every key."""
    from floorplans.starter import starter_plan

    check_suffix(output, (".toml",), "--output")
    match = _SIZE.fullmatch(size)
    if match is None:
        raise typer.BadParameter(
            f"{size!r} is not a size; give width x depth in metres, such as 40x25.",
            param_hint="--size",
        )
    try:
        text = starter_plan(output.stem, float(match[1]), float(match[2]), height)
    except ValueError as error:
        raise typer.BadParameter(f"{error}.", param_hint="--size, --height") from error
    floorplans.loads(text, origin=str(output))
    if output.exists() and not force:
        raise FileExistsError(17, "already exists; use --force to overwrite", str(output))
    with atomic_write(output) as beside:
        beside.write_text(text, encoding="utf-8", newline="\n")
    say(f"wrote {output}; view it with: rssnav plan show {output}")
