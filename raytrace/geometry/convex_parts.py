"""Faces of the plan view divided into convex parts: triangles, merged where they stay convex."""

from collections.abc import Collection, Sequence

import numpy as np
import shapely

from raytrace.arrays import Floats
from raytrace.geometry.chains import Vertex
from raytrace.geometry.sheets import COINCIDENT_M
from raytrace.kernels.plan_view import GRAZING_M

Ring = list[int]
Edge = tuple[int, int]

MOST_FLIPS = 10
"""Flips per flat triangle."""

_MANY = 64
"""Corners from which on it is faster to find the convex hull of a ring first."""


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
    a, b, c = vertices[_longest_edge_first(triangle, vertices)]
    along, to_c = b - a, c - a
    return bool(abs(along[0] * to_c[1] - along[1] * to_c[0]) < COINCIDENT_M * np.hypot(*along))


def _longest_edge_first(triangle: Ring, vertices: Floats) -> Ring:
    corners = vertices[triangle]
    k = int(np.hypot(*(np.roll(corners, -1, axis=0) - corners).T).argmax())
    return triangle[k:] + triangle[:k]


def _merged(rings: list[Ring], vertices: Floats, walls: Collection[Edge]) -> list[Ring]:
    """Remove cuts, longest first, while both sides together stay convex (Hertel-Mehlhorn)."""
    owner = {edge: k for k, ring in enumerate(rings) for edge in edges_of(ring)}
    cuts = [e for e in owner if e[0] < e[1] and e not in walls]
    cuts.sort(key=lambda e: (-np.hypot(*(vertices[e[0]] - vertices[e[1]])), e))
    alive = dict(enumerate(rings))
    for a, b in cuts:
        left, right = owner[a, b], owner.get((b, a))
        if right is None or left == right:
            continue
        merged = _joined(alive[left], alive[right], a, b)
        if len(set(merged)) < len(merged) or not _is_convex(vertices[merged]):
            continue
        alive[left] = merged
        del alive[right], owner[a, b], owner[b, a]
        owner.update(dict.fromkeys(edges_of(merged), left))
    return list(alive.values())


def _joined(left: Ring, right: Ring, a: int, b: int) -> Ring:
    """One ring of two that share the edge a-b (left holds a -> b, right b -> a)."""
    k, m = left.index(b), right.index(a)
    from_b_to_a = left[k:] + left[:k]
    from_a_to_b = right[m:] + right[:m]
    return from_b_to_a[:-1] + from_a_to_b[:-1]


def _is_convex(corners: Floats) -> bool:
    """Whether no corner of a ring lies farther than `GRAZING_M` beyond one of its edges."""
    ahead = np.roll(corners, -1, axis=0) - corners
    ahead /= np.hypot(*ahead.T)[:, None]
    farthest = corners
    if len(corners) > _MANY:  # the corners farthest beyond an edge are those of the convex hull
        farthest = shapely.get_coordinates(shapely.convex_hull(shapely.linestrings(corners)))
    offset = farthest[None, :] - corners[:, None]
    inside = ahead[:, :1] * offset[:, :, 1] - ahead[:, 1:] * offset[:, :, 0]
    return bool(inside.min() >= -GRAZING_M)
