"""Tools of the repair: changes, and walls moved with their openings."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from math import hypot

import numpy as np
import shapely
from numpy.typing import NDArray

from floorplans.walls import TOLERANCE_M, Opening, Point, Wall, centre_lines

DECIMALS = 10
"""Coordinates are rounded to 1e-10 m: a wall that ends on an oblique one then also ends on it for a
tracer, which distinguishes points more than 1e-8 m apart."""

MIN_SINE = 1e-3
"""Sine of the smallest angle at which two walls cross."""


@dataclass(frozen=True)
class Change:
    """One change that a repair made.

    Attributes
    ----------
    kind : str
        "moved", "joined", "cut", "dropped", "closed" or "raised".
    text : str
        What was done.
    at : (float, float)
        Where, (x, y) [m].
    to : (float, float) or None
        The other end of the change [m].
    """

    kind: str
    text: str
    at: Point
    to: Point | None = None

    def __str__(self) -> str:
        """Say where it is, and what was done."""
        where = at_text(self.at) if self.to is None else f"{at_text(self.at)} to {at_text(self.to)}"
        return f"{where}: {self.text}"


def at_text(point: Point) -> str:
    """Write a point to the millimetre.

    Examples
    --------
    >>> at_text((1.0, -0.0))
    '(1, 0)'
    """
    x, y = (round(coordinate, 3) + 0.0 for coordinate in point)
    return f"({x:g}, {y:g})"


def tidy_point(x: float, y: float) -> Point:
    """Round a point to 1e-10 m."""
    return (round(float(x), DECIMALS) + 0.0, round(float(y), DECIMALS) + 0.0)


def direction(wall: Wall) -> Point:
    """Unit vector from a wall's start to its end; (0, 0) for a wall of no length."""
    (x0, y0), (x1, y1) = wall.start, wall.end
    length = hypot(x1 - x0, y1 - y0) or 1.0
    return ((x1 - x0) / length, (y1 - y0) / length)


def along_across(wall: Wall, point: Point) -> tuple[float, float]:
    """Coordinates of a point along a wall's line from its start, and to its left [m]."""
    ux, uy = direction(wall)
    x, y = point[0] - wall.start[0], point[1] - wall.start[1]
    return (x * ux + y * uy, ux * y - uy * x)


def moved_wall(parts: Sequence[Wall], start: Point, end: Point) -> Wall:
    """Create a wall between two points like the first of `parts`, with the openings of all.

    Openings keep their place in the plan where the new wall covers it; of two that would overlap,
    that of the earlier part stays.
    """
    bare = replace(parts[0], start=start, end=end, openings=())
    if not any(part.openings for part in parts):
        return bare
    openings: list[Opening] = []
    for part in parts:
        for moved in _moved_openings(part, bare):
            if not any(moved.overlaps(other) for other in openings):
                openings.append(moved)
    return replace(bare, openings=tuple(sorted(openings, key=lambda o: (o.offset_m, o.sill_m))))


def _moved_openings(part: Wall, bare: Wall) -> Iterable[Opening]:
    """Openings of `part` in the coordinates of `bare`, cut to its length."""
    for opening in part.openings:
        sides = (part.point_at(opening.offset_m), part.point_at(opening.end_m))
        low, high = sorted(along_across(bare, side)[0] for side in sides)
        low, high = max(low, 0.0), min(high, bare.length_m)
        if abs(low - opening.offset_m) < TOLERANCE_M and abs(high - opening.end_m) < TOLERANCE_M:
            yield opening
        elif high - low > TOLERANCE_M and 2 * (high - low) >= opening.width_m:
            low, high = round(low, DECIMALS), round(high, DECIMALS)
            yield replace(opening, offset_m=low, width_m=high - low)


def points_on_walls(walls: Sequence[Wall]) -> list[list[float]]:
    """Where others end on or cross each wall, as distances along it [m]."""
    lines = centre_lines(walls)
    first, second = shapely.STRtree(lines).query(lines, predicate="dwithin", distance=TOLERANCE_M)
    first, second = (x[first != second] for x in (first, second))
    start, end = np.array([(w.start, w.end) for w in walls]).reshape(-1, 2, 2).transpose(1, 0, 2)
    step = end - start
    length = np.hypot(step[:, 0], step[:, 1])
    unit = step / np.where(length > 0, length, 1.0)[:, None]
    cuts: list[list[float]] = [[] for _ in walls]

    def add(s: NDArray[np.float64], on: NDArray[np.bool_]) -> None:
        for i, at in zip(first[on].tolist(), s[on].tolist(), strict=True):
            cuts[i].append(at)

    for point in (start[second], end[second]):
        s, across = _along(unit[first], point - start[first])
        add(s, (np.abs(across) <= TOLERANCE_M) & (s > 0) & (s < length[first]))
    _, sine = _along(unit[first], unit[second])
    apart = start[second] - start[first]
    crossing = np.abs(sine) >= MIN_SINE
    with np.errstate(divide="ignore", invalid="ignore"):
        s = _along(unit[second], apart)[1] / -sine
        t = _along(unit[first], apart)[1] / -sine
    add(s, crossing & (s > 0) & (s < length[first]) & (t > 0) & (t < length[second]))
    return cuts


def _along(
    unit: NDArray[np.float64], vector: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Components of vectors (n, 2) along unit vectors, and to their left."""
    (u_x, u_y), (x, y) = unit.T, vector.T
    return x * u_x + y * u_y, u_x * y - u_y * x


def line_crossing(a: Wall, b: Wall, min_sine: float = MIN_SINE) -> Point | None:
    """Where the lines of two walls cross; None if the sine of their angle is below a limit."""
    (ux, uy), (vx, vy) = direction(a), direction(b)
    sine = ux * vy - uy * vx
    if abs(sine) < min_sine:
        return None
    x, y = b.start[0] - a.start[0], b.start[1] - a.start[1]
    s = (x * vy - y * vx) / sine
    return (a.start[0] + s * ux, a.start[1] + s * uy)
