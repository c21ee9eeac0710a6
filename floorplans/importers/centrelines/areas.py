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

from itertools import pairwise

import numpy as np
import shapely
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry

from floorplans.importers.centrelines.axes import on_common_lines
from floorplans.importers.centrelines.facing_sides import axes_of
from floorplans.importers.centrelines.meeting import meeting_walls
from floorplans.importers.draft import RawWall

MAX_THICKNESS_M = 1.0
"""Largest thickness of a wall; what is thicker is a block, unless it is long [m]."""

MAX_HEAVY_M = 2.5
"""Largest thickness of a long wall, as of heavy masonry [m]."""

_SQUAT, _SLENDER = 0.62, 0.35
"""Width over length of a free-standing piece from which on it is a pillar, and below which a wall;
no common size of columns has either."""
_LEAST_COLUMN_M = 0.2
_GAP_M = 2.5
_CLEAR_M = 0.05

_LONG = 4.0  # area over squared width from which a thick part is a heavy wall


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
    axes = on_common_lines(axes_of(thin, thickest_m, openings), whole)
    rings = [side for block in blocks for side in _ring_walls(block)]
    reach = [RawWall(axis.start, axis.end, axis.thickness_m) for axis in axes]
    return [*meeting_walls(reach, rings, whole), *rings]


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
    core = _eroded(whole, half).buffer(half, join_style="mitre")
    thick = _polygons(core.intersection(whole)) if not core.is_empty else []
    thick = [part for part in thick if part.area > half**2]
    widths_m = [2 * shapely.maximum_inscribed_circle(part).length for part in thick]
    heavy = [
        width_m <= MAX_HEAVY_M and part.area >= _LONG * width_m**2
        for part, width_m in zip(thick, widths_m, strict=True)
    ]
    blocks = [part for part, is_wall in zip(thick, heavy, strict=True) if not is_wall]
    walls_m = [w for w, is_wall in zip(widths_m, heavy, strict=True) if is_wall]
    blocks += [part for part in _polygons(whole) if _is_pillar(part, whole)]
    return blocks, max([MAX_THICKNESS_M, *(1.02 * width_m for width_m in walls_m)])


def _eroded(area: BaseGeometry, distance_m: float) -> BaseGeometry:
    """Area without what is nearer to its edge than a distance.

    Each ring is moved by itself: GEOS's time for a whole area grows with the square of its holes.
    """
    kept: list[BaseGeometry] = []
    for part in _polygons(area):
        holes = [Polygon(ring).buffer(distance_m, join_style="mitre") for ring in part.interiors]
        shell = Polygon(part.exterior).buffer(-distance_m, join_style="mitre")
        kept.append(shell.difference(shapely.union_all(holes)))
    return shapely.union_all(kept)


def _is_pillar(part: Polygon, whole: BaseGeometry) -> bool:
    """Whether a piece that touches no other is a pillar, by its shape and what is in line with it.

    A squat piece is one and a slender piece is none. One between the two, as of 0.4 m x 0.8 m, may
    be the pier of a wall whose gaps are not known: a wall in line with it goes on.
    """
    width, length = box_sides(part)
    if part.interiors or width > MAX_THICKNESS_M or width < _SLENDER * length:
        return False
    if width > _SQUAT * length:
        return True
    return width >= _LEAST_COLUMN_M and not _goes_on(part, whole, width)


def _goes_on(part: Polygon, whole: BaseGeometry, width: float) -> bool:
    """Whether a wall, no wider, begins within a door's or window's width ahead of a piece."""
    a, b, c, d = shapely.get_coordinates(shapely.oriented_envelope(part))[:4]
    if np.hypot(*(b - a)) > np.hypot(*(c - b)):
        a, b, c, d = b, c, d, a
    near = shapely.clip_by_rect(whole, *part.buffer(_GAP_M + width).bounds)
    others = near.difference(part.buffer(_CLEAR_M))
    for middle, along in (((a + b) / 2, a - d), ((c + d) / 2, d - a)):
        along = along / np.hypot(*along)
        ahead = shapely.LineString([middle, middle + _GAP_M * along])
        near_m = float(shapely.distance(others.intersection(ahead), shapely.Point(middle)))
        if not np.isfinite(near_m):
            continue
        at = middle + (near_m + _CLEAR_M) * along
        across = np.array([-along[1], along[0]]) * (width / 2 + 2 * _CLEAR_M)
        section = shapely.LineString([at - across, at + across])
        if others.intersection(section).length < width + 2 * _CLEAR_M:
            return True
    return False


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
