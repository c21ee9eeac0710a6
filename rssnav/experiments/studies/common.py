"""What the studies beyond the paper share: their worlds, their output, their progress."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from matplotlib.figure import Figure

import floorplans
from atomicfiles import atomic_write
from rssnav.experiments.paper import trainings
from rssnav.experiments.paper.data import SPEEDS, Scenario
from rssnav.experiments.tables import Table
from rssnav.maps import make_map
from rssnav.pictures.style import save_figure
from rssnav.world import GridWorld

Progress = Callable[[str, int, int], None]
Worlds = dict[tuple[int, int], GridWorld]
"""Worlds by (scenario, speed)."""

PLANS = ("scenario1", "scenario2")


@dataclass(frozen=True, eq=False)
class Study:
    """A finished study.

    Attributes
    ----------
    tables : tuple of Table
        What it measured.
    files : tuple of Path
        Every file it wrote: the tables as CSV and Markdown, the figures as PNG.
    """

    tables: tuple[Table, ...]
    files: tuple[Path, ...]


def no_progress(_stage: str, _done: int, _total: int) -> None:
    """Drop a progress."""


def load_scenarios(out: Path, threads: int | None, progress: Progress) -> dict[int, Scenario]:
    """Load both plans of the paper, and load or trace their maps below ``out``."""
    scenarios: dict[int, Scenario] = {}
    for number, name in enumerate(PLANS, start=1):
        stage = f"map of {name}"
        plan = floorplans.load(name)
        radio_map = make_map(
            plan,
            out / "maps" / f"{name}.h5",
            threads=threads,
            progress=lambda done, total, stage=stage: progress(stage, done, total),
        )
        progress(stage, 1, 1)
        scenarios[number] = Scenario(plan, radio_map)
    return scenarios


def load_worlds(out: Path, threads: int | None, progress: Progress) -> Worlds:
    """Make the worlds of both scenarios at the paper's speeds."""
    return trainings.worlds(load_scenarios(out, threads, progress), SPEEDS)


def write_study(out: Path, tables: tuple[Table, ...], figures: dict[str, Figure]) -> Study:
    """Write the tables below ``tables/`` and the figures below ``figures/``."""
    files: list[Path] = []
    for table in tables:
        table.save_csv(out / "tables")
        markdown = out / "tables" / f"{table.key}.md"
        with atomic_write(markdown) as beside:
            beside.write_text(as_markdown(table), encoding="utf-8")
        files += [out / "tables" / f"{table.key}.csv", markdown]
    for key, figure in figures.items():
        save_figure(figure, out / "figures" / key)
        files.append(out / "figures" / f"{key}.png")
    return Study(tables, tuple(files))


def as_markdown(table: Table) -> str:
    """Write a table in Markdown, its caption below."""
    headings = [column.heading for column in table.shown_columns]
    rows = [[text for _, text in row] for row in table.shown_rows]
    lines = [headings, ["---"] * len(headings), *rows]
    body = "\n".join(f"| {' | '.join(cells)} |" for cells in lines)
    return f"{body}\n\n{table.caption}\n"
