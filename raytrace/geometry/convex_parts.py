"""Faces of the plan view divided into convex parts: triangles, merged where they stay convex."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from raytrace.arrays import Floats, Ints
from raytrace.errors import SceneError
from raytrace.geometry.chains import Vertex
from raytrace.geometry.sheets import COINCIDENT_M
from raytrace.kernels.plan_view import GRAZING_M

Ring = list[int]
Edge = tuple[int, int]

MOST_FLIPS = 10
"""Flips per flat triangle."""

FLAT = 0.1
"""Sine below which the shortest edge of a triangle is along its longest; a needle is not flat."""

_MANY = 64
"""Corners from which on edges are not compared with the corners of their own ring."""


def convex_parts(
    faces: Sequence[shapely.Polygon], index: dict[Vertex, int], walls: Collection[Edge]
) -> list[Ring]:
    """Divide faces into convex parts.

    Parameters
    ----------
    faces
        Simply bounded polygons.
    index
        Numbers of their vertices, in order.
    walls
        Edges (smaller number, larger number) that remain.

    Returns
    -------
    list
        Vertex numbers of each part, counter-clockwise. No vertex lies farther than `GRAZING_M` on
        the outer side of an edge of its part.
    """
    vertices = np.array(list(index))
    triangles = [ring for face in faces for ring in _triangles(face, index)]
    _flip_flat(triangles, vertices)
    return _merged(triangles, vertices, walls)


def edges_of(ring: Ring) -> list[Edge]:
    """Return the edges of a ring, in order."""
    return list(zip(ring, ring[1:] + ring[:1], strict=True))


def undirected(a: int, b: int) -> Edge:
    """Return an edge without its direction."""
    return (a, b) if a < b else (b, a)


def _triangles(face: shapely.Polygon, index: dict[Vertex, int]) -> list[Ring]:
    """Constrained Delaunay triangles of a face."""
    rings: list[Ring] = []
    for triangle in shapely.get_parts(shapely.constrained_delaunay_triangles(face)):
        ring = shapely.get_coordinates(shapely.orient_polygons(triangle))[:3]
        rings.append([index[(float(x), float(y))] for x, y in ring])
    return rings


def _flip_flat(triangles: list[Ring], vertices: Floats) -> None:
    """Replace triangles whose corners lie on one line: flip the edge to their neighbour.

    Rounding leaves such triangles along straight rows of vertices. The neighbour across the longest
    edge is divided at the corner between its ends instead.
    """
    owner = {edge: k for k, ring in enumerate(triangles) for edge in edges_of(ring)}
    flat = [k for k, ring in enumerate(triangles) if _is_flat(ring, vertices)]
    flips_left = MOST_FLIPS * len(flat)
    while flat and flips_left:
        flips_left -= 1
        k = flat.pop(0)
        a, b, c = _longest_edge_first(triangles[k], vertices)
        other = owner.get((b, a))
        if other is None:
            continue
        if other in flat:
            flat.append(k)
            continue
        d = sum(triangles[other]) - a - b
        del owner[a, b], owner[b, a]
        for number, ring in ((k, [a, d, c]), (other, [d, b, c])):
            triangles[number] = ring
            owner.update(dict.fromkeys(edges_of(ring), number))
            if _is_flat(ring, vertices):
                flat.append(number)


def _is_flat(triangle: Ring, vertices: Floats) -> bool:
    """Whether the corner opposite the longest edge lies on it, between its ends."""
    a, b, c = vertices[_longest_edge_first(triangle, vertices)]
    along, to_c = b - a, c - a
    height = abs(along[0] * to_c[1] - along[1] * to_c[0]) / np.hypot(*along)
    shortest = min(np.hypot(*to_c), np.hypot(*(c - b)))
    return bool(height < min(COINCIDENT_M, FLAT * shortest))


def _longest_edge_first(triangle: Ring, vertices: Floats) -> Ring:
    corners = vertices[triangle]
    k = int(np.hypot(*(np.roll(corners, -1, axis=0) - corners).T).argmax())
    return triangle[k:] + triangle[:k]


def _merged(rings: list[Ring], vertices: Floats, walls: Collection[Edge]) -> list[Ring]:
    """Remove cuts, longest first, while both sides together stay convex (Hertel-Mehlhorn)."""
    owner = {edge: k for k, ring in enumerate(rings) for edge in edges_of(ring)}
    cuts = [e for e in owner if e[0] < e[1] and e not in walls]
    cuts.sort(key=lambda e: (-np.hypot(*(vertices[e[0]] - vertices[e[1]])), e))
    parts = _Parts(rings, vertices)
    for a, b in cuts:
        if (b, a) in owner:
            parts.join(owner[a, b], owner[b, a], a, b)
    return parts.rings()


@dataclass
class _Part:
    """A ring of vertices, without their order.

    Attributes
    ----------
    corners
        (n,) vertex numbers.
    ahead
        (n, 2) unit vectors of the edges that start there.
    members
        The vertex numbers.
    first
        A vertex and the next: where the ring begins.
    place
        Number of the ring in the list of all.
    """

    corners: Ints
    ahead: Floats
    members: set[int]
    first: Edge
    place: int


class _Parts:
    """Triangles, and the rings they are joined to."""

    def __init__(self, rings: list[Ring], vertices: Floats) -> None:
        self._vertices = vertices
        corners = np.array(rings).reshape(-1, 3)
        ahead = vertices[np.roll(corners, -1, axis=1)] - vertices[corners]
        ahead /= np.hypot(ahead[..., 0], ahead[..., 1])[..., None]
        self._parts = {
            k: _Part(corners[k], ahead[k], set(ring), (ring[0], ring[1]), k)
            for k, ring in enumerate(rings)
        }
        self._root = list(range(len(rings)))
        self._next: dict[Edge, int] = {}
        self._previous: dict[Edge, int] = {}
        for ring in rings:
            for before, (a, b), after in zip(
                ring[-1:] + ring[:-1], edges_of(ring), ring[2:] + ring[:2], strict=True
            ):
                self._previous[a, b], self._next[a, b] = before, after

    def join(self, left: int, right: int, a: int, b: int) -> None:
        """Join two rings at an edge, a to b of the left one, where together they are convex."""
        left, right = self._found(left), self._found(right)
        if left == right:
            return
        one, two = self._parts[left], self._parts[right]
        small, large = sorted((one.members, two.members), key=len)
        if len(small & large) > 2 or not self._is_convex(one, two, a, b):
            return
        before_a, after_b = self._previous[a, b], self._next[a, b]
        before_b, after_a = self._previous[b, a], self._next[b, a]
        self._next[before_a, a], self._previous[a, after_a] = after_a, before_a
        self._next[before_b, b], self._previous[b, after_b] = after_b, before_b
        kept = one if large is one.members else two
        kept.corners, kept.ahead = self._edges_of_both(one, two, a, b)
        kept.members |= small
        kept.first, kept.place = (b, after_b), one.place
        gone, root = (right, left) if kept is one else (left, right)
        self._root[gone] = root
        del self._parts[gone]

    @staticmethod
    def _edges_of_both(one: _Part, two: _Part, a: int, b: int) -> tuple[Ints, Floats]:
        """Corners and edges without the common one."""
        of_one, of_two = one.corners != a, two.corners != b
        return (
            np.concatenate([one.corners[of_one], two.corners[of_two]]),
            np.concatenate([one.ahead[of_one], two.ahead[of_two]]),
        )

    def rings(self) -> list[Ring]:
        """Vertex numbers of each ring, in order."""
        found: list[Ring] = []
        for part in sorted(self._parts.values(), key=lambda part: part.place):
            ring, edge = [part.first[0]], part.first
            while edge[1] != ring[0]:
                ring.append(edge[1])
                if len(ring) > len(self._vertices):
                    x, y = self._vertices[ring[0]]
                    raise SceneError(f"walls too close to tell apart at ({x:g}, {y:g})")
                edge = (edge[1], self._next[edge])
            found.append(ring)
        return found

    def _found(self, k: int) -> int:
        """Which ring the ring of a number is part of by now."""
        while self._root[k] != k:
            self._root[k] = self._root[self._root[k]]
            k = self._root[k]
        return k

    def _is_convex(self, one: _Part, two: _Part, a: int, b: int) -> bool:
        """Whether no corner lies farther than `GRAZING_M` beyond an edge of what would be joined.

        The edges of large rings, which are convex, are compared with the other's corners only.
        """
        if len(one.corners) + len(two.corners) <= _MANY:
            corners, ahead = self._edges_of_both(one, two, a, b)
            return self._are_inside(corners, corners, ahead)
        for part, other, start in ((one, two, a), (two, one, b)):
            beyond = other.corners[(other.corners != a) & (other.corners != b)]
            if len(part.corners) == 3:
                beyond = np.concatenate([beyond, part.corners])
            edges = part.corners != start
            if not self._are_inside(beyond, part.corners[edges], part.ahead[edges]):
                return False
        return True

    def _are_inside(self, corners: Ints, starts: Ints, ahead: Floats) -> bool:
        offset = self._vertices[corners][None] - self._vertices[starts][:, None]
        inside = ahead[:, :1] * offset[:, :, 1] - ahead[:, 1:] * offset[:, :, 0]
        return bool(inside.min() >= -GRAZING_M)
