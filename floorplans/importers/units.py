"""Units of length, and which one a drawing is in when it does not say."""

from __future__ import annotations

from collections.abc import Sequence
from statistics import median

from floorplans.errors import PlanError, unknown_name

UNITS: dict[str, float] = {
    "mm": 0.001,
    "cm": 0.01,
    "dm": 0.1,
    "m": 1.0,
    "km": 1000.0,
    "in": 0.0254,
    "ft": 0.3048,
    "yd": 0.9144,
}
"""Length of each unit [m]."""

BUILDING_M = (3.0, 1000.0)
"""Longer sides that a storey can have [m]."""

_USUAL_M = (4.0, 300.0)
_DOOR_M = (0.5, 1.3)
_GUESSED = ("mm", "cm", "m", "in", "ft")


def unit_length(unit: str) -> float:
    """Length of a unit the user names [m]."""
    if unit not in UNITS:
        raise PlanError(unknown_name("unit", unit, tuple(UNITS)), ("unit",), unit)
    return UNITS[unit]


def check_size(size: tuple[float, float], unit: str, said_by: str) -> None:
    """Refuse a drawing whose unit makes it no building.

    Parameters
    ----------
    size : (float, float)
        Width and depth in the drawing's unit.
    unit : str
    said_by : str
        Who says that this is its unit.
    """
    low_m, high_m = BUILDING_M
    if low_m <= max(size) * UNITS[unit] <= high_m:
        return
    fitting = [other for other in _GUESSED if _fits(max(size) * UNITS[other], _USUAL_M)]
    raise PlanError(
        f"in {unit}, as {said_by}, the walls cover {_size_text(size, unit)}, which is no building; "
        f"{_proposal(size, fitting)}",
        ("unit",),
        unit,
        remedy="unit",
    )


def guess_unit(size: tuple[float, float], door_widths: Sequence[float]) -> str:
    """Unit of a drawing from its size and its doors, if only one can be meant.

    Parameters
    ----------
    size : (float, float)
        Width and depth in the drawing's unit.
    door_widths : sequence of float
        Radii of door swings in the drawing's unit; may be empty.

    Raises
    ------
    PlanError
        When no unit makes it a building, or several do.
    """
    fitting = [unit for unit in _GUESSED if _fits(max(size) * UNITS[unit], _USUAL_M)]
    if door_widths:
        width = median(door_widths)
        by_door = [unit for unit in fitting if _fits(width * UNITS[unit], _DOOR_M)]
        fitting = by_door or fitting
    if len(fitting) == 1:
        return fitting[0]
    raise PlanError(
        f"the drawing does not tell its unit, and {'several' if fitting else 'none'} would make "
        f"it a building; {_proposal(size, fitting)}",
        ("unit",),
        remedy="unit",
    )


def _fits(value: float, span: tuple[float, float]) -> bool:
    return span[0] <= value <= span[1]


def _proposal(size: tuple[float, float], fitting: Sequence[str]) -> str:
    """Say what each unit would make of the drawing."""
    if not fitting:
        return f"give the unit, one of {', '.join(UNITS)}"
    choices = [f"{unit} for {_size_text(size, unit)}" for unit in fitting]
    return f"give the unit: {' or '.join(choices)}"


def _size_text(size: tuple[float, float], unit: str) -> str:
    width_m, depth_m = (side * UNITS[unit] for side in size)
    if max(width_m, depth_m) >= 1000:
        return f"{width_m / 1000:.3g} km x {depth_m / 1000:.3g} km"
    return f"{width_m:.3g} m x {depth_m:.3g} m"
