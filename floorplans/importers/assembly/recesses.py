"""Parts of a region behind a gap that hold no wall of their own."""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from shapely.geometry import Polygon

from floorplans.importers.assembly.wall_network import Lines, Network, middles
from floorplans.walls import TOLERANCE_M


def without_recesses(region: Polygon, gaps: NDArray[np.float64], network: Network) -> Polygon:
    """Region without the parts behind a gap that hold no wall of their own, such as a niche.

    A part stays that connects others, such as a corridor that is open at its ends.

    Parameters
    ----------
    region : shapely.geometry.Polygon
        What walls and links enclose.
    gaps : (n, 2, 2) float64
        Sides of the region that only links close, each a piece of the network [m].
    network : Network

    Returns
    -------
    shapely.geometry.Polygon
        Without holes.
    """
    if not len(gaps):
        return region
    near = network.within(region)
    faces = near.with_only(gaps).faces()
    sides = _Sides(faces, near.wall_pieces)
    across = middles(np.array(shapely.linestrings(gaps), dtype=np.object_))
    behind = shapely.STRtree(faces).query(across, "dwithin", distance=TOLERANCE_M)[1]
    for k in dict.fromkeys(behind.tolist()):
        if sides.are_shared(k):
            sides.leave_out(k)
            if sides.n_parts() != 1:
                sides.take_in(k)
    rest = shapely.coverage_union_all(faces[sides.kept])
    if sides.kept.all() or not isinstance(rest, Polygon):
        return region
    return Polygon(rest.exterior)


class _Sides:
    """Which of some faces lie at which pieces of walls, and which faces are kept.

    Attributes
    ----------
    kept : (n,) bool
    """

    def __init__(self, faces: Lines, pieces: Lines) -> None:
        self.kept = np.ones(len(faces), dtype=np.bool_)
        face, piece = shapely.STRtree(middles(pieces)).query(faces, "dwithin", distance=TOLERANCE_M)
        self._n_at = np.bincount(piece, minlength=len(pieces))
        self._pieces_of = np.split(piece, np.searchsorted(face, np.arange(1, len(faces))))
        order = np.argsort(piece, kind="stable")
        same = np.flatnonzero(np.diff(piece[order]) == 0)
        self._pairs = np.stack([face[order][same], face[order][same + 1]])

    def are_shared(self, k: int) -> bool:
        """Whether all walls in or on a face are sides of other faces that are kept."""
        return bool((self._n_at[self._pieces_of[k]] > 1).all())

    def leave_out(self, k: int) -> None:
        """Keep a face no longer."""
        self.kept[k] = False
        self._n_at[self._pieces_of[k]] -= 1

    def take_in(self, k: int) -> None:
        """Keep a face again."""
        self.kept[k] = True
        self._n_at[self._pieces_of[k]] += 1

    def n_parts(self) -> int:
        """Number of parts that the kept faces make up; those that share a wall are one."""
        both = self._pairs[:, self.kept[self._pairs].all(axis=0)]
        graph = coo_array((np.ones(both.shape[1]), tuple(both)), shape=(len(self.kept),) * 2)
        _, labels = connected_components(graph, directed=False)
        return len(np.unique(labels[self.kept]))
