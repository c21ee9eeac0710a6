"""Points, corners and partial walls that are visible from the root of a beam tree.

A point on the border of a window, or of a cell, is visible from a fraction of its surroundings
only, and that fraction is its weight.
"""

import math
from typing import NamedTuple

import numpy as np

from raytrace.arrays import Floats, Int32s, Ints
from raytrace.kernels.beams import (
    CELL,
    EDGE,
    IMAGE_X,
    IMAGE_Y,
    RIGHT_X,
    RIGHT_Y,
    Tree,
    narrowed,
)
from raytrace.kernels.compiling import jit
from raytrace.kernels.guard import Guard, is_stopped, may_hold
from raytrace.kernels.lanes import WIDTH, Lanes, any_of, lanes_of, load, minimum, store
from raytrace.kernels.plan_view import GRAZING_M, PARTIAL, PlanView, cross
from raytrace.kernels.rows import enlarged, resized


class Targets(NamedTuple):
    """Points that beams may hit, cell by cell; one on a border is in all cells around it.

    Attributes
    ----------
    cell_points
        (n_cells + 1,) points of cell c are number[cell_points[c]:cell_points[c + 1]].
    number
        (n,) which point.
    weight
        (n,) fraction of its surroundings within the cell.
    x, y
        (n + 8,) where it is [m]; padded so that eight can be loaded from each.
    """

    cell_points: Ints
    number: Ints
    weight: Floats
    x: Floats
    y: Floats


class Hits(NamedTuple):
    """Points that are visible from the root of beams.

    Attributes
    ----------
    pair
        (n, 2) point and beam.
    weight
        (n,) fraction of the point's surroundings from which the root is visible.
    """

    pair: Int32s
    weight: Floats


HIT_BYTES = 2 * 4 + 8
"""Size of a row of `Hits`."""

PARTIAL_HIT_BYTES = 2 * 4 + 2 * 8
"""Size of a partial wall that a beam meets, see `hit_partial_walls`."""


def no_hits() -> Hits:
    """Hits of no point."""
    return Hits(np.empty((0, 2), np.int32), np.empty(0))


@jit(inner=True)
def window_side(beam: Floats, x: float, y: float, side: int) -> tuple[float, float, float]:
    """Distance [m] of a point inside a beam's right (0) or left (1) border; the inward normal."""
    px, py = beam[IMAGE_X], beam[IMAGE_Y]
    dx, dy = beam[RIGHT_X + 2 * side] - px, beam[RIGHT_Y + 2 * side] - py
    inv_length = (1.0 - 2.0 * side) / math.sqrt(dx * dx + dy * dy)
    nx, ny = -dy * inv_length, dx * inv_length
    return nx * (x - px) + ny * (y - py), nx, ny


@jit(inner=True)
def edge_side(view: PlanView, e: int, x: float, y: float) -> tuple[float, float, float]:
    """Distance [m] of a point inside an edge of a cell; the inward normal."""
    dx, dy = view.ends[e, 2] - view.ends[e, 0], view.ends[e, 3] - view.ends[e, 1]
    inv_length = 1.0 / math.sqrt(dx * dx + dy * dy)
    nx, ny = -dy * inv_length, dx * inv_length
    return nx * (x - view.ends[e, 0]) + ny * (y - view.ends[e, 1]), nx, ny


@jit(inner=True)
def weight_within(normals: Floats, n: int) -> float:
    """Fraction of a point's surroundings within n half planes (docs/theory.md, eq. 40).

    Parameters
    ----------
    normals, n
        (>= n, 2) unit normals into the half planes, whose borders pass through the point.
    """
    widest = 0.0
    for i in range(n):
        for j in range(i):
            turn = cross(normals[i, 0], normals[i, 1], normals[j, 0], normals[j, 1])
            along = normals[i, 0] * normals[j, 0] + normals[i, 1] * normals[j, 1]
            widest = max(widest, abs(math.atan2(turn, along)))
    return 1.0 if n == 0 else max(0.5 - 0.5 * widest / math.pi, 0.0)


@jit(inner=True)
def visible_weight(
    view: PlanView, tree: Tree, i: int, x: float, y: float, cell: int, normals: Floats
) -> float:
    """Fraction of a point's surroundings within beam i.

    Parameters
    ----------
    view, tree, i
        Plan view, beams, and which one.
    x, y
        The point [m].
    cell
        The beam's cell if the point lies on its border; -1 if inside, or where the border does not
        matter.
    normals
        (>= 2 + edges of a cell, 2) scratch.
    """
    n = 0
    if tree.link[i, EDGE] >= 0:
        for side in range(2):
            inside, nx, ny = window_side(tree.beam[i], x, y, side)
            if inside <= -GRAZING_M:
                return 0.0
            if inside < GRAZING_M:
                normals[n, 0], normals[n, 1] = nx, ny
                n += 1
    if cell >= 0:
        for e in range(view.cell_edges[cell], view.cell_edges[cell + 1]):
            inside, nx, ny = edge_side(view, e, x, y)
            if inside < GRAZING_M:
                normals[n, 0], normals[n, 1] = nx, ny
                n += 1
    return weight_within(normals, n)


@jit(inline=True)
def inside_window(beam: Floats, x: Lanes, y: Lanes) -> Lanes:
    """Distances [m] of points inside the nearer border of a beam's window (see `window_side`)."""
    px, py = beam[IMAGE_X], beam[IMAGE_Y]
    nearest = lanes_of(math.inf)
    for side in range(2):
        _, nx, ny = window_side(beam, px, py, side)
        nearest = minimum(nearest, nx * (x - px) + ny * (y - py))
    return nearest


@jit(inner=True)
def most_edges(view: PlanView) -> int:
    """Largest number of edges of a cell."""
    most = 0
    for c in range(len(view.cell_edges) - 1):
        most = max(most, view.cell_edges[c + 1] - view.cell_edges[c])
    return most


def hit_points(
    view: PlanView, tree: Tree, targets: Targets, beams: Ints, max_hits: int, guard: Guard
) -> tuple[Hits, int]:
    """Find the points within beams, beam after beam.

    Parameters
    ----------
    view, tree, targets
        The plan view, the beams and the points.
    beams, max_hits
        Which beams, and the number of hits after which no further beam is taken.
    guard
        May end the search.

    Returns
    -------
    hits, done
        The hits, and how many of the beams were taken.
    """
    pair, weight, done = hit_point_arrays(view, tree, targets, beams, max_hits, guard)
    return Hits(pair, weight), done


@jit()
def hit_point_arrays(
    view: PlanView, tree: Tree, targets: Targets, beams: Ints, max_hits: int, guard: Guard
) -> tuple[Int32s, Floats, int]:
    """Arrays of `hit_points`."""
    pair, weight = np.empty((1024, 2), np.int32), np.empty((1024, 1))
    normals, inside = np.empty((2 + most_edges(view), 2)), np.empty(WIDTH)
    n = done = 0
    while done < len(beams) and n < max_hits and not is_stopped(guard):
        i = int(beams[done])
        cell, is_root = tree.link[i, CELL], tree.link[i, EDGE] < 0
        first, last = targets.cell_points[cell], targets.cell_points[cell + 1]
        needed = n + int(last - first)
        if not may_hold(guard, needed, len(pair), HIT_BYTES):
            break
        while needed > len(pair):
            pair, weight = enlarged(pair), enlarged(weight)
        done += 1
        for k in range(first, last, WIDTH):
            nearest = lanes_of(math.inf)
            if not is_root:
                x, y = load(targets.x[k:]), load(targets.y[k:])
                nearest = inside_window(tree.beam[i], x, y)
                if not any_of(nearest > -GRAZING_M):
                    continue
            store(inside, nearest)
            for at in range(k, min(k + WIDTH, last)):
                if inside[at - k] <= -GRAZING_M:
                    continue
                visible = 1.0
                if inside[at - k] < GRAZING_M or targets.weight[at] < 1.0:
                    border = cell if targets.weight[at] < 1.0 else -1
                    x_at, y_at = targets.x[at], targets.y[at]
                    visible = visible_weight(view, tree, i, x_at, y_at, border, normals)
                if visible > 0.0:
                    pair[n, 0], pair[n, 1], weight[n, 0] = targets.number[at], i, visible
                    n += 1
    return resized(pair, n), resized(weight, n)[:, 0], done


def hit_corners(view: PlanView, tree: Tree, guard: Guard) -> tuple[Hits, bool]:
    """Find the corners of cells within beams, as vertex numbers; return whether they are all.

    The ends of the edge a beam came through were found before it; the ends of the edge it was
    mirrored at are no reflection.
    """
    pair, weight, is_whole = hit_corner_arrays(view, tree, guard)
    return Hits(pair, weight), is_whole


@jit()
def hit_corner_arrays(view: PlanView, tree: Tree, guard: Guard) -> tuple[Int32s, Floats, bool]:
    """Arrays of `hit_corners`."""
    pair, weight = np.empty((1024, 2), np.int32), np.empty((1024, 1))
    normals = np.empty((2, 2))
    n = done = 0
    while done < len(tree.link) and not is_stopped(guard):
        i, cell, entry = done, tree.link[done, CELL], tree.link[done, EDGE]
        first, last = view.cell_edges[cell], view.cell_edges[cell + 1]
        needed = n + int(last - first)
        if not may_hold(guard, needed, len(pair), HIT_BYTES):
            break
        while needed > len(pair):
            pair, weight = enlarged(pair), enlarged(weight)
        done += 1
        for e in range(first, last):
            v = view.vertex[e, 0]
            if entry >= 0 and (v == view.vertex[entry, 0] or v == view.vertex[entry, 1]):
                continue
            visible = visible_weight(view, tree, i, view.ends[e, 0], view.ends[e, 1], -1, normals)
            if visible == 0.0:
                continue
            pair[n, 0], pair[n, 1], weight[n, 0] = v, i, visible
            n += 1
    return resized(pair, n), resized(weight, n)[:, 0], done == len(tree.link)


@jit()
def hit_partial_walls(view: PlanView, tree: Tree, guard: Guard) -> tuple[Int32s, Floats, bool]:
    """Find the partial walls that beams meet.

    Returns
    -------
    hits
        (n, 2) edge and beam.
    interval
        (n, 2) the part of the edge within the beam, as fractions of its length from its start.
    is_whole
        Whether these are all.
    """
    hits = np.empty((1024, 2), np.int32)
    interval = np.empty((1024, 2))
    n = done = 0
    while done < len(tree.link) and not is_stopped(guard):
        i, cell = done, tree.link[done, CELL]
        first, last = view.cell_edges[cell], view.cell_edges[cell + 1]
        needed = n + int(last - first)
        if not may_hold(guard, needed, len(hits), PARTIAL_HIT_BYTES):
            break
        while needed > len(hits):
            hits, interval = enlarged(hits), enlarged(interval)
        done += 1
        for e in range(first, last):
            if view.kind[e] != PARTIAL:
                continue
            meets, (rx, ry, lx, ly) = narrowed(view, tree.link[i, EDGE], tree.beam[i], e)
            if not meets:
                continue
            hits[n, 0] = e
            hits[n, 1] = i
            interval[n, 0] = fraction(view, tree.beam[i], e, rx, ry)
            interval[n, 1] = fraction(view, tree.beam[i], e, lx, ly)
            n += 1
    return resized(hits, n), resized(interval, n), done == len(tree.link)


@jit(inline=True)
def fraction(view: PlanView, beam: Floats, e: int, x: float, y: float) -> float:
    """Where the ray from a beam's image through (x, y) meets edge e: 0 its start, 1 its end."""
    x1, y1, x2, y2 = view.ends[e, 0], view.ends[e, 1], view.ends[e, 2], view.ends[e, 3]
    if x == x1 and y == y1:
        return 0.0
    if x == x2 and y == y2:
        return 1.0
    dx, dy = x - beam[IMAGE_X], y - beam[IMAGE_Y]
    return cross(beam[IMAGE_X] - x1, beam[IMAGE_Y] - y1, dx, dy) / cross(x2 - x1, y2 - y1, dx, dy)
