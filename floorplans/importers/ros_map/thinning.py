"""Lines one pixel wide in the middle of what is solid in a picture, as polylines."""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import LineString

Mask = NDArray[np.bool_]

_RING = ((1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1))
"""Neighbours of a pixel (row, column), going round it."""


def thinned(solid: Mask) -> Mask:
    """Thin what is solid to lines one pixel wide that are connected as it is.

    The method is that of T. Y. Zhang and C. Y. Suen, A fast parallel algorithm for thinning digital
    patterns, Communications of the ACM 27 (1984) 236-239.

    Parameters
    ----------
    solid : (n_y, n_x) bool

    Returns
    -------
    (n_y, n_x) bool
    """
    image = np.pad(solid, 1)
    at = np.argwhere(image)
    removed = True
    while removed:
        removed = False
        for first in (True, False):
            loose = _removable(image, at, first)
            image[tuple(at[loose].T)] = False
            removed |= bool(loose.any())
            at = at[~loose]
    return image[1:-1, 1:-1]


def _removable(image: Mask, at: NDArray[np.int64], first: bool) -> Mask:
    """Which of the pixels `at` (n, 2) a pass of the thinning removes."""
    around = np.array([image[at[:, 0] + row, at[:, 1] + column] for row, column in _RING])
    count = around.sum(axis=0)
    changes = (~around & np.roll(around, -1, axis=0)).sum(axis=0)
    north, east, south, west = around[::2]
    if first:
        ends = ~(north & east & south) & ~(east & south & west)
    else:
        ends = ~(north & east & west) & ~(north & south & west)
    return (count >= 2) & (count <= 6) & (changes == 1) & ends


def polylines(lines: Mask) -> list[LineString]:
    """Chain the pixels of thin lines from junction to junction.

    Parameters
    ----------
    lines : (n_y, n_x) bool

    Returns
    -------
    list of shapely.geometry.LineString
        Through the centres (column, row) of pixels that touch.
    """
    image = np.pad(lines, 1)
    at = np.argwhere(image)
    steps: list[NDArray[np.int64]] = []
    for row, column in ((0, 1), (1, 0), (1, 1), (1, -1)):
        linked = image[at[:, 0] + row, at[:, 1] + column]
        if row and column:  # a diagonal step only where there is no way along two sides
            linked &= ~image[at[:, 0] + row, at[:, 1]] & ~image[at[:, 0], at[:, 1] + column]
        here = at[linked]
        steps.append(np.stack([here, here + np.array([row, column])], axis=1))
    points = np.concatenate(steps)[:, :, ::-1].astype(np.float64) - 1.0
    merged = shapely.line_merge(shapely.multilinestrings(points))
    return [part for part in shapely.get_parts(merged) if isinstance(part, LineString)]


def pruned(lines: list[LineString], thickness: NDArray[np.float64]) -> list[LineString]:
    """Remove the short side branches that thinning leaves in corners, and join what goes on.

    Parameters
    ----------
    lines : list of shapely.geometry.LineString
        Through pixels (column, row).
    thickness : (n_y, n_x) float64
        Of what is solid there [pixels].

    Returns
    -------
    list of shapely.geometry.LineString
    """
    ends = [end for line in lines for end in (line.coords[0], line.coords[-1])]
    kept = [line for line in lines if not _is_spur(line, ends, thickness)]
    if not kept:
        return lines
    merged = shapely.line_merge(shapely.union_all(kept))
    return [part for part in shapely.get_parts(merged) if isinstance(part, LineString)]


def _is_spur(
    line: LineString, ends: list[tuple[float, ...]], thickness: NDArray[np.float64]
) -> bool:
    degrees = [ends.count(end) for end in (line.coords[0], line.coords[-1])]
    if min(degrees) != 1 or max(degrees) < 3:
        return False
    column, row = (int(c) for c in line.coords[0 if degrees[0] > 1 else -1])
    return line.length < 1.0 + thickness[row, column]
