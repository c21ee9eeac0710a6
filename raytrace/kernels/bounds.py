"""Upper bounds on the power of paths, before their field is computed."""

import math

import numpy as np

from raytrace.arrays import Floats
from raytrace.kernels.building import Building, TraceGeometry
from raytrace.kernels.compiling import jit
from raytrace.kernels.field_tables import FieldTables
from raytrace.kernels.lanes import (
    Lanes,
    absolute,
    any_of,
    floor,
    gather_pairs1,
    lanes_of,
    load,
    maximum,
    minimum,
    sqrt,
    where,
)
from raytrace.kernels.losses import NEGLIGIBLE
from raytrace.kernels.unfolding import NORMAL, REFLECT_WALL, SURFACE, TYPE, Leg
from raytrace.kernels.utd import wedge_cotangents
from raytrace.kernels.wedge import FaceAngles, Wedge

SHEET_POWER, SHEET_POWER_THROUGH_WALLS, WEDGE_POWER = 1.0, 2.25, 4.0
"""Largest power behind an edge over that of a free path as long: two terms of half its field; the
same where a sheet's shadow lacks at most twice the field, that of the air less the transmitted one;
four terms (see `wedge_bound`)."""


@jit(inline=True)
def at_one_metre(tables: FieldTables) -> float:
    """Bound on the received fraction of the power over 1 m."""
    return (tables.wavelength / (4.0 * math.pi)) ** 2 * tables.peak_gain


@jit(inline=True)
def free_space(tables: FieldTables, length: Lanes) -> Lanes:
    """Bound on the received fraction of the power over distances [m]."""
    spreading = (tables.wavelength / (4.0 * math.pi)) / length
    return spreading * spreading * tables.peak_gain


@jit(inline=True, fast=True)
def largest_reflectance(tables: FieldTables, slab: int, cosine: Lanes) -> Lanes:
    """Largest fraction of the power that a slab reflects at a cosine of incidence or above."""
    rows = tables.slab_rows
    row = floor(maximum(minimum(cosine * (rows - 2.0), rows - 2.0), 0.0))
    found, _ = gather_pairs1(tables.max_reflectance, row + slab * float(rows))
    return found


@jit(inner=True, fast=True)
def leg_bound(
    geometry: TraceGeometry,
    tables: FieldTables,
    leg: Leg,
    n: int,
    length: Lanes,
    wall_reflections: int,
) -> Lanes:
    """Bound on the fraction of the power that the walls on legs reflect.

    Parameters
    ----------
    geometry, tables
        The geometry of the trace, and the materials.
    leg, n, length
        The legs, their interactions, their horizontal lengths [m].
    wall_reflections
        Their number; the remaining reflections at floor and ceiling bound the slopes.
    """
    rise = (geometry.max_reflections - wall_reflections + 1) * geometry.building.height
    cosine = length / sqrt(length * length + rise * rise)
    bound = lanes_of(1.0)
    for k in range(n):
        if leg.types[k, TYPE] == REFLECT_WALL:
            at = absolute(load(leg.interactions[k, NORMAL])) * cosine
            bound = bound * largest_reflectance(tables, leg.types[k, SURFACE], at)
    return bound


@jit(inline=True, fast=True)
def bounce_bound(
    building: Building, tables: FieldTables, sin_elevation: Lanes, bounces: int
) -> Lanes:
    """Bound on the fraction of the power that floor and ceiling reflect."""
    at_floor = largest_reflectance(tables, building.floor, sin_elevation)
    at_ceiling = largest_reflectance(tables, building.ceiling, sin_elevation)
    once, bound = maximum(at_floor, at_ceiling), lanes_of(1.0)
    for _ in range(bounces):
        bound = bound * once
    return bound


@jit(inline=True, fast=True)
def image_bound(building: Building, tables: FieldTables, slope: Lanes, bounces: int) -> Lanes:
    """Power over an image height, over the bound of a horizontal path."""
    cos_squared = 1.0 / (1.0 + slope * slope)
    sine = absolute(slope) * sqrt(cos_squared)
    return cos_squared * bounce_bound(building, tables, sine, bounces)


@jit(inline=True, fast=True)
def all_from(
    ranks: Floats, k: int, kept: Lanes, distance: Lanes, least: Lanes
) -> tuple[Lanes, bool]:
    """Bound on the power by way k and all weaker ones of as many reflections to an edge.

    Parameters
    ----------
    ranks, k
        See `losses.LossLimit`.
    kept
        Largest fraction of the power at 1 m in free space that is kept otherwise.
    distance, least
        Behind the edge [m], and the power thresholds.

    Returns
    -------
    power, is_negligible
        The bound, and whether each of the ways is far below the threshold everywhere.
    """
    longest = ranks[k, 3]
    nearer = longest / (distance + longest)
    power = kept * nearer * nearer
    return power * ranks[k, 1], not any_of(power * ranks[k, 0] >= least * NEGLIGIBLE)


LENGTHS = 64
"""Intervals of horizontal lengths in `height_sums`."""


def height_sums(geometry: TraceGeometry, tables: FieldTables) -> Floats:
    """Power of all image heights together over the bound of a horizontal path.

    Returns
    -------
    ndarray
        (max_reflections + 1, LENGTHS + 1) by the reflections left and the horizontal length l, in
        equal intervals of l / (l + height of the ceiling); the last column is for any length.
    """
    building, order = geometry.building, geometry.max_reflections
    at = np.minimum(np.arange(1, LENGTHS + 2) / LENGTHS, 1.0 - 1e-12)
    length = building.height * at / (1.0 - at)
    rises = np.abs(geometry.receivers.image_z - geometry.transmitter[2]).min(axis=0, initial=np.inf)
    rises = np.where(np.isfinite(rises), rises, 0.0)
    reflectance = tables.max_reflectance.reshape(-1, tables.slab_rows)
    surfaces = reflectance[[building.floor, building.ceiling]].max(axis=0)
    found = np.zeros((order + 1, LENGTHS + 1))
    for rise, bounces in zip(rises, geometry.image_bounces, strict=True):
        sine = rise / np.hypot(rise, length)
        once = surfaces[(sine * (tables.slab_rows - 2)).astype(np.int64)]
        found[bounces:] += (1.0 - sine**2) * once**bounces
    return found


@jit(inline=True, fast=True)
def all_heights(heights: Floats, left: int, length: Lanes, height: float) -> Lanes:
    """Look up `height_sums`."""
    at = floor(length * (float(LENGTHS) / (length + height)))
    found, _ = gather_pairs1(heights[left], minimum(at, LENGTHS - 1.0))
    return found


@jit(inline=True, fast=True)
def largest_term(size: Lanes, low: Lanes, high: Lanes) -> Lanes:
    """Bound on a term of the diffraction coefficient between two angles, by their cotangents."""
    largest = minimum(size * maximum(absolute(low), absolute(high)), lanes_of(0.5))
    return where(high > low, 0.5, largest)  # a pole lies between: cotangents fall elsewhere


@jit(inline=True)
def least_magnitude(one: Lanes, other: Lanes) -> Lanes:
    """Least magnitude between two numbers."""
    return where(one * other > 0.0, minimum(absolute(one), absolute(other)), 0.0)


@jit(inner=True, fast=True)
def wedge_bound(
    tables: FieldTables,
    wedge: Wedge,
    directions: tuple[FaceAngles, FaceAngles, FaceAngles],
    shadow: Floats,
    sqrt_2kl: Lanes,
    sin_beta: Lanes,
) -> Lanes:
    """Bound on the power behind an edge over that of a free path as long.

    Terms of the diffraction coefficient have at most half the field of a free path, and at most
    that for a transition function of 1 (docs/theory.md, eq. 47).

    Parameters
    ----------
    tables, wedge
        The materials, and the wedge.
    directions
        Behind the edge those of the least and of the largest angle, whose roots are the least
        ones, and before it.
    shadow
        (COSINE_BINS + 1,) largest |1 - T'|^2 of a sheet at a cosine of incidence or above.
    sqrt_2kl, sin_beta
        sqrt(2 k L) / sqrt(sin beta), and least sine of the angle between rays and edge.
    """
    low, high, incident = directions
    size = (1.0 / (2.0 * wedge.n * math.sqrt(math.pi))) / (sqrt_2kl * sqrt(sin_beta))
    o_cosine = low.root_o * incident.root_o * sin_beta
    o_face = sqrt(largest_reflectance(tables, wedge.o_slab, o_cosine))
    if wedge.is_sheet:
        gh, fh = incident.cos_half, incident.sin_half
        one = low.cos_half * gh, low.sin_half * fh
        other = high.cos_half * gh, high.sin_half * fh
        row = floor(minimum(o_cosine * float(len(shadow) - 1), len(shadow) - 2.0))
        through, _ = gather_pairs1(shadow, row)
        at_shadow = least_magnitude(one[0] + one[1], other[0] + other[1])
        at_reflection = least_magnitude(one[0] - one[1], other[0] - other[1])
        shadowed = minimum(2.0 * size / at_shadow, lanes_of(0.5))
        reflected = minimum(2.0 * size / at_reflection, lanes_of(0.5))
        amplitude = sqrt(through) * shadowed + o_face * reflected
        return amplitude * amplitude
    n_cosine = low.root_n * incident.root_n * sin_beta
    n_face = sqrt(largest_reflectance(tables, wedge.n_slab, n_cosine))
    one, other = wedge_cotangents(wedge, low, incident), wedge_cotangents(wedge, high, incident)
    amplitude = largest_term(size, one[0], other[0]) + largest_term(size, other[1], one[1])
    amplitude = amplitude + n_face * largest_term(size, one[2], other[2])
    amplitude = amplitude + o_face * largest_term(size, other[3], one[3])
    return amplitude * amplitude
