"""A slow and plain ray tracer, to hold the fast one to: images of points in planes, by brute force.

It knows triangles and nothing else, in three dimensions throughout: every sequence of planes that
a ray could follow is tried, every point of reflection must lie on a triangle of its plane, and no
more triangles than the path may pass through may stand between two points. Edges are found by
looking which triangles meet along a line; a diffracted path crosses its edge where both sides make
the same angle with it (Keller's law), after all reflections have been undone. What each path's
field is, is the matter of `brute_force_field`.
"""

from collections.abc import Iterator, Sequence
from itertools import product
from typing import NamedTuple

import numpy as np
from brute_force_facets import TOUCHING_M, Edge, Facets, Floats, Ints, Mask

NOTHING, REFLECTION, DIFFRACTION, TRANSMISSION = 0, 1, 2, 3


class Found(NamedTuple):
    """Paths, as in `raytrace.Paths`.

    `receiver` (n,), `kinds` (n, most), `vertices` (n, most + 2, 3) [m].
    """

    receiver: Ints
    kinds: Ints
    vertices: Floats


Most = tuple[int, int, int]
"""Most reflections, transmissions and diffractions of a path."""


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


def find_paths(
    facets: Facets,
    source: Floats,
    receivers: Floats,
    max_reflections: int,
    max_diffractions: int,
    max_transmissions: int = 0,
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
    max_transmissions
        Most walls that a path passes through.
    prune
        Leave out sequences of planes that no ray can follow; the paths do not depend on it.
    """
    most = max_reflections, max_transmissions, max_diffractions
    forth = legs_from(facets, source[None], max_reflections, prune=prune)
    parts = [_reflected(facets, receivers, legs, most) for legs in forth]
    if max_diffractions:
        back = legs_from(facets, receivers, max_reflections, prune=prune)
        for edge in facets.edges:
            parts += _over_edge(facets, edge, (forth, back), most)
    return Found(*(np.concatenate(part) for part in zip(*parts, strict=True)))


def _reflected(facets: Facets, receivers: Floats, legs: Legs, most: Most) -> Found:
    """Paths to every receiver that are only reflected."""
    order = legs.planes.shape[1]
    leg, number = np.nonzero(might_reach(facets, legs, receivers[:, None]))
    rows, points = trace_back(facets, legs.rows(leg), receivers[number])
    return _through_walls(facets, number[rows], [REFLECTION] * order, points, most)


def _over_edge(
    facets: Facets, edge: Edge, legs: tuple[list[Legs], list[Legs]], most: Most
) -> Iterator[Found]:
    """Paths over an edge."""
    ends = np.array([[edge.start, edge.end]])
    forth, back = (
        [some.rows(np.flatnonzero(might_reach(facets, some, ends)[:, 0])) for some in side]
        for side in legs
    )
    for n_in, n_out in product(range(most[0] + 1), repeat=2):
        if n_in + n_out <= most[0]:
            yield _diffracted(facets, edge, forth[n_in], back[n_out], most)


def _diffracted(facets: Facets, edge: Edge, forth: Legs, back: Legs, most: Most) -> Found:
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
    n_in, n_out = forth.planes.shape[1], back.planes.shape[1]
    kinds = [REFLECTION] * n_in + [DIFFRACTION] + [REFLECTION] * n_out
    return _through_walls(facets, back.begin[second[wide]], kinds, points, most)


def _beside(edge: Edge, points: Floats) -> tuple[Floats, Floats]:
    """Distance along an edge, and from it, of points (n, 3) [m]."""
    u = (points - edge.start) @ edge.tangent
    return u, np.linalg.norm(points - edge.start - u[:, None] * edge.tangent, axis=1)


def _through_walls(
    facets: Facets, receiver: Ints, kinds: Sequence[int], points: Floats, most: Most
) -> Found:
    """Return candidates (n, len(kinds) + 2, 3), with the walls that they pass through.

    Those that pass through more than they may, or leave the building, are left out.
    """
    n, room = len(points), sum(most)
    all_kinds = np.zeros((n, room), dtype=np.int64)
    vertices = np.repeat(points[:, -1:], room + 2, axis=1)
    all_kinds[:, : len(kinds)] = kinds
    vertices[:, : len(kinds) + 2] = points
    legs = points.shape[1] - 1
    crossed = [facets.crossed(points[:, k], points[:, k + 1]) for k in range(legs)]
    through = np.array([np.isfinite(t).sum(axis=1) for t in crossed]).T
    valid = through.sum(axis=1) <= most[1]
    for i in np.flatnonzero(valid & (through.sum(axis=1) > 0)):
        path, what = [points[i, 0]], list[int]()
        for k in range(legs):
            for t in np.sort(crossed[k][i])[: through[i, k]]:
                path.append(points[i, k] + t * (points[i, k + 1] - points[i, k]))
                what.append(TRANSMISSION)
            path.append(points[i, k + 1])
            what += kinds[k : k + 1]
        all_kinds[i, : len(what)], vertices[i, : len(path)] = what, path
        middles = 0.5 * (np.array(path[1:]) + np.array(path[:-1]))
        valid[i] = facets.is_inside(middles).all()
    return Found(receiver[valid], all_kinds[valid], vertices[valid])
