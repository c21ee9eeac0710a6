"""Triangles in space, and the edges at which they diffract: the scene of the brute force."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Mask = NDArray[np.bool_]

ON_SURFACE_M = 1e-10
TOUCHING_M = 1e-9


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

    def crossed(self, start: Floats, end: Floats) -> Floats:
        """(n, n_planes) how far from one point to another (n, 3) a triangle of a plane stands.

        As a fraction of the way; infinite where none of a plane's triangles stands strictly
        between the two.
        """
        normals, offsets = self.planes
        before, behind = start @ normals.T - offsets, end @ normals.T - offsets
        touching = np.minimum(np.abs(before), np.abs(behind)) < TOUCHING_M
        row, plane = np.nonzero((before * behind < 0.0) & ~touching)
        t = before[row, plane] / (before - behind)[row, plane]
        hit = start[row] + t[:, None] * (end[row] - start[row])
        found = np.full(before.shape, np.inf)
        for p in np.unique(plane):
            on = np.flatnonzero(plane == p)
            on = on[self.on_plane(hit[on], int(p))]
            found[row[on], p] = t[on]
        return found

    def is_inside(self, points: Floats) -> Mask:
        """(n,) whether points (n, 3) are above the floor and below the ceiling."""
        z = self.triangles[:, :, 2]
        floor = self.plane_of[np.argmin(z.max(axis=1))]
        below = np.column_stack([points[:, :2], np.full(len(points), z.min())])
        above = self.on_plane(below, int(floor))
        return above & (points[:, 2] > z.min()) & (points[:, 2] < z.max())

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
