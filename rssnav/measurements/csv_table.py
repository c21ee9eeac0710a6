"""CSV files with a heading, read strictly: each value is located by its row and its column."""

from __future__ import annotations

import csv
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from raytrace.arrays import Floats
from rssnav.measurements.survey import SurveyError

MAX_ROWS = 1_000_000
MAX_CELL = 200
MAX_CHARACTERS = 100_000_000


@dataclass(frozen=True)
class CsvTable:
    """The rows of a file, and the names of its columns.

    Attributes
    ----------
    path
        The file.
    columns
        Names of its columns.
    rows
        Its cells without surrounding blanks, as many in each row as there are columns.
    numbers
        Row of the file of each, 1 for the heading.
    """

    path: Path
    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    numbers: tuple[int, ...]

    def __len__(self) -> int:
        """Number of rows below the heading."""
        return len(self.rows)

    def texts(self, column: str) -> list[str]:
        """Return the cells of a column."""
        at = self.columns.index(column)
        return [row[at] for row in self.rows]

    def error(self, k: int, column: str, problem: str) -> SurveyError:
        """Return the error that says what is wrong in a column of row `k` below the heading."""
        value = self.texts(column)[k]
        return SurveyError(problem, self.path, self.numbers[k], column, value)

    def floats(
        self,
        column: str,
        expected: str = "a finite number",
        holds: Callable[[float], bool] = math.isfinite,
    ) -> Floats:
        """Return a column (n,) of finite numbers.

        Parameters
        ----------
        column
            Its name.
        expected, holds
            What a number must be, in words and as a test.

        Raises
        ------
        SurveyError
            For the first cell that is none.
        """
        found: list[float] = []
        for k, text in enumerate(self.texts(column)):
            try:
                number = float(text)
            except ValueError:
                number = math.nan
            if not (math.isfinite(number) and holds(number)):
                raise self.error(k, column, f"expected {expected}")
            found.append(number)
        return np.array(found, dtype=np.float64)


def read_table(path: Path, required: Sequence[str], optional: Sequence[str]) -> CsvTable:
    """Read a CSV file with a heading.

    Parameters
    ----------
    path
        The file, in UTF-8; lines that are blank or begin with # are skipped.
    required, optional
        Names of columns, in any order.

    Raises
    ------
    SurveyError
        For a file that is no such table.
    OSError
        Where it cannot be read.
    """
    try:
        with path.open(encoding="utf-8-sig") as file:
            text = file.read(MAX_CHARACTERS + 1)
    except UnicodeDecodeError as error:
        raise SurveyError("not a text file in UTF-8: expected CSV", path) from error
    if len(text) > MAX_CHARACTERS:
        raise SurveyError(f"more than {MAX_CHARACTERS} characters: give a part of them", path)
    if "\0" in text:
        raise SurveyError("holds a NUL character: expected CSV", path)
    lines = csv.reader(text.splitlines(), strict=True)
    heading: tuple[str, ...] = ()
    rows: list[tuple[str, ...]] = []
    numbers: list[int] = []
    try:
        for cells in lines:
            row = tuple(cell.strip() for cell in cells)
            if not any(row) or row[0].startswith("#"):
                continue
            if not heading:
                heading = _checked_heading(path, lines.line_num, row, required, optional)
                continue
            _check_row(path, lines.line_num, row, heading)
            rows.append(row)
            numbers.append(lines.line_num)
            if len(rows) > MAX_ROWS:
                raise SurveyError(f"more than {MAX_ROWS} rows: give a part of them", path)
    except csv.Error as error:
        raise SurveyError(f"not CSV: {error}", path, lines.line_num) from error
    if not rows:
        columns = ", ".join(required)
        raise SurveyError(f"no readings: expected the columns {columns} and a row for each", path)
    return CsvTable(path, heading, tuple(rows), tuple(numbers))


def _checked_heading(
    path: Path, number: int, row: tuple[str, ...], required: Sequence[str], optional: Sequence[str]
) -> tuple[str, ...]:
    """Return the names of the columns: all required ones, no unknown or repeated one."""
    wanted = f"expected the columns {', '.join(required)}"
    if optional:
        wanted += f" and optionally {', '.join(optional)}"
    if len(row) == 1 and ";" in row[0]:
        raise SurveyError("columns separated by semicolons: expected commas", path, number)
    for name in row:
        if name not in (*required, *optional):
            raise SurveyError(f"unknown column {name[:60]!r}: {wanted}", path, number)
        if row.count(name) > 1:
            raise SurveyError(f"the column {name} stands there twice", path, number)
    for name in required:
        if name not in row:
            raise SurveyError(f"no column {name}: {wanted}", path, number)
    return row


def _check_row(path: Path, number: int, row: tuple[str, ...], heading: tuple[str, ...]) -> None:
    if len(row) != len(heading):
        problem = f"{len(row)} values: expected {len(heading)}, as in the heading"
        raise SurveyError(problem, path, number)
    for name, cell in zip(heading, row, strict=True):
        if len(cell) > MAX_CELL:
            raise SurveyError(f"more than {MAX_CELL} characters", path, number, name, cell)
