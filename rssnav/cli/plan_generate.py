"""``rssnav plan generate``: write a building that a seed determines."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

import floorplans
from atomicfiles import atomic_write
from floorplans.generators import LARGEST_M2, LEAST_M2, SHAPES, Kind, Shape
from rssnav.cli.console import say
from rssnav.cli.options import Seed, check_suffix, examples


def add_to(parent: typer.Typer) -> None:
    """Add the command."""
    parent.command(
        "generate",
        epilog=examples(
            "rssnav plan generate office --seed 7 -o office.toml",
            "rssnav plan generate hotel --area 1200 --transmitters 6 -o hotel.toml",
        ),
    )(generate_plan)


def generate_plan(
    kind: Annotated[
        Kind, typer.Argument(metavar="KIND", help="flat, office, hotel, school, hall.")
    ],
    output: Annotated[
        Path, typer.Option("-o", "--output", metavar="FILE", help="The .toml file to write.")
    ],
    seed: Seed = 0,
    area: Annotated[
        float | None,
        typer.Option(
            metavar="M2",
            min=LEAST_M2,
            max=LARGEST_M2,
            help="Approximate floor area in square metres.",
            show_default="drawn from what is usual for the kind",
        ),
    ] = None,
    shape: Annotated[
        Shape, typer.Option(metavar="SHAPE", help="rectangle, or L for a building with a wing.")
    ] = SHAPES[0],
    access_points: Annotated[
        int,
        typer.Option(
            "--transmitters",
            metavar="N",
            min=0,
            max=100,
            help="Access points under the ceiling.",
        ),
    ] = 3,
    furniture: Annotated[
        bool, typer.Option("--furniture/--no-furniture", help="Cabinets, shelves and racks.")
    ] = True,
    connecting_doors: Annotated[
        float,
        typer.Option(
            metavar="CHANCE",
            min=0.0,
            max=1.0,
            help="Chance of a door between two rooms that have none, for more than one way.",
        ),
    ] = 0.0,
    force: Annotated[bool, typer.Option("--force", help="Overwrite FILE if it exists.")] = False,
) -> None:
    """Write a generated building: rooms, doors, windows, furniture, access points.

    The same options give the same plan on any machine.
    """
    check_suffix(output, (".toml",), "--output")
    if output.exists() and not force:
        raise FileExistsError(17, "already exists; use --force to overwrite", str(output))
    try:
        plan = floorplans.generate(
            kind,
            seed,
            area_m2=area,
            furniture=furniture,
            shape=shape,
            n_transmitters=access_points,
            connecting_doors=connecting_doors,
        )
    except ValueError as error:  # a wing needs a larger area
        raise typer.BadParameter(f"{error}.", param_hint="--area") from error
    with atomic_write(output) as beside:
        beside.write_text(floorplans.dumps(plan), encoding="utf-8", newline="\n")
    say(
        f"wrote {output}: {plan.outline.area:.0f} m2, {len(plan.walls)} walls, "
        f"{len(plan.transmitters)} transmitters; view it with: rssnav plan show {output}"
    )
