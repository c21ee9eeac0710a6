"""A slow and plain ray tracer, to hold the fast one to: images of points in planes, by brute force.

It knows triangles and nothing else, in three dimensions throughout: every sequence of planes that
a ray could follow is tried, every point of reflection must lie on a triangle of its plane, and no
triangle may stand between two points. Edges are found by looking which triangles meet along a
line; a diffracted path crosses its edge where both sides make the same angle with it (Keller's
law), after all reflections have been undone. What each path's field is, is the matter of
`brute_force_field`.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise, product
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Mask = NDArray[np.bool_]

ON_SURFACE_M = 1e-10
TOUCHING_M = 1e-9
NOTHING, REFLECTION, DIFFRACTION = 0, 1, 2


class Edge(NamedTuple):
    """A straight edge from `start` to `end` (3,) [m].

    The free space spans `angle` [rad] from the unit vector `o_face`, counter-clockwise as seen
    against the edge's direction; `o_slab` and `n_slab` are the slabs of its two faces.
    """

    start: Floats
    end: Floats
    o_face: Floats
    angle: float
    o_slab: int
    n_slab: int

    @property
    def length(self) -> float:
        """[m]."""
        return float(np.linalg.norm(self.end - self.start))

    @property
    def tangent(self) -> Floats:
        """(3,) unit vector."""
        return (self.end - self.start) / self.length

    def angles(self, directions: Floats) -> Floats:
        """(n,) angle about the edge from the o-face [rad] of directions (n, 3) away from it."""
        across = np.cross(self.tangent, self.o_face)
        return np.arctan2(directions @ across, directions @ self.o_face) % (2.0 * np.pi)


class Found(NamedTuple):
    """Paths, as in `raytrace.Paths`.

    `receiver` (n,), `kinds` (n, most), `vertices` (n, most + 2, 3) [m].
    """

    receiver: Ints
    kinds: Ints
    vertices: Floats


@dataclass(frozen=True, eq=False)
class Facets:
    """Triangles (n, 3, 3) [m] and the slab of each (n,)."""

    triangles: Floats
    slab: Ints

    @cached_property
    def normals(self) -> Floats:
        """(n, 3) unit normals, parallel ones equal."""
        a, b, c = self.triangles.transpose(1, 0, 2)
        normals = np.cross(b - a, c - a)
        normals /= np.linalg.norm(normals, axis=1)[:, None]
        first = np.argmax(np.abs(normals) > 1e-6, axis=1)
        return normals * np.sign(normals[np.arange(len(normals)), first])[:, None]

    @cached_property
    def inward(self) -> Floats:
        """(n, 3, 3) unit vectors across each side of a triangle, into it."""
        along = np.roll(self.triangles, -1, axis=1) - self.triangles
        inward = np.cross(self.normals[:, None], along)
        inward /= np.linalg.norm(inward, axis=2)[:, :, None]
        to_opposite = np.roll(self.triangles, -2, axis=1) - self.triangles
        return inward * np.sign((inward * to_opposite).sum(axis=2))[:, :, None]

    @cached_property
    def plane_of(self) -> Ints:
        """(n,) number of the plane that each triangle lies in."""
        plane_of = np.full(len(self.triangles), -1)
        for k, (corner, normal) in enumerate(zip(self.triangles[:, 0], self.normals, strict=True)):
            if plane_of[k] < 0:
                off = np.abs((self.triangles - corner) @ normal).max(axis=1)
                plane_of[(off < 1e-8) & (plane_of < 0)] = plane_of.max() + 1
        return plane_of

    @cached_property
    def planes(self) -> tuple[Floats, Floats]:
        """(n, 3) normals and (n,) offsets of the planes."""
        first = np.unique(self.plane_of, return_index=True)[1]
        normals = self.normals[first]
        return normals, (normals * self.triangles[first, 0]).sum(axis=1)

    @cached_property
    def rectangles(self) -> Floats:
        """(n_planes, 4, 3) corners, in turn, of a rectangle around each plane's triangles."""
        found = []
        for plane, normal in enumerate(self.planes[0]):
            corners = self.triangles[self.plane_of == plane].reshape(-1, 3)
            u = _across(normal)
            v = np.cross(normal, u)
            (u0, u1), (v0, v1) = ((c.min(), c.max()) for c in (corners @ u, corners @ v))
            foot = (corners[0] @ normal) * normal
            found.append(
                [foot + a * u + b * v for a, b in ((u0, v0), (u1, v0), (u1, v1), (u0, v1))]
            )
        return np.array(found)

    def containing(self, points: Floats) -> Mask:
        """(n_points, n_triangles) whether a point lies in a triangle, its border included."""
        from_corner = points[:, None, None] - self.triangles
        off = np.abs((from_corner[:, :, 0] * self.normals).sum(axis=2))
        inside = (from_corner * self.inward).sum(axis=3).min(axis=2)
        return (off < TOUCHING_M) & (inside > -ON_SURFACE_M)

    def on_plane(self, points: Floats, plane: int) -> Mask:
        """(n_points,) whether points of a plane lie on one of its triangles."""
        mine = self.plane_of == plane
        from_corner = points[:, None, None] - self.triangles[mine]
        inside = (from_corner * self.inward[mine]).sum(axis=3).min(axis=2)
        return (inside > -ON_SURFACE_M).any(axis=1)

    def blocked(self, start: Floats, end: Floats) -> Mask:
        """(n,) whether a triangle stands strictly between two points (n, 3)."""
        normals, offsets = self.planes
        before, behind = start @ normals.T - offsets, end @ normals.T - offsets
        touching = np.minimum(np.abs(before), np.abs(behind)) < TOUCHING_M
        crossing = (before * behind < 0.0) & ~touching
        blocked = np.zeros(len(start), dtype=bool)
        for plane in range(len(offsets)):
            rows = np.flatnonzero(crossing[:, plane] & ~blocked)
            if len(rows):
                t = before[rows, plane] / (before - behind)[rows, plane]
                hit = start[rows] + t[:, None] * (end[rows] - start[rows])
                blocked[rows] = self.on_plane(hit, plane)
        return blocked

    @cached_property
    def edges(self) -> tuple[Edge, ...]:
        """Every edge with more than half a turn of free space around it."""
        return tuple(e for line in _lines(self.triangles) for e in self._edges_on(*line))

    def _edges_on(self, a: Floats, b: Floats) -> Iterator[Edge]:
        for low, high in pairwise(self._marks(a, b)):
            start, end = a + low * (b - a), a + high * (b - a)
            yield from self._wedges(start, end)

    def _marks(self, a: Floats, b: Floats) -> Floats:
        """Fractions of the way from a to b at which any triangle's side meets the line."""
        p, q = self.triangles, np.roll(self.triangles, -1, axis=1)
        u = (b - a) / np.linalg.norm(b - a)
        off_p, off_q = (x - a - ((x - a) @ u)[..., None] * u for x in (p, q))
        turn = off_q - off_p
        t = -(off_p * turn).sum(axis=2) / np.maximum((turn**2).sum(axis=2), 1e-20)
        t = np.clip(t, 0.0, 1.0)[..., None]
        meets = np.linalg.norm(off_p + t * turn, axis=2) < TOUCHING_M
        points = np.concatenate([(p + t * (q - p))[meets], p[_on(off_p)], q[_on(off_q)]])
        marks = np.clip((points - a) @ u / np.linalg.norm(b - a), 0.0, 1.0)
        marks = np.unique(np.concatenate([marks, [0.0, 1.0]]))
        return marks[np.concatenate([[True], np.diff(marks) > 1e-8])]

    def _wedges(self, start: Floats, end: Floats) -> Iterator[Edge]:
        """Wide sectors between the triangles that run along an interval."""
        tangent = (end - start) / np.linalg.norm(end - start)
        frame = Edge(start, end, _across(tangent), 0.0, -1, -1)
        middle = 0.5 * (start + end)
        along = np.abs(self.normals @ tangent) < 1e-9
        sheets: dict[float, int] = {}
        for k in np.flatnonzero(self.containing(middle[None])[0] & along):
            sideways = np.cross(self.normals[k], tangent)
            for direction in (sideways, -sideways):
                if self.containing((middle + 1e-6 * direction)[None])[0, k]:
                    angle = round(float(frame.angles(direction[None])[0]), 9) % (2.0 * np.pi)
                    sheets.setdefault(angle, int(self.slab[k]))
        ordered = sorted(sheets.items())
        for (low, o_slab), (high, n_slab) in zip(ordered, ordered[1:] + ordered[:1], strict=True):
            free = high - low if high > low else high - low + 2.0 * np.pi
            if free > np.pi + 1e-6:
                third = np.cross(tangent, frame.o_face)
                o_face = np.cos(low) * frame.o_face + np.sin(low) * third
                yield Edge(start, end, o_face, free, o_slab, n_slab)


def _on(offset: Floats) -> Mask:
    return np.linalg.norm(offset, axis=2) < TOUCHING_M


def _across(tangent: Floats) -> Floats:
    other = np.eye(3)[np.argmin(np.abs(tangent))]
    across = np.cross(tangent, other)
    return across / np.linalg.norm(across)


def _lines(triangles: Floats) -> list[tuple[Floats, Floats]]:
    """Disjoint stretches of straight lines that hold every side of every triangle."""
    sides = np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=2).reshape(-1, 2, 3)
    groups: dict[tuple[float, ...], list[Floats]] = {}
    for a, b in sides:
        u = (b - a) / np.linalg.norm(b - a)
        u *= np.sign(u[np.argmax(np.abs(u) > 1e-6)])
        foot = a - (a @ u) * u
        key = tuple(np.round(np.concatenate([u, foot]), 6) + 0.0)
        groups.setdefault(key, []).extend([a, b])
    lines = []
    for ends in groups.values():
        u = ends[1] - ends[0]
        order = np.argsort(np.array(ends) @ u)
        lines.append((ends[order[0]], ends[order[-1]]))
    return lines


class Legs(NamedTuple):
    """Candidates for one side of paths.

    `begin` (n,) which point each begins at, `planes` (n, order), `images` (n, order + 1, 3) of
    that point in the planes, one after the other [m].
    """

    begin: Ints
    planes: Ints
    images: Floats

    def rows(self, rows: Ints) -> "Legs":
        """Return some of the candidates."""
        return Legs(self.begin[rows], self.planes[rows], self.images[rows])


def legs_from(facets: Facets, points: Floats, order: int, *, prune: bool = True) -> list[Legs]:
    """All sequences of planes from points (n, 3), and their images.

    Returns
    -------
    list of Legs
        Those of 0 reflections, of 1, ... of `order`. With `prune`, those that end at a plane
        that no ray of theirs can meet are left out, and all that would go on from there.
    """
    normals, offsets = facets.planes
    n = len(points)
    legs = [Legs(np.arange(n), np.empty((n, 0), np.int64), points[:, None])]
    for _ in range(order):
        last = legs[-1]
        may = _differs_from_last(last, len(offsets))
        if prune:
            may &= might_reach(facets, last, facets.rectangles)
        row, plane = np.nonzero(may)
        normal, before = normals[plane], last.images[row, -1]
        height = (before * normal).sum(axis=1) - offsets[plane]
        image = before - 2.0 * height[:, None] * normal
        planes = np.column_stack([last.planes[row], plane])
        images = np.concatenate([last.images[row], image[:, None]], axis=1)
        legs.append(Legs(last.begin[row], planes, images))
    return legs


def _differs_from_last(legs: Legs, n_planes: int) -> Mask:
    """(n_legs, n_planes): no plane reflects twice in a row."""
    may = np.ones((len(legs.planes), n_planes), dtype=bool)
    if legs.planes.shape[1]:
        may[np.arange(len(may)), legs.planes[:, -1]] = False
    return may


def might_reach(facets: Facets, legs: Legs, targets: Floats) -> Mask:
    """(n_legs, n_targets) False where no ray of a leg can meet a target, the hull of its corners.

    Behind its last plane a ray is on that plane's reflecting side, and within the pyramid from the
    last image through the rectangle around the plane's triangles. A target is out of reach if all
    its corners (n_targets, n_corners, 3) are behind the plane, or outside one face of the pyramid.
    """
    reach = np.ones((len(legs.planes), len(targets)), dtype=bool)
    if not legs.planes.shape[1]:
        return reach
    normals, offsets = facets.planes
    plane, image = legs.planes[:, -1], legs.images[:, -1]
    behind = (image * normals[plane]).sum(axis=1) - offsets[plane]
    corners = facets.rectangles[plane] - image[:, None]
    faces = np.cross(corners, np.roll(corners, -1, axis=1))
    inside = (faces * corners.mean(axis=1)[:, None]).sum(axis=2)
    faces *= np.sign(inside)[:, :, None]
    for k, target in enumerate(targets):
        side = (target @ normals.T - offsets)[:, plane] * np.sign(behind)
        reach[:, k] &= side.min(axis=0) < TOUCHING_M
        off = np.einsum("nfi,nci->nfc", faces, target - image[:, None])
        reach[:, k] &= (off.max(axis=2) > -TOUCHING_M).all(axis=1)
    return reach


def trace_back(facets: Facets, legs: Legs, targets: Floats) -> tuple[Ints, Floats]:
    """Follow candidates back from their targets (n, 3).

    Returns
    -------
    rows, points
        Which candidates meet their planes on triangles, and their points (n_rows, order + 2, 3),
        both ends included.
    """
    normals, offsets = facets.planes
    order = legs.planes.shape[1]
    rows = np.arange(len(legs.planes))
    points = np.repeat(targets[:, None], order + 2, axis=1)
    points[:, 0] = legs.images[:, 0]
    for k in range(order, 0, -1):
        plane = legs.planes[rows, k - 1]
        image, here = legs.images[rows, k], points[:, k + 1]
        behind = (image * normals[plane]).sum(axis=1) - offsets[plane]
        before = (here * normals[plane]).sum(axis=1) - offsets[plane]
        good = (behind * before < 0.0) & (np.minimum(abs(behind), abs(before)) > TOUCHING_M)
        t = behind[good] / (behind[good] - before[good])
        rows, points, plane = rows[good], points[good], plane[good]
        points[:, k] = image[good] + t[:, None] * (here[good] - image[good])
        on = np.zeros(len(rows), dtype=bool)
        for p in np.unique(plane):
            on[plane == p] = facets.on_plane(points[plane == p, k], int(p))
        rows, points = rows[on], points[on]
    return rows, points


def unblocked(facets: Facets, points: Floats) -> Ints:
    """Which paths (n, most, 3) nothing stands in the way of."""
    rows = np.arange(len(points))
    for k in range(points.shape[1] - 1):
        rows = rows[~facets.blocked(points[rows, k], points[rows, k + 1])]
    return rows


def find_paths(
    facets: Facets,
    source: Floats,
    receivers: Floats,
    max_reflections: int,
    max_diffractions: int,
    *,
    prune: bool = True,
) -> Found:
    """Find every path with at most that many reflections, and one diffraction or none.

    Parameters
    ----------
    facets
        The building.
    source
        (3,) [m].
    receivers
        (n, 3) [m].
    max_reflections
        Most reflections, on both sides of a diffraction together.
    max_diffractions
        0 or 1.
    prune
        Leave out sequences of planes that no ray can follow; the paths do not depend on it.
    """
    most = max_reflections + max_diffractions
    forth = legs_from(facets, source[None], max_reflections, prune=prune)
    parts = [_reflected(facets, receivers, legs, most) for legs in forth]
    if max_diffractions:
        back = legs_from(facets, receivers, max_reflections, prune=prune)
        for edge in facets.edges:
            parts += _over_edge(facets, edge, (forth, back), most)
    return Found(*(np.concatenate(part) for part in zip(*parts, strict=True)))


def _reflected(facets: Facets, receivers: Floats, legs: Legs, most: int) -> Found:
    """Paths to every receiver that are only reflected."""
    order = legs.planes.shape[1]
    leg, number = np.nonzero(might_reach(facets, legs, receivers[:, None]))
    rows, points = trace_back(facets, legs.rows(leg), receivers[number])
    free = unblocked(facets, points)
    return _padded(number[rows[free]], [REFLECTION] * order, points[free], most)


def _over_edge(
    facets: Facets, edge: Edge, legs: tuple[list[Legs], list[Legs]], most: int
) -> Iterator[Found]:
    """Paths over an edge with one reflection less than `most` at most."""
    ends = np.array([[edge.start, edge.end]])
    forth, back = (
        [some.rows(np.flatnonzero(might_reach(facets, some, ends)[:, 0])) for some in side]
        for side in legs
    )
    for n_in, n_out in product(range(most), repeat=2):
        if n_in + n_out < most:
            yield _diffracted(facets, edge, forth[n_in], back[n_out], most)


def _diffracted(facets: Facets, edge: Edge, forth: Legs, back: Legs, most: int) -> Found:
    """Paths over an edge that are made of two sets of legs."""
    (u_in, d_in), (u_out, d_out) = (_beside(edge, legs.images[:, -1]) for legs in (forth, back))
    u = u_in[:, None] * d_out + u_out * d_in[:, None]
    u /= np.maximum(d_in[:, None] + d_out, 1e-12)
    first, second = np.nonzero((u > 0.0) & (u < edge.length))
    at = edge.start + u[first, second, None] * edge.tangent
    rows, points_in = trace_back(facets, forth.rows(first), at)
    second, at = second[rows], at[rows]
    rows, points_out = trace_back(facets, back.rows(second), at)
    points_in, second = points_in[rows], second[rows]
    wide = np.ones(len(rows), dtype=bool)
    for points in (points_in, points_out):
        wide &= edge.angles(points[:, -2] - points[:, -1]) <= edge.angle
    points = np.concatenate([points_in, points_out[:, -2::-1]], axis=1)[wide]
    free = unblocked(facets, points)
    n_in, n_out = forth.planes.shape[1], back.planes.shape[1]
    kinds = [REFLECTION] * n_in + [DIFFRACTION] + [REFLECTION] * n_out
    return _padded(back.begin[second[wide][free]], kinds, points[free], most)


def _beside(edge: Edge, points: Floats) -> tuple[Floats, Floats]:
    """Distance along an edge, and from it, of points (n, 3) [m]."""
    u = (points - edge.start) @ edge.tangent
    return u, np.linalg.norm(points - edge.start - u[:, None] * edge.tangent, axis=1)


def _padded(number: Ints, kinds: Sequence[int], points: Floats, most: int) -> Found:
    n, room = len(points), most + 2 - points.shape[1]
    all_kinds = np.zeros((n, most), dtype=np.int64)
    all_kinds[:, : len(kinds)] = kinds
    vertices = np.concatenate([points, np.repeat(points[:, -1:], room, axis=1)], axis=1)
    return Found(number, all_kinds, vertices)
