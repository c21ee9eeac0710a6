"""Columns and shafts: regions of the plan view that walls enclose and nothing can enter.

A ring of walls without an opening around at most 0.4 m² is drawn for a column, a chimney or a duct,
not for a room: it counts as solid up to the top of its walls. So there are no cells of a map and
no flights in it, and it needs no door. Larger rings are rooms. A column that is a hole of the
outline lies outside the building, whatever its area.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
import shapely
from shapely.geometry import Polygon

from floorplans.walls import TOLERANCE_M, Wall, centre_lines

MAX_AREA_M2 = 0.4
"""Larger enclosed regions are rooms [m²]."""

_ROUNDING_M2 = 1e-6
_NEAR_M = 10 * TOLERANCE_M
_SHARED_M = 1e-3
"""A wall or an opening is part of a region's edge if they share more than this [m]."""


class SolidRegion(NamedTuple):
    """A region that counts as solid.

    Attributes
    ----------
    polygon : shapely.geometry.Polygon
        Enclosed by the centre lines of its walls [m].
    top_m : float
        Height of the lowest of its walls above the floor [m].
    material : str
        Of that wall.
    """

    polygon: Polygon
    top_m: float
    material: str


def faces_of(walls: Sequence[Wall]) -> list[Polygon]:
    """Regions that the centre lines of walls enclose and divide [m]."""
    noded = shapely.union_all(centre_lines(walls))
    parts = shapely.get_parts(shapely.polygonize(shapely.get_parts(noded)))
    return [part for part in parts if isinstance(part, Polygon)]


def solid_regions(walls: Sequence[Wall]) -> tuple[SolidRegion, ...]:
    """Find the columns and shafts that walls enclose.

    Parameters
    ----------
    walls : sequence of Wall

    Returns
    -------
    tuple of SolidRegion
        They do not overlap.
    """
    small = [face for face in faces_of(walls) if face.area <= MAX_AREA_M2 + _ROUNDING_M2]
    if not small:
        return ()
    tree = shapely.STRtree(centre_lines(walls))
    return tuple(region for face in small if (region := _solid(face, walls, tree)) is not None)


def _solid(face: Polygon, walls: Sequence[Wall], tree: shapely.STRtree) -> SolidRegion | None:
    """Return the region of a face; None if an opening leads into it."""
    around: list[Wall] = []
    for wall, low, high in _edges(face, walls, tree):
        for opening in wall.openings:
            if min(high, opening.end_m) - max(low, opening.offset_m) > _SHARED_M:
                return None
        around.append(wall)
    if not around:
        return None
    lowest = min(around, key=lambda wall: wall.height_m)
    return SolidRegion(face, lowest.height_m, lowest.material)


def _edges(
    face: Polygon, walls: Sequence[Wall], tree: shapely.STRtree
) -> Iterator[tuple[Wall, float, float]]:
    """Yield each section of a wall, from s to s [m], that is part of a face's edge."""
    for ring in (face.exterior, *face.interiors):
        for ends in pairwise(np.asarray(ring.coords)):
            middle = shapely.points(np.mean(ends, axis=0))
            for k in tree.query(middle, predicate="dwithin", distance=_NEAR_M):
                wall = walls[int(k)]
                along = np.subtract(wall.end, wall.start) / wall.length_m
                low, high = sorted(((np.array(ends) - wall.start) @ along).tolist())
                if high - low > _SHARED_M:
                    yield wall, low, high
