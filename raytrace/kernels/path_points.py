"""The points of single paths, in three dimensions."""

import math

import numpy as np
from numpy.typing import NDArray

from raytrace.kernels.beams import Hits, Tree
from raytrace.kernels.compiling import jit
from raytrace.kernels.field import EDGE_OF_STOREY
from raytrace.kernels.horizontal_edges import RIM_LOOKS, Rim, RimLegsIn, new_work, unfold_over_rim
from raytrace.kernels.lanes import lane, lanes_of
from raytrace.kernels.plan_view import Floats, PlanView, folded, material_at
from raytrace.kernels.strips import StripTree, from_frame
from raytrace.kernels.tracing import Record, Trace
from raytrace.kernels.unfolding import (
    DISTANCE,
    ITEM_X,
    ITEM_Y,
    KIND,
    LOOKS,
    PASS_PARTIAL,
    PASS_WALL,
    WHAT,
    Leg,
    most_items,
    new_leg,
    unfold,
)
from raytrace.kernels.vertical_edges import Edge, LegsIn

NOTHING, REFLECTION, DIFFRACTION, TRANSMISSION = 0, 1, 2, 3
"""Interactions, as in `Paths.interactions`."""


@jit()
def add_point(
    points: Floats, kinds: NDArray[np.int8], k: int, kind: int, at: tuple[float, float, float]
) -> int:
    """Append a point that is not the first one; return how many there are now."""
    points[k, 0], points[k, 1], points[k, 2] = at
    kinds[k - 1] = kind
    return k + 1


@jit()
def interaction(view: PlanView, mark: int, what: int, z: float) -> int:
    """What happens at an item met at height z."""
    if mark == PASS_WALL:
        return TRANSMISSION
    if mark == PASS_PARTIAL:
        return NOTHING if material_at(view, what, z) < 0 else TRANSMISSION
    return REFLECTION


@jit()
def add_leg(
    view: PlanView,
    whole: tuple[Leg, int, float],
    heights: tuple[float, float, float, float],
    end: tuple[float, float],
    points: Floats,
    kinds: NDArray[np.int8],
    k: int,
) -> int:
    """Append what a leg meets, walls, floor and ceiling in their order.

    Parameters
    ----------
    view
        The plan view.
    whole
        The leg (the first of eight), its number of items, its horizontal length [m].
    heights
        Unfolded height at its root [m], slope, height of the ceiling [m], and nudge [m] of the look
        at it.
    end
        Where it ends in the plan view [m]; `points[k - 1]` is where it begins.
    points, kinds, k
        Written to from k on.

    Returns
    -------
    int
        How many points there are now.
    """
    (leg, n, length), (z_root, slope, height, nudge) = whole, heights
    done, x, y = 0.0, points[k - 1, 0], points[k - 1, 1]
    rising = math.copysign(1.0, slope)
    storey = math.floor(z_root / height - rising * EDGE_OF_STOREY) + max(rising, 0.0)
    at_edge = EDGE_OF_STOREY * height / abs(slope) if slope != 0.0 else 0.0
    for item in range(n + 1):
        last = item == n
        distance = length if last else leg.items[item, DISTANCE, 0]
        to_x = end[0] if last else leg.items[item, ITEM_X, 0]
        to_y = end[1] if last else leg.items[item, ITEM_Y, 0]
        while slope != 0.0 and (storey * height - z_root) / slope < distance - at_edge:
            w = ((storey * height - z_root) / slope - done) / (distance - done)
            z = height if int(storey) & 1 else 0.0
            k = add_point(points, kinds, k, REFLECTION, (x + w * (to_x - x), y + w * (to_y - y), z))
            storey += rising
        if not last:
            z = folded(z_root + slope * distance, height)
            beside = folded(z_root + slope * distance + nudge, height)
            kind = interaction(view, leg.marks[item, KIND], leg.marks[item, WHAT], beside)
            if kind != NOTHING:
                k = add_point(points, kinds, k, kind, (to_x, to_y, z))
        done, x, y = distance, to_x, to_y
    return k


@jit()
def start_path(trace: Trace, points: Floats) -> int:
    """Write the source as the first point."""
    for k in range(3):
        points[0, k] = trace.source[k]
    return 1


@jit()
def finish_path(trace: Trace, r: int, points: Floats, k: int) -> None:
    """Write the receiver as the last point, and again behind it."""
    for end in range(k, len(points)):
        points[end, 0], points[end, 1] = trace.receivers[r, 0], trace.receivers[r, 1]
        points[end, 2] = trace.image_z[trace.level[r], 0]


@jit()
def unfold_one(
    view: PlanView, tree: Tree, i: int, target: tuple[float, float], leg: Leg
) -> tuple[int, float]:
    """Number of items and length of a leg (see `unfolding.unfold`)."""
    at = lanes_of(target[0]), lanes_of(target[1])
    n, length, _, _ = unfold(view, tree.link, tree.beam, i, at, leg)
    return n, lane(length, 0)


@jit()
def reflection_points(
    trace: Trace,
    tree: Tree,
    hits: Hits,
    record: Record,
    points: Floats,
    kinds: NDArray[np.int8],
) -> None:
    """Points (n, most, 3) and interactions (n, most - 2) of recorded reflection paths."""
    leg = new_leg(most_items(tree.link))
    z = trace.source[2]
    for path in range(record.used[0]):
        r, i = hits.pair[record.key[path, 0], 0], hits.pair[record.key[path, 0], 1]
        end = (trace.receivers[r, 0], trace.receivers[r, 1])
        n, length = unfold_one(trace.plan, tree, i, end, leg)
        slope = (trace.image_z[trace.level[r], record.key[path, 3]] - z) / length
        k = start_path(trace, points[path])
        heights = (z, slope, trace.radio.height, LOOKS[record.key[path, 4]])
        k = add_leg(trace.plan, (leg, n, length), heights, end, points[path], kinds[path], k)
        finish_path(trace, r, points[path], k)


@jit()
def upright_points(
    trace: Trace,
    edge: Edge,
    legs_in: LegsIn,
    tree: Tree,
    hits: Hits,
    record: Record,
    points: Floats,
    kinds: NDArray[np.int8],
) -> None:
    """Points and interactions of recorded paths over a vertical edge."""
    leg = new_leg(most_items(tree.link))
    z, height = trace.source[2], trace.radio.height
    for path in range(record.used[0]):
        hit, p = record.key[path, 0], record.key[path, 1]
        leg_in = Leg(legs_in.items[p], legs_in.marks[p])
        n_in, length_in = int(legs_in.n_items[p]), float(legs_in.length[p])
        r, i = hits.pair[hit, 0], hits.pair[hit, 1]
        end = (trace.receivers[r, 0], trace.receivers[r, 1])
        n, length = unfold_one(trace.plan, tree, i, end, leg)
        slope = (trace.image_z[trace.level[r], record.key[path, 3]] - z) / (length_in + length)
        z_edge = z + slope * length_in
        row, kind = points[path], kinds[path]
        k = start_path(trace, row)
        at, nudge = (edge.x, edge.y), LOOKS[record.key[path, 4]]
        heights = (z, slope, height, nudge)
        k = add_leg(trace.plan, (leg_in, n_in, length_in), heights, at, row, kind, k)
        k = add_point(row, kind, k, DIFFRACTION, (edge.x, edge.y, folded(z_edge, height)))
        heights = (z_edge, slope, height, nudge)
        k = add_leg(trace.plan, (leg, n, length), heights, end, row, kind, k)
        finish_path(trace, r, row, k)


@jit()
def level_points(
    trace: Trace,
    rim: Rim,
    source: tuple[Tree, RimLegsIn],
    strips: StripTree,
    lit: tuple[Hits, Floats],
    record: Record,
    points: Floats,
    kinds: NDArray[np.int8],
) -> None:
    """Points and interactions of recorded paths over a level edge."""
    tree, legs_in = source
    hits, seen = lit
    work = new_work(trace.max_order, tree, strips)
    height = trace.radio.height
    z_in, bounces = trace.source_z, trace.image_bounces
    for path in range(record.used[0]):
        hit, p = int(record.key[path, 0]), int(record.key[path, 1])
        a, b = int(record.key[path, 2]), int(record.key[path, 3])
        r, i = hits.pair[hit, 0], hits.pair[hit, 1]
        rise_in = float(rim.z - z_in[a])
        rise_out = float(trace.image_z[trace.level[r], b] - rim.z)
        in_, out = math.hypot(legs_in.h[p], rise_in), math.hypot(seen[hit, 1], rise_out)
        u = (legs_in.x[p] * out + seen[hit, 0] * in_) / (in_ + out)
        end = (trace.receivers[r, 0], trace.receivers[r, 1])
        (n_in, lengths_in, _, _), (n, lengths, _, _) = unfold_over_rim(
            trace, rim, lanes_of(u), (tree, strips), (legs_in.beam[p], i),
            (lanes_of(end[0]), lanes_of(end[1])), work,
        )  # fmt: skip
        length_in, length = lane(lengths_in, 0), lane(lengths, 0)
        at = from_frame(rim.frame, u)
        slope = (-rise_in if bounces[a] & 1 else rise_in) / length_in
        row, kind = points[path], kinds[path]
        k = start_path(trace, row)
        nudges = RIM_LOOKS[record.key[path, 4]]
        heights = (trace.source[2], slope, height, nudges[0])
        k = add_leg(trace.plan, (work.leg_in, n_in, length_in), heights, at, row, kind, k)
        k = add_point(row, kind, k, DIFFRACTION, (at[0], at[1], rim.z))
        heights = (rim.z, rise_out / length, height, nudges[1])
        k = add_leg(trace.plan, (work.room.leg, n, length), heights, end, row, kind, k)
        finish_path(trace, r, row, k)
