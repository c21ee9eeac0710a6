"""The space a robot's map knows: its border is the outline, where there is a wall and where not."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy.ndimage import binary_fill_holes, binary_opening, label
from shapely.geometry import LineString, Point, Polygon
from shapely.geometry.base import BaseGeometry

from floorplans.importers.draft import RawWall

Mask = NDArray[np.bool_]

_LEAST_UNKNOWN = 0.02
_MOST_FREE_EDGE = 0.25
"""A picture with less unknown space, or with more of its edge free, does not tell in from out."""
_RAY_M = 0.5
"""Free space narrower than this beside no wall is the trace of single laser rays [m]."""
_BESIDE_PX = 2.5
_LEAST_OPENING_M = 0.3
_STRAIGHT_M = 0.2
"""Largest deviation of closing walls from the border of known space [m]."""
_EVERYWHERE = np.ones((3, 3), dtype=np.bool_)


def known_region(free: Mask, solid: Mask, pixel_m: float) -> Polygon | None:
    """Outer border of the largest connected known space, without the traces of single rays.

    Parameters
    ----------
    free, solid : (n_y, n_x) bool
        The first row is the bottom one; other pixels are unknown.
    pixel_m : float
        Side of a pixel [m].

    Returns
    -------
    shapely.geometry.Polygon or None
        In pixels, the picture's lower left corner at (0, 0); None if the picture does not tell
        unknown from free space, as a drawing on white paper.
    """
    edge = np.concatenate([free[0], free[-1], free[:, 0], free[:, -1]])
    unknown = 1.0 - float((free | solid).mean())
    if unknown < _LEAST_UNKNOWN or edge.mean() > _MOST_FREE_EDGE:
        return None
    inside = _largest(free | solid, free)
    inside = np.array(binary_fill_holes(inside), dtype=np.bool_)
    reach = max(1, round(_RAY_M / pixel_m / 2))
    wide = np.array(binary_opening(np.pad(inside, reach), _EVERYWHERE, reach), dtype=np.bool_)
    wide = wide[reach:-reach, reach:-reach] | (solid & inside)
    area = _polygons(_largest(wide, free & wide))
    shells = [Polygon(p.exterior) for p in shapely.get_parts(area) if isinstance(p, Polygon)]
    return max(shells, key=lambda shell: shell.area, default=None)


def openings_in_border(
    region: Polygon, walls: Sequence[RawWall], pixel_m: float
) -> Iterator[LineString]:
    """Yield the sections of the border of known space without a wall, from wall to wall.

    Parameters
    ----------
    region : shapely.geometry.Polygon
        Of `known_region` [pixels].
    walls : sequence of RawWall
        [pixels].
    pixel_m : float
        Side of a pixel [m].

    Yields
    ------
    shapely.geometry.LineString
        Straightened [pixels].
    """
    lines = np.array([LineString([wall.start, wall.end]) for wall in walls], dtype=np.object_)
    thickness_px = np.array([wall.thickness_m or 1.0 for wall in walls])
    beside = shapely.union_all(shapely.buffer(lines, thickness_px / 2 + _BESIDE_PX))
    tree = shapely.STRtree(lines)
    open_ = shapely.line_merge(region.exterior.difference(beside))
    for part in shapely.get_parts(open_):
        if not isinstance(part, LineString) or part.length * pixel_m < _LEAST_OPENING_M:
            continue
        simple = _joined(part, tree, lines).simplify(max(_STRAIGHT_M / pixel_m, _BESIDE_PX + 0.5))
        assert isinstance(simple, LineString)
        yield simple


def _joined(part: LineString, tree: shapely.STRtree, lines: NDArray[np.object_]) -> LineString:
    """Extend an open section at both ends to the nearest walls; a ring has none."""
    points = [(float(x), float(y)) for x, y in part.coords]
    if points[0] == points[-1]:
        return part
    ends = [
        shapely.get_coordinates(shapely.shortest_line(lines[tree.nearest(Point(p))], Point(p)))[0]
        for p in (points[0], points[-1])
    ]
    (x0, y0), (x1, y1) = (end.tolist() for end in ends)
    return LineString([(x0, y0), *points, (x1, y1)])


def _largest(known: Mask, free: Mask) -> Mask:
    """Connected part of the known space with most free pixels."""
    numbers: NDArray[np.int32] = np.empty(known.shape, dtype=np.int32)
    label(known, structure=_EVERYWHERE, output=numbers)
    sizes = np.bincount(numbers[free], minlength=2)
    sizes[0] = 0
    return numbers == int(sizes.argmax())


def _polygons(mask: Mask) -> BaseGeometry:
    """Area of the pixels of a mask: rows of pixels, merged."""
    padded = np.pad(mask, 1).astype(np.int8)
    steps = np.diff(padded, axis=1)
    row, begin = np.nonzero(steps == 1)
    _, end = np.nonzero(steps == -1)
    boxes = shapely.box(begin, row - 1, end, row)
    return shapely.union_all(boxes)
