"""``rssnav plan export``: write a plan in another program's format."""

from pathlib import Path
from typing import Annotated

import typer

import floorplans
from floorplans.exporters import FORMATS, ExportOptions
from floorplans.exporters import export as export_plan
from rssnav.cli.console import say
from rssnav.cli.options import Plan, check_suffix, examples

_SUFFIXES = tuple(suffix for kind in FORMATS for suffix in kind.suffixes)


def add_to(parent: typer.Typer) -> None:
    """Add the command."""
    parent.command(
        epilog=examples(
            "rssnav plan export flat -o flat.glb",
            "rssnav plan export flat -o flat.geojson",
            "rssnav plan export flat -o sionna/flat.xml",
        )
    )(export)


def export(
    plan: Plan,
    output: Annotated[
        Path,
        typer.Option(
            "-o",
            "--output",
            metavar="FILE",
            help=f"Output file; the extension selects the format: {', '.join(_SUFFIXES)}.",
        ),
    ],
    resolution: Annotated[
        float,
        typer.Option(
            metavar="M", min=0.001, max=10.0, help="Side of a pixel of a ROS map in metres."
        ),
    ] = 0.05,
    slice_height: Annotated[
        float | None,
        typer.Option(
            metavar="M",
            min=0.0,
            max=1000.0,
            help="Height in metres of the horizontal section shown in a ROS map.",
            show_default="1, or half the storey height if that is less",
        ),
    ] = None,
    frequency: Annotated[
        float,
        typer.Option(
            metavar="GHZ",
            min=0.001,
            max=1000.0,
            help="Frequency in GHz at which the plan's own materials are evaluated (Sionna RT).",
        ),
    ] = 2.4,
) -> None:
    """Write a plan in another program's format, in metres."""
    check_suffix(output, _SUFFIXES, "--output")
    options = ExportOptions(resolution, slice_height, frequency * 1e9)
    files = export_plan(floorplans.load(plan), output, options=options)
    for file in files:
        say(f"wrote {file}: {file.stat().st_size} bytes")
