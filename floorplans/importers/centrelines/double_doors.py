"""Leaves of double doors, joined to one opening."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import hypot, radians, sin

from floorplans.importers.draft import RawOpening
from floorplans.repair.geometry import along_across, direction
from floorplans.walls import Opening, Point, Wall

LEAF_GAP_M = 0.15
"""Openings of one kind nearer than this are one [m]."""


_BENT_SINE = sin(radians(3.0))
"""Sine of the largest angle between two leaves; windows of a curved wall are not joined."""


def same_kind(a: RawOpening | Opening, b: RawOpening | Opening) -> bool:
    """Whether two openings have the same kind, heights and filling."""
    return _kind(a) == _kind(b)


def _kind(opening: RawOpening | Opening) -> tuple[object, ...]:
    return (opening.kind, opening.sill_m, opening.head_m, opening.material, opening.thickness_m)


def join_leaves(openings: Sequence[RawOpening]) -> list[RawOpening]:
    """Join openings of one kind that lie next to each other, as the leaves of double doors do.

    Parameters
    ----------
    openings : sequence of RawOpening
        Those of unknown direction stay as they are.
    """
    joined: list[RawOpening] = []
    for opening in openings:
        new = opening
        for other in [*joined]:
            both = _joined(new, other)
            if both is not None:
                joined.remove(other)
                new = both
        joined.append(new)
    return joined


def _joined(a: RawOpening, b: RawOpening) -> RawOpening | None:
    """One opening in place of two that lie next to each other; None where they do not."""
    if a.direction is None or b.direction is None or not same_kind(a, b):
        return None
    along = Wall(a.centre, _step_along(a.centre, a.direction), "", 1.0, 1.0)
    s, across = along_across(along, b.centre)
    reach_m = (a.width_m + b.width_m) / 2
    if (
        abs(_sine(direction(along), b.direction)) > _BENT_SINE
        or abs(across) > LEAF_GAP_M
        or abs(s) > reach_m + LEAF_GAP_M
    ):
        return None
    low = min(-a.width_m, 2 * s - b.width_m) / 2
    high = max(a.width_m, 2 * s + b.width_m) / 2
    return replace(a, centre=along.point_at((low + high) / 2), width_m=high - low)


def _sine(a: Point, b: Point) -> float:
    return (a[0] * b[1] - a[1] * b[0]) / (hypot(*a) * hypot(*b))


def _step_along(point: Point, along: Point) -> Point:
    length = hypot(*along)
    return (point[0] + along[0] / length, point[1] + along[1] / length)
