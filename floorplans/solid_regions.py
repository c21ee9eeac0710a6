"""Columns and shafts: regions of the plan view that walls enclose and nothing can enter.

A ring of walls without an opening around at most 0.4 m² is drawn for a column, a chimney or a duct,
not for a room: it counts as solid up to the top of its walls. So there are no cells of a map and
no flights in it, and it needs no door. Larger rings are rooms. A column that is a hole of the
outline lies outside the building, whatever its area.
"""

from __future__ import annotations

from collections.abc import Sequence
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
    edges = _edges(small, walls)
    return tuple(
        region
        for face, around in zip(small, edges, strict=True)
        if (region := _solid(face, around)) is not None
    )


_Edge = tuple[Wall, float, float]
"""A section of a wall, from s to s along it [m]."""


def _solid(face: Polygon, edges: Sequence[_Edge]) -> SolidRegion | None:
    """Return the region of a face with its edges; None if an opening leads into it."""
    for wall, low, high in edges:
        for opening in wall.openings:
            if min(high, opening.end_m) - max(low, opening.offset_m) > _SHARED_M:
                return None
    if not edges:
        return None
    lowest = min((wall for wall, _, _ in edges), key=lambda wall: wall.height_m)
    return SolidRegion(face, lowest.height_m, lowest.material)


def _edges(faces: Sequence[Polygon], walls: Sequence[Wall]) -> list[list[_Edge]]:
    """Sections of walls that are part of the edge of each face."""
    chains = [
        (k, shapely.get_coordinates(ring))
        for k, face in enumerate(faces)
        for ring in (face.exterior, *face.interiors)
    ]
    face_of = np.concatenate([np.full(len(chain) - 1, k) for k, chain in chains])
    ends = np.concatenate([np.stack([chain[:-1], chain[1:]], axis=1) for _, chain in chains])
    middles = np.array(shapely.points(ends.mean(axis=1)), dtype=np.object_)
    side, near = shapely.STRtree(centre_lines(walls)).query(
        middles, predicate="dwithin", distance=_NEAR_M
    )
    start, stop = (
        np.array([(walls[k].start, walls[k].end) for k in near]).reshape(-1, 2, 2).swapaxes(0, 1)
    )
    step = stop - start
    along = step / np.hypot(step[:, 0], step[:, 1])[:, None]
    s = np.sort(((ends[side] - start[:, None]) * along[:, None]).sum(axis=2), axis=1)
    found: list[list[_Edge]] = [[] for _ in faces]
    for face, wall, (low, high) in zip(
        face_of[side].tolist(), near.tolist(), s.tolist(), strict=True
    ):
        if high - low > _SHARED_M:
            found[face].append((walls[wall], low, high))
    return found
