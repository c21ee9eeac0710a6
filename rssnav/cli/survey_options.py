"""What the commands on surveys share: their options, and the reading of plan and survey."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

if TYPE_CHECKING:
    from floorplans import FloorPlan
    from raytrace import Antenna
    from rssnav.measurements.survey import Survey

SurveyFile = Annotated[
    Path,
    typer.Argument(metavar="SURVEY", help="A CSV file: tx, x, y, z, rss_dbm.", show_default=False),
]
TransmitterFile = Annotated[
    Path | None,
    typer.Option(
        "--transmitters",
        metavar="FILE",
        help="A CSV file of the transmitters: tx, x, y, z.",
        show_default=False,
    ),
]
Offset = Annotated[
    Literal["one", "transmitter", "device"],
    typer.Option(
        "--offset", help="What a constant offset is fitted for: all readings, or each of these."
    ),
]
Square = Annotated[
    float,
    typer.Option(
        "--square",
        metavar="M",
        min=0.01,
        max=1000.0,
        help="Side of the squares of which every second one is held out.",
    ),
]
SurveyFrequency = Annotated[
    float | None,
    typer.Option(
        "--frequency",
        metavar="GHZ",
        min=0.001,
        max=1000.0,
        help="Carrier frequency in GHz.",
        show_default="the survey's, otherwise 2.4",
    ),
]
Antennas = Annotated[
    Literal["isotropic", "dipole"],
    typer.Option("--antenna", help="Of transmitters and receivers; a dipole is vertical."),
]
Report = Annotated[
    Path | None,
    typer.Option(
        "--report", metavar="FILE", help="Write a page with figures (.html).", show_default=False
    ),
]


def load_survey(plan: FloorPlan, survey: Path, transmitters: Path | None) -> Survey:
    """Read a survey and the transmitters it refers to."""
    from rssnav.measurements.survey_csv import read_survey, read_transmitters

    if transmitters is None:
        raise typer.BadParameter(
            "the plan names no transmitters; give a CSV file with the columns tx, x, y, z.",
            param_hint="--transmitters",
        )
    return read_survey(survey, plan, read_transmitters(transmitters, plan))


def antenna_of(name: str) -> Antenna:
    """Return the antenna of that name."""
    from raytrace import HalfWaveDipole, Isotropic

    return HalfWaveDipole() if name == "dipole" else Isotropic()
