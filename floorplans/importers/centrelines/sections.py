"""Sections of straight lines inside an area of thousands of corners, all lines at once."""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry.base import BaseGeometry

from floorplans.walls import Interval

BESIDE_M = 1e-6
"""What is this near to an area lies in it [m]."""

Segments = NDArray[np.float64]
Pairs = NDArray[np.int64]


def sections_inside(lines: Segments, area: BaseGeometry) -> list[list[Interval]]:
    """Sections of lines inside an area.

    The edge of the area cuts each line into pieces; a piece lies inside if its middle does.

    Parameters
    ----------
    lines : (n, 2, 2) float64
        [m].
    area : shapely geometry
        Polygons [m].

    Returns
    -------
    list of list of (float, float)
        For each line, begin and end of each section along it from its start, in order [m].
    """
    sections: list[list[Interval]] = [[] for _ in lines]
    if not len(lines) or area.is_empty:
        return sections
    line, s = _cuts(lines, _edges(area))
    piece = np.flatnonzero(np.diff(line) == 0)
    line, low, high = line[piece], s[piece], s[piece + 1]
    inside = _is_inside(lines, line, (low + high) / 2, area) | (high - low <= 2 * BESIDE_M)
    line, low, high = line[inside], low[inside], high[inside]
    begins = np.ones(len(line), dtype=np.bool_)
    begins[1:] = (line[1:] != line[:-1]) | (low[1:] > high[:-1])
    ends = np.roll(begins, -1)
    for k, begin, end in zip(
        line[begins].tolist(), low[begins].tolist(), high[ends].tolist(), strict=True
    ):
        if end - begin > 2 * BESIDE_M:
            sections[k].append((begin, end))
    return sections


def _edges(area: BaseGeometry) -> Segments:
    """Straight pieces of the edge of an area, (n, 2, 2)."""
    rings = shapely.get_rings(shapely.get_parts(area))
    points, ring = shapely.get_coordinates(rings, return_index=True)
    first = np.flatnonzero(np.diff(ring) == 0)
    return np.stack([points[first], points[first + 1]], axis=1)


def _cuts(lines: Segments, edges: Segments) -> tuple[Pairs, NDArray[np.float64]]:
    """Numbers of lines and places along them [m] of their ends and of the edges, in order."""
    tree = shapely.STRtree(linestrings(edges))
    line, edge = tree.query(linestrings(lines), "dwithin", distance=BESIDE_M)
    steps = lines[:, 1] - lines[:, 0]
    length_m = np.hypot(steps[:, 0], steps[:, 1])
    along = steps / np.where(length_m > 0, length_m, 1.0)[:, None]
    offsets = edges[edge] - lines[line, None, 0]
    s = np.sum(offsets * along[line, None], axis=2)
    t = along[line, None, 0] * offsets[..., 1] - along[line, None, 1] * offsets[..., 0]
    across = t[:, 1] - t[:, 0]
    crosses = t[:, 0] * t[:, 1] < 0
    ratio = np.divide(-t[:, 0], across, out=np.zeros_like(across), where=crosses)
    touches = np.abs(t) <= BESIDE_M
    numbers = np.arange(len(lines))
    which = np.concatenate([numbers, numbers, line[crosses], *(line[x] for x in touches.T)])
    places = np.concatenate(
        [
            np.zeros(len(lines)),
            length_m,
            (s[:, 0] + ratio * (s[:, 1] - s[:, 0]))[crosses],
            *(s[touches[:, k], k] for k in (0, 1)),
        ]
    )
    places = np.clip(places, 0.0, length_m[which])
    order = np.lexsort((places, which))
    return which[order], places[order]


def _is_inside(
    lines: Segments, line: Pairs, s: NDArray[np.float64], area: BaseGeometry
) -> NDArray[np.bool_]:
    """Whether places along lines [m] lie in an area or just beside it."""
    steps = lines[line, 1] - lines[line, 0]
    length_m = np.hypot(steps[:, 0], steps[:, 1])
    ratio = s / np.where(length_m > 0, length_m, 1.0)
    points = lines[line, 0] + ratio[:, None] * steps
    shapely.prepare(area)
    inside = np.array(shapely.intersects_xy(area, points), dtype=np.bool_)
    outside = np.flatnonzero(~inside)
    inside[outside] = shapely.dwithin(area, shapely.points(points[outside]), BESIDE_M)
    return inside


def linestrings(ends: Segments) -> NDArray[np.object_]:
    """Shapely lines (n,) between pairs of points (n, 2, 2)."""
    return np.array(shapely.linestrings(ends), dtype=np.object_)
