"""Pages on validations: self-contained HTML, with nothing that is loaded from elsewhere."""

from __future__ import annotations

import base64
from pathlib import Path

from jinja2 import Environment, PackageLoader, StrictUndefined
from matplotlib.figure import Figure

from atomicfiles import atomic_write
from floorplans import FloorPlan
from rssnav.measurements.figures import residual_map, residual_plots
from rssnav.measurements.survey import Survey
from rssnav.measurements.traced import TraceSettings
from rssnav.measurements.validation import Validation
from rssnav.pictures.style import png_bytes

SCREEN_DPI = 150


def render(template: str, **content: object) -> str:
    """Fill in one of the package's templates."""
    environment = Environment(
        loader=PackageLoader("rssnav.measurements"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    return environment.get_template(template).render(**content)


def data_url(figure: Figure) -> str:
    """Return a figure as a PNG in a data URL."""
    return "data:image/png;base64," + base64.b64encode(png_bytes(figure, SCREEN_DPI)).decode()


def sentence_of(survey: Survey, validation: Validation) -> str:
    """Say in a sentence how far the tracer is off, compared with the best empirical model."""
    found, others = validation.tracer.space, [r.space for r in validation.rows[:-1] if r.space]
    places = f"{len(survey)} readings at {survey.n_places} places"
    places += f" from {len(survey.transmitters)} transmitters"
    if found is None:
        return f"{places}: the tracer finds a path to none of them"
    best = min(others, key=lambda agreement: agreement.sigma_db)
    name = next(row.name for row in validation.rows if row.space is best)
    return (
        f"{places}, held out by space: sigma {found.sigma_db:.1f} dB for traced RSS, "
        f"{best.sigma_db:.1f} dB for the best empirical model ({name})"
    )


def cautions_of(validation: Validation) -> list[str]:
    """Say what limits the comparison."""
    found: list[str] = []
    tracer = validation.tracer.space
    if tracer is not None and tracer.n_without:
        found.append(
            f"No path reaches {tracer.n_without} of {tracer.n + tracer.n_without} readings, "
            "which are excluded for the tracer only; allow more transmissions."
        )
    if validation.tracer.slope < 0.5:
        found.append(
            f"The slope is {validation.tracer.slope:.2f}: traced RSS varies more than measured RSS."
        )
    if validation.n_censored:
        found.append(
            f"{validation.n_censored} readings are below the sensitivity and not in the table; "
            f"traced RSS is below it for {validation.n_censored_below} of them."
        )
    return found


def trace_assumptions(
    plan: FloorPlan, survey: Survey, settings: TraceSettings
) -> list[tuple[str, str]]:
    """List what a survey was traced with."""
    config = settings.config
    transmissions = config.max_transmissions
    return [
        ("plan", f"{plan.name}, {len(plan.walls)} walls"),
        ("readings", str(len(survey))),
        ("frequency", f"{settings.frequency_hz / 1e9:g} GHz"),
        ("reflections, at most", str(config.max_reflections)),
        ("diffractions, at most", str(config.max_diffractions)),
        ("transmissions, at most", "no limit" if transmissions is None else str(transmissions)),
        ("transmit antenna", settings.transmit_antenna.describe()),
        ("receive antenna", settings.receive_antenna.describe()),
        ("RSS", "sum of the powers of the paths"),
    ]


def assumptions_of(
    plan: FloorPlan, survey: Survey, validation: Validation, settings: TraceSettings
) -> list[tuple[str, str]]:
    """List what a validation was made with."""
    offsets = {"one": "one for all readings"}.get(
        validation.offsets, f"one for each {validation.offsets}"
    )
    return [*trace_assumptions(plan, survey, settings), ("offsets", offsets)]


def save_validation_page(
    path: Path, plan: FloorPlan, survey: Survey, validation: Validation, settings: TraceSettings
) -> None:
    """Write the page on a validation atomically."""
    text = render(
        "validation.html.j2",
        title=f"{plan.name}: traced and measured RSS",
        sentence=sentence_of(survey, validation) + ".",
        cautions=cautions_of(validation),
        validation=validation,
        map=data_url(residual_map(plan, survey, validation)),
        plots=data_url(residual_plots(survey, validation)),
        assumptions=assumptions_of(plan, survey, validation, settings),
    )
    with atomic_write(path) as beside:
        beside.write_text(text, encoding="utf-8")
