"""Upper bounds on the power of paths, before their field is computed."""

import math

from raytrace.kernels.building import TraceGeometry
from raytrace.kernels.compiling import jit
from raytrace.kernels.field_tables import FieldTables
from raytrace.kernels.lanes import (
    Lanes,
    absolute,
    floor,
    gather_pairs1,
    lanes_of,
    load,
    maximum,
    minimum,
    sqrt,
    where,
)
from raytrace.kernels.unfolding import NORMAL, REFLECT_WALL, SURFACE, TYPE, Leg

SHEET_POWER, SHEET_POWER_THROUGH_WALLS, WEDGE_POWER = 1.0, 2.25, 4.0
"""Largest power behind an edge over that of a free path as long: two terms of half its field; the
same where a sheet's shadow lacks at most twice the field, that of the air less the transmitted one;
four terms (see `wedge_bound`)."""


@jit(inline=True)
def free_space(tables: FieldTables, length: Lanes) -> Lanes:
    """Bound on the received fraction of the power over distances [m]."""
    spreading = (tables.wavelength / (4.0 * math.pi)) / length
    return spreading * spreading * tables.peak_gain


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
    rows, bound = tables.slab_rows, lanes_of(1.0)
    for k in range(n):
        if leg.types[k, TYPE] == REFLECT_WALL:
            at = absolute(load(leg.interactions[k, NORMAL])) * cosine * (rows - 2.0)
            row = floor(maximum(minimum(at, rows - 2.0), 0.0))
            row = row + leg.types[k, SURFACE] * float(rows)
            reflectance, _ = gather_pairs1(tables.max_reflectance, row)
            bound = bound * reflectance
    return bound


@jit(inner=True, fast=True)
def wedge_bound(
    geometry: TraceGeometry,
    tables: FieldTables,
    is_sheet: bool,
    cosines: tuple[Lanes, Lanes],
    sqrt_2kl: Lanes,
    total: Lanes,
    wall_reflections: int,
) -> Lanes:
    """Bounds on diffracted powers, without the reflections at walls.

    A term of a half plane has at most half the field of a free path as long, and at most
    1 / (2 sqrt(pi) s) of it, s the argument of its transition function; a wedge has four. The
    transmitted field in the shadow of a sheet at most doubles the first one.

    Parameters
    ----------
    geometry, tables, is_sheet
        The geometry of the trace, the antennas, and whether the wedge is a half plane.
    cosines
        Of half the angles to the two shadow boundaries.
    sqrt_2kl, total, wall_reflections
        See `vertical_edges.Pair`, and the number of reflections at walls.
    """
    if not is_sheet:
        return free_space(tables, total) * WEDGE_POWER
    rise = (geometry.max_reflections - wall_reflections + 1) * geometry.building.height
    cosine = total / sqrt(total * total + rise * rise)
    amplitude = lanes_of(0.0)
    through = 2.0 if len(tables.transmission) > 0 else 1.0
    for half in cosines:
        s = (2.0 * math.sqrt(math.pi)) * sqrt_2kl * sqrt(cosine) * absolute(half)
        amplitude = amplitude + where(s < 2.0, lanes_of(0.5), 1.0 / s) * through
        through = 1.0
    return amplitude * amplitude * free_space(tables, total)
