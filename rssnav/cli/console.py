"""Output of commands: tables and JSON on standard output, progress on standard error."""

import json
import math
import sys
import time
from collections.abc import Callable, Generator, Iterable, Sequence
from contextlib import contextmanager
from datetime import timedelta
from typing import Any

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.progress import (
    BarColumn,
    Progress,
    ProgressColumn,
    Task,
    TaskID,
    TaskProgressColumn,
    TextColumn,
)
from rich.table import Table
from rich.text import Text

from rssnav.experiments.progress import StageProgress
from rssnav.messages import printable

LINE_EVERY_S = 2.0
COMPILING_EVERY_S = 10.0
COMPILING = "compiling kernels (first use only)"


def print_table(columns: Sequence[str], rows: Iterable[Sequence[object]]) -> None:
    """Print a table; plain text without truncated or wrapped cells if not on a terminal.

    Parameters
    ----------
    columns
        Headings; ">" at the beginning right-aligns a column.
    rows
        Cells, converted by `str`.
    """
    cells = [[printable(str(cell)) for cell in row] for row in rows]
    console = Console()
    if console.is_terminal:
        console.print(_rich_table(columns, cells))
        return
    names = [column.removeprefix(">") for column in columns]
    widths = [max(map(len, column)) for column in zip(names, *cells, strict=True)]
    for row in (names, *cells):
        aligned = [
            cell.rjust(width) if column.startswith(">") else cell.ljust(width)
            for cell, width, column in zip(row, widths, columns, strict=True)
        ]
        print("  ".join(aligned).rstrip())


def _rich_table(columns: Sequence[str], rows: Iterable[Sequence[str]]) -> Table:
    table = Table(box=SIMPLE_HEAD, pad_edge=False)
    for column in columns:
        justify = "right" if column.startswith(">") else "left"
        table.add_column(Text(column.removeprefix(">")), justify=justify, no_wrap=True)
    for row in rows:
        table.add_row(*map(Text, row))
    return table


def print_pairs(pairs: Iterable[tuple[str, object]]) -> None:
    """Print names and values, a pair per line, with the values aligned."""
    pairs = list(pairs)
    width = max(len(name) for name, _ in pairs)
    for name, value in pairs:
        say(f"{name:<{width}}  {value}")


def print_json(value: Any) -> None:
    """Print strict JSON, with non-finite numbers as null and escapes for what cannot be shown."""
    text = json.dumps(_jsonable(value), indent=2, ensure_ascii=False, allow_nan=False)
    if printable(text) != text or not _can_encode(text):
        text = json.dumps(_jsonable(value), indent=2, allow_nan=False)
    print(text)


def _can_encode(text: str) -> bool:
    try:
        text.encode(sys.stdout.encoding or "utf-8")
    except UnicodeEncodeError:
        return False
    return True


def _jsonable(value: Any) -> Any:
    if isinstance(value, dict):
        return {str(key): _jsonable(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_jsonable(item) for item in value]
    if hasattr(value, "tolist"):
        return _jsonable(value.tolist())
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


def say(line: str) -> None:
    """Write a line to standard output, with escapes for characters that a terminal would obey."""
    print(printable(line))


def note(sentence: str) -> None:
    """Write a line to standard error."""
    print(printable(sentence), file=sys.stderr)


@contextmanager
def stage_progress() -> Generator[StageProgress]:
    """Show the progress of stages: bars on a terminal, otherwise a line every few seconds.

    Kernels that are compiled meanwhile are a stage of their own.
    """
    from raytrace.compilation import watched_compilation

    console = Console(stderr=True)
    if not console.is_terminal:
        lines = _Lines()
        with watched_compilation(lines.compiled):
            yield lines
        return
    with _bars(console) as progress:
        bars = _Bars(progress)
        with watched_compilation(bars.compiled):
            yield bars


@contextmanager
def one_progress(stage: str) -> Generator[Callable[[int, int], None]]:
    """Show the progress of a single stage; see `stage_progress`."""
    with stage_progress() as show:
        yield lambda done, total: show(stage, done, total)


def _bars(console: Console) -> Progress:
    return Progress(
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        TaskProgressColumn(),
        _Times(),
        console=console,
        transient=True,
    )


class _Times(ProgressColumn):
    """The time that has passed, and the time that is left where it can be told."""

    def render(self, task: Task) -> Text:
        passed, left = task.elapsed, task.time_remaining
        text = "" if passed is None else str(timedelta(seconds=int(passed)))
        if left is not None and not task.finished:
            text += f", {timedelta(seconds=int(left))} left"
        return Text(text)


class _Bars:
    """A bar per stage, of unknown length until the stage advances."""

    def __init__(self, progress: Progress) -> None:
        self._progress = progress
        self._waiting: TaskID | None = progress.add_task("preparing", total=None)
        self._tasks: dict[str, TaskID] = {}

    def __call__(self, stage: str, done: int, total: int) -> None:
        if self._waiting is not None and done > 0:
            self._progress.remove_task(self._waiting)
            self._waiting = None
        if stage not in self._tasks:
            self._tasks[stage] = self._progress.add_task(stage, total=None)
        self._progress.update(self._tasks[stage], completed=done, total=total if done > 0 else None)

    def compiled(self, count: int) -> None:
        """Show how many kernels are compiled, in place of "preparing"."""
        if self._waiting is None:
            self._waiting = self._progress.add_task(COMPILING, total=None)
        self._progress.update(self._waiting, description=f"{COMPILING}: {count}")


class _Lines:
    """A line per stage every few seconds, none for short stages."""

    def __init__(self) -> None:
        self._last_s: dict[str, float] = {}

    def __call__(self, stage: str, done: int, total: int) -> None:
        if self._is_due(stage):
            note(f"{stage}: {done} of {total} ({100 * done // max(total, 1)} %)")

    def compiled(self, count: int) -> None:
        """Say that kernels are compiled, and every few seconds how many are."""
        if COMPILING not in self._last_s:
            note(COMPILING)
            self._is_due(COMPILING)
        elif self._is_due(COMPILING, COMPILING_EVERY_S):
            note(f"{COMPILING}: {count}")

    def _is_due(self, stage: str, every_s: float = LINE_EVERY_S) -> bool:
        """Whether the last line of a stage, or its beginning, is long enough ago."""
        now_s = time.monotonic()
        last_s = self._last_s.setdefault(stage, now_s)
        if now_s - last_s < every_s:
            return False
        self._last_s[stage] = now_s
        return True
