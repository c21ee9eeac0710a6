"""Openings in curved walls: one opening covers several chords."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from math import dist, hypot

import shapely

from floorplans.importers.draft import CURVE_COSINE, RawOpening
from floorplans.repair.geometry import direction, tidy_point
from floorplans.walls import TOLERANCE_M, Point, Wall, centre_lines

_SAME_END_M = 0.01
_MIN_ALONG = 0.3
"""Least cosine between a chord and its opening."""
_MIN_PART_M = 0.01
_MEET_M = 0.12
"""Farthest that an end of an opening is from the wall or opening it meets [m]."""
_CLEAR_M = 0.05
"""An opening whose middle is nearer to a wall lies in it [m]."""


def parts_on_chords(
    opening: RawOpening, host: int, walls: Sequence[Wall], near: Sequence[int]
) -> list[tuple[int, RawOpening]]:
    """Divide an opening among its wall and those that continue it at a slight bend.

    Parameters
    ----------
    opening : RawOpening
    host : int
        Index of the wall the middle of the opening is on.
    walls : sequence of Wall
    near : sequence of int
        Indices of the walls that come into question.

    Returns
    -------
    list of (int, RawOpening)
        Wall and part of the opening, as wide as the chord or less; the opening as it is where
        it ends on its own wall or no other continues it.
    """
    u = _unit(opening.direction or direction(walls[host]))
    middle = _dot(opening.centre, u)
    span = (middle - opening.width_m / 2, middle + opening.width_m / 2)
    chain, todo = [host], [host]
    while todo:
        i = todo.pop()
        ends = [end for end in (walls[i].start, walls[i].end) if _is_within(_dot(end, u), span)]
        for end in ends:
            next_ = [j for j in near if j not in chain and _continues(walls[i], walls[j], end, u)]
            if len(next_) == 1:
                chain += next_
                todo += next_
    if len(chain) == 1:
        return [(host, opening)]
    return [(i, part) for i in chain for part in _part(opening, walls[i], u, span)]


def _part(
    opening: RawOpening, wall: Wall, u: Point, span: tuple[float, float]
) -> Iterator[RawOpening]:
    """Section of a wall whose projection on a direction `u` lies in the span."""
    v = direction(wall)
    begin, cosine = _dot(wall.start, u), _dot(v, u)
    stops = sorted((s - begin) / cosine for s in span)
    low, high = max(stops[0], 0.0), min(stops[1], wall.length_m)
    if high - low > _MIN_PART_M:
        s = (low + high) / 2
        centre = (wall.start[0] + s * v[0], wall.start[1] + s * v[1])
        yield replace(opening, centre=centre, width_m=high - low, direction=v)


def _continues(wall: Wall, other: Wall, end: Point, u: Point) -> bool:
    """Whether another wall of the same kind goes on from an end at a slight bend."""
    far = [b for a, b in ((other.start, other.end), (other.end, other.start))
           if dist(a, end) <= _SAME_END_M]  # fmt: skip
    if not far or (wall.material, wall.height_m) != (other.material, other.height_m):
        return False
    here = wall.start if end == wall.end else wall.end
    before = _unit((end[0] - here[0], end[1] - here[1]))
    after = _unit((far[0][0] - end[0], far[0][1] - end[1]))
    return _dot(before, after) >= CURVE_COSINE and abs(_dot(after, u)) >= _MIN_ALONG


def _is_within(s: float, span: tuple[float, float]) -> bool:
    return span[0] + TOLERANCE_M < s < span[1] - TOLERANCE_M


def _dot(a: Point, b: Point) -> float:
    return a[0] * b[0] + a[1] * b[1]


def _unit(vector: Point) -> Point:
    length = max(hypot(*vector), TOLERANCE_M)
    return (vector[0] / length, vector[1] / length)


def glazed_chords(walls: Sequence[Wall], openings: Sequence[RawOpening]) -> tuple[Wall, ...]:
    """Walls for openings that stand between the ends of walls, alone or in a chain.

    Where a curved wall is drawn interrupted at its windows, nothing is left of a chord that a
    window fills. Both ends of such an opening meet an end of a wall or of another such opening.

    Parameters
    ----------
    walls : sequence of Wall
    openings : sequence of RawOpening

    Returns
    -------
    tuple of Wall
        Each like a wall that its chain begins at.
    """
    tree = shapely.STRtree(centre_lines(walls))
    loose = [
        opening
        for opening in openings
        if opening.direction is not None
        and not len(tree.query(shapely.Point(opening.centre), "dwithin", distance=_CLEAR_M))
    ]
    at_wall = {end: wall for wall in walls for end in (wall.start, wall.end)}
    new: list[Wall] = []
    chains = _chains([_ends(opening) for opening in loose])
    for chain in chains:
        stops = [_nearest(end, at_wall) for end in (chain[0], chain[-1])]
        if None in stops:
            continue
        first, last = stops
        assert first is not None
        assert last is not None
        points = [first, *chain[1:-1], last]
        new += [replace(at_wall[first], start=a, end=b, openings=()) for a, b in pairwise(points)]
    return tuple(new)


def _ends(opening: RawOpening) -> tuple[Point, Point]:
    assert opening.direction is not None
    (x, y), (u, v) = opening.centre, _unit(opening.direction)
    half = opening.width_m / 2
    return tidy_point(x - half * u, y - half * v), tidy_point(x + half * u, y + half * v)


def _chains(sections: Sequence[tuple[Point, Point]]) -> list[list[Point]]:
    """Corners of the chains that sections make, whose ends meet within `_MEET_M`."""
    left = list(sections)
    chains: list[list[Point]] = []
    while left:
        chain = list(left.pop())
        grows = True
        while grows:
            grows = False
            for k, (a, b) in enumerate(left):
                if dist(chain[-1], a) < _MEET_M or dist(chain[-1], b) < _MEET_M:
                    chain.append(b if dist(chain[-1], a) < _MEET_M else a)
                elif dist(chain[0], b) < _MEET_M or dist(chain[0], a) < _MEET_M:
                    chain.insert(0, a if dist(chain[0], b) < _MEET_M else b)
                else:
                    continue
                del left[k]
                grows = True
                break
        chains.append(chain)
    return chains


def _nearest(point: Point, ends: Mapping[Point, Wall]) -> Point | None:
    """End of a wall that a point meets; None if there is none."""
    near = min(ends, key=lambda end: dist(end, point))
    return near if dist(near, point) < _MEET_M else None
