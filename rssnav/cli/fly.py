"""``rssnav fly``: a film of a trained UAV's flight."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

import floorplans
from raytrace import RadioMap
from rssnav import TrainingResult
from rssnav.cli.console import one_progress, print_json, print_pairs
from rssnav.cli.failures import EXIT_FAILURE, print_error
from rssnav.cli.options import MAX_RUNS, Json, Plan, Style, check_suffix, examples
from rssnav.maps import require_map_for

if TYPE_CHECKING:
    from rssnav.pictures.flight_movie import FinalFlight


def add_to(parent: typer.Typer) -> None:
    """Add the command ``fly``."""
    parent.command(
        "fly",
        epilog=examples(
            "rssnav map flat -o flat.h5",
            "rssnav train flat --map flat.h5 --goal-rss -30 --runs 10 -o rss.h5",
            "rssnav fly flat rss.h5 --map flat.h5 -o flight.gif",
        ),
    )(fly)


def fly(
    plan: Plan,
    trainings: Annotated[
        list[Path],
        typer.Argument(
            metavar="TRAINING",
            help="Training results (rssnav train -o); one flight of each is shown.",
            show_default=False,
        ),
    ],
    map_file: Annotated[
        Path,
        typer.Option("--map", metavar="FILE", help="The plan's radio map (rssnav map)."),
    ],
    output: Annotated[
        Path,
        typer.Option("-o", "--output", metavar="FILE", help="A .gif, or a .mp4 with ffmpeg."),
    ],
    run: Annotated[
        int | None,
        typer.Option(
            metavar="N",
            min=0,
            max=MAX_RUNS,
            help="Index of the realisation to show, from 0.",
            show_default="the one of median length",
        ),
    ] = None,
    frames_per_s: Annotated[
        int, typer.Option("--fps", metavar="N", min=1, max=50, help="Steps shown per second.")
    ] = 10,
    style: Style = None,
    as_json: Json = False,
) -> None:
    """Animate a trained UAV's flight: its path over the map, and its RSS readings."""
    from rssnav.pictures.flight_movie import SUFFIXES, MovieError, save_flight_movie
    from rssnav.pictures.style import chosen_style

    check_suffix(output, SUFFIXES, "--output")
    loaded = floorplans.load(plan)
    radio_map = RadioMap.load(map_file)
    require_map_for(loaded, radio_map, map_file)
    results = [TrainingResult.load(training) for training in trainings]
    try:
        with one_progress("drawing") as progress, chosen_style(style):
            flights = save_flight_movie(
                loaded,
                radio_map,
                results,
                output,
                run=run,
                frames_per_s=frames_per_s,
                progress=progress,
            )
    except MovieError as error:
        print_error(str(error))
        raise typer.Exit(EXIT_FAILURE) from error
    _print({"file": str(output), "flights": [_summary(flight) for flight in flights]}, as_json)


def _summary(flight: FinalFlight) -> dict[str, Any]:
    return {
        "agent": flight.agent,
        "steps": len(flight.position) - 1,
        "length_m": flight.length_m,
        "reached": flight.reached,
    }


def _print(summary: dict[str, Any], as_json: bool) -> None:
    if as_json:
        print_json(summary)
        return
    print_pairs(
        [
            ("film", summary["file"]),
            *(
                (
                    f"{flight['agent']} agent",
                    f"{flight['length_m']:.1f} m in {flight['steps']} steps"
                    + ("" if flight["reached"] else "; it does not reach the source"),
                )
                for flight in summary["flights"]
            ),
        ]
    )
