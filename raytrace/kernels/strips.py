"""Beam trees from a horizontal edge: a whole segment as the root.

The rays of a beam are a polygon in the frame of the edge, see `raytrace.kernels.edge_rays`.
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
    link_child,
    may_enter,
    most_children,
    turns_of,
)
from raytrace.kernels.compiling import jit
from raytrace.kernels.edge_rays import (
    between,
    copy_rays,
    edge_frame,
    in_frame,
    mirror_frame,
    nearest_zero,
    write_box,
)
from raytrace.kernels.guard import Guard, is_stopped, may_hold
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
from raytrace.kernels.strip_losses import Spread, has_strong_way
from raytrace.kernels.turns import Heights, turns_at, turns_from_edge, turns_needed

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


@jit(inner=True)
def through_edge(view: PlanView, tree: StripTree, i: int, e: int, work: Floats, out: Floats) -> int:
    """Clip beam i to the part that meets edge e; write corners to `out`, return how many."""
    n = tree.first[i + 1] - tree.first[i]
    copy_rays(tree.rays, tree.first[i], n, out, 0)
    ends = (view.ends[e, 0], view.ends[e, 1], view.ends[e, 2], view.ends[e, 3])
    return between(tree.frame[i], ends, n, work, out)


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
