"""Centre lines that end in the solid of other walls, extended to meet theirs."""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry.base import BaseGeometry

from floorplans.importers.centrelines.axes import point_of
from floorplans.importers.centrelines.sections import BESIDE_M, linestrings, sections_inside
from floorplans.importers.draft import RawWall

_BEND = np.sin(np.radians(1.0))
_REACH = 2.0  # times the thickest wall: how far an end may be extended to meet another wall
_AT_END_M = 1e-5
"""A section that begins this near to an end continues the wall [m]."""

Vectors = NDArray[np.float64]


def meeting_walls(walls: list[RawWall], rings: list[RawWall], solid: BaseGeometry) -> list[RawWall]:
    """Extend each end through the solid to the nearest centre line it meets.

    Parameters
    ----------
    walls : list of RawWall
        Of known thickness.
    rings : list of RawWall
        Sides of blocks, which walls may end on.
    solid : shapely geometry
        All walls and blocks [m].

    Returns
    -------
    list of RawWall
        In the order of `walls`.
    """
    if not walls:
        return []
    long = _extended(walls, solid)
    ring_lines = np.array([(ring.start, ring.end) for ring in rings]).reshape(-1, 2, 2)
    meets = _crossings(long, np.concatenate([long, ring_lines]))
    cut = [_cut(wall, points) for wall, points in zip(walls, meets, strict=True)]
    ends = np.array([(wall.start, wall.end) for wall in cut]).reshape(-1, 2)
    tree = shapely.STRtree(np.array(shapely.points(ends), dtype=np.object_))
    line, end = tree.query(linestrings(long), "dwithin", distance=BESIDE_M)
    order = np.lexsort((end, line))
    on_line = np.split(ends[end[order]], np.searchsorted(line[order], np.arange(1, len(long))))
    return [_reaching(wall, points) for wall, points in zip(cut, on_line, strict=True)]


def _extended(walls: list[RawWall], solid: BaseGeometry) -> Vectors:
    """Walls' centre lines (n, 2, 2), extended at both ends as far as there is solid [m]."""
    reach_m = _REACH * max(wall.thickness_m or 0.0 for wall in walls)
    lines = np.array([(wall.start, wall.end) for wall in walls])
    step = lines[:, 1] - lines[:, 0]
    ahead = step / np.hypot(step[:, 0], step[:, 1])[:, None] * reach_m
    for end, towards in ((0, -ahead), (1, ahead)):
        rays = np.stack([lines[:, end], lines[:, end] + towards], axis=1)
        free = [
            next((high for low, high in found if low < _AT_END_M), 0.0)
            for found in sections_inside(rays, solid)
        ]
        lines[:, end] += towards * np.array(free)[:, None] / reach_m
    return lines


def _crossings(lines: Vectors, others: Vectors) -> list[Vectors]:
    """Points (n, 2) where each line meets others of other directions [m].

    The others are the lines themselves and more.
    """
    drawn = linestrings(others)
    i, j = shapely.STRtree(drawn).query(drawn[: len(lines)], "intersects")
    step = others[:, 1] - others[:, 0]
    length_m = np.hypot(step[:, 0], step[:, 1])
    sine = np.abs(step[i, 0] * step[j, 1] - step[i, 1] * step[j, 0])
    bends = (i != j) & (sine > _BEND * length_m[i] * length_m[j])
    i, j = i[bends], j[bends]
    points, pair = shapely.get_coordinates(
        shapely.intersection(drawn[i], drawn[j]), return_index=True
    )
    return np.split(points, np.searchsorted(i[pair], np.arange(1, len(lines))))


def _cut(wall: RawWall, points: Vectors) -> RawWall:
    """End a wall where it meets others (n, 2), or where it ended before if it meets none."""
    a, b = np.array(wall.start), np.array(wall.end)
    length = float(np.hypot(*(b - a)))
    along = (b - a) / length
    s = (points - a) @ along
    slack = min(wall.thickness_m or 0.0, length / 2)
    before, after = s[s < slack], s[s > length - slack]
    first = before[np.argmin(np.abs(before))] if len(before) else 0.0
    last = after[np.argmin(np.abs(after - length))] if len(after) else length
    return RawWall(point_of(a + first * along), point_of(a + last * along), wall.thickness_m)


def _reaching(wall: RawWall, ends: Vectors) -> RawWall:
    """Extend a wall to ends (n, 2) that were cut at its extended line."""
    a, b = np.array(wall.start), np.array(wall.end)
    length = float(np.hypot(*(b - a)))
    s = (ends - a) @ (b - a) / length
    slack = wall.thickness_m or 0.0
    s = s[(s > -slack) & (s < length + slack)]
    start, end = (a + (b - a) * float(t) / length for t in (s.min(), s.max()))
    return RawWall(point_of(start), point_of(end), wall.thickness_m)
