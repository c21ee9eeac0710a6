"""Spurious thin walls, caused by steps in the faces of other walls."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely
from shapely.geometry import LineString
from shapely.geometry.base import BaseGeometry

from floorplans.importers.draft import RawWall

_BESIDE_M = 0.1
_FRACTION = 0.7
_RATIO = 3.0
_THIN_M = 0.06


def without_spurious_walls(walls: Sequence[RawWall], area: BaseGeometry) -> list[RawWall]:
    """Remove walls that run within, or just beside, the body of a much thicker one.

    Parameters
    ----------
    walls : sequence of RawWall
        All of known thickness.
    area : shapely geometry
        Of all walls: a thin wall whose area is not as thick is removed too [m].

    Returns
    -------
    list of RawWall
        In the order given.
    """
    if not walls:
        return []
    lines = [LineString([wall.start, wall.end]) for wall in walls]
    thickness_m = [wall.thickness_m or 0.0 for wall in walls]
    bodies = [
        line.buffer(thick / 2 + _BESIDE_M, cap_style="flat")
        for line, thick in zip(lines, thickness_m, strict=True)
    ]
    thin, thick = shapely.STRtree(bodies).query(np.array(lines), predicate="intersects")
    spurious = {
        i
        for i, j in zip(thin.tolist(), thick.tolist(), strict=True)
        if _RATIO * thickness_m[i] < thickness_m[j]
        and lines[i].intersection(bodies[j]).length > _FRACTION * lines[i].length
    }
    return [
        wall
        for i, wall in enumerate(walls)
        if i not in spurious
        and (thickness_m[i] >= _THIN_M or _is_filled(lines[i], thickness_m[i], area))
    ]


def _is_filled(line: LineString, thickness_m: float, area: BaseGeometry) -> bool:
    """Whether the area along a wall is as wide as its thickness, and not much wider."""
    body = line.buffer(thickness_m / 2, cap_style="flat")
    wide = line.buffer(thickness_m, cap_style="flat")
    solid = body.intersection(area).area / body.area
    return bool(solid > _FRACTION and wide.intersection(area).area < _FRACTION * wide.area)
