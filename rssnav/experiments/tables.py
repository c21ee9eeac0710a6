"""Tables: values in full precision for CSV files, rounded for people."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from atomicfiles import atomic_write

Cell = str | int | float | None
"""A value of a table; None for a missing value."""


@dataclass(frozen=True)
class Column:
    """A column of a table.

    Attributes
    ----------
    name : str
        Name in the CSV file, with its unit.
    heading : str
        Heading in the report and in Markdown, with its unit.
    digits : int
        Digits after the decimal point below the heading.
    shown : bool
        Whether the report and Markdown show it; the CSV file always has it.
    """

    name: str
    heading: str
    digits: int = 0
    shown: bool = True

    def text(self, cell: Cell) -> str:
        """Return a value as the report shows it."""
        if cell is None:
            return "–"
        if isinstance(cell, str):
            return cell
        return f"{cell:,.{self.digits}f}".replace("-", "−")


@dataclass(frozen=True)
class Table:
    """A table.

    Attributes
    ----------
    key : str
        Name of its files.
    title, caption : str
        What it is, and what it shows.
    columns : tuple of Column
    rows : tuple of tuple of Cell
        One value per column.
    """

    key: str
    title: str
    caption: str
    columns: tuple[Column, ...]
    rows: tuple[tuple[Cell, ...], ...]

    @property
    def shown_columns(self) -> list[Column]:
        """Columns that the report shows."""
        return [column for column in self.columns if column.shown]

    @property
    def shown_rows(self) -> list[list[tuple[Cell, str]]]:
        """Values of the columns that the report shows, each with its text."""
        return [
            [
                (cell, column.text(cell))
                for column, cell in zip(self.columns, row, strict=True)
                if column.shown
            ]
            for row in self.rows
        ]

    def records(self) -> list[dict[str, Cell]]:
        """Return each row as a mapping from column names to values."""
        names = [column.name for column in self.columns]
        return [dict(zip(names, row, strict=True)) for row in self.rows]

    def markdown(self) -> str:
        """Return the table in Markdown, its caption below."""
        headings = [column.heading for column in self.shown_columns]
        rows = [[text for _, text in row] for row in self.shown_rows]
        lines = [headings, ["---"] * len(headings), *rows]
        body = "\n".join(f"| {' | '.join(cells)} |" for cells in lines)
        return f"{body}\n\n{self.caption}\n"

    def save_csv(self, folder: Path) -> Path:
        """Write ``key``.csv with full precision, None as an empty field; return its path."""
        path = folder / f"{self.key}.csv"
        with atomic_write(path) as beside, beside.open("w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file)
            writer.writerow(column.name for column in self.columns)
            writer.writerows(self.rows)
        return path

    def save_markdown(self, folder: Path) -> Path:
        """Write :meth:`markdown` to ``key``.md; return its path."""
        path = folder / f"{self.key}.md"
        with atomic_write(path) as beside:
            beside.write_text(self.markdown(), encoding="utf-8")
        return path


def mean_cell(values: Sequence[float] | NDArray[np.number]) -> float | None:
    """Mean of values (n,); None where there are none."""
    return float(np.mean(values)) if len(values) else None


def sd_cell(values: NDArray[np.number]) -> float | None:
    """Sample standard deviation of values (n,); None where there are fewer than two."""
    return float(np.std(values, ddof=1)) if len(values) > 1 else None
