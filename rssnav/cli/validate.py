"""``rssnav validate``: traced RSS compared with a survey."""

from __future__ import annotations

import typer

import floorplans
from rssnav.cli.console import note, print_json, print_pairs, print_table, say, stage_progress
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
from rssnav.measurements.hold_out import SQUARE_M
from rssnav.measurements.pages import cautions_of, save_validation_page, sentence_of
from rssnav.measurements.survey import Survey
from rssnav.measurements.traced import survey_announcement, traced_dbm
from rssnav.measurements.validation import Validation, validate
from rssnav.scenes import scene_of

EXAMPLE = "measured-flat/flat.toml measured-flat/survey.csv"


def add_to(parent: typer.Typer) -> None:
    """Add the command ``validate``."""
    parent.command(
        "validate",
        epilog=examples(
            "rssnav example",
            f"rssnav validate {EXAMPLE}",
            f"rssnav validate {EXAMPLE} --report validation.html",
        ),
    )(validate_plan)


def validate_plan(
    plan: Plan,
    survey: SurveyFile,
    transmitters: TransmitterFile = None,
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
    """Compare traced RSS and empirical models with measured RSS, on held-out readings.

    Two cross-validations: by space, with the squares of a chequerboard as folds, and by
    transmitter, leaving one out.
    """
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
        traced = traced_dbm(
            scene,
            read,
            settings,
            lambda done, total: show("transmitters", done, total),
        )
    found = validate(loaded, read, traced, offsets=offset, square_m=square)
    if report is not None:
        save_validation_page(report, loaded, read, found, settings)
    if as_json:
        print_json({"plan": plan, "readings": len(read), **found.summary()})
    else:
        _print(read, found)


def _print(survey: Survey, found: Validation) -> None:
    print_table(
        ("model", ">sigma [dB]", ">median [dB]", ">sigma, new transmitter [dB]", ">slope"),
        [
            (
                row.name,
                _decibels(row.space and row.space.sigma_db),
                _decibels(row.space and row.space.median_db),
                _decibels(row.transmitter and row.transmitter.sigma_db),
                f"{row.slope:.2f}",
            )
            for row in found.rows
        ],
    )
    floor = "unknown, too few neighbours"
    if found.floor is not None:
        floor = (
            f"{found.floor.sigma_db:.2f} dB, as much as readings {found.floor.distance_m:.2f} m "
            f"apart differ ({found.floor.n_pairs} pairs)"
        )
    print_pairs([("readings", len(survey)), ("places", survey.n_places), ("floor", floor)])
    say(sentence_of(survey, found))
    for line in cautions_of(found):
        say(line)


def _decibels(value: float | None) -> str:
    return "-" if value is None else f"{value:.2f}"
