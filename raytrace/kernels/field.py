"""The field along a leg, propagated from wall to wall.

Floor and ceiling keep the polarisations V and H apart; a wall mixes them by its plan-view angles
alone (docs/theory.md, eqs. 10-13). Eight rays that meet the same walls are computed side by side.
"""

from typing import NamedTuple

from raytrace.arrays import Floats
from raytrace.kernels.building import Building
from raytrace.kernels.compiling import jit
from raytrace.kernels.field_tables import FieldTables, both_reflections, slab_lookup
from raytrace.kernels.lanes import (
    ComplexLanes,
    Lanes,
    absolute,
    all_false,
    any_of,
    complex_of,
    copysign,
    floor,
    imag_of,
    lanes_of,
    load,
    maximum,
    minimum,
    real_of,
    sqrt,
    store,
    where,
    where_complex,
)
from raytrace.kernels.plan_view import in_building, slabs_at
from raytrace.kernels.unfolding import (
    DISTANCE,
    FIRST,
    NORMAL,
    PASS_PARTIAL,
    REFLECT_PARTIAL,
    SKEW,
    SURFACE,
    TYPE,
    Leg,
)
from raytrace.kernels.waves import Wave


class Ray(NamedTuple):
    """The heights of eight unfolded legs with equally many reflections at floor and ceiling.

    Attributes
    ----------
    slope
        Growth of the unfolded height over horizontal distance.
    sec_elevation
        Length over horizontal distance.
    cos_elevation, sin_elevation
        Of the elevation at the root.
    bounces
        Reflections at floor and ceiling.
    floor_tm, floor_te, ceiling_tm, ceiling_te
        Their coefficients.
    """

    slope: Lanes
    sec_elevation: Lanes
    cos_elevation: Lanes
    sin_elevation: Lanes
    bounces: int
    floor_tm: ComplexLanes
    floor_te: ComplexLanes
    ceiling_tm: ComplexLanes
    ceiling_te: ComplexLanes


@jit(inline=True, fast=True)
def new_ray(building: Building, tables: FieldTables, slope: Lanes, bounces: int) -> Ray:
    """Rays of given slopes; floor and ceiling are looked up only if they meet them."""
    secant = sqrt(1.0 + slope * slope)
    cosine = 1.0 / secant
    sine = slope * cosine
    floor_tm = floor_te = complex_of(lanes_of(0.0), 0.0)
    ceiling_tm, ceiling_te = floor_tm, floor_te
    if bounces > 0:
        floor_tm, floor_te = both_reflections(tables, building.floor, absolute(sine))
        ceiling_tm, ceiling_te = floor_tm, floor_te
        if building.ceiling != building.floor:
            ceiling_tm, ceiling_te = both_reflections(tables, building.ceiling, absolute(sine))
    return Ray(slope, secant, cosine, sine, bounces, floor_tm, floor_te, ceiling_tm, ceiling_te)


STOREY_TOLERANCE = 1e-9
"""A wall met this near to floor or ceiling is met before them [storeys]."""


@jit(inline=True, fast=True)
def apply_bounces(ray: Ray, storeys: Lanes, wave: Wave) -> Wave:
    """Apply the floor and ceiling reflections up to unfolded heights in storeys."""
    if ray.bounces == 0:
        return wave
    v, h, sine, count = wave
    due = absolute(floor(storeys - copysign(lanes_of(STOREY_TOLERANCE), ray.slope)))
    # an invalid ray beside seven valid ones may have been unfolded to anywhere
    due = minimum(due, float(ray.bounces))
    late = count < due
    while any_of(late):
        upwards = sine > 0.0
        tm = where_complex(upwards, ray.ceiling_tm, ray.floor_tm)
        te = where_complex(upwards, ray.ceiling_te, ray.floor_te)
        v = where_complex(late, v * tm, v)
        h = where_complex(late, h * te, h)
        sine = where(late, -sine, sine)
        count = where(late, count + 1.0, count)
        late = count < due
    return Wave(v, h, sine, count)


@jit(inline=True, fast=True)
def wall_coefficients(
    table: Floats, rows: int, leg: Leg, k: int, cos_elevation: Lanes, seen: Floats
) -> tuple[ComplexLanes, ComplexLanes]:
    """`field_tables.slab_lookup` for the wall of interaction k, once for all that are alike.

    `seen` is scratch that holds what was looked up for earlier interactions of the leg.
    """
    first = leg.types[k, FIRST]
    row = seen[first]
    if first < k:
        return complex_of(load(row[0]), load(row[1])), complex_of(load(row[2]), load(row[3]))
    cosine = absolute(load(leg.interactions[k, NORMAL])) * cos_elevation
    slab = lanes_of(float(leg.types[k, SURFACE]))
    tm, mix = slab_lookup(table, rows, slab, cosine)
    store(row[0], real_of(tm))
    store(row[1], imag_of(tm))
    store(row[2], real_of(mix))
    store(row[3], imag_of(mix))
    return tm, mix


@jit(inline=True, fast=True)
def propagate(
    building: Building,
    tables: FieldTables,
    leg: Leg,
    n: int,
    length: Lanes,
    ray: Ray,
    heights: tuple[Lanes, float],
    seen: Floats,
    wave: Wave,
) -> Wave:
    """Propagate a field along legs (docs/theory.md, eqs. 10-13 and 28-30).

    Parameters
    ----------
    building, tables
        The building, and its materials.
    leg, n, length
        The legs, their number of interactions and their horizontal lengths [m].
    ray, heights
        Their slopes; the unfolded heights at their roots, and the offset of the heights at which
        partial walls are looked up [m].
    seen
        (>= n, 4, 8) scratch for coefficients of walls.
    wave
        The field at the root; the one at the end is returned.
    """
    (z_root, offset), inv_height = heights, 1.0 / building.height
    for k in range(n):
        kind = leg.types[k, TYPE]
        passes = kind >= PASS_PARTIAL
        table = tables.transmission if passes else tables.reflection
        if len(table) == 0:
            continue
        z = z_root + ray.slope * load(leg.interactions[k, DISTANCE])
        normal, solid = load(leg.interactions[k, NORMAL]), all_false()
        if kind in (PASS_PARTIAL, REFLECT_PARTIAL):
            beside = in_building(z + offset, building.height)
            slab = slabs_at(building.plan, leg.types[k, SURFACE], beside)
            solid = slab >= 0.0
            if passes and not any_of(solid):
                continue
            cosine = absolute(normal) * ray.cos_elevation
            tm, mix = slab_lookup(table, tables.slab_rows, maximum(slab, 0.0), cosine)
        else:
            tm, mix = wall_coefficients(table, tables.slab_rows, leg, k, ray.cos_elevation, seen)
        wave = apply_bounces(ray, z * inv_height, wave)
        a, b = load(leg.interactions[k, SKEW]), -normal * wave.sin_elevation
        t = (wave.v * a + wave.h * b) * mix
        if passes:
            v, h = tm * wave.v + t * a, tm * wave.h + t * b
            if kind == PASS_PARTIAL:
                v, h = where_complex(solid, v, wave.v), where_complex(solid, h, wave.h)
        else:
            v, h = t * a - tm * wave.v, tm * wave.h - t * b
        wave = Wave(v, h, wave.sin_elevation, wave.bounce_count)
    return apply_bounces(ray, (z_root + ray.slope * length) * inv_height, wave)
