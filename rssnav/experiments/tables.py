"""Tables: values with full precision for CSV files, rounded ones for people."""

from __future__ import annotations

import csv
from dataclasses import dataclass
from pathlib import Path

from atomicfiles import atomic_write

Cell = str | int | float | None
"""A value of a table; None where there is none."""


@dataclass(frozen=True)
class Column:
    """A column of a table.

    Attributes
    ----------
    name : str
        Name in the CSV file, with its unit.
    heading : str
        Name for people, with its unit.
    digits : int
        Digits after the decimal point that people see.
    shown : bool
        Whether people see it, or only the CSV file has it.
    """

    name: str
    heading: str
    digits: int = 0
    shown: bool = True

    def text(self, cell: Cell) -> str:
        """Return a value as people see it."""
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
        Name for files.
    title, caption : str
        What it is, and what one sees in it.
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
        """Columns that people see."""
        return [column for column in self.columns if column.shown]

    @property
    def shown_rows(self) -> list[list[tuple[Cell, str]]]:
        """Values of the columns that people see, each with its text."""
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

    def save_csv(self, folder: Path) -> None:
        """Write ``key``.csv with full precision; a value that is not there is an empty field."""
        with (
            atomic_write(folder / f"{self.key}.csv") as beside,
            beside.open("w", newline="", encoding="utf-8") as file,
        ):
            writer = csv.writer(file)
            writer.writerow(column.name for column in self.columns)
            writer.writerows(self.rows)
