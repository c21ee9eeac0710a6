"""The least loss of beams from a horizontal edge, by the ways on which power arrives there."""

import math
from typing import NamedTuple

from raytrace.arrays import Floats
from raytrace.kernels.compiling import jit
from raytrace.kernels.horizontal_edge_bounds import distance_bin
from raytrace.kernels.losses import NEGLIGIBLE, ROUNDING, Limits, LossLimit, all_from


class Spread(NamedTuple):
    """Rays of a beam from a horizontal edge.

    Attributes
    ----------
    slopes
        Their least and largest slope, along the edge over away from it.
    starts
        The interval of the edge that they leave from [m].
    away
        How far off the edge, at right angles to it, they are at least [m].
    rays, n
        Corners (>= n, 2) of their polygon, see `strips.StripTree`, and how many.
    """

    slopes: tuple[float, float]
    starts: tuple[float, float]
    away: float
    rays: Floats
    n: int


@jit(inner=True)
def may_leave(loss: LossLimit, k: int, left: int, spread: Spread) -> bool:
    """Whether some rays that arrive on way k at a horizontal edge leave it within a beam.

    A ray from x, seen from the edge's line, that leaves at u with the slope m in the plan view has
    m = q (u - x): the cone of diffracted rays has the angle of the incident one with the edge. Here
    q is the secant of the elevation behind the edge, at right angles to it, over the distance of
    its source from the line.
    """
    x, low, high = loss.ways[k, 3], loss.ways[k, 4], loss.ways[k, 5]
    if low > spread.starts[1] + ROUNDING or high < spread.starts[0] - ROUNDING:
        return False
    rise, near = loss.rises[left], max(loss.across[k, left, 0], 1e-9)
    least = 1.0 / max(loss.across[k, left, 1], 1e-9)
    most = math.hypot(1.0, rise / max(spread.away, 1e-9)) / near
    if spread.slopes[1] < min(least * (low - x), most * (low - x)) - ROUNDING:
        return False
    if spread.slopes[0] > max(least * (high - x), most * (high - x)) + ROUNDING:
        return False
    above = below = False
    for c in range(spread.n):
        u, m = spread.rays[c, 0] - x, spread.rays[c, 1]
        above = above or m > min(least * u, most * u) - ROUNDING
        below = below or m < max(least * u, most * u) + ROUNDING
    return above and below


@jit(inner=True)
def has_strong_way(
    limits: Limits,
    order: int,
    entry: int,
    kept: tuple[float, float],
    spread: Spread,
    left_out: Floats,
) -> bool:
    """`is_strong` for a beam from a horizontal edge, by the ways to it whose direction fits.

    A diffracted ray makes the same angle with the edge as the arriving one.

    Parameters
    ----------
    limits, order, entry, left_out
        See `is_strong`.
    kept
        Its fraction and distance.
    spread
        Its rays.
    """
    loss, (fraction, distance) = limits.loss, kept
    if not loss.is_active:
        return True
    power, least = fraction * loss.power_at_1m, loss.least[entry]
    missing, k = 0.0, 0
    interval = distance_bin(spread.away)
    while k < len(loss.ways):
        reflections, length = loss.ways[k, 0], loss.ways[k, 1]
        left = int(loss.most_reflections - reflections - order)
        if left < 0:
            break
        rest, skips = all_from(loss, k, fraction, distance, least)
        if skips:
            missing += rest * loss.further[left]
            k = int(loss.ranks[k, 2])
            continue
        k += 1
        total, nearest = max(length + distance, 1e-9), max(length + spread.away, 1e-9)
        free = power * loss.ways[k - 1, 2] / (total * total)
        over = loss.over_edge[k - 1, left, interval] * nearest * nearest
        arriving = free * min(over, 1.0)
        if arriving >= NEGLIGIBLE * least and not may_leave(loss, k - 1, left, spread):
            continue
        missing += arriving * loss.further[left]
        if (arriving if loss.is_alone else missing) >= least:
            return True
    left_out[0] += missing
    return False
