"""The least loss of beams from a horizontal edge, by the ways on which power arrives there.

Behind an edge the field is strong near two shadow boundaries only. A plan view tells no heights,
but there are few: those of the images of both ends in floor and ceiling. So each way to the edge
has a bound by the distance behind it, the largest of all pairs of heights (docs/theory.md,
section 16).
"""

import math
from typing import NamedTuple

import numpy as np

from raytrace.arrays import Floats, Ints
from raytrace.kernels.compiling import jit
from raytrace.kernels.lanes import Lanes, floor, minimum

DISTANCES = 16
"""Intervals of the distance behind an edge."""

MIDDLE_M = 4.0
"""Half of the intervals are nearer than this [m]."""

ROUNDING = 1e-6
"""Intervals of cosines are widened by this fraction of one."""


class EdgeHeights(NamedTuple):
    """Heights of paths over a horizontal edge, and what these meet.

    Attributes
    ----------
    bounces
        (n,) reflections at floor and ceiling of each image of a height.
    before
        (n,) images of the transmitter above the edge [m].
    low, high
        (n,) lowest and highest images of receivers above the edge [m].
    surfaces
        (COSINE_BINS,) largest fraction of the power that floor or ceiling reflects, at a cosine of
        incidence in an interval or above.
    face, shadow
        (COSINE_BINS,) largest reflection coefficient of the wall, and largest |1 - T'| of its
        shadow, the same way.
    wavelength
        [m]
    most
        Largest power behind the edge over that of a free path as long.
    """

    bounces: Ints
    before: Floats
    low: Floats
    high: Floats
    surfaces: Floats
    face: Floats
    shadow: Floats
    wavelength: float
    most: float


@jit(inline=True)
def distance_bin(distance: float) -> int:
    """Interval that a distance behind an edge [m] lies in."""
    return min(int(DISTANCES * distance / (distance + MIDDLE_M)), DISTANCES - 1)


@jit(inline=True, fast=True)
def distance_bins(distance: Lanes) -> Lanes:
    """`distance_bin` of eight distances."""
    return floor(minimum(distance * (DISTANCES / (distance + MIDDLE_M)), DISTANCES - 1.0))


@jit(inline=True)
def start_of_bin(k: int) -> float:
    """Where an interval begins [m]; infinite behind the last."""
    return MIDDLE_M * k / (DISTANCES - k) if k < DISTANCES else math.inf


@jit(inline=True)
def at_cosine(table: Floats, cosine: float) -> float:
    """Look up the largest value at a cosine or above."""
    return table[min(max(int(cosine * len(table) - ROUNDING), 0), len(table) - 1)]


@jit(inline=True)
def half_angle(rise: float, distance: float) -> tuple[float, float]:
    """Cosine and sine of half an elevation."""
    half = 0.5 * math.atan2(rise, distance) if distance < math.inf else 0.0
    return math.cos(half), math.sin(half)


COS_LOW, SIN_LOW, COS_HIGH, SIN_HIGH, CLOSENESS, STEEP, SINE = range(7)
"""What is known of rays behind an edge in an interval of distances: cosine and sine of half the
least and of half the largest elevation; the largest inverse length [1/m]; the least root of the
cosine and the least sine of the elevation."""


@jit(inner=True)
def write_rays_behind(heights: EdgeHeights, rays: Floats) -> None:
    """Set rays (n, DISTANCES, 7) behind an edge, by image and interval."""
    for b in range(len(heights.bounces)):
        low, high = heights.low[b], heights.high[b]
        least, largest = max(low, -high, 0.0), max(abs(low), abs(high))
        for k in range(DISTANCES):
            near, far, ray = start_of_bin(k), start_of_bin(k + 1), rays[b, k]
            ray[COS_LOW], ray[SIN_LOW] = half_angle(low, near if low < 0.0 else far)
            ray[COS_HIGH], ray[SIN_HIGH] = half_angle(high, near if high > 0.0 else far)
            ray[CLOSENESS] = 1.0 / max(math.hypot(near, least), 1e-9)
            ray[STEEP] = math.sqrt(near / max(math.hypot(near, largest), 1e-9))
            ray[SINE] = least / math.hypot(far, least) if far < math.inf else 0.0


@jit(inline=True)
def least_sine(before: tuple[float, float], ray: Floats) -> float:
    """Least |sin| of half the sum of two elevations: 0 for a ray that goes straight on."""
    low = ray[SIN_LOW] * before[0] + ray[COS_LOW] * before[1]
    high = ray[SIN_HIGH] * before[0] + ray[COS_HIGH] * before[1]
    return min(abs(low), abs(high)) if low * high > 0.0 else 0.0


@jit(inline=True)
def least_cosine(before: tuple[float, float], ray: Floats) -> float:
    """Least cosine of half the difference of two elevations."""
    low = ray[COS_LOW] * before[0] + ray[SIN_LOW] * before[1]
    high = ray[COS_HIGH] * before[0] + ray[SIN_HIGH] * before[1]
    return max(min(low, high), 0.0)


@jit(inline=True)
def surfaces_keep(heights: EdgeHeights, sine: float, bounces: int) -> float:
    """Largest fraction of the power after some reflections at floor and ceiling."""
    once, kept = at_cosine(heights.surfaces, sine), 1.0
    for _ in range(bounces):
        kept *= once
    return kept


@jit(inline=True)
def largest_power(
    heights: EdgeHeights,
    is_across: bool,
    before: tuple[tuple[float, float], float, float],
    ray: Floats,
    sin_beta: float,
) -> float:
    """Largest power behind an edge over that of a free path as long (docs/theory.md, eq. 47).

    Parameters
    ----------
    heights
        Heights of paths, and what these meet.
    is_across
        Whether the rays go to the other side of the wall.
    before, ray
        Half the elevation before the edge, the inverse of that length [1/m], and the root of the
        cosine of the elevation; and the same behind it.
    sin_beta
        Least sine of the angle between rays and edge, more than 0.
    """
    half, closeness, steep = before
    size = math.sqrt(heights.wavelength * (closeness + ray[CLOSENESS]) / sin_beta) / (4.0 * math.pi)
    cosine = sin_beta * steep * ray[STEEP]
    face, shadow = at_cosine(heights.face, cosine), at_cosine(heights.shadow, cosine)
    straight, back = (shadow, face) if is_across else (face, shadow)
    amplitude = straight * min(size / max(least_sine(half, ray), 1e-9), 0.5)
    amplitude += back * min(size / max(least_cosine(half, ray), 1e-9), 0.5)
    return amplitude * amplitude


def bounds_over_edge(
    heights: EdgeHeights, left: Ints, h: Floats, length: Floats, sin_beta: Floats
) -> Floats:
    """Bound the power at some distance behind a horizontal edge, and at any larger one.

    Parameters
    ----------
    heights
        Heights of paths, and what these meet.
    left
        (n,) reflections left behind n ways to the edge.
    h
        (n,) distances of the transmitter's images from the edge [m], negative on the other side
        than the receivers.
    length
        (n,) shortest horizontal lengths of the ways to the edge [m].
    sin_beta
        (n,) least sines of the angle between rays and edge.

    Returns
    -------
    ndarray
        (n, max_reflections + 1, DISTANCES + 1) by the reflections at floor and ceiling, as many as
        are left or fewer, and by the interval of the distance, of which the last is not used: the
        power, as a fraction of `EdgeHeights.most`, over the squared length of the path [1/m^2].
    """
    n_images = len(heights.bounces)
    found = np.zeros((len(h), int(heights.bounces[-1]) + 1, DISTANCES + 1))
    scratch = np.empty((n_images, DISTANCES, 7)), np.empty((n_images, DISTANCES))
    write_bounds_over_edge(heights, left, h, length, np.maximum(sin_beta, 1e-6), scratch, found)
    return found


@jit()
def write_bounds_over_edge(
    heights: EdgeHeights,
    left: Ints,
    h: Floats,
    length: Floats,
    sin_beta: Floats,
    scratch: tuple[Floats, Floats],
    found: Floats,
) -> None:
    """Set `found` as in `bounds_over_edge`; `scratch` is for rays behind it, and what they keep."""
    rays, kept = scratch
    write_rays_behind(heights, rays)
    for p in range(len(h)):
        for k in range(DISTANCES):
            total = max(length[p] + start_of_bin(k), 1e-9)
            for b in range(2 * left[p] + 1):
                sine = sin_beta[p] * rays[b, k, SINE]
                kept[b, k] = surfaces_keep(heights, sine, heights.bounces[b])
                kept[b, k] /= heights.most * total * total
        write_pairs(heights, h[p], sin_beta[p], (rays, kept), found[p, : left[p] + 1])
        for bounces in range(left[p] + 1):
            for k in range(DISTANCES - 1, -1, -1):
                if k + 1 < DISTANCES:
                    found[p, bounces, k] = max(found[p, bounces, k], found[p, bounces, k + 1])
                if bounces > 0:
                    found[p, bounces, k] = max(found[p, bounces, k], found[p, bounces - 1, k])


@jit(inner=True)
def write_pairs(
    heights: EdgeHeights,
    h: float,
    sin_beta: float,
    behind: tuple[Floats, Floats],
    found: Floats,
) -> None:
    """Set the bounds of one way (max_reflections + 1, DISTANCES + 1) by reflections of a pair."""
    (rays, kept), n_images = behind, 2 * len(found) - 1
    for a in range(n_images):
        rise = heights.before[a]
        across = max(math.hypot(h, rise), 1e-9)
        before = half_angle(rise, abs(h)), 1.0 / across, math.sqrt(abs(h) / across)
        power = surfaces_keep(heights, sin_beta * abs(rise) / across, heights.bounces[a])
        for b in range(n_images):
            bounces = heights.bounces[a] + heights.bounces[b]
            if bounces >= len(found):
                break
            for k in range(DISTANCES):
                here = largest_power(heights, h < 0.0, before, rays[b, k], sin_beta)
                found[bounces, k] = max(found[bounces, k], here * power * kept[b, k])
