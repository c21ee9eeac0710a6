"""Beam trees from a horizontal edge: a whole segment as the root.

In the frame of the edge (x along it, h away from it into the cell) a ray of the plan view is a
point (u, m): it leaves at x = u with x = u + m h. The rays that pass between two corners form a
convex polygon there, which is clipped exactly (docs/theory.md, section 6).
"""

import math
from typing import NamedTuple

import numpy as np

from raytrace.arrays import Floats, Int32s, Ints
from raytrace.kernels.beams import (
    CELL,
    EDGE,
    ORDER,
    PARENT,
    TRANSMITTED,
    TURNS_DOWN,
    TURNS_UP,
    Window,
    link_child,
    may_enter,
    most_children,
    turns_of,
)
from raytrace.kernels.compiling import jit
from raytrace.kernels.guard import Guard, is_stopped, may_hold
from raytrace.kernels.lanes import (
    Number,
)
from raytrace.kernels.losses import (
    IS_MIRRORED,
    IS_TRANSMITTED,
    PASSES,
    Incidence,
    Limits,
    incidence,
    largest_fraction,
)
from raytrace.kernels.plan_view import PlanView
from raytrace.kernels.rows import copy_row, enlarged, resized
from raytrace.kernels.strip_losses import Spread, has_strong_way, nearest_zero
from raytrace.kernels.turns import Heights, turns_at, turns_from_edge, turns_needed

STEEPEST = 1e5
"""Largest |m| of a ray that leaves a horizontal edge."""

SLIVER_M = 1e-10
"""Narrowest interval of an edge that is traced [m]."""

FRACTION, Z_UP, Z_DOWN = 7, 8, 9
"""Columns of `StripTree.frame`."""


class StripTree(NamedTuple):
    """Beams from a segment.

    Attributes
    ----------
    link
        (n, 9) int32, as in `beams.Tree`.
    frame
        (n, 10) x = f[0] X + f[1] Y + f[2] and h = f[3] X + f[4] Y + f[5] of a point of the beam's
        cell; f[6] is -1 where the frame is mirrored, else 1; f[7] as `beams.FRACTION`; f[8] and
        f[9] the heights in `turns.Turns` [m].
    first
        (n + 1,) corners of beam i's polygon are rays[first[i]:first[i + 1]].
    rays
        (m, 2) corners (u [m], m [1]).
    """

    link: Int32s
    frame: Floats
    first: Ints
    rays: Floats


STRIP_BYTES, RAY_BYTES = 9 * 4 + 10 * 8 + 8, 2 * 8
"""Sizes of a beam without its corners, and of a corner."""


def no_strips() -> StripTree:
    """Return a tree without beams."""
    link, frame, rays = np.empty((0, 9), np.int32), np.empty((0, 10)), np.empty((0, 2))
    return StripTree(link, frame, np.zeros(1, np.int64), rays)


@jit()
def edge_frame(view: PlanView, e: int) -> Floats:
    """Frame (8,) of an edge of the plan view, h into its cell."""
    x1, y1, x2, y2 = view.ends[e, 0], view.ends[e, 1], view.ends[e, 2], view.ends[e, 3]
    length = math.hypot(x2 - x1, y2 - y1)
    tx, ty = (x2 - x1) / length, (y2 - y1) / length
    frame = np.empty(8)
    frame[0], frame[1], frame[2] = tx, ty, -(tx * x1 + ty * y1)
    frame[3], frame[4], frame[5] = -ty, tx, ty * x1 - tx * y1
    frame[6] = frame[7] = 1.0
    return frame


@jit(inline=True)
def in_frame(frame: Floats, x: Number, y: Number) -> tuple[Number, Number]:
    """(x, h) of a point."""
    return (
        frame[0] * x + frame[1] * y + frame[2],
        frame[3] * x + frame[4] * y + frame[5],
    )


@jit(inline=True)
def from_frame(frame: Floats, u: Number) -> tuple[Number, Number]:
    """Point (x, y) of the plan view that is u along the edge; the frame is orthonormal."""
    return (
        frame[0] * (u - frame[2]) - frame[3] * frame[5],
        frame[1] * (u - frame[2]) - frame[4] * frame[5],
    )


@jit(inner=True)
def copy_rays(rays: Floats, start: int, n: int, out: Floats, to: int) -> None:
    """out[to:to + n] = rays[start:start + n], much faster to compile."""
    for k in range(n):
        out[to + k, 0], out[to + k, 1] = rays[start + k, 0], rays[start + k, 1]


@jit(inner=True)
def clipped(rays: Floats, n: int, x: float, h: float, sign: float, out: Floats) -> int:
    """Keep the rays with sign (x - u - m h) >= 0; write them to `out`, return how many corners."""
    kept = 0
    for i in range(n):
        j = i + 1 if i + 1 < n else 0
        here = sign * (x - rays[i, 0] - rays[i, 1] * h)
        there = sign * (x - rays[j, 0] - rays[j, 1] * h)
        if here >= 0.0:
            out[kept, 0], out[kept, 1] = rays[i, 0], rays[i, 1]
            kept += 1
        if (here > 0.0 and there < 0.0) or (here < 0.0 and there > 0.0):
            t = here / (here - there)
            out[kept, 0] = rays[i, 0] + t * (rays[j, 0] - rays[i, 0])
            out[kept, 1] = rays[i, 1] + t * (rays[j, 1] - rays[i, 1])
            kept += 1
    return kept


@jit(inline=True)
def is_sliver(rays: Floats, n: int) -> bool:
    """Whether a polygon of rays is too thin to be traced."""
    if n < 3:
        return True
    low = high = rays[0, 0]
    area = 0.0
    for i in range(n):
        j = i + 1 if i + 1 < n else 0
        area += rays[i, 0] * rays[j, 1] - rays[j, 0] * rays[i, 1]
        low, high = min(low, rays[i, 0]), max(high, rays[i, 0])
    return abs(area) < 1e-13 or high - low < SLIVER_M


@jit(inner=True)
def through_edge(view: PlanView, tree: StripTree, i: int, e: int, work: Floats, out: Floats) -> int:
    """Clip beam i to the part that meets edge e; write corners to `out`, return how many."""
    n = tree.first[i + 1] - tree.first[i]
    copy_rays(tree.rays, tree.first[i], n, out, 0)
    ends = (view.ends[e, 0], view.ends[e, 1], view.ends[e, 2], view.ends[e, 3])
    return between(tree.frame[i], ends, n, work, out)


@jit(inner=True)
def between(frame: Floats, ends: Window, n: int, work: Floats, out: Floats) -> int:
    """Clip the n rays in `out` to those between two corners; return how many are left.

    By rounding, a polygon of almost no width could meet an edge from behind: its mean ray must not.
    """
    x1, h1 = in_frame(frame, ends[0], ends[1])
    x2, h2 = in_frame(frame, ends[2], ends[3])
    if h1 <= 1e-9 and h2 <= 1e-9:
        return 0
    if h1 > 1e-9:
        copy_rays(out, 0, n, work, 0)
        n = clipped(work, n, x1, h1, frame[6], out)
    if h2 > 1e-9 and n >= 3:
        copy_rays(out, 0, n, work, 0)
        n = clipped(work, n, x2, h2, -frame[6], out)
    if is_sliver(out, n):
        return 0
    slope = 0.0
    for k in range(n):
        slope += out[k, 1] / n
    faces = frame[6] * (slope * (h2 - h1) - (x2 - x1)) > 0.0
    return n if faces else 0


@jit(inner=True)
def mirror_frame(frame: Floats, line: Floats) -> None:
    """Change a frame to that of the beam mirrored at a line."""
    nx, ny, d = line[0], line[1], line[2]
    for k in (0, 3):
        along = 2.0 * (frame[k] * nx + frame[k + 1] * ny)
        frame[k] -= along * nx
        frame[k + 1] -= along * ny
        frame[k + 2] += along * d
    frame[6] = -frame[6]


@jit(inner=True)
def write_box(rays: Floats, length: float) -> None:
    """All rays that leave an edge of that length."""
    rays[0, 0], rays[1, 0], rays[2, 0], rays[3, 0] = 0.0, length, length, 0.0
    rays[0, 1] = rays[1, 1] = -STEEPEST
    rays[2, 1] = rays[3, 1] = STEEPEST


@jit(inner=True)
def add_child(
    view: PlanView,
    tree: StripTree,
    at: tuple[int, int, int],
    how: int,
    corners: int,
    rays: Floats,
    fraction: float,
) -> None:
    """Write beam n: the part of beam i that passes edge e, is mirrored there, or transmitted.

    Parameters
    ----------
    view, tree
        Plan view and beams.
    at
        i, n and e.
    how
        `PASSES`, `IS_MIRRORED` or `IS_TRANSMITTED`.
    corners, rays
        Number of corners of its polygon, and these.
    fraction
        See `beams.FRACTION`.
    """
    i, n, e = at
    link, frame, first = tree.link, tree.frame, tree.first
    link_child(view, link, i, n, e, how == IS_MIRRORED)
    copy_row(frame, n, i)
    frame[n, FRACTION] = fraction
    if how == IS_MIRRORED:
        mirror_frame(frame[n], view.plane[e])
    elif how == PASSES:
        link[n, CELL] = view.beyond[e]
    else:
        link[n, CELL] = view.cell_of[e]
        link[n, TRANSMITTED] += 1
    copy_rays(rays, 0, corners, tree.rays, first[n])
    first[n + 1] = first[n] + corners


@jit(inner=True)
def spread_on(
    view: PlanView, frame: Floats, e: int, rays: Floats, n: int, limits: Limits
) -> tuple[Incidence, Spread]:
    """Incidence on edge e of a beam, whose rays that meet it have n corners, and their spread.

    Neither is read without a limit by loss.
    """
    if not limits.loss.is_active:
        return Incidence(0.0, 0.0, 1.0), Spread((0.0, 0.0), (0.0, 0.0), 0.0, rays, n)
    low = high = rays[0, 1]
    start = end = rays[0, 0]
    for k in range(1, n):
        low, high = min(low, rays[k, 1]), max(high, rays[k, 1])
        start, end = min(start, rays[k, 0]), max(end, rays[k, 0])
    nx, ny = view.plane[e, 0], view.plane[e, 1]
    normal = (frame[0] * nx + frame[1] * ny, frame[3] * nx + frame[4] * ny)
    x1, h1 = in_frame(frame, view.ends[e, 0], view.ends[e, 1])
    _, h2 = in_frame(frame, view.ends[e, 2], view.ends[e, 3])
    off, least, away = normal[0] * x1 + normal[1] * h1, max(min(h1, h2), 0.0), max(h1, h2)
    for k in range(n):
        across = abs(normal[0] * rays[k, 1] + normal[1])
        away = min(away, abs(off - normal[0] * rays[k, 0]) / max(across, 1e-12))
    away = max(away, least)
    met = incidence(0.0, normal, (low, 1.0), (high, 1.0))
    to_line = min(abs(off - normal[0] * start), abs(off - normal[0] * end))
    along = away * math.hypot(1.0, nearest_zero((low, high)))
    nearest = max(to_line / max(met.largest, 1e-9), along)
    spread = Spread((low, high), (start, end), away, rays, n)
    return Incidence(nearest, met.least, met.largest), spread


@jit(inner=True)
def split_strip(
    view: PlanView,
    heights: Heights,
    tree: StripTree,
    i: int,
    n: int,
    limits: Limits,
    scratch: tuple[Floats, Floats, Floats],
) -> int:
    """Write the children of beam i from row n on; return the next row.

    `scratch` holds two arrays for corners, and `left_out` of `losses.is_strong`.
    """
    work, out, left_out = scratch
    link, frame = tree.link, tree.frame[i]
    cell, order = link[i, CELL], int(link[i, ORDER])
    before = turns_of(link[i], frame[Z_UP], frame[Z_DOWN])
    for e in range(view.cell_edges[cell], view.cell_edges[cell + 1]):
        if view.line[e] == view.line[link[i, EDGE]]:
            continue
        corners = through_edge(view, tree, i, e, work, out)
        if corners == 0:
            continue
        met, spread = spread_on(view, frame, e, out, corners, limits)
        for how in (PASSES, IS_MIRRORED):
            possible = may_enter(link, i, view.beyond[e]) if how == 0 else view.profile[e] >= 0
            if not possible:
                continue
            turns = before
            if how == IS_MIRRORED or limits.max_transmissions == 0:
                turns = turns_at(view, e, how == IS_MIRRORED, before)
            if order + how + turns_needed(turns, heights) > limits.max_reflections:
                continue
            kept = frame[FRACTION] * largest_fraction(limits, view, e, how, met, order)
            into = int(view.twin[e]) if how == PASSES else e
            if has_strong_way(limits, order + how, into, (kept, met.nearest), spread, left_out):
                add_child(view, tree, (i, n, e), how, corners, out, kept)
                link[n, TURNS_UP], tree.frame[n, Z_UP] = turns[0], turns[1]
                link[n, TURNS_DOWN], tree.frame[n, Z_DOWN] = turns[2], turns[3]
                n += 1
        if link[i, TRANSMITTED] < limits.max_transmissions:
            kept = frame[FRACTION] * largest_fraction(limits, view, e, IS_TRANSMITTED, met, order)
            n = transmit_strip(view, tree, (i, n, e), scratch, (limits, kept))
    return n


@jit(inner=True)
def transmit_strip(
    view: PlanView,
    tree: StripTree,
    place: tuple[int, int, int],
    scratch: tuple[Floats, Floats, Floats],
    loss: tuple[Limits, float],
) -> int:
    """Write the beams that go through a solid wall; return the next row.

    `place` is as for `add_child`, `scratch` for `split_strip`; `loss` holds limits and fraction of
    the power for `strip_losses.has_strong_way`.
    """
    (i, n, e), (work, out, left_out), (limits, kept) = place, scratch, loss
    order = int(tree.link[i, ORDER])
    for k in range(view.behind_first[e], view.behind_first[e + 1]):
        f = view.behind[k]
        back = (view.ends[f, 2], view.ends[f, 3], view.ends[f, 0], view.ends[f, 1])
        corners = through_edge(view, tree, i, e, work, out)
        corners = between(tree.frame[i], back, corners, work, out)
        if corners == 0 or not may_enter(tree.link, i, int(view.cell_of[f])):
            continue
        met, spread = spread_on(view, tree.frame[i], e, out, corners, limits)
        if has_strong_way(limits, order, int(f), (kept, met.nearest), spread, left_out):
            add_child(view, tree, (i, n, f), IS_TRANSMITTED, corners, out, kept)
            n += 1
    return n


def grow_strips(
    view: PlanView, heights: Heights, root: int, root_cell: int, limits: Limits, guard: Guard
) -> tuple[StripTree, float, bool]:
    """Grow all beams from one side of an edge.

    Parameters
    ----------
    view, heights
        As for `beams.grow_tree`.
    root, root_cell
        The edge, as seen from the cell that the beams go into.
    limits, guard
        As for `beams.grow_tree`.

    Returns
    -------
    strips, left_out, is_whole
        As from `beams.grow_tree`.
    """
    arrays = grow_strip_arrays(view, heights, root, root_cell, limits, guard)
    return StripTree(*arrays[:4]), *arrays[4:]


@jit()
def grow_strip_arrays(
    view: PlanView, heights: Heights, root: int, root_cell: int, limits: Limits, guard: Guard
) -> tuple[Int32s, Floats, Ints, Floats, float, bool]:
    """Arrays of `grow_strips`."""
    link = np.zeros((256, 9), np.int32)
    frame, left_out = np.empty((256, 10)), np.zeros(1)
    first = np.zeros((257, 1), np.int64)
    rays = np.empty((4096, 2))
    work, out = np.empty((256, 2)), np.empty((256, 2))
    link[0, PARENT], link[0, EDGE], link[0, CELL] = -1, root, root_cell
    root_frame = edge_frame(view, root)
    for k in range(len(root_frame)):
        frame[0, k] = root_frame[k]
    _, frame[0, Z_UP], _, frame[0, Z_DOWN] = turns_from_edge(heights)
    length, _ = in_frame(frame[0], view.ends[root, 2], view.ends[root, 3])
    write_box(rays, length)
    first[1, 0] = 4
    i = int(np.int64(0))  # a literal would be compiled as a type of its own
    n = i + 1
    while i < n and not is_stopped(guard):
        corners = first[i + 1, 0] - first[i, 0] + 2
        n_beams = n + most_children(view, link[i, CELL]) + 1
        n_rays = first[n, 0] + (n_beams - n - 1) * corners
        if not may_hold(guard, n_beams, len(link), STRIP_BYTES):
            break
        if not may_hold(guard, n_rays, len(rays), RAY_BYTES):
            break
        while n_beams > len(link):
            link, frame, first = enlarged(link), enlarged(frame), enlarged(first)
        while n_rays > len(rays):
            rays = enlarged(rays)
        while corners > len(out):
            work, out = enlarged(work), enlarged(out)
        tree = StripTree(link, frame, first[:, 0], rays)
        n = split_strip(view, heights, tree, i, n, limits, (work, out, left_out))
        i += 1
    is_whole = i == n
    n = n if is_whole else 0
    first_ray, rays = resized(first, n + 1)[:, 0], resized(rays, first[n, 0])
    return resized(link, n), resized(frame, n), first_ray, rays, left_out[0], is_whole
