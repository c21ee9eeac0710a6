"""Walls and their openings, and the solid parts that remain of a wall.

A wall stands on the floor, on a straight centre line. A point of it has the coordinates s, the
distance from its start along the centre line, and z, the height above the floor, both in metres.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import hypot
from typing import Literal, NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray

OpeningKind = Literal["door", "window", "passage"]
WallKind = Literal["wall", "clutter"]

TOLERANCE_M = 1e-6
"""Points nearer than this are the same point [m]."""

Point = tuple[float, float]
Interval = tuple[float, float]


@dataclass(frozen=True)
class Opening:
    """A rectangular hole in a wall, open or filled with another sheet of material.

    Attributes
    ----------
    offset_m : float
        From the wall's start, along it, to the near side of the opening [m].
    width_m : float
        Along the wall [m].
    sill_m, head_m : float
        Heights of the lower and the upper edge above the floor [m].
    kind : {"door", "window", "passage"}
        How it is drawn; the geometry does not depend on it.
    material : str or None
        What fills it; None leaves it open.
    thickness_m : float or None
        Of the filling [m]; None is the wall's own thickness.
    """

    offset_m: float
    width_m: float
    sill_m: float
    head_m: float
    kind: OpeningKind
    material: str | None = None
    thickness_m: float | None = None

    @property
    def end_m(self) -> float:
        """Distance from the wall's start to the far side of the opening [m]."""
        return self.offset_m + self.width_m

    def overlaps(self, other: Opening) -> bool:
        """Whether two openings of a wall have more than an edge in common."""
        along = min(self.end_m, other.end_m) - max(self.offset_m, other.offset_m)
        upwards = min(self.head_m, other.head_m) - max(self.sill_m, other.sill_m)
        return min(along, upwards) > TOLERANCE_M


@dataclass(frozen=True)
class Wall:
    """A straight wall that stands on the floor.

    Attributes
    ----------
    start, end : (float, float)
        Ends (x, y) of its centre line [m].
    material : str
        One of `floorplans.MATERIALS`.
    thickness_m, height_m : float
        Thickness, and height above the floor [m].
    openings : tuple of Opening
        They may lie above each other (a window above a door) but not overlap.
    kind : {"wall", "clutter"}
        Clutter is shelves, wardrobes and the like: it reflects and transmits like a wall, but its
        edges do not diffract.
    """

    start: Point
    end: Point
    material: str
    thickness_m: float
    height_m: float
    openings: tuple[Opening, ...] = ()
    kind: WallKind = "wall"

    @property
    def length_m(self) -> float:
        """Length of the centre line [m]."""
        return hypot(self.end[0] - self.start[0], self.end[1] - self.start[1])

    def point_at(self, s: float) -> Point:
        """Plan-view point (x, y) [m] at the distance `s` [m] from the start.

        Exact at both ends, and on walls along an axis with integer coordinates.
        """
        if s == self.length_m:
            return self.end
        (x0, y0), (x1, y1) = self.start, self.end
        return (
            x0 + s * ((x1 - x0) / self.length_m),
            y0 + s * ((y1 - y0) / self.length_m),
        )


class Panel(NamedTuple):
    """A solid rectangle of a wall: [s_min, s_max] along it, [z_min, z_max] above the floor [m]."""

    s_min: float
    s_max: float
    z_min: float
    z_max: float
    material: str
    thickness_m: float


def panels(wall: Wall) -> tuple[Panel, ...]:
    """Divide the solid parts of a wall into rectangles that do not overlap.

    The wall comes first, in columns between the sides of its openings: full height where there is
    no opening, sill and lintel where there is one. The fillings of openings follow, one panel
    each.

    Returns
    -------
    tuple of Panel
        Their total area is the wall's area minus that of its unfilled openings.
    """
    return (*_wall_panels(wall), *_fillings(wall))


def _wall_panels(wall: Wall) -> Iterator[Panel]:
    sides = {min(s, wall.length_m) for o in wall.openings for s in (o.offset_m, o.end_m)}
    ahead = sorted(wall.openings, key=lambda o: o.offset_m, reverse=True)
    here: list[Opening] = []
    for s_min, s_max in pairwise(sorted(sides | {0.0, wall.length_m})):
        if s_max - s_min < TOLERANCE_M:
            continue
        middle = (s_min + s_max) / 2
        while ahead and ahead[-1].offset_m < middle:
            here.append(ahead.pop())
        here = [o for o in here if o.end_m > middle]
        for z_min, z_max in complement(((o.sill_m, o.head_m) for o in here), wall.height_m):
            yield Panel(s_min, s_max, z_min, z_max, wall.material, wall.thickness_m)


def _fillings(wall: Wall) -> Iterator[Panel]:
    for o in wall.openings:
        if o.material is not None:
            thickness = wall.thickness_m if o.thickness_m is None else o.thickness_m
            s_max = min(o.end_m, wall.length_m)
            yield Panel(o.offset_m, s_max, o.sill_m, o.head_m, o.material, thickness)


def solid_intervals(wall: Wall, height_m: float) -> list[Interval]:
    """Where a wall is solid at a height; an edge at exactly that height counts as solid.

    Returns
    -------
    list of (float, float)
        Disjoint intervals of s [m], in ascending order, touching ones merged.
    """
    spans = [(p.s_min, p.s_max) for p in panels(wall) if p.z_min <= height_m <= p.z_max]
    return _union(spans)


def solid_segments(walls: Sequence[Wall], height_m: float) -> NDArray[np.float64]:
    """Plan-view segments in which walls are solid at a height.

    Returns
    -------
    (n, 2, 2) float64
        Segment, end, and (x, y) [m].
    """
    segments = [
        (wall.point_at(low), wall.point_at(high))
        for wall in walls
        for low, high in solid_intervals(wall, height_m)
    ]
    return np.array(segments, dtype=np.float64).reshape(-1, 2, 2)


def centre_lines(walls: Sequence[Wall]) -> NDArray[np.object_]:
    """Centre lines as shapely lines, (n,)."""
    ends = np.array([(wall.start, wall.end) for wall in walls], dtype=np.float64)
    return np.array(shapely.linestrings(ends.reshape(-1, 2, 2)), dtype=np.object_)


def solid_heights(walls: Sequence[Wall], point: Point) -> list[Interval]:
    """Heights [m] between which walls and fillings are solid at a point of the plan view.

    Returns
    -------
    list of (float, float)
        Disjoint intervals of z, in ascending order, touching ones merged.
    """
    near = shapely.dwithin(centre_lines(walls), shapely.points(point), TOLERANCE_M)
    spans: list[Interval] = []
    for wall in (walls[k] for k in np.flatnonzero(near).tolist()):
        along = np.subtract(wall.end, wall.start) / wall.length_m
        s = float(np.subtract(point, wall.start) @ along)
        spans += [
            (p.z_min, p.z_max)
            for p in panels(wall)
            if p.s_min - TOLERANCE_M < s < p.s_max + TOLERANCE_M
        ]
    return _union(spans)


def closed_intervals(wall: Wall) -> list[Interval]:
    """Where a wall has no unfilled opening at any height, as intervals of s [m]."""
    unfilled = ((o.offset_m, o.end_m) for o in wall.openings if o.material is None)
    return list(complement(unfilled, wall.length_m))


def complement(intervals: Iterable[Interval], end: float) -> Iterator[Interval]:
    """Yield the complement of intervals in [0, end], without pieces shorter than 1e-6 m."""
    position = 0.0
    for low, high in [*_union(intervals), (end, end)]:
        if low - position >= TOLERANCE_M:
            yield (position, low)
        position = max(position, high)


def _union(intervals: Iterable[Interval]) -> list[Interval]:
    merged: list[Interval] = []
    for low, high in sorted(intervals):
        if merged and low - merged[-1][1] < TOLERANCE_M:
            merged[-1] = (merged[-1][0], max(high, merged[-1][1]))
        else:
            merged.append((low, high))
    return merged
