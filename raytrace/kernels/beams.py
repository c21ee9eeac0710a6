"""Beam trees: which sequences of walls and openings a ray from a point can take.

A beam is the image of its root point and a window of two corners, all in the frame of the cell
it is in (docs/theory.md, section 3). It splits over the edges of its cell with two cross
products an edge, and a point of the cell is lit when it lies within the window. A window is
closed on the side that was its right one at the root, so of two beams that share a border just
one holds it.
"""

from typing import Any, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from raytrace.kernels.compiling import jit
from raytrace.kernels.plan_view import WALL, Floats, Ints, PlanView, cross, mirrored

PARENT, EDGE, REFLECTED, CELL, ORDER, FLIPPED, BOUNCES, ITEMS = range(8)
"""Columns of `Tree.link`: the beam it split from; the edge it came through or was mirrored at,
-1 at the root; whether it was mirrored; the cell it is in; wall reflections so far; whether
their number is odd; floor or ceiling reflections its heights cannot do without; reflections
and partial walls so far."""

IMAGE_X, IMAGE_Y, RIGHT_X, RIGHT_Y, LEFT_X, LEFT_Y = range(6)
"""Columns of `Tree.beam` [m]: the root's image, and the corners of the window."""


Rows = TypeVar("Rows", bound=NDArray[Any])


ON_LINE_M = 1e-8
"""A point this near to an edge's line sees it edge-on, that is, not at all [m]."""


class Tree(NamedTuple):
    """Beams, each behind its parent: `link` (n, 8) int32 and `beam` (n, 6) [m]."""

    link: NDArray[np.int32]
    beam: Floats


class Targets(NamedTuple):
    """Points that beams may hit, cell by cell.

    Attributes
    ----------
    cell_points
        (n_cells + 1,) points of cell c are number[cell_points[c]:cell_points[c + 1]].
    number
        (n,) which point.
    xy
        (n_points, 2) all points [m].
    """

    cell_points: Ints
    number: Ints
    xy: Floats


@jit()
def enlarged(rows: Rows) -> Rows:
    """Copy of an array with room for twice as many rows."""
    more: Any = np.empty((2 * len(rows), rows.shape[1]), rows.dtype)
    for i in range(rows.shape[0]):
        for k in range(rows.shape[1]):
            more[i, k] = rows[i, k]
    return more


@jit(inner=True)
def copy_row(rows: NDArray[Any], to: int, source: int) -> None:
    """rows[to] = rows[source], much faster to compile."""
    for k in range(rows.shape[1]):
        rows[to, k] = rows[source, k]


@jit()
def grow_tree(
    view: PlanView, bounces: Ints, x: float, y: float, root_cells: Ints, max_order: int
) -> Tree:
    """All beams from a point with at most `max_order` reflections.

    Parameters
    ----------
    view
        The plan view.
    bounces
        (n_edges, 2) floor or ceiling reflections needed to pass, and to be reflected at, an
        edge.
    x, y
        The root [m].
    root_cells
        The cells it lies in.
    max_order
        Most reflections, the needed ones at floor and ceiling included.
    """
    link = np.zeros((256 + len(root_cells), 8), np.int32)
    beam = np.zeros((256 + len(root_cells), 6))
    n = 0
    for cell in root_cells:
        link[n, PARENT] = link[n, EDGE] = -1
        link[n, CELL] = cell
        beam[n, IMAGE_X], beam[n, IMAGE_Y] = x, y
        n += 1
    i = 0
    while i < n:
        cell = link[i, CELL]
        most = 2 * (view.cell_edges[cell + 1] - view.cell_edges[cell])
        while n + most > len(link):
            link, beam = enlarged(link), enlarged(beam)
        n = split(view, bounces, link, beam, i, n, max_order)
        i += 1
    return Tree(link[:n].copy(), beam[:n].copy())


@jit(inner=True)
def leads_on(link: NDArray[np.int32], i: int, cell: int) -> bool:
    """Whether beam i may enter a cell: a straight ray is in a convex cell only once.

    That also ends slivers, which rounding could else lead round a corner for ever.
    """
    while cell >= 0:
        if link[i, CELL] == cell:
            return False
        if link[i, REFLECTED] or link[i, PARENT] < 0:
            return True
        i = link[i, PARENT]
    return False


@jit(inner=True)
def split(
    view: PlanView,
    bounces: Ints,
    link: NDArray[np.int32],
    beam: Floats,
    i: int,
    n: int,
    max_order: int,
) -> int:
    """Write what becomes of beam i at the edges of its cell, from row n on; return the next row."""
    cell = link[i, CELL]
    for e in range(view.cell_edges[cell], view.cell_edges[cell + 1]):
        lit, window = narrowed(view, link[i, EDGE], beam[i], e)
        if not lit:
            continue
        needed = max(link[i, BOUNCES], bounces[e, 0])
        if link[i, ORDER] + needed <= max_order and leads_on(link, i, view.beyond[e]):
            pass_through(view, link, beam, i, n, e, window)
            link[n, BOUNCES] = needed
            n += 1
        needed = max(link[i, BOUNCES], bounces[e, 1])
        if view.profile[e] >= 0 and link[i, ORDER] + 1 + needed <= max_order:
            reflect(view, link, beam, i, n, e, window)
            link[n, BOUNCES] = needed
            n += 1
    return n


@jit(inner=True)
def narrowed(
    view: PlanView, entry: int, beam: Floats, e: int
) -> tuple[bool, tuple[float, float, float, float]]:
    """Whether a beam lights edge e, and the window (right x, y, left x, y) there."""
    px, py = beam[IMAGE_X], beam[IMAGE_Y]
    rx, ry, lx, ly = view.ends[e, 0], view.ends[e, 1], view.ends[e, 2], view.ends[e, 3]
    off = view.plane[e, 0] * px + view.plane[e, 1] * py - view.plane[e, 2]
    lit = abs(off) > ON_LINE_M and cross(rx - px, ry - py, lx - px, ly - py) > 0.0
    if lit and entry >= 0:
        if view.line[e] == view.line[entry]:
            lit = False
        ax, ay, bx, by = beam[RIGHT_X], beam[RIGHT_Y], beam[LEFT_X], beam[LEFT_Y]
        if cross(ax - px, ay - py, rx - px, ry - py) <= 0.0:
            rx, ry = ax, ay
        if cross(lx - px, ly - py, bx - px, by - py) <= 0.0:
            lx, ly = bx, by
        lit = lit and cross(rx - px, ry - py, lx - px, ly - py) > 0.0
    return lit, (rx, ry, lx, ly)


@jit(inner=True)
def pass_through(
    view: PlanView,
    link: NDArray[np.int32],
    beam: Floats,
    i: int,
    n: int,
    e: int,
    window: tuple[float, float, float, float],
) -> None:
    """Write beam n: beam i carried on through edge e."""
    copy_row(link, n, i)
    copy_row(beam, n, i)
    link[n, PARENT], link[n, EDGE], link[n, REFLECTED] = i, e, 0
    link[n, CELL] = view.beyond[e]
    if view.profile[e] >= 0:
        link[n, ITEMS] += 1
    beam[n, RIGHT_X], beam[n, RIGHT_Y], beam[n, LEFT_X], beam[n, LEFT_Y] = window


@jit(inner=True)
def reflect(
    view: PlanView,
    link: NDArray[np.int32],
    beam: Floats,
    i: int,
    n: int,
    e: int,
    window: tuple[float, float, float, float],
) -> None:
    """Write beam n: beam i mirrored at edge e."""
    copy_row(link, n, i)
    link[n, PARENT], link[n, EDGE], link[n, REFLECTED] = i, e, 1
    link[n, ORDER] += 1
    link[n, FLIPPED] ^= 1
    link[n, ITEMS] += 1
    line = view.plane[e]
    rx, ry, lx, ly = window
    beam[n, IMAGE_X], beam[n, IMAGE_Y] = mirrored(beam[i, IMAGE_X], beam[i, IMAGE_Y], line)
    beam[n, RIGHT_X], beam[n, RIGHT_Y] = mirrored(lx, ly, line)
    beam[n, LEFT_X], beam[n, LEFT_Y] = mirrored(rx, ry, line)


@jit(inner=True)
def is_lit(tree: Tree, i: int, x: float, y: float) -> bool:
    """Whether a point of beam i's cell lies within its window."""
    if tree.link[i, EDGE] < 0:
        return True
    px, py = tree.beam[i, IMAGE_X], tree.beam[i, IMAGE_Y]
    right = cross(tree.beam[i, RIGHT_X] - px, tree.beam[i, RIGHT_Y] - py, x - px, y - py)
    left = cross(x - px, y - py, tree.beam[i, LEFT_X] - px, tree.beam[i, LEFT_Y] - py)
    if tree.link[i, FLIPPED]:
        return right > 0.0 and left >= 0.0
    return right >= 0.0 and left > 0.0


@jit()
def hit_points(tree: Tree, targets: Targets) -> NDArray[np.int32]:
    """(n, 2) every lit point with the beam that lights it, beam after beam."""
    hits = np.empty((1024, 2), np.int32)
    n = 0
    for i in range(len(tree.link)):
        cell = tree.link[i, CELL]
        first, last = targets.cell_points[cell], targets.cell_points[cell + 1]
        while n + last - first > len(hits):
            hits = enlarged(hits)
        for k in range(first, last):
            point = targets.number[k]
            if is_lit(tree, i, targets.xy[point, 0], targets.xy[point, 1]):
                hits[n, 0] = point
                hits[n, 1] = i
                n += 1
    return hits[:n].copy()


@jit()
def hit_corners(view: PlanView, tree: Tree) -> NDArray[np.int32]:
    """(n, 2) every lit corner of a cell, as vertex number, with the beam that lights it.

    The ends of the edge a beam came through were lit before it, the ends of the edge it was
    mirrored at are no reflection.
    """
    hits = np.empty((1024, 2), np.int32)
    n = 0
    for i in range(len(tree.link)):
        cell, entry = tree.link[i, CELL], tree.link[i, EDGE]
        for e in range(view.cell_edges[cell], view.cell_edges[cell + 1]):
            v = view.vertex[e, 0]
            if entry >= 0 and (v == view.vertex[entry, 0] or v == view.vertex[entry, 1]):
                continue
            if not is_lit(tree, i, view.ends[e, 0], view.ends[e, 1]):
                continue
            if n == len(hits):
                hits = enlarged(hits)
            hits[n, 0] = v
            hits[n, 1] = i
            n += 1
    return hits[:n].copy()


@jit()
def hit_partial_walls(view: PlanView, tree: Tree) -> tuple[NDArray[np.int32], Floats]:
    """Partial walls that beams light.

    Returns
    -------
    hits
        (n, 2) edge and beam.
    stretch
        (n, 2) the part of the edge within the beam, as fractions of its length from its start.
    """
    hits = np.empty((1024, 2), np.int32)
    stretch = np.empty((1024, 2))
    n = 0
    for i in range(len(tree.link)):
        cell = tree.link[i, CELL]
        for e in range(view.cell_edges[cell], view.cell_edges[cell + 1]):
            if view.profile[e] < 0 or view.kind[e] == WALL:
                continue
            lit, (rx, ry, lx, ly) = narrowed(view, tree.link[i, EDGE], tree.beam[i], e)
            if not lit:
                continue
            if n == len(hits):
                hits, stretch = enlarged(hits), enlarged(stretch)
            hits[n, 0] = e
            hits[n, 1] = i
            stretch[n, 0] = fraction(view, tree.beam[i], e, rx, ry)
            stretch[n, 1] = fraction(view, tree.beam[i], e, lx, ly)
            n += 1
    return hits[:n].copy(), stretch[:n].copy()


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
