"""Scores -> a JSON to submit, a Markdown table, and a page."""

from __future__ import annotations

import html
import json
import platform
from collections.abc import Sequence
from dataclasses import asdict
from importlib.metadata import version
from pathlib import Path

from atomicfiles import atomic_write_all
from rssnav.benchmark.protocol import BENCHMARK_VERSION, Extent
from rssnav.benchmark.scores import Score

_HEAD = (
    "policy", "knows", "success", "SPL (95 %)", "time to find [s]: median, 90 %",
    "false alarms", "kJ", "turns", "collisions", "µs a step",
)  # fmt: skip


def write(folder: Path, scores: Sequence[Score], extent: Extent) -> list[Path]:
    """Write ``results.json``, ``table.md`` and ``page.html``; return their paths."""
    folder.mkdir(parents=True, exist_ok=True)
    contents = {
        folder / "results.json": as_json(scores, extent),
        folder / "table.md": as_markdown(scores),
        folder / "page.html": as_page(scores, extent),
    }
    atomic_write_all({path: text.encode() for path, text in contents.items()})
    return list(contents)


def as_json(scores: Sequence[Score], extent: Extent) -> str:
    """Results that others can compare with."""
    content = {
        "benchmark": "rssnav",
        "version": BENCHMARK_VERSION,
        "rssnav": version("rssnav"),
        "python": platform.python_version(),
        "extent": asdict(extent),
        "scores": [asdict(score) for score in scores],
    }
    return json.dumps(content, indent=1) + "\n"


def load_scores(path: Path) -> list[Score]:
    """Read scores from a ``results.json``.

    Raises
    ------
    ValueError
        Unless it holds results of this version of the benchmark.
    """
    try:
        content = json.loads(path.read_text())
        found = content["version"]
        read = [Score(**score) for score in content["scores"]]
    except (ValueError, KeyError, TypeError) as error:
        raise ValueError(f"{path}: not a results.json of rssnav benchmark ({error})") from error
    if found != BENCHMARK_VERSION:
        raise ValueError(
            f"{path}: version {found} of the benchmark; results compare only with those of the "
            f"same version, here {BENCHMARK_VERSION}"
        )
    return read


def as_markdown(scores: Sequence[Score]) -> str:
    """A table for each task, best SPL first."""
    parts: list[str] = []
    for condition, rows in _by_condition(scores).items():
        lines = [_row(_HEAD), _row(["---"] * len(_HEAD))]
        parts.append("\n".join([f"### {condition}", "", *lines, *(_row(row) for row in rows)]))
    return "\n\n".join(parts) + "\n"


def as_page(scores: Sequence[Score], extent: Extent) -> str:
    """The same as a page that needs nothing else."""
    tables = "".join(
        f"<h2>{html.escape(condition)}</h2><table><tr>{_cells('th', _HEAD)}</tr>"
        + "".join(f"<tr>{_cells('td', row)}</tr>" for row in rows)
        + "</table>"
        for condition, rows in _by_condition(scores).items()
    )
    return (
        '<!doctype html><html lang="en"><meta charset="utf-8"><title>rssnav benchmark</title>'
        "<style>body{font:1rem/1.5 system-ui,sans-serif;margin:2rem;max-width:75rem}"
        "table{border-collapse:collapse}td,th{padding:.2rem .8rem;text-align:left;"
        "border-bottom:1px solid #999}</style>"
        f"<h1>rssnav benchmark, version {BENCHMARK_VERSION}</h1>"
        f"<p>{extent.buildings} buildings ({extent.split}), {extent.seeds} seeds, "
        f"{extent.flights} flights of each.</p>{tables}</html>\n"
    )


def table_rows(scores: Sequence[Score]) -> list[list[str]]:
    """Short rows for a terminal: task, policy, success, SPL."""
    return [
        [score.condition, score.entrant, score.knows, f"{score.success:.3f}", _interval(score)]
        for score in scores
    ]


def _by_condition(scores: Sequence[Score]) -> dict[str, list[list[str]]]:
    grouped: dict[str, list[Score]] = {}
    for score in scores:
        grouped.setdefault(score.condition, []).append(score)
    return {
        condition: [_words(score) for score in sorted(group, key=lambda s: -s.spl)]
        for condition, group in grouped.items()
    }


def _words(score: Score) -> list[str]:
    _, median, _, late = ("-" if t is None else f"{t:.0f}" for t in score.time_s)
    return [
        score.entrant,
        score.knows,
        f"{score.success:.3f}",
        _interval(score),
        f"{median}, {late}",
        f"{score.false_alarms:.3f}",
        f"{score.energy_kj:.2f}",
        f"{score.turns:.0f}",
        f"{score.collisions}",
        f"{score.step_us:.0f}",
    ]


def _interval(score: Score) -> str:
    return f"{score.spl:.3f} ({score.spl_low:.3f} to {score.spl_high:.3f})"


def _row(cells: Sequence[str]) -> str:
    return f"| {' | '.join(cell.replace('|', '/') for cell in cells)} |"


def _cells(tag: str, cells: Sequence[str]) -> str:
    return "".join(f"<{tag}>{html.escape(cell)}</{tag}>" for cell in cells)
