"""Lines that are no walls in a drawing without layers: dimension lines, leaders, symbols."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely
from shapely.geometry import LineString
from shapely.geometry.base import BaseGeometry

_FEW = 0.2
"""Length of single lines over that of all, up to which a drawing shows walls by both faces."""
_TOUCH_M = 0.1

Single = tuple[LineString, str | None]


def without_loose_singles(
    singles: Sequence[Single], area: BaseGeometry
) -> tuple[tuple[Single, ...], str]:
    """Leave out single lines that touch no wall, where walls are drawn by both faces.

    Parameters
    ----------
    singles : sequence of (LineString, str or None)
        Unpaired lines, and their materials [m].
    area : shapely geometry
        Of the walls drawn by both faces [m].

    Returns
    -------
    tuple of (LineString, str or None)
        Those that are kept.
    str
        A sentence about the others; empty if there are none.
    """
    lines = np.array([line for line, _ in singles], dtype=np.object_)
    single_m = float(np.sum(shapely.length(lines)))
    if area.is_empty or single_m > _FEW * (single_m + area.length):
        return tuple(singles), ""
    groups = shapely.get_parts(shapely.union_all(shapely.buffer(lines, _TOUCH_M / 2)))
    loose = shapely.union_all(groups[shapely.distance(groups, area) > _TOUCH_M / 2])
    out = shapely.intersects(lines, loose)
    if not out.any():
        return tuple(singles), ""
    out_m = float(np.sum(shapely.length(lines[out])))
    note = (
        f"{np.count_nonzero(out)} single lines, {out_m:.3g} m, touch no wall and are left out as "
        "dimensions or symbols, because walls are drawn as two lines; name the layer of walls, "
        "such as 0=wall, to keep them"
    )
    kept = [single for single, is_out in zip(singles, out.tolist(), strict=True) if not is_out]
    return tuple(kept), note
