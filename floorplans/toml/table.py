"""Typed reading of TOML tables: each value is checked when it is read."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import cast

from floorplans.errors import Place, PlanError, unknown_name
from floorplans.values import COORDINATE, check_number, finite_number


@dataclass(frozen=True)
class Table:
    """One TOML table and the keys its format allows.

    Attributes
    ----------
    data : mapping of str to object
        The table as `tomllib` returns it.
    known : tuple of str
        Allowed keys; any other key raises `PlanError`.
    place : Place
        Its place in the file, for messages.
    """

    data: Mapping[str, object]
    known: tuple[str, ...]
    place: Place = ()

    def __post_init__(self) -> None:
        for key in self.data:
            if key not in self.known:
                raise PlanError(unknown_name("key", key, self.known), (*self.place, key))

    def number(self, key: str, default: float | None = None) -> float:
        """Return a finite number; a missing key gives the default, if there is one."""
        if key not in self.data and default is not None:
            return default
        return _number(self._required(key, "a number"), (*self.place, key))

    def optional_number(self, key: str) -> float | None:
        """Return a finite number, or None if the key is missing."""
        return self.number(key) if key in self.data else None

    def text(self, key: str, default: str | None = None) -> str:
        """Return a string; a missing key gives the default, if there is one."""
        if key not in self.data and default is not None:
            return default
        value = self._required(key, "a string")
        if not isinstance(value, str):
            raise _wrong_type("a string", value, (*self.place, key))
        return value

    def optional_text(self, key: str) -> str | None:
        """Return a string, or None if the key is missing."""
        return self.text(key) if key in self.data else None

    def coordinates(self, key: str, names: str) -> tuple[float, ...]:
        """Return one number for each letter of `names`, such as "xyz" [m]."""
        expected = f"[{', '.join(names)}]"
        return _coordinates(self._required(key, expected), names, (*self.place, key))

    def optional_xyz(self, key: str) -> tuple[float, float, float] | None:
        """Return a point or vector (x, y, z), or None if the key is missing."""
        if key not in self.data:
            return None
        x, y, z = self.coordinates(key, "xyz")
        return x, y, z

    def optional_xy(self, key: str) -> tuple[float, float] | None:
        """Return a point (x, y) [m], or None if the key is missing."""
        if key not in self.data:
            return None
        x, y = self.coordinates(key, "xy")
        return x, y

    def points(self, key: str) -> list[tuple[float, float]]:
        """Return a list of points (x, y) [m]."""
        value = self._required(key, "a list of points [x, y]")
        return as_points(value, (*self.place, key))

    def items(self, key: str) -> list[object]:
        """Return a list, empty if the key is missing."""
        return _list(self.data.get(key, []), "a list", (*self.place, key))

    def tables(self, key: str, known: tuple[str, ...]) -> list[Table]:
        """Return an array of tables, empty if the key is missing."""
        return [
            as_table(item, known, (*self.place, key, index))
            for index, item in enumerate(self.items(key))
        ]

    def table(self, key: str, known: tuple[str, ...]) -> Table:
        """Return a table, empty if the key is missing."""
        return as_table(self.data.get(key, {}), known, (*self.place, key))

    def _required(self, key: str, expected: str) -> object:
        if key not in self.data:
            raise PlanError(f"the key is missing; expected {expected}", (*self.place, key))
        return self.data[key]


def as_table(value: object, known: tuple[str, ...] | None, place: Place) -> Table:
    """Return a value as a table; raise `PlanError` if it is not one. None allows any keys."""
    if not isinstance(value, dict):
        raise _wrong_type("a table", value, place)
    data = cast("dict[str, object]", value)
    return Table(data, tuple(data) if known is None else known, place)


def as_points(value: object, place: Place) -> list[tuple[float, float]]:
    """Return a value as a list of points (x, y) [m]; raise `PlanError` if it is not one."""
    points = _list(value, "a list of points [x, y]", place)
    pairs = (_coordinates(point, "xy", (*place, index)) for index, point in enumerate(points))
    return [(x, y) for x, y in pairs]


def _coordinates(value: object, names: str, place: Place) -> tuple[float, ...]:
    expected = f"[{', '.join(names)}]"
    numbers = _list(value, expected, place)
    if len(numbers) != len(names):
        raise PlanError(f"expected {len(names)} numbers {expected} [m]", place, value)
    found = [_number(number, (*place, index)) for index, number in enumerate(numbers)]
    for index, number in enumerate(found):
        check_number(number, COORDINATE, (*place, index))
    return tuple(found)


def _list(value: object, expected: str, place: Place) -> list[object]:
    if not isinstance(value, list):
        raise _wrong_type(expected, value, place)
    return cast("list[object]", value)


def _number(value: object, place: Place) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise _wrong_type("a number", value, place)
    number = finite_number(value)
    if number is None:
        raise PlanError("expected a finite number", place, value)
    return number


def _wrong_type(expected: str, value: object, place: Place) -> PlanError:
    names: dict[type, str] = {bool: "a boolean", int: "a number", float: "a number"}
    names |= {str: "a string", list: "a list", dict: "a table"}
    return PlanError(
        f"expected {expected}, not {names.get(type(value), 'a date or time')}", place, value
    )
