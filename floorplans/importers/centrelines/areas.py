"""Wall areas in the plan view -> centre lines with the measured thickness.

Two edges of the area that face each other across solid wall are the sides of one straight wall: its
centre line runs midway between them, where they face each other, and their distance is its
thickness. Nearly collinear centre lines are then put on one line, and each end is extended through
the solid to the next centre line it meets: to the corner, or into the T.

What is too thick or too short to be a wall, such as a pillar or a filled shaft, is kept as the ring
around it; a heavy wall, thick but long, is a wall. Each side of a ring has half the block's width,
so that the two sides a ray crosses add up to the block.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import LineString, Polygon
from shapely.geometry.base import BaseGeometry

from floorplans.importers.centrelines.axes import Axis, on_common_lines
from floorplans.importers.centrelines.tiles import Tiles
from floorplans.importers.draft import RawWall

MAX_THICKNESS_M = 1.0
"""Largest thickness of a wall; what is thicker is a block, unless it is long [m]."""

MAX_HEAVY_M = 2.5
"""Largest thickness of a long wall, as of heavy masonry [m]."""

SQUATNESS = 0.5
"""A free-standing piece wider than this fraction of its length is a pillar."""

_PARALLEL = np.cos(np.radians(12.0))
_LONG = 4.0  # area over squared width from which a thick part is a heavy wall
_FACING_FRACTION = 0.6  # of the thickness, on which the two sides of a wall must face each other
_BEND = np.sin(np.radians(1.0))
_REACH = 2.0  # times the thickest wall: how far an end may be extended to meet another wall

Vectors = NDArray[np.float64]


def walls_of_area(
    area: BaseGeometry, tolerance_m: float, fillings: BaseGeometry | None = None
) -> list[RawWall]:
    """Return the walls that make up a wall area.

    Parameters
    ----------
    area : shapely geometry
        Polygons [m]; those that touch or nearly touch are merged.
    tolerance_m : float
        Gaps up to this are closed, and corners nearer than this to a side removed [m].
    fillings : shapely geometry, optional
        Areas of doors and windows [m]: they join the line of their wall and take its thickness.

    Returns
    -------
    list of RawWall
        With thickness; those of blocks last.
    """
    openings = shapely.Polygon() if fillings is None else fillings
    solid = _polygons(_closed(area.union(openings), tolerance_m).simplify(tolerance_m / 2))
    whole = shapely.union_all(solid)
    blocks, thickest_m = _blocks(whole)
    thin = [
        part
        for part in _polygons(whole.difference(shapely.union_all(blocks).buffer(1e-6)))
        if part.area > tolerance_m**2
    ]
    found = [
        _with_filling_flag(axis, openings) for part in thin for axis in _axes(part, thickest_m)
    ]
    axes = on_common_lines(found, whole)
    rings = [side for block in blocks for side in _ring_walls(block)]
    reach = [RawWall(axis.start, axis.end, axis.thickness_m) for axis in axes]
    return [*_joined(reach, rings, whole), *rings]


def block_walls(block: Polygon) -> list[RawWall]:
    """Return the ring of walls around a block, each of half its width."""
    return _ring_walls(shapely.orient_polygons(block))


def _closed(area: BaseGeometry, gap_m: float) -> BaseGeometry:
    """Close gaps narrower than `gap_m`, and remove slivers."""
    grown = area.buffer(gap_m / 2, join_style="mitre")
    return grown.buffer(-gap_m, join_style="mitre").buffer(gap_m / 2, join_style="mitre")


def _polygons(geometry: BaseGeometry) -> list[Polygon]:
    """Polygons of a geometry, outer rings counter-clockwise."""
    parts = shapely.get_parts(shapely.orient_polygons(geometry))
    return [part for part in parts if isinstance(part, Polygon) and part.area > 0]


def _blocks(whole: BaseGeometry) -> tuple[list[Polygon], float]:
    """Parts that are kept as rings, and the thickness of the thickest wall in the others [m]."""
    half = MAX_THICKNESS_M / 2
    core = whole.buffer(-half, join_style="mitre").buffer(half, join_style="mitre")
    thick = _polygons(core.intersection(whole)) if not core.is_empty else []
    thick = [part for part in thick if part.area > half**2]
    widths_m = [2 * shapely.maximum_inscribed_circle(part).length for part in thick]
    heavy = [
        width_m <= MAX_HEAVY_M and part.area >= _LONG * width_m**2
        for part, width_m in zip(thick, widths_m, strict=True)
    ]
    blocks = [part for part, is_wall in zip(thick, heavy, strict=True) if not is_wall]
    walls_m = [w for w, is_wall in zip(widths_m, heavy, strict=True) if is_wall]
    blocks += [part for part in _polygons(whole) if _is_pillar(part)]
    return blocks, max([MAX_THICKNESS_M, *(1.02 * width_m for width_m in walls_m)])


def _is_pillar(part: Polygon) -> bool:
    width, length = box_sides(part)
    return not part.interiors and SQUATNESS * length < width <= MAX_THICKNESS_M


def box_sides(polygon: BaseGeometry) -> tuple[float, float]:
    """Return width and length of the smallest box around a shape, of any orientation [m]."""
    box = shapely.oriented_envelope(polygon)
    if not isinstance(box, Polygon):
        return 0.0, box.length
    a, b, c = shapely.get_coordinates(box)[:3]
    width, length = sorted((float(np.hypot(*(b - a))), float(np.hypot(*(c - b)))))
    return width, length


def _ring_walls(block: Polygon) -> list[RawWall]:
    thickness_m = min(max(box_sides(block)[0], 2e-3), MAX_THICKNESS_M) / 2
    corners = [(float(x), float(y)) for x, y in block.exterior.coords]
    return [RawWall(a, b, thickness_m) for a, b in pairwise(corners)]


@dataclass(frozen=True)
class _Edges:
    """Sides of a polygon, solid on their left: starts, unit directions (n, 2), lengths (n,)."""

    start: Vectors
    along: Vectors
    length: Vectors


def _edges(part: Polygon) -> _Edges:
    rings = [shapely.get_coordinates(ring) for ring in (part.exterior, *part.interiors)]
    start = np.concatenate([ring[:-1] for ring in rings])
    step = np.concatenate([np.diff(ring, axis=0) for ring in rings])
    length = np.hypot(step[:, 0], step[:, 1])
    real = length > 0
    return _Edges(start[real], step[real] / length[real, None], length[real])


def _axes(part: Polygon, thickest_m: float) -> list[Axis]:
    """Centre lines of all pairs of sides that face each other across up to `thickest_m`."""
    edges = _edges(part)
    ends = np.stack([edges.start, edges.start + edges.along * edges.length[:, None]], axis=1)
    lines = np.array(shapely.linestrings(ends), dtype=np.object_)
    pairs = shapely.STRtree(lines).query(lines, predicate="dwithin", distance=thickest_m)
    near = pairs[:, pairs[0] < pairs[1]].T
    opposed = np.sum(edges.along[near[:, 0]] * edges.along[near[:, 1]], axis=1) < -_PARALLEL
    inside = part.buffer(1e-6)
    shapely.prepare(inside)
    found = [_axis_between(edges, int(i), int(j), thickest_m) for i, j in near[opposed]]
    return [part for axis in found if axis is not None for part in _solid_parts(axis, inside)]


def _solid_parts(axis: Axis, inside: BaseGeometry) -> Iterator[Axis]:
    """Yield the sections of an axis in the solid: a niche or a shaft may interrupt a wall."""
    line = LineString([axis.start, axis.end])
    if inside.covers(line):
        yield axis
        return
    for part in shapely.get_parts(line.intersection(inside)):
        if part.length > axis.thickness_m:
            (x0, y0), *_, (x1, y1) = part.coords
            yield replace(axis, start=(x0, y0), end=(x1, y1))


def _with_filling_flag(axis: Axis, fillings: BaseGeometry) -> Axis:
    """Flag an axis whose middle lies in a filling."""
    middle = LineString([axis.start, axis.end]).centroid
    return replace(axis, is_filling=bool(fillings.covers(middle)))


def _axis_between(edges: _Edges, i: int, j: int, thickest_m: float) -> Axis | None:
    """Centre line of the wall between two sides; None if they do not face each other."""
    along = edges.along[i] - edges.along[j]
    along /= np.hypot(*along)
    across = np.array([-along[1], along[0]])
    ends = np.array(
        [[edges.start[k], edges.start[k] + edges.along[k] * edges.length[k]] for k in (i, j)]
    )
    s, t = ends @ along, ends @ across
    low, high = max(s[0].min(), s[1].min()), min(s[0].max(), s[1].max())
    if high <= low:
        return None
    near, far = (np.interp([low, high], np.sort(s[k]), t[k][np.argsort(s[k])]) for k in (0, 1))
    thickness_m = float(np.mean(far - near))
    if not 1e-3 < thickness_m <= thickest_m or high - low < _FACING_FRACTION * thickness_m:
        return None
    middle = (near + far) / 2
    start, end = (along * p + across * q for p, q in zip((low, high), middle, strict=True))
    return Axis((float(start[0]), float(start[1])), (float(end[0]), float(end[1])), thickness_m)


def _joined(walls: list[RawWall], rings: list[RawWall], whole: BaseGeometry) -> list[RawWall]:
    """Extend each end through the solid to the nearest centre line it meets."""
    if not walls:
        return []
    reach_m = _REACH * max(wall.thickness_m or 0.0 for wall in walls)
    solid = _Solid(whole.buffer(1e-6), reach_m)
    long = [_extended(wall, solid) for wall in walls]
    others = [*long, *(LineString([ring.start, ring.end]) for ring in rings)]
    tree = shapely.STRtree(others)
    near = [[m for m in tree.query(line).tolist() if m != k] for k, line in enumerate(long)]
    cut = [_cut(walls[k], long[k], [others[m] for m in near[k]]) for k in range(len(walls))]
    ends = np.array(shapely.points([end for wall in cut for end in (wall.start, wall.end)]))
    touching = shapely.STRtree(ends).query(long, "dwithin", distance=1e-6)
    on_line = np.split(touching[1], np.searchsorted(touching[0], np.arange(1, len(long))))
    return [_reaching(wall, ends[np.sort(on_line[k])]) for k, wall in enumerate(cut)]


class _Solid:
    """The solid of all walls.

    Attributes
    ----------
    reach_m : float
        Length of the lines that are looked up [m].
    """

    def __init__(self, solid: BaseGeometry, reach_m: float) -> None:
        shapely.prepare(solid)
        self.reach_m = reach_m
        self._solid = solid
        self._tiles = Tiles(solid)

    def last_point(self, start: Vectors, end: Vectors) -> Vectors:
        """Point up to which the line from `start` to `end`, no longer than the reach, is solid."""
        line = LineString([start, end])
        if self._solid.covers(line):
            return end
        near = self._tiles.around(float(start[0]), float(start[1]), self.reach_m)
        for part in shapely.get_parts(line.intersection(near)):
            points = shapely.get_coordinates(part)
            if len(points) and np.hypot(*(points - start).T).min() < 1e-5:
                return points[np.argmax(np.hypot(*(points - start).T))]
        return start


def _extended(wall: RawWall, solid: _Solid) -> LineString:
    """Extend a wall's centre line at both ends as far as there is solid."""
    a, b = np.array(wall.start), np.array(wall.end)
    step = (b - a) / np.hypot(*(b - a)) * solid.reach_m
    return LineString([solid.last_point(a, a - step), solid.last_point(b, b + step)])


def _bends(along: Vectors, other: LineString) -> bool:
    """Whether another line deviates from a direction by more than a rounding error."""
    a, b = shapely.get_coordinates(other)
    return abs(along[0] * (b - a)[1] - along[1] * (b - a)[0]) > _BEND * np.hypot(*(b - a))


def _cut(wall: RawWall, long: LineString, others: list[LineString]) -> RawWall:
    """End an extended wall where it meets others, or where it ended before if it meets none."""
    a, b = np.array(wall.start), np.array(wall.end)
    length = float(np.hypot(*(b - a)))
    along = (b - a) / length
    points = shapely.get_coordinates([long.intersection(x) for x in others if _bends(along, x)])
    s = (points - a) @ along
    slack = min(wall.thickness_m or 0.0, length / 2)
    before, after = s[s < slack], s[s > length - slack]
    first = before[np.argmin(np.abs(before))] if len(before) else 0.0
    last = after[np.argmin(np.abs(after - length))] if len(after) else length
    start, end = a + first * along, a + last * along
    return RawWall(
        (float(start[0]), float(start[1])), (float(end[0]), float(end[1])), wall.thickness_m
    )


def _reaching(wall: RawWall, ends: NDArray[np.object_]) -> RawWall:
    """Extend a wall to ends that were cut at its extended line."""
    a, b = np.array(wall.start), np.array(wall.end)
    length = float(np.hypot(*(b - a)))
    s = (shapely.get_coordinates(list(ends)) - a) @ (b - a) / length
    slack = wall.thickness_m or 0.0
    s = s[(s > -slack) & (s < length + slack)]
    start, end = (a + (b - a) * float(t) / length for t in (s.min(), s.max()))
    return RawWall(
        (float(start[0]), float(start[1])), (float(end[0]), float(end[1])), wall.thickness_m
    )
