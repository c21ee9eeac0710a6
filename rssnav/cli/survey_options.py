"""What the commands on surveys share: their options, and the reading of plan and survey."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

if TYPE_CHECKING:
    from floorplans import FloorPlan
    from rssnav.measurements.survey import Survey
    from rssnav.measurements.traced import TraceSettings

SurveyFile = Annotated[
    Path,
    typer.Argument(
        metavar="SURVEY", help="CSV file with the columns tx, x, y, z, rss_dbm.", show_default=False
    ),
]
TransmitterFile = Annotated[
    Path | None,
    typer.Option(
        "--transmitters",
        metavar="FILE",
        help="CSV file of the transmitters with the columns tx, x, y, z.",
        show_default="those in the plan",
    ),
]
Offset = Annotated[
    Literal["one", "transmitter", "device"],
    typer.Option(
        "--offset", help="Fit one constant offset, or one for each transmitter or device."
    ),
]
Square = Annotated[
    float,
    typer.Option(
        "--square",
        metavar="M",
        min=0.01,
        max=1000.0,
        help="Side in metres of the chequerboard squares for spatial cross-validation.",
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
    Literal["isotropic", "unpolarised", "dipole"] | None,
    typer.Option(
        "--antenna",
        help="Antenna of transmitters and receivers; dipoles are vertical.",
        show_default="the transmitters' in the plan, otherwise the preset's",
    ),
]
Report = Annotated[
    Path | None,
    typer.Option(
        "--report", metavar="FILE", help="Write a page with figures (.html).", show_default=False
    ),
]


def load_survey(plan: FloorPlan, name: str, survey: Path, transmitters: Path | None) -> Survey:
    """Read a survey and the transmitters it refers to; by default those of the plan."""
    from rssnav.measurements.survey_csv import read_survey, read_transmitters, transmitters_of

    if transmitters is not None:
        return read_survey(survey, plan, read_transmitters(transmitters, plan))
    if not plan.transmitters:
        raise typer.BadParameter(
            "the plan has no [[transmitters]]; give a CSV file with the columns tx, x, y, z.",
            param_hint="--transmitters",
        )
    return read_survey(survey, plan, transmitters_of(plan, Path(name).parent))


def settings_of(
    survey: Survey, options: dict[str, Any], threads: int | None, max_memory_bytes: int | None
) -> TraceSettings:
    """Return how a survey is traced; a frequency that it denies is wrong usage.

    Parameters
    ----------
    survey
        The readings.
    options
        Of the command, by parameter; those that are None have the preset's value.
    threads, max_memory_bytes
        See `TraceSettings`.
    """
    from rssnav.cli.radio import config_of
    from rssnav.measurements.traced import TraceSettings
    from rssnav.presets import PRESETS
    from rssnav.transmitters import FREQUENCY_HZ, antenna_of

    preset = PRESETS[options["preset"] or "building"]
    frequency_hz = survey.frequency_hz or FREQUENCY_HZ
    if options["frequency"] is not None:
        frequency_hz = options["frequency"] * 1e9
        if survey.frequency_hz not in (None, frequency_hz):
            raise typer.BadParameter(
                f"the survey was made at {survey.frequency_hz:g} Hz; leave the option out.",
                param_hint="--frequency",
            )
    chosen = None if options["antenna"] is None else antenna_of(options["antenna"])
    antenna = chosen or preset.antenna
    return TraceSettings(
        config_of(preset, options),
        frequency_hz,
        antenna,
        antenna,
        is_antenna_chosen=chosen is not None,
        threads=threads,
        max_memory_bytes=max_memory_bytes,
    )
