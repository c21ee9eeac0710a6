"""Points that are visible from a horizontal edge: those within the beams of a strip tree."""

import numpy as np

from raytrace.arrays import Floats, Int32s, Ints
from raytrace.kernels.beam_hits import HIT_BYTES, Hits, Targets
from raytrace.kernels.beams import CELL
from raytrace.kernels.compiling import jit
from raytrace.kernels.edge_rays import SLIVER_M, in_frame
from raytrace.kernels.guard import Guard, is_stopped, may_hold
from raytrace.kernels.lanes import (
    WIDTH,
    Lanes,
    any_of,
    lanes_of,
    load,
    maximum,
    minimum,
    store,
    where,
)
from raytrace.kernels.plan_view import GRAZING_M
from raytrace.kernels.rows import enlarged, resized
from raytrace.kernels.strips import StripTree

SEEN_BYTES = 4 * 8
"""Size of a row of `seen` (`hit_from_strip`)."""


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
