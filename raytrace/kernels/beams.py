"""Beam trees: which sequences of walls and openings a ray from a point can take.

A beam is the image of its root point and a window of two corners, all in the frame of the cell
it is in (docs/theory.md, section 3). It splits over the edges of its cell with two cross
products an edge; a point of the cell is visible from the root where it lies within the window.
"""

from typing import NamedTuple

import numpy as np

from raytrace.arrays import Floats, Int32s, Ints
from raytrace.kernels.compiling import jit
from raytrace.kernels.edge_losses import Directions, directions_between
from raytrace.kernels.guard import Guard, is_stopped, may_hold
from raytrace.kernels.losses import (
    IS_MIRRORED,
    IS_TRANSMITTED,
    Incidence,
    Limits,
    incidence,
    is_strong,
    largest_fraction,
)
from raytrace.kernels.plan_view import GRAZING_M, PlanView, cross, mirrored
from raytrace.kernels.rows import copy_row, enlarged, resized
from raytrace.kernels.turns import Heights, Turns, turns_at, turns_needed

PARENT, EDGE, REFLECTED, CELL, ORDER, TRANSMITTED, INTERACTIONS, TURNS_UP, TURNS_DOWN = range(9)
"""Columns of `Tree.link`: the beam it split from; the edge it came through or was mirrored at,
-1 at the root; whether it was mirrored; the cell it is in; wall reflections so far; solid walls
gone through; reflections, solid walls gone through and partial walls with openings so far; and the
numbers of turns in `turns.Turns`."""

IMAGE_X, IMAGE_Y, RIGHT_X, RIGHT_Y, LEFT_X, LEFT_Y, FRACTION, AXIS_X, AXIS_Y, Z_UP, Z_DOWN = range(
    11
)
"""Columns of `Tree.beam`: the root's image, and the corners of the window [m]. Where there is a
limit by loss: the largest fraction of the power that the walls on the way leave, and the image of
the direction of a vertical edge's o-face. The heights in `turns.Turns` [m]."""

BEAM_BYTES = 9 * 4 + 11 * 8
"""Size of a row of `Tree`."""

Window = tuple[float, float, float, float]
"""Right and left corner of a window: x, y, x, y [m]."""


class Tree(NamedTuple):
    """Beams, each behind its parent: `link` (n, 9) int32 and `beam` (n, 11)."""

    link: Int32s
    beam: Floats


def no_tree() -> Tree:
    """Return a tree without beams."""
    return Tree(np.empty((0, 9), np.int32), np.empty((0, 11)))


def grow_tree(
    view: PlanView,
    heights: Heights,
    root: tuple[float, float],
    root_cells: Ints,
    limits: Limits,
    guard: Guard,
) -> tuple[Tree, float, bool]:
    """Grow all beams from a point.

    Parameters
    ----------
    view
        The plan view.
    heights
        At which paths begin and end.
    root
        The point [m].
    root_cells
        The cells it lies in.
    limits
        How far the beams are grown.
    guard
        May end the growth.

    Returns
    -------
    tree, left_out, is_whole
        The beams; a bound on the power of all paths within those that are too weak to be grown;
        and whether these are all beams; otherwise there are none.
    """
    arrays = grow_tree_arrays(view, heights, root, root_cells, limits, guard)
    return Tree(*arrays[:2]), *arrays[2:]


@jit()
def grow_tree_arrays(
    view: PlanView,
    heights: Heights,
    root: tuple[float, float],
    root_cells: Ints,
    limits: Limits,
    guard: Guard,
) -> tuple[Int32s, Floats, float, bool]:
    """Arrays of `grow_tree`."""
    link = np.zeros((256 + len(root_cells), 9), np.int32)
    beam, left_out = np.zeros((256 + len(root_cells), 11)), np.zeros(1)
    n = i = int(np.int64(0))  # a literal would be compiled as a type of its own
    for cell in root_cells:
        link[n, PARENT] = link[n, EDGE] = -1
        link[n, CELL] = cell
        beam[n, IMAGE_X], beam[n, IMAGE_Y] = root
        beam[n, FRACTION] = 1.0
        beam[n, AXIS_X], beam[n, AXIS_Y] = limits.loss.edge_ways.axis
        beam[n, Z_UP] = beam[n, Z_DOWN] = heights.start
        n += 1
    while i < n and not is_stopped(guard):
        needed = n + most_children(view, link[i, CELL])
        if not may_hold(guard, needed, len(link), BEAM_BYTES):
            break
        while needed > len(link):
            link, beam = enlarged(link), enlarged(beam)
        n = split(view, heights, (link, beam), i, n, limits, left_out)
        i += 1
    is_whole = i == n
    n = n if is_whole else 0
    return resized(link, n), resized(beam, n), left_out[0], is_whole


@jit(inner=True)
def most_children(view: PlanView, cell: int) -> int:
    """Most beams that one in this cell can split into."""
    first, last = view.cell_edges[cell], view.cell_edges[cell + 1]
    return 2 * (last - first) + view.behind_first[last] - view.behind_first[first]


@jit(inner=True)
def may_enter(link: Int32s, i: int, cell: int) -> bool:
    """Whether beam i may enter a cell: a straight ray is in a convex cell only once.

    This also ends slivers, which rounding could otherwise send around a corner forever.
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
    heights: Heights,
    rows: tuple[Int32s, Floats],
    i: int,
    n: int,
    limits: Limits,
    left_out: Floats,
) -> int:
    """Write the children of beam i from row n of `Tree` on; return the next row.

    The bound on those that are too weak is added to `left_out` (1,).
    """
    link, beam = rows
    cell, order, fraction = link[i, CELL], int(link[i, ORDER]), beam[i, FRACTION]
    turns = turns_of(link[i], beam[i, Z_UP], beam[i, Z_DOWN])
    for e in range(view.cell_edges[cell], view.cell_edges[cell + 1]):
        meets, window = narrowed(view, link[i, EDGE], beam[i], e)
        if not meets:
            continue
        met = incidence_of(view, beam[i], e, window, limits)
        leaves = directions_of(beam[i], order, window, limits)
        passed = turns if limits.max_transmissions > 0 else turns_at(view, e, False, turns)
        if (
            order + turns_needed(passed, heights) <= limits.max_reflections
            and may_enter(link, i, view.beyond[e])
            and is_strong(
                limits, order, int(view.twin[e]), (fraction, met.nearest), leaves, left_out
            )
        ):
            pass_beam(view, link, beam, i, n, e, window)
            link[n, CELL] = view.beyond[e]
            write_turns(link, beam, n, passed)
            n += 1
        if link[i, TRANSMITTED] < limits.max_transmissions:
            kept = fraction * largest_fraction(limits, view, e, IS_TRANSMITTED, met, order)
            loss = limits, (kept, met.nearest), leaves, left_out
            n = transmit_beam(view, link, beam, i, n, e, window, loss)
        if view.profile[e] < 0:
            continue
        turned = turns_at(view, e, True, turns)
        if order + 1 + turns_needed(turned, heights) <= limits.max_reflections:
            kept = fraction * largest_fraction(limits, view, e, IS_MIRRORED, met, order)
            if is_strong(limits, order + 1, e, (kept, met.nearest), leaves, left_out):
                reflect_beam(view, link, beam, i, n, e, window)
                write_turns(link, beam, n, turned)
                beam[n, FRACTION] = kept
                n += 1
    return n


@jit(inline=True)
def turns_of(link: Int32s, z_up: float, z_down: float) -> Turns:
    """Turns of a beam, whose heights lie elsewhere."""
    return int(link[TURNS_UP]), z_up, int(link[TURNS_DOWN]), z_down


@jit(inline=True)
def write_turns(link: Int32s, beam: Floats, n: int, turns: Turns) -> None:
    """Write the turns of beam n."""
    link[n, TURNS_UP], beam[n, Z_UP], link[n, TURNS_DOWN], beam[n, Z_DOWN] = turns


@jit(inline=True)
def incidence_of(view: PlanView, beam: Floats, e: int, window: Window, limits: Limits) -> Incidence:
    """Incidence of a beam on the part of edge e within a window."""
    if not limits.loss.is_active:
        return Incidence(0.0, 0.0, 1.0)
    px, py = beam[IMAGE_X], beam[IMAGE_Y]
    nx, ny, d = view.plane[e, 0], view.plane[e, 1], view.plane[e, 2]
    right, left = (window[0] - px, window[1] - py), (window[2] - px, window[3] - py)
    return incidence(nx * px + ny * py - d, (nx, ny), right, left)


@jit(inline=True)
def directions_of(beam: Floats, order: int, window: Window, limits: Limits) -> Directions:
    """Directions in which the rays of a beam within a window leave a vertical edge."""
    ways = limits.loss.edge_ways
    if len(ways.order) == 0:
        return Directions(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    px, py, rx, ry, lx, ly = beam[IMAGE_X], beam[IMAGE_Y], *window
    right, left = (
        in_root_frame(beam, order, rx - px, ry - py),
        in_root_frame(beam, order, lx - px, ly - py),
    )
    if order % 2 == 1:
        right, left = left, right
    return directions_between(ways.wedge, right, left)


@jit(inline=True)
def in_root_frame(beam: Floats, order: int, x: float, y: float) -> tuple[float, float]:
    """Components of a beam's direction along the edge's o-face and across, before reflections."""
    across = cross(beam[AXIS_X], beam[AXIS_Y], x, y)
    return beam[AXIS_X] * x + beam[AXIS_Y] * y, -across if order % 2 == 1 else across


@jit(inner=True)
def narrowed(view: PlanView, entry: int, beam: Floats, e: int) -> tuple[bool, Window]:
    """Whether a beam meets edge e, and its window there."""
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
    """Intersection of two windows, as seen from a beam's image."""
    px, py = beam[IMAGE_X], beam[IMAGE_Y]
    ax, ay, bx, by = one
    rx, ry, lx, ly = other
    if cross(ax - px, ay - py, rx - px, ry - py) <= 0.0:
        rx, ry = ax, ay
    if cross(lx - px, ly - py, bx - px, by - py) <= 0.0:
        lx, ly = bx, by
    return rx, ry, lx, ly


@jit(inline=True)
def link_child(view: PlanView, link: Int32s, i: int, n: int, e: int, is_mirrored: bool) -> None:
    """Write the link of beam n, which beam i becomes at edge e; its cell stays that of beam i."""
    copy_row(link, n, i)
    link[n, PARENT], link[n, EDGE], link[n, REFLECTED] = i, e, 1 if is_mirrored else 0
    if view.profile[e] >= 0:
        link[n, INTERACTIONS] += 1
    if is_mirrored:
        link[n, ORDER] += 1


@jit(inner=True)
def pass_beam(
    view: PlanView,
    link: Int32s,
    beam: Floats,
    i: int,
    n: int,
    e: int,
    window: Window,
) -> None:
    """Write beam n: the part of beam i that goes on through edge e; the caller sets its cell."""
    link_child(view, link, i, n, e, False)
    beam[n, IMAGE_X], beam[n, IMAGE_Y] = beam[i, IMAGE_X], beam[i, IMAGE_Y]
    beam[n, RIGHT_X], beam[n, RIGHT_Y], beam[n, LEFT_X], beam[n, LEFT_Y] = window
    for k in (FRACTION, AXIS_X, AXIS_Y, Z_UP, Z_DOWN):
        beam[n, k] = beam[i, k]


@jit(inner=True)
def transmit_beam(
    view: PlanView,
    link: Int32s,
    beam: Floats,
    i: int,
    n: int,
    e: int,
    window: Window,
    loss: tuple[Limits, tuple[float, float], Directions, Floats],
) -> int:
    """Write the beams that go through a solid wall, from row n on; return the next row.

    `loss` holds the arguments of `losses.is_strong`.
    """
    limits, kept, leaves, left_out = loss
    order = int(link[i, ORDER])
    for k in range(view.behind_first[e], view.behind_first[e + 1]):
        f = view.behind[k]
        back = (view.ends[f, 2], view.ends[f, 3], view.ends[f, 0], view.ends[f, 1])
        part = common(beam[i], window, back)
        if not is_wide(beam[i], part) or not may_enter(link, i, int(view.cell_of[f])):
            continue
        if is_strong(limits, order, int(f), kept, leaves, left_out):
            pass_beam(view, link, beam, i, n, f, part)
            link[n, CELL] = view.cell_of[f]
            link[n, TRANSMITTED] += 1
            beam[n, FRACTION] = kept[0]
            n += 1
    return n


@jit(inner=True)
def reflect_beam(
    view: PlanView,
    link: Int32s,
    beam: Floats,
    i: int,
    n: int,
    e: int,
    window: Window,
) -> None:
    """Write beam n: the part of beam i that is mirrored at edge e."""
    link_child(view, link, i, n, e, True)
    line = view.plane[e]
    rx, ry, lx, ly = window
    beam[n, IMAGE_X], beam[n, IMAGE_Y] = mirrored(beam[i, IMAGE_X], beam[i, IMAGE_Y], line)
    beam[n, RIGHT_X], beam[n, RIGHT_Y] = mirrored(lx, ly, line)
    beam[n, LEFT_X], beam[n, LEFT_Y] = mirrored(rx, ry, line)
    along = 2.0 * (beam[i, AXIS_X] * line[0] + beam[i, AXIS_Y] * line[1])
    beam[n, AXIS_X], beam[n, AXIS_Y] = (
        beam[i, AXIS_X] - along * line[0],
        beam[i, AXIS_Y] - along * line[1],
    )
