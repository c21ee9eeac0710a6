"""``rssnav dataset check``, ``info`` and ``show``: look at a data set that was made."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import typer

from rssnav.cli.console import one_progress, print_json, print_pairs, say
from rssnav.cli.failures import EXIT_FAILURE
from rssnav.cli.options import PICTURE_SUFFIXES, Json, check_suffix, examples

Folder = Annotated[
    Path, typer.Argument(metavar="FOLDER", help="The folder of a data set.", show_default=False)
]
SplitName = Literal["train", "validation", "test"]
MOST_SHOWN = 20


def add_to(group: typer.Typer) -> None:
    """Add the commands to the group ``dataset``."""
    group.command(
        "check", epilog=examples("rssnav dataset make demo -o demo", "rssnav dataset check demo")
    )(check)
    group.command(
        "info",
        epilog=examples("rssnav dataset make demo -o demo", "rssnav dataset info demo --json"),
    )(info)
    group.command(
        "show",
        epilog=examples(
            "rssnav dataset make demo -o demo",
            "rssnav dataset show demo -o sheet.png --split test",
        ),
    )(show)


def check(dataset: Folder, as_json: Json = False) -> None:
    """Check every file, hash and value of a data set; exit with status 1 on errors."""
    from rssnav.datasets.checks import problems

    with one_progress("plans") as progress:
        found = list(problems(dataset, progress))
    if as_json:
        print_json({"folder": str(dataset), "problems": found})
    else:
        for problem in found[:MOST_SHOWN]:
            say(problem)
        if len(found) > MOST_SHOWN:
            say(f"and {len(found) - MOST_SHOWN} more")
        say(f"{dataset}: {len(found) or 'no'} problems")
    if found:
        raise typer.Exit(EXIT_FAILURE)


def info(dataset: Folder, as_json: Json = False) -> None:
    """Print what a data set holds."""
    from rssnav.datasets.info import facts

    found = facts(dataset)
    if as_json:
        print_json(found)
        return
    pairs = [(key.replace("_", " "), value) for key, value in found.items() if key != "splits"]
    for split, counts in found.get("splits", {}).items():
        pairs.append((split, f"{counts['plans']} plans, {counts['maps']} maps"))
    print_pairs(
        (key, ", ".join(map(str, value)) if isinstance(value, list) else value)
        for key, value in pairs
    )


def show(
    dataset: Folder,
    output: Annotated[
        Path, typer.Option("-o", "--output", metavar="FILE", help="A .png, .svg or .pdf.")
    ],
    count: Annotated[
        int, typer.Option(metavar="N", min=1, max=200, help="Number of maps in the picture.")
    ] = 20,
    layer: Annotated[str, typer.Option(metavar="NAME", help="The layer to draw.")] = "rss_dbm",
    split: Annotated[
        SplitName | None,
        typer.Option(help="Maps of this split only.", show_default="all splits"),
    ] = None,
) -> None:
    """Draw maps that are spread evenly over a data set."""
    from rssnav.datasets.contact_sheet import draw_sheet

    check_suffix(output, PICTURE_SUFFIXES, "--output")
    n = draw_sheet(dataset, output, count=count, layer=layer, split=split)
    say(f"wrote {output}: {n} maps")
