"""Checks of single values: their types and ranges, wherever a plan comes from.

A plan read from a file has values of the right types already; one made in Python may hold anything.
Both are checked against the annotations of `UncheckedPlan` and of the classes it is made of.
"""

from __future__ import annotations

from collections.abc import Iterator, Sized
from dataclasses import is_dataclass
from functools import cache
from math import isfinite
from types import NoneType, UnionType
from typing import Any, Literal, NamedTuple, Union, get_args, get_origin, get_type_hints

import numpy as np

from floorplans.errors import Place, PlanError


class Range(NamedTuple):
    """Numbers that are allowed, ends included, and their unit."""

    least: float
    most: float
    unit: str = ""

    def __str__(self) -> str:
        """Write the range as messages state it."""
        unit = f" [{self.unit}]" if self.unit else ""
        return f"{self.least:g} to {self.most:g}{unit}"


COORDINATE = Range(-1e6, 1e6, "m")
"""Coordinates of a plan: at its ends, neighbouring numbers are 1e-10 m apart."""

LENGTH = Range(1e-9, 1000.0, "m")
"""Heights, thicknesses, and widths of openings."""

MAX_SIDE_M = 2000.0
"""Extent of a plan along x and y [m]."""

MAX_WALLS = 20_000
MAX_OPENINGS = 5000
MAX_CORNERS = 10_000
MAX_HOLES = 1000
MAX_MATERIALS = 200
MAX_LAYERS = 100


def check_number(number: float, allowed: Range, place: Place) -> None:
    """Raise `PlanError` for a number out of range."""
    if not allowed.least <= number <= allowed.most:
        raise PlanError(f"expected a finite number from {allowed}", place, number)


def check_count(items: Sized, most: int, place: Place) -> None:
    """Raise `PlanError` for a list that is too long."""
    if len(items) > most:
        raise PlanError(f"a list of {len(items)}; expected at most {most}", place)


def finite_number(value: object) -> float | None:
    """Return a value as a float; None if it is no number or not finite."""
    if isinstance(value, bool) or not isinstance(value, int | float | np.integer | np.floating):
        return None
    try:
        number = float(value)
    except OverflowError:  # an integer of hundreds of digits
        return None
    return number if isfinite(number) else None


def type_faults(value: object, hint: Any, place: Place = ()) -> Iterator[PlanError]:
    """Yield the values that do not have the annotated type, and numbers that are not finite.

    Parameters
    ----------
    value : object
    hint : type
        A dataclass or named tuple, whose fields are checked; ``float``, for any real number; a
        tuple, for which a list will do; a literal, a union, or another class.
    place : Place
        Of the value, for the messages.
    """
    origin, args = get_origin(hint), get_args(hint)
    if origin in (Union, UnionType):
        if value is not None or NoneType not in args:
            yield from type_faults(value, next(a for a in args if a is not NoneType), place)
    elif origin is tuple:
        yield from _tuple_faults(value, args, place)
    elif hint is float:
        if finite_number(value) is None:
            yield PlanError("expected a finite number", place, value)
    elif origin is Literal:
        if not isinstance(value, str) or value not in args:
            yield PlanError(f"expected one of {', '.join(args)}", place, value)
    elif not isinstance(value, hint):
        yield _wrong_type(value, hint.__name__, place)
    elif is_dataclass(hint) or hasattr(hint, "_fields"):
        for key, field_hint in _fields(hint).items():
            yield from type_faults(getattr(value, key), field_hint, (*place, key))


def _tuple_faults(value: object, args: tuple[Any, ...], place: Place) -> Iterator[PlanError]:
    if not isinstance(value, tuple | list):
        yield _wrong_type(value, "tuple", place)
        return
    hints = args[:1] * len(value) if args[-1] is Ellipsis else args
    if len(hints) != len(value):
        yield PlanError(f"expected {len(hints)} values", place, value)
        return
    if all(hint is float for hint in hints) and all(
        type(x) is float and isfinite(x) for x in value
    ):
        return
    for index, (item, hint) in enumerate(zip(value, hints, strict=True)):
        yield from type_faults(item, hint, (*place, index))


def _wrong_type(value: object, expected: str, place: Place) -> PlanError:
    return PlanError(f"expected {expected}, not {type(value).__name__}", place, value)


@cache
def _fields(kind: type) -> dict[str, Any]:
    return get_type_hints(kind)
