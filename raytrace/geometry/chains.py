"""Walls and cuts as chains of vertices, which they share where they meet.

What coincides is decided here, once: vertices within `COINCIDENT_M` of each other become one, a
chain passes through every vertex that near to it, and chains that cross get a vertex there. After
that, different vertices lie apart, and so do a vertex and a chain that does not pass through it.
The straight pieces of all chains then meet at common vertices only, and no face between them is as
thin as a rounding error.
"""

from collections.abc import Iterable, Sequence
from itertools import pairwise

import numpy as np
import shapely
from numpy.typing import NDArray

from raytrace.arrays import Floats
from raytrace.errors import SceneError
from raytrace.geometry.sheets import COINCIDENT_M

Vertex = tuple[float, float]
Segment = tuple[Vertex, Vertex]

FINEST_SNAP_M = 2.0**-40
"""Vertices are snapped to this grid, or a coarser one where coordinates are large [m]."""

AIM_M = 1e-3
"""A cut that would pass a vertex by less ends there [m]."""

AHEAD_M = 1e-6
"""A cut looks for other chains from here [m]."""

FARTHEST_M = 1e5
"""A cut looks for other chains up to here [m]."""

MOST_ROUNDS = 100
"""Rounds of deciding what coincides; a few are enough where walls are drawn with care."""


class Chains:
    """Walls and cuts as chains of vertices.

    Parameters
    ----------
    segments
        The walls.
    """

    def __init__(self, segments: Iterable[Segment]) -> None:
        self._chains = [list(segment) for segment in segments]
        self._lines = np.empty(0, dtype=object)
        self._ends = np.empty((0, 2, 2))
        self._redrawn = set(range(len(self._chains)))
        self._seen = Places()
        far = max((abs(c) for chain in self._chains for v in chain for c in v), default=1.0)
        self.snap_m = max(FINEST_SNAP_M, 2.0 ** (np.ceil(np.log2(max(far, 1.0))) - 46.0))
        self._settle()

    def geometries(self) -> NDArray[np.object_]:
        """(n,) line strings; empty for a chain whose vertices are one."""
        added = np.empty(len(self._chains) - len(self._lines), dtype=object)
        self._lines = np.concatenate([self._lines, added])
        self._ends = np.concatenate([self._ends, np.zeros((len(added), 2, 2))])
        for number in self._redrawn:
            chain = self._chains[number]
            self._lines[number] = shapely.LineString(chain if len(chain) > 1 else None)
            self._ends[number] = chain[0], chain[-1]
        self._redrawn.clear()
        return self._lines.copy()

    def pieces(self) -> list[Segment]:
        """Straight pieces between vertices, which are snapped."""
        noded = shapely.get_parts(shapely.union_all(self.geometries(), grid_size=self.snap_m))
        found: dict[Segment, None] = {}
        for line in noded:
            points = [vertex_at(p) for p in shapely.get_coordinates(line)]
            for a, b in pairwise(points):
                found[(a, b) if a < b else (b, a)] = None
        return list(found)

    def add_cuts(self, cuts: Sequence[tuple[Vertex, Floats]]) -> Vertex | None:
        """Add straight cuts, each from a vertex in a direction to what it meets first.

        Returns
        -------
        tuple or None
            The first vertex from which a cut meets nothing; None if there is none.
        """
        self._seen = Places(self._vertices())
        for tip, ahead in cuts:
            if not self._add_cut(tip, ahead):
                return tip
        self._settle()
        return None

    def _add_cut(self, tip: Vertex, ahead: Floats) -> bool:
        """Add a cut, unless there is one already; return whether it meets something."""
        start, reach = np.array(tip), FARTHEST_M
        ray = shapely.LineString([start + ahead * AHEAD_M, start + ahead * FARTHEST_M])
        lines = self.geometries()
        met = self._met(start, ahead)
        hits, line = shapely.get_coordinates(
            shapely.intersection(ray, lines[met]), return_index=True
        )
        chain = met[line]
        away = np.hypot(*(hits - start).T)
        if len(hits):
            reach = float(away.min()) + AIM_M
        offset = self._seen.points - start
        apart = np.hypot(*offset.T)
        root = self._first_of(np.flatnonzero(apart == apart.min()))
        if len(hits) and root in self._chains[chain[away.argmin()]]:
            return True
        passed = self._passed(offset, ahead, reach)
        if len(passed):
            place = self._first_of(passed)
        elif len(hits):
            nearest = int(np.argmin(away))
            place = self._insert(int(chain[nearest]), vertex_at(hits[nearest]))
        else:
            return False
        self._redrawn.add(len(self._chains))
        self._chains.append([root, place])
        return True

    def _met(self, start: Floats, ahead: Floats) -> NDArray[np.int64]:
        """Numbers of the chains that a ray may meet: those that are not on one side of it."""
        x, y = (self._ends - start).transpose(2, 1, 0)
        left, along = ahead[0] * y - ahead[1] * x, ahead[0] * x + ahead[1] * y
        beside = (np.minimum(*left) > AIM_M) | (np.maximum(*left) < -AIM_M)
        return np.flatnonzero(~beside & (np.maximum(*along) > -AIM_M))

    def _first_of(self, found: NDArray[np.int64]) -> Vertex:
        """Vertex of a number; of several, the first in the order of the chains."""
        vertices = [self._seen.vertices[number] for number in found.tolist()]
        if len(vertices) == 1:
            return vertices[0]
        return next(vertex for vertex in self._vertices() if vertex in vertices)

    @staticmethod
    def _passed(offset: Floats, ahead: Floats, reach: float) -> NDArray[np.int64]:
        """Return the first vertex that a ray passes by less than `AIM_M`, or several as near."""
        along = offset @ ahead
        aside = np.abs(ahead[0] * offset[:, 1] - ahead[1] * offset[:, 0])
        passed = np.flatnonzero((aside < AIM_M) & (along > AHEAD_M) & (along < reach))
        return passed[along[passed] == along[passed].min(initial=np.inf)]

    def _vertices(self) -> list[Vertex]:
        """All vertices, ends of chains first."""
        ends = [v for chain in self._chains for v in (chain[0], chain[-1])]
        return list(dict.fromkeys([*ends, *(v for chain in self._chains for v in chain)]))

    def _settle(self) -> None:
        """Decide what coincides."""
        at = None
        for _ in range(MOST_ROUNDS):
            at = self._merge_vertices() or self._pass_through_vertices() or self._insert_crossings()
            if at is None:
                return
        raise SceneError(
            f"the walls around {at} run so near to each other that they cannot be told apart: "
            f"let them meet, or move them apart by more than {COINCIDENT_M:g} m"
        )

    def _merge_vertices(self) -> Vertex | None:
        """Replace vertices by others that they coincide with; return one, or None."""
        vertices = self._vertices()
        points = shapely.points(vertices)
        pairs = shapely.STRtree(points).query(points, "dwithin", COINCIDENT_M)
        merged: dict[Vertex, Vertex] = {}
        for kept, other in sorted(pairs.T[pairs[0] < pairs[1]].tolist()):
            if vertices[kept] not in merged:
                merged.setdefault(vertices[other], vertices[kept])
        for number, chain in enumerate(self._chains):
            if not merged.keys().isdisjoint(chain):
                self._chains[number] = list(dict.fromkeys(merged.get(v, v) for v in chain))
                self._redrawn.add(number)
        return next(iter(merged), None)

    def _pass_through_vertices(self) -> Vertex | None:
        """Insert vertices into chains that they lie on; return one, or None."""
        vertices, inserted = self._vertices(), None
        tree = shapely.STRtree(self.geometries())
        near = tree.query(shapely.points(vertices), "dwithin", COINCIDENT_M)
        for number, chain in near.T.tolist():
            if vertices[number] not in self._chains[chain]:
                inserted = self._insert(chain, vertices[number])
        return inserted

    def _insert_crossings(self) -> Vertex | None:
        """Insert a vertex where chains cross; return one, or None."""
        pieces = [(k, a, b) for k, chain in enumerate(self._chains) for a, b in pairwise(chain)]
        lines = shapely.linestrings([(a, b) for _, a, b in pieces])
        one, two = shapely.STRtree(lines).query(lines, "crosses")
        one, two = one[one < two], two[one < two]
        places = shapely.get_coordinates(shapely.intersection(lines[one], lines[two]))
        inserted = None
        for i, j, place in zip(one.tolist(), two.tolist(), places, strict=True):
            for piece in (i, j):
                inserted = self._insert(pieces[piece][0], vertex_at(place))
        return inserted

    def _insert(self, number: int, vertex: Vertex) -> Vertex:
        """Insert a vertex into a chain; return it, or the vertex already there."""
        chain = self._chains[number]
        away = [float(np.hypot(v[0] - vertex[0], v[1] - vertex[1])) for v in chain]
        if min(away) <= COINCIDENT_M:
            return chain[away.index(min(away))]
        self._seen.add(vertex)
        chain.append(vertex)
        start, end = np.array(chain[0]), np.array(chain[-2])
        chain.sort(key=lambda v: float((np.array(v) - start) @ (end - start)))
        self._redrawn.add(number)
        return vertex


class Places:
    """Different vertices, and their points.

    Attributes
    ----------
    vertices : list of tuple
    """

    def __init__(self, vertices: Sequence[Vertex] = ()) -> None:
        self.vertices = list(vertices)
        self._known = set(vertices)
        self._points = np.array(vertices, dtype=np.float64).reshape(-1, 2)

    @property
    def points(self) -> Floats:
        """(n, 2) [m]."""
        return self._points[: len(self.vertices)]

    def add(self, vertex: Vertex) -> None:
        """Add a vertex, unless it is there already."""
        if vertex in self._known:
            return
        if len(self.vertices) == len(self._points):
            self._points = np.concatenate([self._points, np.empty((len(self._points) + 16, 2))])
        self._points[len(self.vertices)] = vertex
        self.vertices.append(vertex)
        self._known.add(vertex)


def vertex_at(point: Sequence[float] | Floats) -> Vertex:
    """Return a point as a vertex."""
    return float(point[0]), float(point[1])
