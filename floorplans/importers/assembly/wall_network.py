"""Walls as a network of lines, and the regions that it encloses together with links."""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry

from floorplans.walls import TOLERANCE_M

ON_EDGE_M = 1e-5
"""What is this near to an edge lies on it [m]."""

Lines = NDArray[np.object_]


class Network:
    """Lines in pieces that meet only at their ends, which are found once for any links.

    Attributes
    ----------
    lines : (n,) shapely lines
    """

    def __init__(self, lines: Lines, pieces: Lines | None = None) -> None:
        self.lines = lines
        self._pieces = _noded(lines) if pieces is None else pieces
        self._tree = shapely.STRtree(self._pieces)

    def around(self, region: Polygon) -> Network:
        """Lines that bound a region or lie outside: those within cannot extend it."""
        return Network(not_within(self.lines, region), not_within(self._pieces, region))

    def faces(self, links: NDArray[np.float64]) -> Lines:
        """Smallest regions that the lines and links enclose."""
        closing = np.array(shapely.linestrings(links), dtype=np.object_)
        touched = np.unique(self._tree.query(closing, "intersects")[1])
        met = _noded(np.concatenate([self._pieces[touched], closing]))
        pieces = np.concatenate([np.delete(self._pieces, touched), met])
        return np.array(shapely.get_parts(shapely.polygonize(pieces)), dtype=np.object_)

    def is_edged(self, face: BaseGeometry, others: Lines) -> bool:
        """Whether all lines in or on a face are edges of other faces too."""
        wide = face.buffer(ON_EDGE_M)
        pieces = self._pieces[self._tree.query(wide, "contains")]
        middles = shapely.line_interpolate_point(pieces, 0.5, normalized=True)
        shared = shapely.STRtree(others).query(middles, "dwithin", distance=TOLERANCE_M)[0]
        return len(np.unique(shared)) == len(pieces)


def _noded(lines: Lines) -> Lines:
    """Lines split where they meet."""
    return np.array(shapely.get_parts(shapely.union_all(lines)), dtype=np.object_)


def not_within(lines: Lines, region: Polygon) -> Lines:
    """Lines that bound a region or lie outside."""
    inner = region.buffer(-ON_EDGE_M)
    shapely.prepare(inner)
    return lines[~shapely.contains_properly(inner, lines)]
