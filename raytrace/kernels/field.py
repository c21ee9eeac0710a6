"""The field along a leg, propagated from wall to wall.

Floor and ceiling keep the polarisations V and H apart; a wall mixes them by its plan-view angles
alone (docs/theory.md, eqs. 10-13). Eight rays that meet the same walls are computed side by side.
"""

from typing import NamedTuple

from raytrace.kernels.building import Building
from raytrace.kernels.compiling import jit
from raytrace.kernels.field_tables import FieldTables, both_reflections, slab_lookup
from raytrace.kernels.lanes import (
    ComplexLanes,
    Lanes,
    absolute,
    any_of,
    complex_of,
    copysign,
    floor,
    lanes_of,
    load,
    maximum,
    minimum,
    sqrt,
    where,
    where_complex,
)
from raytrace.kernels.plan_view import in_building, slabs_at
from raytrace.kernels.unfolding import (
    DISTANCE,
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


@jit(inner=True, fast=True)
def transmit(
    building: Building,
    tables: FieldTables,
    leg: Leg,
    k: int,
    ray: Ray,
    heights: tuple[Lanes, float],
    wave: Wave,
) -> Wave:
    """Field behind the wall of interaction k (docs/theory.md, eqs. 28-30)."""
    slab = lanes_of(float(leg.types[k, SURFACE]))
    z_root, offset = heights
    z = z_root + ray.slope * load(leg.interactions[k, DISTANCE])
    if leg.types[k, TYPE] == PASS_PARTIAL:
        beside = in_building(z + offset, building.height)
        slab = slabs_at(building.plan, leg.types[k, SURFACE], beside)
    solid = slab >= 0.0
    if not any_of(solid):
        return wave
    wave = apply_bounces(ray, z / building.height, wave)
    normal = load(leg.interactions[k, NORMAL])
    cosine = absolute(normal) * ray.cos_elevation
    tm, mix = slab_lookup(tables.transmission, tables.slab_rows, maximum(slab, 0.0), cosine)
    a, b = load(leg.interactions[k, SKEW]), -normal * wave.sin_elevation
    t = (wave.v * a + wave.h * b) * mix
    return Wave(
        where_complex(solid, tm * wave.v + t * a, wave.v),
        where_complex(solid, tm * wave.h + t * b, wave.h),
        wave.sin_elevation,
        wave.bounce_count,
    )


@jit(inline=True, fast=True)
def propagate(
    building: Building,
    tables: FieldTables,
    leg: Leg,
    n: int,
    length: Lanes,
    ray: Ray,
    heights: tuple[Lanes, float],
    wave: Wave,
) -> Wave:
    """Propagate a field along legs.

    Parameters
    ----------
    building, tables
        The building, and its materials.
    leg, n, length
        The legs, their number of interactions and their horizontal lengths [m].
    ray, heights
        Their slopes; the unfolded heights at their roots, and the offset of the heights at which
        partial walls are looked up [m].
    wave
        The field at the root; the one at the end is returned.
    """
    (z_root, offset), inv_height = heights, 1.0 / building.height
    for k in range(n):
        kind = leg.types[k, TYPE]
        if kind >= PASS_PARTIAL:
            if len(tables.transmission) > 0:
                wave = transmit(building, tables, leg, k, ray, heights, wave)
            continue
        z = z_root + ray.slope * load(leg.interactions[k, DISTANCE])
        wave = apply_bounces(ray, z * inv_height, wave)
        slab = lanes_of(float(leg.types[k, SURFACE]))
        if kind == REFLECT_PARTIAL:
            z = in_building(z + offset, building.height)
            slab = maximum(slabs_at(building.plan, leg.types[k, SURFACE], z), 0.0)
        normal = load(leg.interactions[k, NORMAL])
        cosine = absolute(normal) * ray.cos_elevation
        tm, mix = slab_lookup(tables.reflection, tables.slab_rows, slab, cosine)
        a, b = load(leg.interactions[k, SKEW]), -normal * wave.sin_elevation
        t = (wave.v * a + wave.h * b) * mix
        wave = Wave(t * a - tm * wave.v, tm * wave.h - t * b, wave.sin_elevation, wave.bounce_count)
    return apply_bounces(ray, (z_root + ray.slope * length) * inv_height, wave)
