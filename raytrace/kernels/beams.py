"""Beam trees: which sequences of walls and openings a ray from a point can take.

A beam is the image of its root point and a window of two corners, all in the frame of the cell
it is in (docs/theory.md, section 3). It splits over the edges of its cell with two cross
products an edge, and a point of the cell is lit when it lies within the window. A point on the
border of a window, or of a cell, is lit in a share of its surroundings.
"""

import math
from typing import Any, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from raytrace.kernels.compiling import jit
from raytrace.kernels.lanes import WIDTH, Lanes, any_of, lanes_of, load, minimum, store
from raytrace.kernels.plan_view import (
    GRAZING_M,
    PARTIAL,
    Floats,
    Ints,
    PlanView,
    cross,
    mirrored,
)

PARENT, EDGE, REFLECTED, CELL, ORDER, TRANSMITTED, BOUNCES, ITEMS = range(8)
"""Columns of `Tree.link`: the beam it split from; the edge it came through or was mirrored at,
-1 at the root; whether it was mirrored; the cell it is in; wall reflections so far; full walls
gone through; floor or ceiling reflections its heights cannot do without; reflections, walls
gone through and partial walls so far."""

IMAGE_X, IMAGE_Y, RIGHT_X, RIGHT_Y, LEFT_X, LEFT_Y = range(6)
"""Columns of `Tree.beam` [m]: the root's image, and the corners of the window."""

Window = tuple[float, float, float, float]
"""Right and left corner of a window: x, y, x, y [m]."""

Rows = TypeVar("Rows", bound=NDArray[Any])


class Tree(NamedTuple):
    """Beams, each behind its parent: `link` (n, 8) int32 and `beam` (n, 6) [m]."""

    link: NDArray[np.int32]
    beam: Floats


class Targets(NamedTuple):
    """Points that beams may hit, cell by cell; one on a border is in all cells around it.

    Attributes
    ----------
    cell_points
        (n_cells + 1,) points of cell c are number[cell_points[c]:cell_points[c + 1]].
    number
        (n,) which point.
    share
        (n,) how much of its surroundings is in the cell.
    x, y
        (n + 8,) where it is [m]; room to load eight from each.
    """

    cell_points: Ints
    number: Ints
    share: Floats
    x: Floats
    y: Floats


class Hits(NamedTuple):
    """Points that beams light.

    Attributes
    ----------
    pair
        (n, 2) point and beam.
    share
        (n,) how much of the point's surroundings is lit.
    """

    pair: NDArray[np.int32]
    share: Floats


@jit()
def resized(rows: Rows, n: int) -> Rows:
    """Copy of the first rows of an array, with room for n; one kernel for all that grow."""
    more: Any = np.empty((n, rows.shape[1]), rows.dtype)
    for i in range(min(n, rows.shape[0])):
        for k in range(rows.shape[1]):
            more[i, k] = rows[i, k]
    return more


@jit()
def enlarged(rows: Rows) -> Rows:
    """Copy of an array with room for twice as many rows."""
    return resized(rows, 2 * len(rows))


@jit(inner=True)
def copy_row(rows: NDArray[Any], to: int, source: int) -> None:
    """rows[to] = rows[source], much faster to compile."""
    for k in range(rows.shape[1]):
        rows[to, k] = rows[source, k]


@jit()
def grow_tree(
    view: PlanView, bounces: Ints, x: float, y: float, root_cells: Ints, most: tuple[int, int]
) -> Tree:
    """All beams from a point with at most so many reflections and transmissions.

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
    most
        Most reflections, the needed ones at floor and ceiling included, and most full walls
        gone through.
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
        while n + most_children(view, link[i, CELL]) > len(link):
            link, beam = enlarged(link), enlarged(beam)
        n = split(view, bounces, link, beam, i, n, most)
        i += 1
    return Tree(resized(link, n), resized(beam, n))


@jit(inner=True)
def most_children(view: PlanView, cell: int) -> int:
    """Most beams that one in this cell can split into."""
    first, last = view.cell_edges[cell], view.cell_edges[cell + 1]
    return 2 * (last - first) + view.behind_first[last] - view.behind_first[first]


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
    most: tuple[int, int],
) -> int:
    """Write what becomes of beam i at the edges of its cell, from row n on; return the next row."""
    cell = link[i, CELL]
    for e in range(view.cell_edges[cell], view.cell_edges[cell + 1]):
        lit, window = narrowed(view, link[i, EDGE], beam[i], e)
        if not lit:
            continue
        needed = max(link[i, BOUNCES], bounces[e, 0])
        if link[i, ORDER] + needed <= most[0] and leads_on(link, i, view.beyond[e]):
            pass_through(view, link, beam, i, n, e, window)
            link[n, CELL] = view.beyond[e]
            link[n, BOUNCES] = needed
            n += 1
        if link[i, TRANSMITTED] < most[1]:
            n = transmit(view, link, beam, i, n, e, window)
        needed = max(link[i, BOUNCES], bounces[e, 1])
        if view.profile[e] >= 0 and link[i, ORDER] + 1 + needed <= most[0]:
            reflect(view, link, beam, i, n, e, window)
            link[n, BOUNCES] = needed
            n += 1
    return n


@jit(inner=True)
def narrowed(view: PlanView, entry: int, beam: Floats, e: int) -> tuple[bool, Window]:
    """Whether a beam lights edge e, and the window there."""
    ends = (view.ends[e, 0], view.ends[e, 1], view.ends[e, 2], view.ends[e, 3])
    if entry >= 0:
        if view.line[e] == view.line[entry] or not is_wide(beam, ends):
            return False, ends
        own = (beam[RIGHT_X], beam[RIGHT_Y], beam[LEFT_X], beam[LEFT_Y])
        ends = common(beam, own, ends)
    return is_wide(beam, ends), ends


@jit(inline=True)
def is_wide(beam: Floats, window: Window) -> bool:
    """Whether a beam's image sees a window from the front, and not edge-on."""
    px, py = beam[IMAGE_X], beam[IMAGE_Y]
    ax, ay, bx, by = window[0] - px, window[1] - py, window[2] - px, window[3] - py
    width = cross(ax, ay, bx, by)
    return width > 0.0 and width * width > GRAZING_M * GRAZING_M * max(
        ax * ax + ay * ay, bx * bx + by * by
    )


@jit(inner=True)
def common(beam: Floats, one: Window, other: Window) -> Window:
    """Part that two windows have in common, as a beam's image sees them."""
    px, py = beam[IMAGE_X], beam[IMAGE_Y]
    ax, ay, bx, by = one
    rx, ry, lx, ly = other
    if cross(ax - px, ay - py, rx - px, ry - py) <= 0.0:
        rx, ry = ax, ay
    if cross(lx - px, ly - py, bx - px, by - py) <= 0.0:
        lx, ly = bx, by
    return rx, ry, lx, ly


@jit(inner=True)
def pass_through(
    view: PlanView,
    link: NDArray[np.int32],
    beam: Floats,
    i: int,
    n: int,
    e: int,
    window: Window,
) -> None:
    """Write beam n: beam i carried on through edge e, its cell left to the caller."""
    copy_row(link, n, i)
    copy_row(beam, n, i)
    link[n, PARENT], link[n, EDGE], link[n, REFLECTED] = i, e, 0
    if view.profile[e] >= 0:
        link[n, ITEMS] += 1
    beam[n, RIGHT_X], beam[n, RIGHT_Y], beam[n, LEFT_X], beam[n, LEFT_Y] = window


@jit(inner=True)
def transmit(
    view: PlanView,
    link: NDArray[np.int32],
    beam: Floats,
    i: int,
    n: int,
    e: int,
    window: Window,
) -> int:
    """Write the beams that go through a full wall, from row n on; return the next row."""
    for k in range(view.behind_first[e], view.behind_first[e + 1]):
        f = view.behind[k]
        back = (view.ends[f, 2], view.ends[f, 3], view.ends[f, 0], view.ends[f, 1])
        part = common(beam[i], window, back)
        if is_wide(beam[i], part) and leads_on(link, i, int(view.cell_of[f])):
            pass_through(view, link, beam, i, n, f, part)
            link[n, CELL] = view.cell_of[f]
            link[n, TRANSMITTED] += 1
            n += 1
    return n


@jit(inner=True)
def reflect(
    view: PlanView,
    link: NDArray[np.int32],
    beam: Floats,
    i: int,
    n: int,
    e: int,
    window: Window,
) -> None:
    """Write beam n: beam i mirrored at edge e."""
    copy_row(link, n, i)
    link[n, PARENT], link[n, EDGE], link[n, REFLECTED] = i, e, 1
    link[n, ORDER] += 1
    link[n, ITEMS] += 1
    line = view.plane[e]
    rx, ry, lx, ly = window
    beam[n, IMAGE_X], beam[n, IMAGE_Y] = mirrored(beam[i, IMAGE_X], beam[i, IMAGE_Y], line)
    beam[n, RIGHT_X], beam[n, RIGHT_Y] = mirrored(lx, ly, line)
    beam[n, LEFT_X], beam[n, LEFT_Y] = mirrored(rx, ry, line)


@jit(inner=True)
def window_side(beam: Floats, x: float, y: float, side: int) -> tuple[float, float, float]:
    """How far [m] a point lies inside a beam's right (0) or left (1) border; the way inside."""
    px, py = beam[IMAGE_X], beam[IMAGE_Y]
    dx, dy = beam[RIGHT_X + 2 * side] - px, beam[RIGHT_Y + 2 * side] - py
    per_length = (1.0 - 2.0 * side) / math.sqrt(dx * dx + dy * dy)
    nx, ny = -dy * per_length, dx * per_length
    return nx * (x - px) + ny * (y - py), nx, ny


@jit(inner=True)
def edge_side(view: PlanView, e: int, x: float, y: float) -> tuple[float, float, float]:
    """How far [m] a point lies inside an edge of a cell; the way inside."""
    dx, dy = view.ends[e, 2] - view.ends[e, 0], view.ends[e, 3] - view.ends[e, 1]
    per_length = 1.0 / math.sqrt(dx * dx + dy * dy)
    nx, ny = -dy * per_length, dx * per_length
    return nx * (x - view.ends[e, 0]) + ny * (y - view.ends[e, 1]), nx, ny


@jit(inner=True)
def share_within(ways: Floats, n: int) -> float:
    """Share of a point's surroundings within n half planes through it (docs/theory.md, eq. 40).

    Parameters
    ----------
    ways, n
        (>= n, 2) unit normals into the half planes.
    """
    widest = 0.0
    for i in range(n):
        for j in range(i):
            turn = cross(ways[i, 0], ways[i, 1], ways[j, 0], ways[j, 1])
            along = ways[i, 0] * ways[j, 0] + ways[i, 1] * ways[j, 1]
            widest = max(widest, abs(math.atan2(turn, along)))
    return 1.0 if n == 0 else max(0.5 - 0.5 * widest / math.pi, 0.0)


@jit(inner=True)
def lit_share(
    view: PlanView, tree: Tree, i: int, x: float, y: float, cell: int, ways: Floats
) -> float:
    """Share of a point's surroundings that beam i lights.

    Parameters
    ----------
    view, tree, i
        Plan view, beams, and which one.
    x, y
        The point [m].
    cell
        The beam's cell if the point lies on its border; -1 if inside, or where the border does not
        matter.
    ways
        (>= 2 + edges of a cell, 2) room.
    """
    n = 0
    if tree.link[i, EDGE] >= 0:
        for side in range(2):
            inside, nx, ny = window_side(tree.beam[i], x, y, side)
            if inside <= -GRAZING_M:
                return 0.0
            if inside < GRAZING_M:
                ways[n, 0], ways[n, 1] = nx, ny
                n += 1
    if cell >= 0:
        for e in range(view.cell_edges[cell], view.cell_edges[cell + 1]):
            inside, nx, ny = edge_side(view, e, x, y)
            if inside < GRAZING_M:
                ways[n, 0], ways[n, 1] = nx, ny
                n += 1
    return share_within(ways, n)


@jit(inline=True)
def inside_window(beam: Floats, x: Lanes, y: Lanes) -> Lanes:
    """How far [m] points lie inside the nearer border of a beam's window (see `window_side`)."""
    px, py = beam[IMAGE_X], beam[IMAGE_Y]
    nearest = lanes_of(math.inf)
    for side in range(2):
        _, nx, ny = window_side(beam, px, py, side)
        nearest = minimum(nearest, nx * (x - px) + ny * (y - py))
    return nearest


@jit(inner=True)
def most_corners(view: PlanView) -> int:
    """Most edges of a cell."""
    most = 0
    for c in range(len(view.cell_edges) - 1):
        most = max(most, view.cell_edges[c + 1] - view.cell_edges[c])
    return most


@jit()
def hit_points(
    view: PlanView, tree: Tree, targets: Targets, beams: Ints, most: int
) -> tuple[Hits, int]:
    """Lit points with the beams that light them, beam after beam.

    Parameters
    ----------
    view, tree, targets
        The plan view, the beams and the points.
    beams, most
        Which beams, and how many hits are enough: the last beam is done with, though.

    Returns
    -------
    hits, done
        The hits, and how many of the beams are done with.
    """
    pair, share = np.empty((1024, 2), np.int32), np.empty((1024, 1))
    ways, inside = np.empty((2 + most_corners(view), 2)), np.empty(WIDTH)
    n = done = 0
    while done < len(beams) and n < most:
        i = int(beams[done])
        done += 1
        cell, is_root = tree.link[i, CELL], tree.link[i, EDGE] < 0
        last = targets.cell_points[cell + 1]
        for k in range(targets.cell_points[cell], last, WIDTH):
            nearest = lanes_of(math.inf)
            if not is_root:
                x, y = load(targets.x[k:]), load(targets.y[k:])
                nearest = inside_window(tree.beam[i], x, y)
                if not any_of(nearest > -GRAZING_M):
                    continue
            store(inside, nearest)
            if n + WIDTH > len(pair):
                pair, share = enlarged(pair), enlarged(share)
            for at in range(k, min(k + WIDTH, last)):
                if inside[at - k] <= -GRAZING_M:
                    continue
                lit = 1.0
                if inside[at - k] < GRAZING_M or targets.share[at] < 1.0:
                    border = cell if targets.share[at] < 1.0 else -1
                    lit = lit_share(view, tree, i, targets.x[at], targets.y[at], border, ways)
                if lit > 0.0:
                    pair[n, 0], pair[n, 1], share[n, 0] = targets.number[at], i, lit
                    n += 1
    return Hits(resized(pair, n), resized(share, n)[:, 0]), done


@jit()
def hit_corners(view: PlanView, tree: Tree) -> Hits:
    """Every lit corner of a cell, as vertex number, with the beam that lights it.

    The ends of the edge a beam came through were lit before it, the ends of the edge it was
    mirrored at are no reflection.
    """
    pair, share = np.empty((1024, 2), np.int32), np.empty((1024, 1))
    ways = np.empty((2, 2))
    n = 0
    for i in range(len(tree.link)):
        cell, entry = tree.link[i, CELL], tree.link[i, EDGE]
        for e in range(view.cell_edges[cell], view.cell_edges[cell + 1]):
            v = view.vertex[e, 0]
            if entry >= 0 and (v == view.vertex[entry, 0] or v == view.vertex[entry, 1]):
                continue
            lit = lit_share(view, tree, i, view.ends[e, 0], view.ends[e, 1], -1, ways)
            if lit == 0.0:
                continue
            if n == len(pair):
                pair, share = enlarged(pair), enlarged(share)
            pair[n, 0], pair[n, 1], share[n, 0] = v, i, lit
            n += 1
    return Hits(resized(pair, n), resized(share, n)[:, 0])


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
            if view.kind[e] != PARTIAL:
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
    return resized(hits, n), resized(stretch, n)


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
