"""Beam trees from a horizontal edge: a whole segment as the root.

In the frame of the edge (x along it, h away from it into the cell) a ray of the plan view is a
point (u, m): it leaves at x = u with x = u + m h. The rays that pass between two corners form a
convex polygon there, which is clipped exactly (docs/theory.md, section 6).
"""

import math
from typing import NamedTuple

import numpy as np

from raytrace.arrays import Floats, Int32s, Ints
from raytrace.kernels.beam_hits import HIT_BYTES, Hits, Targets
from raytrace.kernels.beams import (
    BOUNCES,
    CELL,
    EDGE,
    ORDER,
    PARENT,
    TRANSMITTED,
    Window,
    link_child,
    may_enter,
    most_children,
)
from raytrace.kernels.compiling import jit
from raytrace.kernels.guard import Guard, is_stopped, may_hold
from raytrace.kernels.lanes import (
    WIDTH,
    Lanes,
    Number,
    any_of,
    lanes_of,
    load,
    maximum,
    minimum,
    store,
    where,
)
from raytrace.kernels.plan_view import GRAZING_M, PlanView
from raytrace.kernels.rows import copy_row, enlarged, resized

STEEPEST = 1e5
"""Largest |m| of a ray that leaves a horizontal edge."""

SLIVER_M = 1e-10
"""Narrowest interval of an edge that is traced [m]."""


class StripTree(NamedTuple):
    """Beams from a segment.

    Attributes
    ----------
    link
        (n, 8) int32, as in `beams.Tree`.
    frame
        (n, 7) x = f[0] X + f[1] Y + f[2] and h = f[3] X + f[4] Y + f[5] of a point of the beam's
        cell; f[6] is -1 where the frame is mirrored, else 1.
    first
        (n + 1,) corners of beam i's polygon are rays[first[i]:first[i + 1]].
    rays
        (m, 2) corners (u [m], m [1]).
    """

    link: Int32s
    frame: Floats
    first: Ints
    rays: Floats


STRIP_BYTES, RAY_BYTES, SEEN_BYTES = 8 * 4 + 7 * 8 + 8, 2 * 8, 4 * 8
"""Sizes of a beam without its corners, of a corner, and of a row of `seen` (`hit_from_strip`)."""


@jit()
def edge_frame(view: PlanView, e: int) -> Floats:
    """Frame (7,) of an edge of the plan view, h into its cell."""
    x1, y1, x2, y2 = view.ends[e, 0], view.ends[e, 1], view.ends[e, 2], view.ends[e, 3]
    length = math.hypot(x2 - x1, y2 - y1)
    tx, ty = (x2 - x1) / length, (y2 - y1) / length
    frame = np.empty(7)
    frame[0], frame[1], frame[2] = tx, ty, -(tx * x1 + ty * y1)
    frame[3], frame[4], frame[5] = -ty, tx, ty * x1 - tx * y1
    frame[6] = 1.0
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


PASSES, IS_MIRRORED, IS_TRANSMITTED = 0, 1, 2
"""What becomes of a beam at an edge."""


@jit(inner=True)
def add_child(
    view: PlanView, tree: StripTree, i: int, n: int, e: int, how: int, corners: int, rays: Floats
) -> None:
    """Write beam n: the part of beam i that passes edge e, is mirrored there, or transmitted."""
    link, frame, first = tree.link, tree.frame, tree.first
    link_child(view, link, i, n, e, how == IS_MIRRORED)
    copy_row(frame, n, i)
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
def split_strip(
    view: PlanView,
    bounces: Ints,
    tree: StripTree,
    i: int,
    n: int,
    limits: tuple[int, int],
    scratch: tuple[Floats, Floats],
) -> int:
    """Write the children of beam i from row n on; return the next row."""
    work, out = scratch
    link = tree.link
    cell = link[i, CELL]
    for e in range(view.cell_edges[cell], view.cell_edges[cell + 1]):
        if view.line[e] == view.line[link[i, EDGE]]:
            continue
        corners = through_edge(view, tree, i, e, work, out)
        if corners == 0:
            continue
        for how in (PASSES, IS_MIRRORED):
            required = max(link[i, BOUNCES], bounces[e, how])
            possible = may_enter(link, i, view.beyond[e]) if how == 0 else view.profile[e] >= 0
            if not possible or link[i, ORDER] + how + required > limits[0]:
                continue
            add_child(view, tree, i, n, e, how, corners, out)
            link[n, BOUNCES] = required
            n += 1
        if link[i, TRANSMITTED] < limits[1]:
            n = transmit_strip(view, tree, i, n, e, scratch)
    return n


@jit(inner=True)
def transmit_strip(
    view: PlanView, tree: StripTree, i: int, n: int, e: int, scratch: tuple[Floats, Floats]
) -> int:
    """Write the beams that go through a solid wall, from row n on; return the next row."""
    work, out = scratch
    for k in range(view.behind_first[e], view.behind_first[e + 1]):
        f = view.behind[k]
        back = (view.ends[f, 2], view.ends[f, 3], view.ends[f, 0], view.ends[f, 1])
        corners = through_edge(view, tree, i, e, work, out)
        corners = between(tree.frame[i], back, corners, work, out)
        if corners > 0 and may_enter(tree.link, i, int(view.cell_of[f])):
            add_child(view, tree, i, n, f, IS_TRANSMITTED, corners, out)
            n += 1
    return n


def grow_strips(
    view: PlanView, bounces: Ints, root: int, root_cell: int, limits: tuple[int, int], guard: Guard
) -> tuple[StripTree, bool]:
    """Grow all beams from one side of an edge.

    Parameters
    ----------
    view, bounces
        As for `beams.grow_tree`.
    root, root_cell
        The edge, as seen from the cell that the beams go into.
    limits
        Maximum numbers of reflections and of transmissions through solid walls.
    guard
        May end the growth.

    Returns
    -------
    strips, is_whole
        The beams, and whether they are all; otherwise there are none.
    """
    link, frame, first, rays, is_whole = grow_strip_arrays(
        view, bounces, root, root_cell, limits, guard
    )
    return StripTree(link, frame, first, rays), is_whole


@jit()
def grow_strip_arrays(
    view: PlanView, bounces: Ints, root: int, root_cell: int, limits: tuple[int, int], guard: Guard
) -> tuple[Int32s, Floats, Ints, Floats, bool]:
    """Arrays of `grow_strips`."""
    link = np.zeros((256, 8), np.int32)
    frame = np.empty((256, 7))
    first = np.zeros((257, 1), np.int64)
    rays = np.empty((4096, 2))
    work, out = np.empty((256, 2)), np.empty((256, 2))
    link[0, PARENT], link[0, EDGE], link[0, CELL] = -1, root, root_cell
    root_frame = edge_frame(view, root)
    for k in range(len(root_frame)):
        frame[0, k] = root_frame[k]
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
        n = split_strip(view, bounces, tree, i, n, limits, (work, out))
        i += 1
    is_whole = i == n
    n = n if is_whole else 0
    first_ray = resized(first, n + 1)[:, 0]
    return resized(link, n), resized(frame, n), first_ray, resized(rays, first[n, 0]), is_whole


def hit_from_strip(
    tree: StripTree, targets: Targets, beams: Ints, max_hits: int, guard: Guard
) -> tuple[Hits, Floats, int]:
    """Find the points within beams from a segment.

    Parameters
    ----------
    tree, targets
        The beams and the points.
    beams, max_hits
        Which beams, and the number of hits after which no further beam is taken.
    guard
        May end the search.

    Returns
    -------
    hits
        Points and beams; the weight is that of the point in its cell.
    seen
        (n, 4) the point as (x, h) in the edge's frame, and the interval of the edge visible from it
        [m].
    done
        How many of the beams were taken.
    """
    pair, weight, seen, done = hit_strip_arrays(tree, targets, beams, max_hits, guard)
    return Hits(pair, weight), seen, done


@jit()
def hit_strip_arrays(
    tree: StripTree, targets: Targets, beams: Ints, max_hits: int, guard: Guard
) -> tuple[Int32s, Floats, Floats, int]:
    """Arrays of `hit_from_strip`."""
    pair, weight = np.empty((1024, 2), np.int32), np.empty((1024, 1))
    seen, rows = np.empty((1024, 4)), np.empty((4, WIDTH))
    n = done = 0
    while done < len(beams) and n < max_hits and not is_stopped(guard):
        i = int(beams[done])
        cell, rays = tree.link[i, CELL], tree.rays[tree.first[i] : tree.first[i + 1]]
        begin, last = targets.cell_points[cell], targets.cell_points[cell + 1]
        needed = n + int(last - begin)
        if not may_hold(guard, needed, len(pair), HIT_BYTES + SEEN_BYTES):
            break
        while needed > len(pair):
            pair, weight, seen = enlarged(pair), enlarged(weight), enlarged(seen)
        done += 1
        for k in range(begin, last, WIDTH):
            x, h = in_frame(tree.frame[i], load(targets.x[k:]), load(targets.y[k:]))
            low, high = interval_through(rays, x, h)
            visible = (high - low > SLIVER_M) & (h > GRAZING_M)
            if not any_of(visible):
                continue
            low, high = where(visible, low, 0.0), where(visible, high, 0.0)
            for row, column in enumerate((x, h, low, high)):
                store(rows[row], column)
            for at in range(k, min(k + WIDTH, last)):
                if rows[2, at - k] == rows[3, at - k]:
                    continue
                pair[n, 0], pair[n, 1] = targets.number[at], i
                weight[n, 0] = targets.weight[at]
                for column in range(4):
                    seen[n, column] = rows[column, at - k]
                n += 1
    return resized(pair, n), resized(weight, n)[:, 0], resized(seen, n), done


@jit(inline=True)
def interval_through(rays: Floats, x: Lanes, h: Lanes) -> tuple[Lanes, Lanes]:
    """Smallest and largest u of the rays of a polygon through points; empty if low > high."""
    low, high = lanes_of(1e300), lanes_of(-1e300)
    last = len(rays) - 1
    before = h * rays[last, 1] + rays[last, 0] - x
    for j in range(last + 1):
        here = h * rays[j, 1] + rays[j, 0] - x
        left, right = (here >= 0.0) & (before < 0.0), (here < 0.0) & (before >= 0.0)
        t = before / (before - here)
        u = rays[j - 1, 0] + t * (rays[j, 0] - rays[j - 1, 0])
        low = where(left | right, minimum(low, u), low)
        high = where(left | right, maximum(high, u), high)
        before = here
    return low, high
