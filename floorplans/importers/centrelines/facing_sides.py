"""Sides of wall areas that face each other across solid wall -> the centre line between them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry

from floorplans.importers.centrelines.axes import Axis, point_of
from floorplans.importers.centrelines.sections import BESIDE_M, linestrings, sections_inside

_PARALLEL = np.cos(np.radians(12.0))
_LEAST_M = 1e-3
"""Sides nearer to each other are no wall's [m]."""
_FACING_FRACTION = 0.6  # of the thickness, on which the two sides of a wall must face each other

Vectors = NDArray[np.float64]


def axes_of(parts: list[Polygon], thickest_m: float, fillings: BaseGeometry) -> list[Axis]:
    """Return the centre lines between sides that face each other.

    Only their sections in the solid: a niche or a shaft may interrupt a wall.

    Parameters
    ----------
    parts : list of shapely.geometry.Polygon
        Wall areas, outer rings counter-clockwise, that do not overlap [m].
    thickest_m : float
        Largest distance of two sides [m].
    fillings : shapely geometry
        Areas of doors and windows [m]: axes whose middle lies in one are flagged.

    Returns
    -------
    list of Axis
    """
    if not parts:
        return []
    edges = _edges(parts)
    lines, thickness_m = _lines_between(edges, _facing_pairs(edges, thickest_m), thickest_m)
    found = sections_inside(lines, shapely.multipolygons(parts))
    solid, whole_m = [], np.hypot(*(lines[:, 1] - lines[:, 0]).T)
    for line, sections, thick_m, length_m in zip(
        lines, found, thickness_m.tolist(), whole_m.tolist(), strict=True
    ):
        for low, high in sections:
            if high - low > thick_m or high - low > length_m - 4 * BESIDE_M:
                ends = line[0] + np.outer((low, high), (line[1] - line[0]) / length_m)
                solid.append((ends, thick_m))
    return _flagged(solid, fillings)


@dataclass(frozen=True)
class _Edges:
    """Sides of polygons, solid on their left.

    Attributes
    ----------
    start, along : (n, 2) float64
        One end [m], and the unit direction.
    length : (n,) float64
        [m].
    part : (n,) int64
        Number of the polygon.
    """

    start: Vectors
    along: Vectors
    length: Vectors
    part: NDArray[np.int64]


def _edges(parts: list[Polygon]) -> _Edges:
    rings, part = shapely.get_rings(parts, return_index=True)
    points, ring = shapely.get_coordinates(rings, return_index=True)
    first = np.flatnonzero(np.diff(ring) == 0)
    step = points[first + 1] - points[first]
    length = np.hypot(step[:, 0], step[:, 1])
    real = length > 0
    first, step, length = first[real], step[real], length[real]
    return _Edges(points[first], step / length[:, None], length, part[ring[first]])


def _facing_pairs(edges: _Edges, thickest_m: float) -> NDArray[np.int64]:
    """Pairs (i, j), i < j, of opposed sides of one polygon that lie near each other, (n, 2)."""
    ends = np.stack([edges.start, edges.start + edges.along * edges.length[:, None]], axis=1)
    low, high = ends.min(axis=1), ends.max(axis=1)
    tree = shapely.STRtree(linestrings(ends))
    boxes = shapely.box(*(low - thickest_m).T, *(high + thickest_m).T)
    i, j = tree.query(boxes)
    dot = np.sum(edges.along[i] * edges.along[j], axis=1)
    chosen = (i < j) & (edges.part[i] == edges.part[j]) & (dot < -_PARALLEL)
    pairs = np.stack([i[chosen], j[chosen]], axis=1)
    return pairs[np.lexsort(pairs.T[::-1])]


def _lines_between(
    edges: _Edges, pairs: NDArray[np.int64], thickest_m: float
) -> tuple[Vectors, Vectors]:
    """Centre lines (n, 2, 2) and thicknesses (n,) of the walls between pairs of sides [m].

    Without those of sides that do not face each other.
    """
    along = edges.along[pairs[:, 0]] - edges.along[pairs[:, 1]]
    along /= np.hypot(along[:, 0], along[:, 1])[:, None]
    across = np.stack([-along[:, 1], along[:, 0]], axis=1)
    start = edges.start[pairs]
    ends = np.stack([start, start + (edges.along * edges.length[:, None])[pairs]], axis=2)
    s, t = (np.einsum("pkec,pc->pke", ends, axis) for axis in (along, across))
    low, high = s.min(axis=2).max(axis=1), s.max(axis=2).min(axis=1)
    places = np.stack([low, high], axis=1)
    run = s[..., 1] - s[..., 0]
    slope = np.divide(t[..., 1] - t[..., 0], run, out=np.zeros_like(run), where=run != 0)
    near, far = (t[:, k, :1] + slope[:, k, None] * (places - s[:, k, :1]) for k in (0, 1))
    thickness_m = np.mean(far - near, axis=1)
    facing = (thickness_m > _LEAST_M) & (thickness_m <= thickest_m) & (high > low)
    facing &= high - low >= _FACING_FRACTION * thickness_m
    middle = (near + far) / 2
    lines = places[..., None] * along[:, None] + middle[..., None] * across[:, None]
    return lines[facing], thickness_m[facing]


def _flagged(lines: list[tuple[Vectors, float]], fillings: BaseGeometry) -> list[Axis]:
    """Axes; those whose middle lies in a filling are flagged."""
    shapely.prepare(fillings)
    middles = np.array([ends.mean(axis=0) for ends, _ in lines]).reshape(-1, 2)
    in_filling = np.array(shapely.intersects_xy(fillings, middles)).tolist()
    return [
        Axis(point_of(ends[0]), point_of(ends[1]), thickness_m, is_filling)
        for (ends, thickness_m), is_filling in zip(lines, in_filling, strict=True)
    ]
