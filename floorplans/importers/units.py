"""Units of length, and the likely unit of a drawing that does not state one."""

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
"""Range of a storey's longer side [m]."""

_COMMON_SIZE_M = (4.0, 300.0)
_DOOR_M = (0.5, 1.3)
_COMMON_UNITS = ("mm", "cm", "m", "in", "ft")


def unit_length(unit: str) -> float:
    """Length of a unit that the user gives [m]."""
    if unit not in UNITS:
        raise PlanError(unknown_name("unit", unit, tuple(UNITS)), ("unit",), unit)
    return UNITS[unit]


def check_size(size: tuple[float, float], unit: str, stated_by: str) -> None:
    """Reject a unit in which the drawing is too large or too small for a building.

    Parameters
    ----------
    size : (float, float)
        Width and depth in the drawing's unit.
    unit : str
    stated_by : str
        Who states this unit, for the message.
    """
    low_m, high_m = BUILDING_M
    if low_m <= max(size) * UNITS[unit] <= high_m:
        return
    candidates = _plausible_units(size)
    raise PlanError(
        f"in {unit}, as {stated_by}, the walls cover {_size_text(size, unit)}, too large or too "
        f"small for a building; {_proposal(size, candidates)}",
        ("unit",),
        unit,
        remedy="unit",
    )


def guess_unit(size: tuple[float, float], door_widths: Sequence[float]) -> str:
    """Infer the unit of a drawing from its size and its doors.

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
    candidates = _plausible_units(size)
    if door_widths:
        width = median(door_widths)
        by_door = [unit for unit in candidates if _fits(width * UNITS[unit], _DOOR_M)]
        candidates = by_door or candidates
    if len(candidates) == 1:
        return candidates[0]
    raise PlanError(
        f"the drawing does not state its unit, and {'several' if candidates else 'none'} would "
        f"make it a building; {_proposal(size, candidates)}",
        ("unit",),
        remedy="unit",
    )


def _fits(value: float, span: tuple[float, float]) -> bool:
    return span[0] <= value <= span[1]


def _plausible_units(size: tuple[float, float]) -> list[str]:
    return [unit for unit in _COMMON_UNITS if _fits(max(size) * UNITS[unit], _COMMON_SIZE_M)]


def _proposal(size: tuple[float, float], candidates: Sequence[str]) -> str:
    """Write the size of the drawing in each candidate unit."""
    if not candidates:
        return f"give the unit, one of {', '.join(UNITS)}"
    choices = [f"{unit} for {_size_text(size, unit)}" for unit in candidates]
    return f"give the unit: {' or '.join(choices)}"


def _size_text(size: tuple[float, float], unit: str) -> str:
    width_m, depth_m = (side * UNITS[unit] for side in size)
    if max(width_m, depth_m) >= 1000:
        return f"{width_m / 1000:.3g} km x {depth_m / 1000:.3g} km"
    return f"{width_m:.3g} m x {depth_m:.3g} m"
