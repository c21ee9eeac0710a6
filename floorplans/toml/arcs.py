"""Arcs of walls -> chords."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import pairwise
from math import acos, atan2, ceil, cos, hypot, pi, sin

from floorplans.errors import Place, PlanError
from floorplans.walls import TOLERANCE_M, Point

CHORD_M = 0.02
"""Largest deviation of chords from an arc [m]."""
MAX_CHORDS = 180
"""Most chords of one arc."""

_DECIMALS = 6


def chords_of_arc(start: Point, through: Point, end: Point, place: Place) -> list[Point]:
    """Points on an arc whose chords deviate from it by at most `CHORD_M`, ends included.

    Parameters
    ----------
    start, through, end : (float, float)
        Three points of the arc, in order (x, y) [m].
    place : Place
        Of the arc in the file, for messages.

    Raises
    ------
    PlanError
        When the points lie on one line, or the arc needs more than `MAX_CHORDS`.
    """
    (x, y), radius = _circle(start, through, end, place)
    first, middle, last = (atan2(p[1] - y, p[0] - x) for p in (start, through, end))
    sweep = (last - first) % (2 * pi)
    if (middle - first) % (2 * pi) > sweep:
        sweep -= 2 * pi
    count = ceil(abs(sweep) / (2 * acos(max(1 - CHORD_M / radius, 0.5))))
    if count > MAX_CHORDS:
        raise PlanError(
            f"an arc of radius {radius:.4g} m has {count} chords; expected at most {MAX_CHORDS}, "
            "so divide it",
            place,
            list(through),
        )
    angles = (first + sweep * k / count for k in range(1, count))
    inner = [(x + radius * cos(angle), y + radius * sin(angle)) for angle in angles]
    return [start, *((round(px, _DECIMALS), round(py, _DECIMALS)) for px, py in inner), end]


def along_arcs(ring: list[Point], arcs: Iterable[list[Point]]) -> list[Point]:
    """Ring whose sides between the ends of an arc follow its chords."""
    chords = {ends: arc for arc in arcs for ends in ((arc[0], arc[-1]),)}
    chords |= {(end, start): arc[::-1] for (start, end), arc in chords.items()}
    sides = (chords.get(side, list(side)) for side in pairwise(ring))
    return [*ring[:1], *(point for side in sides for point in side[1:])]


def _circle(a: Point, b: Point, c: Point, place: Place) -> tuple[Point, float]:
    """Centre and radius of the circle through three points."""
    (bx, by), (cx, cy) = ((p[0] - a[0], p[1] - a[1]) for p in (b, c))
    twice_area = bx * cy - by * cx
    if abs(twice_area) <= TOLERANCE_M * max(hypot(bx, by), hypot(cx, cy), TOLERANCE_M):
        raise PlanError(
            "expected a point of the arc beside the line from its start to its end; a straight "
            "wall needs no arc",
            place,
            list(b),
        )
    b2, c2 = bx * bx + by * by, cx * cx + cy * cy
    ux, uy = (cy * b2 - by * c2) / (2 * twice_area), (bx * c2 - cx * b2) / (2 * twice_area)
    return (a[0] + ux, a[1] + uy), hypot(ux, uy)
