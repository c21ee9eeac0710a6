"""Gaps in walls at doors and windows, filled so that the wall continues behind the opening."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import atan2, degrees

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely import affinity
from shapely.geometry import Polygon, box
from shapely.geometry.base import BaseGeometry

from floorplans.importers.draft import RawOpening

_BESIDE_M = 1.0
"""How far beside an opening's middle the sides of a gap are searched [m]."""
_FRAME_M = 0.3
"""How far a gap may extend beyond an opening on each side [m]."""
_REBATE_M = 0.06
"""How far the faces of a gap may step back [m]."""
_STEP_M = 0.02
_OVER_M = 0.01
_MIN_HALF_M = 0.05
"""Least half thickness of a wall at the end of a corridor [m]."""
_MIN_FRACTION = 0.5
_MIN_COMMON = 0.7


def fill_gaps(area: BaseGeometry, openings: Sequence[RawOpening]) -> tuple[Polygon, ...]:
    """Fill the gaps of a wall area in which openings lie.

    A gap lies between two wall faces that an opening connects; it is filled to the depth that the
    faces have in common. An opening of unknown direction, or inside a wall, has no gap.

    Parameters
    ----------
    area : shapely geometry
        Of the walls in the plan view [m].
    openings : sequence of RawOpening

    Returns
    -------
    tuple of shapely.geometry.Polygon
    """
    parts = shapely.get_parts(area)
    if not len(parts):
        return ()
    tree = shapely.STRtree(parts)
    return tuple(filling for opening in openings for filling in _filling(opening, parts, tree))


def _filling(
    opening: RawOpening, parts: NDArray[np.object_], tree: shapely.STRtree
) -> Iterator[Polygon]:
    if opening.direction is None:
        return
    angle = atan2(opening.direction[1], opening.direction[0])
    x, y = opening.centre
    far_m = opening.width_m / 2 + _FRAME_M
    frame = box(-far_m - _STEP_M, -_BESIDE_M, far_m + _STEP_M, _BESIDE_M)
    window = affinity.translate(affinity.rotate(frame, degrees(angle), origin=(0, 0)), x, y)
    near = [parts[i] for i in tree.query(window, predicate="intersects").tolist()]
    if not near:
        return
    here = affinity.translate(shapely.intersection(shapely.union_all(near), window), -x, -y)
    local = affinity.rotate(here, degrees(-angle), origin=(0, 0))
    gap = _gap(local, opening.width_m)
    if gap is not None:
        yield affinity.translate(affinity.rotate(gap, degrees(angle), origin=(0, 0)), x, y)


def _gap(local: BaseGeometry, width_m: float) -> Polygon | None:
    """Gap around the origin, along x, in a wall area; None if there is none."""
    rows = np.arange(-_BESIDE_M + _STEP_M / 2, _BESIDE_M, _STEP_M)
    sides = np.array([_sides(local, float(row), width_m) for row in rows])
    spanned = np.array(np.isfinite(sides).all(axis=1))
    run = _run_nearest_middle(spanned)
    if run is None or run == (0, len(rows)):
        return None
    middle = min(max(len(rows) // 2, run[0]), run[1] - 1)
    run = _run_nearest_middle(spanned & _level(sides, middle)) or run
    left, right = np.median(sides[run[0] : run[1]], axis=0)
    low, high = rows[run[0]] - _STEP_M / 2, rows[run[1] - 1] + _STEP_M / 2
    low, high = _at_the_end(*_exact(local, (float(left), float(right)), (float(low), float(high))))
    return box(left - _OVER_M, low, right + _OVER_M, high)


def _at_the_end(low: float, high: float) -> tuple[float, float]:
    """Limit a gap whose sides run on, as those of a corridor do, to the wall at its end.

    An opening lies in the middle of that wall.
    """
    if low <= _STEP_M - _BESIDE_M and abs(high) < _BESIDE_M / 2:
        return high - 2 * max(high, _MIN_HALF_M), high
    if high >= _BESIDE_M - _STEP_M and abs(low) < _BESIDE_M / 2:
        return low, low + 2 * max(-low, _MIN_HALF_M)
    return low, high


def _level(sides: NDArray[np.float64], middle: int) -> NDArray[np.bool_]:
    """Rows whose sides match the middle row: others lie between other walls."""
    return np.array((np.abs(sides - sides[middle]) <= _REBATE_M).all(axis=1))


def _sides(local: BaseGeometry, row: float, width_m: float) -> tuple[float, float]:
    """Where wall begins left and right of x = 0 in a row; nan if not near enough."""
    far_m = width_m / 2 + _FRAME_M
    line = shapely.linestrings([[-far_m - _STEP_M, row], [far_m + _STEP_M, row]])
    hits = shapely.get_parts(shapely.intersection(line, local))
    spans = [(hit.bounds[0], hit.bounds[2]) for hit in hits if not hit.is_empty]
    left = max((high for _, high in spans if high <= 0), default=np.nan)
    right = min((low for low, _ in spans if low >= 0), default=np.nan)
    blocked = any(low < 0 < high for low, high in spans)
    if blocked or not right - left >= _MIN_FRACTION * width_m:
        return (np.nan, np.nan)
    return (left, right)


def _run_nearest_middle(flags: NDArray[np.bool_]) -> tuple[int, int] | None:
    """Bounds [first, last + 1) of the run of true flags nearest to the middle."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]]).astype(np.int8)))
    runs = edges.reshape(-1, 2).tolist()
    if not runs:
        return None
    middle = len(flags) / 2
    low, high = min(runs, key=lambda run: max(run[0] - middle, middle - run[1], 0.0))
    return (low, high)


def _exact(
    local: BaseGeometry, sides: tuple[float, float], rows: tuple[float, float]
) -> tuple[float, float]:
    """Depth of a gap: from the edges of its faces, where the rows found them within a step.

    Faces offset from each other overlap by less than their depth; the gap is then as deep as the
    thinner of them, centred on the overlap, if that much is free.
    """
    thinnest_m = np.inf
    lows, highs = [], []
    for side, beyond in zip(sides, (-1, 1), strict=True):
        x0, x1 = sorted((side + beyond * _OVER_M, side + beyond * 3 * _OVER_M))
        strip = local.intersection(box(x0, -_BESIDE_M, x1, _BESIDE_M))
        for face in shapely.get_parts(strip):
            _, bottom, _, top = face.bounds
            if top <= rows[0] or bottom >= rows[1]:
                continue
            thinnest_m = min(thinnest_m, top - bottom)
            lows += [bottom] if abs(bottom - rows[0]) < _STEP_M else []
            highs += [top] if abs(top - rows[1]) < _STEP_M else []
    low, high = max(lows, default=rows[0]), min(highs, default=rows[1])
    if np.isfinite(thinnest_m) and high - low < _MIN_COMMON * thinnest_m:
        middle, half = (low + high) / 2, thinnest_m / 2
        whole = box(sides[0] + _OVER_M, middle - half, sides[1] - _OVER_M, middle + half)
        if not local.intersects(whole):
            return (middle - half, middle + half)
    return low, high
