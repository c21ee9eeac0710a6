"""Thin walls that the jags of a thick wall's face leave beside it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely
from shapely.geometry import LineString

from floorplans.importers.draft import RawWall

_BESIDE_M = 0.1
_SHARE = 0.7
_RATIO = 3.0


def without_doubles(walls: Sequence[RawWall]) -> list[RawWall]:
    """Leave out walls that run within, or just beside, the body of one that is much thicker.

    Parameters
    ----------
    walls : sequence of RawWall
        All of known thickness.

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
    doubles = {
        i
        for i, j in zip(thin.tolist(), thick.tolist(), strict=True)
        if _RATIO * thickness_m[i] < thickness_m[j]
        and lines[i].intersection(bodies[j]).length > _SHARE * lines[i].length
    }
    return [wall for i, wall in enumerate(walls) if i not in doubles]
