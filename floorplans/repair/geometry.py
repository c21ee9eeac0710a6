"""Tools of the repair: changes, and walls moved with their openings."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from math import hypot

import shapely

from floorplans.walls import TOLERANCE_M, Opening, Point, Wall, centre_lines

DECIMALS = 10
"""Coordinates are rounded to 1e-10 m: a wall that ends on an oblique one then also ends on it for a
tracer, which distinguishes points more than 1e-8 m apart."""


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
    cuts: list[list[float]] = [[] for _ in walls]
    first, second = shapely.STRtree(lines).query(lines, predicate="dwithin", distance=TOLERANCE_M)
    for i, j in zip(first.tolist(), second.tolist(), strict=True):
        if i == j:
            continue
        for end in (walls[j].start, walls[j].end):
            s, across = along_across(walls[i], end)
            if abs(across) <= TOLERANCE_M and 0 < s < walls[i].length_m:
                cuts[i].append(s)
        crossing = line_crossing(walls[i], walls[j])
        if crossing is not None:
            s = along_across(walls[i], crossing)[0]
            t = along_across(walls[j], crossing)[0]
            if 0 < s < walls[i].length_m and 0 < t < walls[j].length_m:
                cuts[i].append(s)
    return cuts


def line_crossing(a: Wall, b: Wall, min_sine: float = 1e-3) -> Point | None:
    """Where the lines of two walls cross; None if the sine of their angle is below a limit."""
    (ux, uy), (vx, vy) = direction(a), direction(b)
    sine = ux * vy - uy * vx
    if abs(sine) < min_sine:
        return None
    x, y = b.start[0] - a.start[0], b.start[1] - a.start[1]
    s = (x * vy - y * vx) / sine
    return (a.start[0] + s * ux, a.start[1] + s * uy)
