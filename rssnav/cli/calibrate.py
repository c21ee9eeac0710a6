"""``rssnav calibrate``: materials of a plan fitted to a survey."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated

import typer

import floorplans
from atomicfiles import atomic_write_all
from floorplans import FloorPlan
from rssnav.cli.console import note, print_json, print_table, say, stage_progress
from rssnav.cli.failures import EXIT_FAILURE, print_error
from rssnav.cli.options import (
    Diffractions,
    DynamicRange,
    Edition,
    Json,
    MaxMemory,
    Plan,
    Preset,
    Reflections,
    Threads,
    Transmissions,
    check_suffix,
    examples,
    in_bytes,
)
from rssnav.cli.survey_options import (
    Antennas,
    Offset,
    Report,
    Square,
    SurveyFile,
    SurveyFrequency,
    TransmitterFile,
    load_survey,
    settings_of,
)
from rssnav.measurements.calibrate import Calibration, Change, calibrate
from rssnav.measurements.calibration_page import calibration_page
from rssnav.measurements.doors import DoorState
from rssnav.measurements.hold_out import SQUARE_M
from rssnav.measurements.traced import survey_announcement
from rssnav.messages import printable
from rssnav.scenes import scene_of

EXAMPLE = "measured-flat/flat.toml measured-flat/survey.csv -o calibrated.toml"


def add_to(parent: typer.Typer) -> None:
    """Add the command ``calibrate``."""
    parent.command(
        "calibrate",
        epilog=examples(
            "rssnav example",
            f"rssnav calibrate {EXAMPLE} --report calibration.html",
            f"rssnav calibrate {EXAMPLE} --material partition",
        ),
    )(calibrate_plan)


def calibrate_plan(
    plan: Plan,
    survey: SurveyFile,
    output: Annotated[
        Path,
        typer.Option(
            "-o", "--output", metavar="FILE", help="File for the calibrated plan (.toml)."
        ),
    ],
    transmitters: TransmitterFile = None,
    material: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME",
            help="Material to fit; repeatable.",
            show_default="all dielectrics of the plan",
        ),
    ] = None,
    doors: Annotated[
        bool,
        typer.Option("--doors", help="Also find which doors were open or shut during the survey."),
    ] = False,
    offset: Offset = "one",
    square: Square = SQUARE_M,
    frequency: SurveyFrequency = None,
    antenna: Antennas = None,
    preset: Preset = "building",
    reflections: Reflections = None,
    diffractions: Diffractions = None,
    transmissions: Transmissions = None,
    dynamic_range: DynamicRange = None,
    report: Report = None,
    max_memory: MaxMemory = None,
    edition: Edition = None,
    threads: Threads = None,
    as_json: Json = False,
) -> None:
    """Fit a plan's material properties to measured RSS, and report the held-out error.

    FILE is written only if the fit predicts held-out readings better than the plan's own materials.
    """
    check_suffix(output, (".toml",), "--output")
    check_suffix(report, (".html",), "--report")
    loaded = floorplans.load(plan)
    read = load_survey(loaded, plan, survey, transmitters)
    options = {
        "preset": preset,
        "reflections": reflections,
        "diffractions": diffractions,
        "transmissions": transmissions,
        "dynamic_range": dynamic_range,
        "antenna": antenna,
        "frequency": frequency,
    }
    settings = settings_of(read, options, threads, in_bytes(max_memory))
    scene = scene_of(loaded, edition)
    if (words := survey_announcement(scene, read, settings)) is not None:
        note(words)
    with stage_progress() as show:
        found = calibrate(
            loaded,
            scene,
            read,
            settings,
            offsets=offset,
            materials=material,
            square_m=square,
            doors=doors,
            edition=edition,
            progress=lambda done, total: show("calibrating", done, total),
        )
    contents: dict[Path, bytes] = {}
    if report is not None:
        contents[report] = calibration_page(loaded, read, found, settings).encode()
    if found.is_better:
        contents[output] = _toml(found.plan, plan, survey).encode()
    atomic_write_all(contents)
    if as_json:
        print_json({"plan": plan, "written": found.is_better, **found.summary()})
    else:
        _print(found)
    if not found.is_better:
        change = found.space
        print_error(
            f"{plan}: the fit does not improve held-out readings, sigma "
            f"{change.before.sigma_db:.2f} dB before and {change.after.sigma_db:.2f} dB after; "
            f"{output} is not written"
        )
        raise typer.Exit(EXIT_FAILURE)
    note(f"wrote {output}")


def _toml(plan: FloorPlan, name: str, survey: Path) -> str:
    """Return the text of a calibrated plan, with where its materials come from."""
    origin = f"fitted to {survey.name} by rssnav calibrate, from {Path(name).name}"
    return f"# {printable(' '.join(origin.split()))}\n{floorplans.dumps(plan)}"


def _print(found: Calibration) -> None:
    print_table(
        ("material", "property", ">plan", ">fitted", ">95 % interval"),
        [
            (
                value.material,
                f"{value.kind} [{value.unit}]" if value.unit else value.kind,
                f"{value.quantity(value.prior):.3g}",
                f"{value.quantity(fitted):.3g}",
                f"{value.quantity(fitted - 2.0 * deviation):.3g} to "
                f"{value.quantity(fitted + 2.0 * deviation):.3g}",
            )
            for value, fitted, deviation in found.rows()
        ],
    )
    for state in found.doors:
        say(_of_door(state))
    for told in found.found.not_told:
        say(
            f"{told.value.material}, {told.value.kind}: not fitted, as the readings hardly "
            f"depend on it (one standard deviation of it changes them by "
            f"{told.sensitivity_db:.2g} dB; they narrow its range to "
            f"{100.0 * told.narrowing:.0f} %)"
        )
    for doubt in found.doubts:
        say(f"doubtful: {doubt}")
    _print_change("held out by space", found.space)
    if found.transmitter is not None:
        _print_change("held out by transmitter", found.transmitter)
    for point in found.curve:
        say(
            f"with {point.n_places} places: {point.before_db:.2f} dB before, "
            f"{point.after_db:.2f} dB after, at all others"
        )


def _of_door(state: DoorState) -> str:
    was, now = ("open" if is_open else "shut" for is_open in (state.was_open, state.is_open))
    x, y = state.place
    told = f"{was}, as in the plan; the readings do not tell"
    if math.isinf(state.evidence):
        told = f"{now}, as the plan needs it"
    elif state.is_told:
        told = f"{now}, as in the plan" if now == was else f"{now}, and not {was} as in the plan"
        told += f" (log likelihood ratio {state.evidence:.1f})"
    return f"door at ({x:.2f}, {y:.2f}) m: {told}"


def _print_change(name: str, change: Change) -> None:
    before, after = change.before.sigma_db, change.after.sigma_db
    say(f"{name}: sigma {before:.2f} dB before, {after:.2f} dB after")
