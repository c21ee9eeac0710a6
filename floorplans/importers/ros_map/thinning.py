"""Skeletons of solid pixels: lines one pixel wide, as polylines."""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import LineString

Mask = NDArray[np.bool_]

_RING = ((1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1))
"""Neighbours of a pixel (row, column), in circular order."""


def thinned(solid: Mask) -> Mask:
    """Thin solid pixels to lines one pixel wide with the same connectivity.

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
            removable = _removable(image, at, first)
            image[tuple(at[removable].T)] = False
            removed |= bool(removable.any())
            at = at[~removable]
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
    """Chain the pixels of thin lines between junctions.

    Parameters
    ----------
    lines : (n_y, n_x) bool

    Returns
    -------
    list of shapely.geometry.LineString
        Through the centres (column, row) of adjacent pixels.
    """
    image = np.pad(lines, 1)
    at = np.argwhere(image)
    steps: list[NDArray[np.int64]] = []
    for row, column in ((0, 1), (1, 0), (1, 1), (1, -1)):
        linked = image[at[:, 0] + row, at[:, 1] + column]
        if row and column:  # a diagonal step only where no step along two sides exists
            linked &= ~image[at[:, 0] + row, at[:, 1]] & ~image[at[:, 0], at[:, 1] + column]
        here = at[linked]
        steps.append(np.stack([here, here + np.array([row, column])], axis=1))
    points = np.concatenate(steps)[:, :, ::-1].astype(np.float64) - 1.0
    merged = shapely.line_merge(shapely.multilinestrings(points))
    return [part for part in shapely.get_parts(merged) if isinstance(part, LineString)]


def pruned(lines: list[LineString], thickness: NDArray[np.float64]) -> list[LineString]:
    """Remove the short side branches that thinning leaves in corners, and join the rest.

    Parameters
    ----------
    lines : list of shapely.geometry.LineString
        Through pixels (column, row).
    thickness : (n_y, n_x) float64
        Of the solid there [pixels].

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
