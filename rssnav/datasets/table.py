"""A table of a spec: each key is known, of its type and within its range, and none is left over."""

from __future__ import annotations

import difflib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rssnav.arguments import is_finite
from rssnav.datasets.errors import DatasetError

_REQUIRED: Any = object()


@dataclass(frozen=True)
class Table:
    """A table of a TOML file that is not trusted.

    Attributes
    ----------
    path
        The file, for messages.
    name
        Of the table, empty for the top level.
    values
        As they were read.
    """

    path: Path
    name: str
    values: Mapping[str, Any]

    def error(self, key: str, expected: str) -> DatasetError:
        """Return an error that names file, key and value."""
        found = f" = {_short(self.values[key])}" if key in self.values else ": missing"
        return DatasetError(f"{self._at(key)}{found}, expected {expected}", self.path)

    def _at(self, key: str) -> str:
        return f"{self.name}.{key}" if self.name else key

    def only(self, *known: str) -> Table:
        """Return the table; refuse a key that is not known."""
        for key in self.values:
            if key not in known:
                near = difflib.get_close_matches(key, known, 1)
                expected = f"did you mean {near[0]}?" if near else f"expected {', '.join(known)}"
                raise DatasetError(f"unknown key {self._at(key)}: {expected}", self.path)
        return self

    def table(self, key: str) -> Table:
        """Return a table within; an empty one where there is none."""
        value = self.values.get(key, {})
        if not isinstance(value, Mapping):
            raise self.error(key, f"a table [{self._at(key)}]")
        return Table(self.path, self._at(key), value)

    def tables(self, key: str) -> list[Table]:
        """Return an array of tables, at least one."""
        value = self.values.get(key)
        if not isinstance(value, list) or not value or not all(isinstance(v, dict) for v in value):
            raise self.error(key, f"one or more tables [[{self._at(key)}]]")
        return [Table(self.path, f"{self._at(key)}[{k}]", v) for k, v in enumerate(value)]

    def text(self, key: str, default: Any = _REQUIRED, most: int = 10_000) -> Any:
        """Return a text."""
        if key not in self.values and default is not _REQUIRED:
            return default
        value = self.values.get(key)
        if not isinstance(value, str) or not value.strip() or len(value) > most:
            raise self.error(key, f"a text of at most {most} characters")
        return value

    def flag(self, key: str, default: bool) -> bool:
        """Return a boolean."""
        value = self.values.get(key, default)
        if not isinstance(value, bool):
            raise self.error(key, "true or false")
        return value

    def integer(self, key: str, low: int, high: int, default: Any = _REQUIRED) -> Any:
        """Return an integer within a range."""
        if key not in self.values and default is not _REQUIRED:
            return default
        value = self.values.get(key)
        if isinstance(value, bool) or not isinstance(value, int) or not low <= value <= high:
            raise self.error(key, f"an integer from {low} to {high}")
        return value

    def number(self, key: str, low: float, high: float, default: Any = _REQUIRED) -> Any:
        """Return a number within a range."""
        if key not in self.values and default is not _REQUIRED:
            return default
        if not _is_number(self.values.get(key), low, high):
            raise self.error(key, f"a number from {low:g} to {high:g}")
        return float(self.values[key])

    def numbers(
        self, key: str, low: float, high: float, default: Sequence[float]
    ) -> tuple[float, ...]:
        """Return different numbers within a range, at least one."""
        values = self.values.get(key, list(default))
        if (
            not isinstance(values, list)
            or not values
            or not all(_is_number(v, low, high) for v in values)
            or len(set(values)) < len(values)
        ):
            raise self.error(key, f"a list of different numbers from {low:g} to {high:g}")
        return tuple(map(float, values))

    def texts(
        self, key: str, default: Sequence[str], known: Sequence[str] | None = None
    ) -> tuple[str, ...]:
        """Return different texts, at least one."""
        values = self.values.get(key, list(default))
        is_list = isinstance(values, list) and values
        if not is_list or not all(isinstance(v, str) and v.strip() for v in values):
            raise self.error(key, "a list of texts")
        if len(set(values)) < len(values):
            raise self.error(key, "each only once")
        if known is not None and not set(values) <= set(known):
            raise self.error(key, f"some of {', '.join(known)}")
        return tuple(values)


def _is_number(value: Any, low: float, high: float) -> bool:
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    return is_number and is_finite(value) and low <= value <= high


def _short(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:60]}..."
