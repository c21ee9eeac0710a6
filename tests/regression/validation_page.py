"""Tables of docs/validation.md, computed from the shipped survey.

`python tests/regression/validation_page.py` writes them into the page.
"""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import floorplans
import rssnav.measurements
from raytrace import Isotropic, TraceConfig
from rssnav.measurements.calibrate import Calibration, Change, calibrate
from rssnav.measurements.survey_csv import read_survey, transmitters_of
from rssnav.measurements.traced import TraceSettings, traced_dbm
from rssnav.measurements.validation import Row, Validation, validate
from rssnav.presets import PRESETS
from rssnav.scenes import scene_of

PAGE = Path(__file__).resolve().parents[2] / "docs" / "validation.md"
FLAT = Path(rssnav.measurements.__file__).parent / "measured_flat"

Cells = list[list[str]]


def tables() -> dict[str, Cells]:
    """Compute the rows of each table by its name."""
    plan = floorplans.load(FLAT / "flat.toml")
    survey = read_survey(FLAT / "survey.csv", plan, transmitters_of(plan, FLAT))
    scene = scene_of(plan)
    building = TraceSettings(PRESETS["building"].config, 2.44e9)
    unknown = Isotropic(polarisation="mean")
    isotropic = replace(building, transmit_antenna=unknown, receive_antenna=unknown)
    vertical = replace(building, transmit_antenna=Isotropic(), receive_antenna=Isotropic())
    paper = replace(building, config=TraceConfig(6, 1, 0))
    found = {
        name: validate(plan, survey, traced_dbm(scene, survey, settings))
        for name, settings in (
            ("traced, no transmission (preset `paper`)", paper),
            ("traced, isotropic antennas, mean over polarisations (preset `building`)", isotropic),
            ("traced, isotropic antennas, vertically polarised", vertical),
            ("traced, vertical dipoles", building),
        )
    }
    first = next(iter(found.values()))
    models = [_row(row.name, row) for row in first.rows[:-1]]
    models += [_row(name, validation.tracer) for name, validation in found.items()]
    fitted = calibrate(plan, scene, survey, building)
    models.append(_calibrated(fitted))
    models.append(["floor", _floor(first), "–"])
    return {
        "models": models,
        "materials": _materials(fitted),
        "places": [
            [str(p.n_places), f"{p.before_db:.1f}", f"{p.after_db:.1f}"] for p in fitted.curve
        ],
    }


def _row(name: str, row: Row) -> list[str]:
    of = [row.space, row.transmitter]
    return [name, *("–" if a is None else f"{a.sigma_db:.2f}" for a in of)]


def _calibrated(found: Calibration) -> list[str]:
    changes: list[Change | None] = [found.space, found.transmitter]
    after = ["–" if change is None else f"{change.after.sigma_db:.2f}" for change in changes]
    return ["traced, vertical dipoles, materials fitted", *after]


def _floor(validation: Validation) -> str:
    assert validation.floor is not None
    return f"{validation.floor.sigma_db:.2f}"


def _materials(found: Calibration) -> Cells:
    return [
        [
            f"{value.material}, {value.kind}",
            f"{value.quantity(value.prior):.2g}",
            f"{value.quantity(fitted):.2g}",
            f"{value.quantity(fitted - 2.0 * deviation):.2g} to "
            f"{value.quantity(fitted + 2.0 * deviation):.2g}",
        ]
        for value, fitted, deviation in found.rows()
    ]


def marked(name: str) -> re.Pattern[str]:
    """Pattern of the rows of a table in the page, which stand behind a comment with its name."""
    return re.compile(rf"(<!-- table: {name} -->\n+\|.*\n\|[-| ]+\n)((?:\|.*\n)*)")


def main() -> None:
    """Write the tables into the page."""
    text = PAGE.read_text("utf-8")
    for name, rows in tables().items():
        lines = "".join("| " + " | ".join(row) + " |\n" for row in rows)
        text = marked(name).sub(lambda found, lines=lines: found[1] + lines, text)
    PAGE.write_text(text, "utf-8", newline="\n")


if __name__ == "__main__":
    main()
