"""Walls as a network of lines, and the regions that it encloses together with links."""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy.spatial import KDTree
from shapely.geometry import Polygon

from floorplans.walls import TOLERANCE_M

ON_EDGE_M = 1e-5
"""What is this near to an edge lies on it [m]."""

Lines = NDArray[np.object_]


class Network:
    """Walls and links in pieces that meet only at their ends.

    A piece stays as it is when others are added or left out, unless a new one meets it: what is
    enclosed once stays enclosed, however the places of crossings are rounded.

    Attributes
    ----------
    lines : (n,) shapely lines
        The walls.
    """

    def __init__(
        self, lines: Lines, pieces: Lines | None = None, is_wall: NDArray[np.bool_] | None = None
    ) -> None:
        self.lines = lines
        self._pieces = _noded(lines) if pieces is None else pieces
        self._is_wall = np.ones(len(self._pieces), np.bool_) if is_wall is None else is_wall

    @property
    def wall_pieces(self) -> Lines:
        """Pieces of walls."""
        return self._pieces[self._is_wall]

    def with_links(self, links: NDArray[np.float64]) -> Network:
        """Network with further links (n, 2, 2) [m]."""
        closing = np.array(shapely.linestrings(_on_nodes(links, self._pieces)), dtype=np.object_)
        near = shapely.STRtree(closing).query(self._pieces, "dwithin", distance=TOLERANCE_M)
        touched = np.unique(near[0])
        met = _noded(np.concatenate([_cut(self._pieces[touched], links), closing]))
        walls = shapely.STRtree(self._pieces[touched][self._is_wall[touched]])
        on_wall = np.zeros(len(met), dtype=np.bool_)
        on_wall[walls.query(middles(met), "dwithin", distance=TOLERANCE_M)[0]] = True
        return Network(
            self.lines,
            np.concatenate([np.delete(self._pieces, touched), met]),
            np.concatenate([np.delete(self._is_wall, touched), on_wall]),
        )

    def around(self, region: Polygon) -> Network:
        """What bounds a region or lies outside: what is within cannot extend it."""
        kept = _is_outside(self._pieces, region)
        return Network(not_within(self.lines, region), self._pieces[kept], self._is_wall[kept])

    def with_only(self, gaps: NDArray[np.float64]) -> Network:
        """Network with only those pieces of links that are given (n, 2, 2) [m]."""
        apart_m, _ = KDTree(gaps.mean(axis=1)).query(_ends(self._pieces).mean(axis=1))
        kept = self._is_wall | (apart_m <= TOLERANCE_M)
        return Network(self.lines, self._pieces[kept], self._is_wall[kept])

    def within(self, region: Polygon) -> Network:
        """What lies in a region or on its edge."""
        wide = region.buffer(ON_EDGE_M)
        shapely.prepare(wide)
        kept = shapely.covers(wide, self._pieces)
        return Network(self.lines, self._pieces[kept], self._is_wall[kept])

    def faces(self) -> Lines:
        """Smallest regions that walls and links enclose."""
        return np.array(shapely.get_parts(shapely.polygonize(self._pieces)), dtype=np.object_)


def _on_nodes(links: NDArray[np.float64], pieces: Lines) -> NDArray[np.float64]:
    """Links (n, 2, 2) with ends exactly at the ends of pieces that they differ from by rounding."""
    nodes, ends = shapely.get_coordinates(pieces), links.reshape(-1, 2)
    if not len(nodes) or not len(ends):
        return links
    apart_m, nearest = KDTree(nodes).query(ends)
    return np.where((apart_m <= TOLERANCE_M)[:, None], nodes[nearest], ends).reshape(-1, 2, 2)


def _cut(pieces: Lines, links: NDArray[np.float64]) -> Lines:
    """Pieces cut where links (n, 2, 2) end on them, at exactly their ends."""
    ends = np.unique(links.reshape(-1, 2), axis=0)
    piece, end = shapely.STRtree(_points(ends)).query(pieces, "dwithin", distance=TOLERANCE_M)
    first, last = _ends(pieces).transpose(1, 0, 2)
    step = last - first
    s = np.sum((ends[end] - first[piece]) * step[piece], axis=1) / np.hypot(*step[piece].T)
    inner = (s > TOLERANCE_M) & (s < np.hypot(*step[piece].T) - TOLERANCE_M)
    piece, s, points = piece[inner], s[inner], ends[end[inner]]
    order = np.lexsort((s, piece))
    at = np.concatenate([np.arange(len(pieces)), piece[order], np.arange(len(pieces))])
    order = np.argsort(at, kind="stable")
    points = np.concatenate([first, points[np.lexsort((s, piece))], last])[order]
    same = np.flatnonzero(np.diff(at[order]) == 0)
    return np.array(
        shapely.linestrings(np.stack([points[same], points[same + 1]], axis=1)), dtype=np.object_
    )


def _noded(lines: Lines) -> Lines:
    """Lines split where they meet."""
    return np.array(shapely.get_parts(shapely.union_all(lines)), dtype=np.object_)


def middles(lines: Lines) -> Lines:
    """Points halfway along lines."""
    return _points(_ends(lines).mean(axis=1))


def not_within(lines: Lines, region: Polygon) -> Lines:
    """Lines that bound a region or lie outside."""
    return lines[_is_outside(lines, region)]


def _is_outside(lines: Lines, region: Polygon) -> NDArray[np.bool_]:
    inner = region.buffer(-ON_EDGE_M)
    shapely.prepare(inner)
    return np.array(~shapely.contains_properly(inner, lines), dtype=np.bool_)


def _ends(lines: Lines) -> NDArray[np.float64]:
    """Ends of straight lines, (n, 2, 2)."""
    return shapely.get_coordinates(lines).reshape(-1, 2, 2)


def _points(places: NDArray[np.float64]) -> NDArray[np.object_]:
    return np.array(shapely.points(places), dtype=np.object_)
