"""Scores -> a JSON to submit, a Markdown table, and a page."""

from __future__ import annotations

import html
from collections.abc import Sequence
from pathlib import Path

from atomicfiles import atomic_write_all
from rssnav.benchmark.protocol import BENCHMARK_VERSION, Extent
from rssnav.benchmark.scores import WITHIN_S, Score
from rssnav.benchmark.submissions import as_json
from rssnav.experiments.statistics import Estimate

_TITLES = {
    "train": "Generated buildings, split train",
    "validation": "Generated buildings, split validation",
    "test": "Generated buildings, unseen",
    "paper": "The paper's buildings",
    "own": "Own buildings",
}
_HEAD = (
    "policy", "track", "success", "SPL (95 %)", "median time [s]",
    f"found within {', '.join(map(str, WITHIN_S[:-1]))} s", "false alarms",
    "kJ", "turns", "collisions", "µs a step",
)  # fmt: skip

FEWEST_BUILDINGS = 10
"""Intervals over fewer buildings are not shown: they are too narrow."""


def write(folder: Path, scores: Sequence[Score], extent: Extent) -> list[Path]:
    """Write ``results.json``, ``table.md`` and ``page.html``; return their paths."""
    contents = {
        folder / "results.json": as_json(scores, extent),
        folder / "table.md": as_markdown(scores),
        folder / "page.html": as_page(scores, extent),
    }
    atomic_write_all({path: text.encode() for path, text in contents.items()})
    return list(contents)


def as_markdown(scores: Sequence[Score]) -> str:
    """A table for each site and condition, best SPL first."""
    parts: list[str] = []
    for title, rows in _grouped(scores).items():
        lines = [_row(_HEAD), _row(["---"] * 2 + ["---:"] * (len(_HEAD) - 2))]
        parts.append("\n".join([f"### {title}", "", *lines, *(_row(row) for row in rows)]))
    return "\n\n".join(parts) + "\n"


def as_page(scores: Sequence[Score], extent: Extent) -> str:
    """The same as a page that needs nothing else."""
    tables = "".join(
        f"<h2>{html.escape(title)}</h2><table><tr>{_cells('th', _HEAD)}</tr>"
        + "".join(f"<tr>{_cells('td', row)}</tr>" for row in rows)
        + "</table>"
        for title, rows in _grouped(scores).items()
    )
    return (
        '<!doctype html><html lang="en"><meta charset="utf-8"><title>rssnav benchmark</title>'
        '<meta name="viewport" content="width=device-width">'
        "<style>body{font:1rem/1.5 system-ui,sans-serif;margin:2rem}"
        "table{border-collapse:collapse}td,th{padding:.2rem .8rem;text-align:left;"
        "border-bottom:1px solid #999}</style>"
        f"<h1>rssnav benchmark, version {BENCHMARK_VERSION}</h1>"
        f"<p>{words(extent)}</p>{tables}</html>\n"
    )


def words(extent: Extent) -> str:
    """How much was flown."""
    generated = f"{extent.generated} generated buildings (split {extent.split})"
    parts = [generated] if extent.generated else []
    parts += ["the paper's two"] if extent.paper else []
    parts += [f"{len(extent.plans)} of own plans"] if extent.plans else []
    return f"{', '.join(parts)}; {extent.seeds} seeds."


def table_rows(scores: Sequence[Score]) -> list[list[str]]:
    """Short rows for a terminal: buildings, condition, policy, track, success, SPL."""
    return [
        [
            s.site,
            s.condition,
            s.policy,
            s.track,
            f"{s.success.value:.3f}",
            _interval(s.spl, len(s.spl_by_building)),
        ]
        for s in scores
    ]


def _grouped(scores: Sequence[Score]) -> dict[str, list[list[str]]]:
    grouped: dict[str, list[Score]] = {}
    for score in scores:
        grouped.setdefault(f"{_TITLES[score.site]}: {score.condition}", []).append(score)
    return {
        title: [_words(score) for score in sorted(group, key=lambda s: -s.spl.value)]
        for title, group in grouped.items()
    }


def _words(score: Score) -> list[str]:
    return [
        score.policy,
        score.track,
        f"{score.success.value:.3f}",
        _interval(score.spl, len(score.spl_by_building)),
        "-" if score.median_s is None else f"{score.median_s:.0f}",
        ", ".join(f"{part:.2f}" for part in score.found_within[:-1]),
        f"{score.false_alarms.value:.3f}",
        f"{score.energy_kj:.2f}",
        f"{score.turns:.0f}",
        f"{score.collisions}",
        f"{score.step_us:.0f}",
    ]


def _interval(estimate: Estimate, n_buildings: int) -> str:
    if n_buildings < FEWEST_BUILDINGS:
        return f"{estimate.value:.3f}"
    return f"{estimate.value:.3f} ({estimate.low:.3f} to {estimate.high:.3f})"


def _row(cells: Sequence[str]) -> str:
    return f"| {' | '.join(html.escape(cell.replace('|', '/')) for cell in cells)} |"


def _cells(tag: str, cells: Sequence[str]) -> str:
    return "".join(f"<{tag}>{html.escape(cell)}</{tag}>" for cell in cells)
