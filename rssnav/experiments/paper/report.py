"""The report of a run of the paper: one self-contained HTML file, and a JSON summary.

Pictures and styles are embedded and nothing is loaded, so the file can be mailed, archived and
printed. Its template is ``templates/report.html.j2``.
"""

from __future__ import annotations

import base64
import json
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from jinja2 import Environment, PackageLoader, StrictUndefined

from atomicfiles import atomic_write

if TYPE_CHECKING:
    from rssnav.experiments.paper.claims import ClaimResult
    from rssnav.experiments.paper.provenance import Record
    from rssnav.experiments.tables import Table

_VERDICTS = ("reproduced", "inconclusive", "not reproduced")


@dataclass(frozen=True)
class Picture:
    """A figure in the report.

    Attributes
    ----------
    key, title : str
        Name in links, and title.
    of_paper : str
        The figure of the paper that it reproduces.
    caption : str
        Text below the picture.
    png : bytes
        Content of a PNG file.
    """

    key: str
    title: str
    of_paper: str
    caption: str
    png: bytes

    @property
    def address(self) -> str:
        """The picture as a data URL."""
        return "data:image/png;base64," + base64.b64encode(self.png).decode("ascii")


@dataclass(frozen=True, eq=False)
class Report:
    """Everything that the report shows.

    Attributes
    ----------
    pictures : tuple of Picture
        Figures in the paper's order.
    tables : tuple of Table
        Tables of results, in the paper's order.
    findings : tuple of ClaimResult
        Claims with their verdicts.
    settings : tuple of Table
        Interpretation and parameters.
    scenarios : dict
        Plan, hash and map of each scenario.
    record : Record
        Seed, versions and run times.
    """

    pictures: tuple[Picture, ...]
    tables: tuple[Table, ...]
    findings: tuple[ClaimResult, ...]
    settings: tuple[Table, ...]
    scenarios: dict[str, dict[str, Any]]
    record: Record

    @property
    def verdict_counts(self) -> dict[str, int]:
        """Number of claims of each verdict."""
        counts = Counter(finding.verdict.value for finding in self.findings)
        return {verdict: counts[verdict] for verdict in _VERDICTS}


def number(value: float) -> str:
    """Format a number with about four digits."""
    if value == int(value) and abs(value) < 1e6:
        return f"{int(value):,}".replace("-", "−")
    size = abs(value)
    digits = 0 if size >= 1000 else 1 if size >= 100 else 2 if size >= 1 else 3
    return f"{value:,.{digits}f}".replace("-", "−")


def render(report: Report) -> str:
    """Return the report's HTML."""
    environment = Environment(
        loader=PackageLoader("rssnav.experiments.paper"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["number"] = number
    return environment.get_template("report.html.j2").render(report=report, record=report.record)


def save_report(report: Report, path: Path) -> None:
    """Write the report atomically."""
    with atomic_write(path) as beside:
        beside.write_text(render(report), encoding="utf-8")


def summary(report: Report) -> dict[str, Any]:
    """Return results, verdicts and record as plain values."""
    record = report.record
    return {
        "run": {
            "runs": record.runs,
            "seed": record.seed,
            "quick": record.quick,
            "plans": list(record.plans),
            "count": str(record.count),
            "started": record.started,
        },
        "verdicts": report.verdict_counts,
        "claims": [_claim(finding) for finding in report.findings],
        "tables": {table.key: table.records() for table in (*report.tables, *report.settings)},
        "scenarios": report.scenarios,
        "versions": record.versions,
        "machine": record.machine,
        "stages_s": record.stages,
        "trainings_s": record.trained,
    }


def save_summary(report: Report, path: Path) -> None:
    """Write :func:`summary` as JSON, atomically."""
    with atomic_write(path) as beside:
        text = json.dumps(summary(report), indent=2, ensure_ascii=False, allow_nan=False)
        beside.write_text(text + "\n", encoding="utf-8")


def _claim(finding: ClaimResult) -> dict[str, Any]:
    return {
        "key": finding.claim.key,
        "paper": finding.claim.paper,
        "test": finding.claim.test,
        "statistic": finding.claim.statistic,
        "verdict": finding.verdict.value,
        "cases": [
            {
                "case": case.name,
                "compared": dict(case.compared),
                "value": None if case.estimate is None else case.estimate.value,
                "low": None if case.estimate is None else case.estimate.low,
                "high": None if case.estimate is None else case.estimate.high,
                "verdict": case.verdict.value,
            }
            for case in finding.cases
        ],
    }
