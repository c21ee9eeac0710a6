"""Spurious thin walls, caused by steps in the faces of other walls."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry.base import BaseGeometry

from floorplans.importers.centrelines.sections import linestrings
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
    lines = linestrings(np.array([(wall.start, wall.end) for wall in walls]))
    thickness_m = np.array([wall.thickness_m or 0.0 for wall in walls])
    bodies = shapely.buffer(lines, thickness_m / 2 + _BESIDE_M, cap_style="flat")
    i, j = shapely.STRtree(bodies).query(lines, predicate="intersects")
    i, j = (k[_RATIO * thickness_m[i] < thickness_m[j]] for k in (i, j))
    within_m = shapely.length(shapely.intersection(lines[i], bodies[j]))
    kept = np.ones(len(walls), dtype=np.bool_)
    kept[i[within_m > _FRACTION * shapely.length(lines[i])]] = False
    thin = np.flatnonzero(kept & (thickness_m < _THIN_M))
    kept[thin] = _are_filled(lines[thin], thickness_m[thin], area)
    return [wall for wall, keep in zip(walls, kept.tolist(), strict=True) if keep]


def _are_filled(
    lines: NDArray[np.object_], thickness_m: NDArray[np.float64], area: BaseGeometry
) -> NDArray[np.bool_]:
    """Whether the area along each wall (n,) is as wide as its thickness, and not much wider."""
    bodies = shapely.buffer(lines, thickness_m / 2, cap_style="flat")
    wide = shapely.buffer(lines, thickness_m, cap_style="flat")
    here = shapely.intersection(area, wide)
    solid = shapely.area(shapely.intersection(bodies, here)) / shapely.area(bodies)
    around = shapely.area(here) / shapely.area(wide)
    return np.array((solid > _FRACTION) & (around < _FRACTION))
