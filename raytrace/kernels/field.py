"""The field along a leg: two polarisations, carried from wall to wall.

A ray of direction (u_x cos_el, u_y cos_el, sin_el) has the polarisations `upright`, along
tau = (z - (z . s) s) / cos_el, and `level`, along psi = z x s / cos_el. Floor and ceiling leave
them apart; a wall mixes them by its plan-view angles alone (docs/theory.md, eqs. 10-13). Eight
rays that meet the same walls are carried side by side.
"""

import math
from typing import NamedTuple

from raytrace.kernels.compiling import jit
from raytrace.kernels.lanes import (
    ComplexLanes,
    Lanes,
    absolute,
    any_of,
    complex_of,
    copysign,
    floor,
    gather2,
    gather_pairs1,
    gather_pairs4,
    lanes_of,
    load,
    maximum,
    minimum,
    sqrt,
    where,
    where_complex,
)
from raytrace.kernels.plan_view import Floats, PlanView
from raytrace.kernels.unfolding import (
    DISTANCE,
    KIND,
    NORMAL,
    PASS_PARTIAL,
    REFLECT_PARTIAL,
    SKEW,
    WHAT,
    Leg,
    in_building,
    materials_at,
)


class Radio(NamedTuple):
    """Everything of a trace that is not plan view.

    Attributes
    ----------
    wavelength
        [m]
    height
        Of the ceiling [m].
    floor, ceiling
        Their slabs.
    slab_rows
        Rows of a slab in the tables that follow: steps of the cosine of incidence, and 2.
    slabs
        (n_slabs * slab_rows, 4) see `raytrace.radio.materials.slab_tables`.
    through
        (n_slabs * slab_rows, 4) see `raytrace.radio.materials.transmission_tables`; empty where
        paths go through no wall.
    highest
        (n_slabs * slab_rows,) largest reflected share of the power at a cosine of incidence or
        above.
    peak
        Largest power gain of both antennas together.
    transition
        (steps + 2, 2) F(s^2) / s of the UTD transition function, see `raytrace.kernels.utd`.
    cis
        (steps + 1, 2) cosine and sine of a turn.
    transmit, receive
        (steps + 2,) antenna amplitudes over the direction's z component from -1 to 1, where both
        are the same all around and polarised upright.
    patterns
        (n_elevations * n_azimuths, 4) of transmitter and receiver else: real and imaginary parts,
        upright and level, row by row of an elevation (see
        `raytrace.radio.antennas.antenna_tables`); of no row where the above do.
    azimuths
        How many azimuths patterns have.
    """

    wavelength: float
    height: float
    floor: int
    ceiling: int
    slab_rows: int
    slabs: Floats
    through: Floats
    highest: Floats
    peak: float
    transition: Floats
    cis: Floats
    transmit: Floats
    receive: Floats
    patterns: tuple[Floats, Floats]
    azimuths: int


class Ray(NamedTuple):
    """The heights of eight unfolded legs with as many bounces at floor and ceiling.

    Attributes
    ----------
    slope
        Growth of the unfolded height over horizontal distance.
    stretch
        Length over horizontal distance.
    cos_el, sin_el
        Of the elevation at the root.
    bounces
        Reflections at floor and ceiling.
    floor_tm, floor_te, ceiling_tm, ceiling_te
        Their coefficients.
    """

    slope: Lanes
    stretch: Lanes
    cos_el: Lanes
    sin_el: Lanes
    bounces: int
    floor_tm: ComplexLanes
    floor_te: ComplexLanes
    ceiling_tm: ComplexLanes
    ceiling_te: ComplexLanes


class Wave(NamedTuple):
    """What travels along eight rays.

    Attributes
    ----------
    upright, level
        The field's polarisations.
    rising
        Sine of the elevation; it changes its sign at every bounce.
    done
        Number of bounces at floor and ceiling so far.
    """

    upright: ComplexLanes
    level: ComplexLanes
    rising: Lanes
    done: Lanes


@jit(inline=True)
def steps_into(t: Lanes, steps: int) -> tuple[Lanes, Lanes]:
    """Row and the rest of positions in a table of so many steps and a row more at its end."""
    t = maximum(minimum(t, float(steps)), 0.0)
    row = floor(t)
    return row, t - row


@jit(inline=True, fast=True)
def row_between(table: Floats, row: Lanes, w: Lanes) -> tuple[ComplexLanes, ComplexLanes]:
    """Two complex entries between a row of a table and the next."""
    a, b, c, d, a2, b2, c2, d2 = gather_pairs4(table, row)
    return (
        complex_of(a + (a2 - a) * w, b + (b2 - b) * w),
        complex_of(c + (c2 - c) * w, d + (d2 - d) * w),
    )


@jit(inline=True, fast=True)
def slab_lookup(
    slabs: Floats, rows: int, slab: Lanes, cosine: Lanes
) -> tuple[ComplexLanes, ComplexLanes]:
    """R_tm and (R_te + R_tm) / sin^2, or T_tm and (T_te - T_tm) / sin^2, of slabs."""
    row, w = steps_into(cosine * (rows - 2.0), rows - 2)
    return row_between(slabs, slab * float(rows) + row, w)


@jit(inline=True, fast=True)
def both_reflections(radio: Radio, slab: int, cosine: Lanes) -> tuple[ComplexLanes, ComplexLanes]:
    """R_tm and R_te of a slab."""
    tm, mix = slab_lookup(radio.slabs, radio.slab_rows, lanes_of(float(slab)), cosine)
    return tm, mix * (1.0 - cosine * cosine) - tm


@jit(inline=True, fast=True)
def interpolated(table: Floats, sine: Lanes) -> Lanes:
    """Entries of a table over -1 to 1."""
    steps = len(table) - 2
    row, w = steps_into((sine + 1.0) * (0.5 * steps), steps)
    a, b = gather_pairs1(table, row)
    return a + (b - a) * w


@jit(inline=True, fast=True)
def phasor(cis: Floats, turns: Lanes) -> ComplexLanes:
    """exp(-2 pi j turns), to 1e-12: a table and a short Taylor series."""
    steps = len(cis) - 1
    row, w = steps_into((turns - floor(turns)) * float(steps), steps)
    d = w * (2.0 * math.pi / steps)
    d2 = d * d
    cosine = 1.0 - d2 * (0.5 - d2 * (1.0 / 24.0))
    sine = d * (1.0 - d2 * (1.0 / 6.0 - d2 * (1.0 / 120.0)))
    c, s = gather2(cis, row)
    return complex_of(c * cosine - s * sine, -(s * cosine + c * sine))


@jit(inline=True, fast=True)
def new_ray(radio: Radio, slope: Lanes, bounces: int) -> Ray:
    """Rays of given slopes; floor and ceiling are looked up only if they meet them."""
    stretch = sqrt(1.0 + slope * slope)
    cos_el = 1.0 / stretch
    sin_el = slope * cos_el
    floor_tm = floor_te = complex_of(lanes_of(0.0), 0.0)
    ceiling_tm, ceiling_te = floor_tm, floor_te
    if bounces > 0:
        floor_tm, floor_te = both_reflections(radio, radio.floor, absolute(sin_el))
        ceiling_tm, ceiling_te = floor_tm, floor_te
        if radio.ceiling != radio.floor:
            ceiling_tm, ceiling_te = both_reflections(radio, radio.ceiling, absolute(sin_el))
    return Ray(slope, stretch, cos_el, sin_el, bounces, floor_tm, floor_te, ceiling_tm, ceiling_te)


EDGE_OF_STOREY = 1e-9
"""A wall met this near to floor or ceiling is met before them [storeys]."""


@jit(inline=True, fast=True)
def bounced(ray: Ray, storeys: Lanes, wave: Wave) -> Wave:
    """Apply the floor and ceiling reflections up to unfolded heights of so many storeys."""
    if ray.bounces == 0:
        return wave
    upright, level, rising, done = wave
    due = absolute(floor(storeys - copysign(lanes_of(EDGE_OF_STOREY), ray.slope)))
    # a ray that is not one, beside seven that are, may have been unfolded to anywhere
    due = minimum(due, float(ray.bounces))
    late = done < due
    while any_of(late):
        upwards = rising > 0.0
        tm = where_complex(upwards, ray.ceiling_tm, ray.floor_tm)
        te = where_complex(upwards, ray.ceiling_te, ray.floor_te)
        upright = where_complex(late, upright * tm, upright)
        level = where_complex(late, level * te, level)
        rising = where(late, -rising, rising)
        done = where(late, done + 1.0, done)
        late = done < due
    return Wave(upright, level, rising, done)


@jit(inner=True, fast=True)
def let_through(
    view: PlanView,
    radio: Radio,
    leg: Leg,
    k: int,
    ray: Ray,
    heights: tuple[Lanes, float],
    wave: Wave,
) -> Wave:
    """Field behind item k of legs, which they pass (docs/theory.md, eqs. 28-30)."""
    slab = lanes_of(float(leg.marks[k, WHAT]))
    z_root, nudge = heights
    z = z_root + ray.slope * load(leg.items[k, DISTANCE])
    if leg.marks[k, KIND] == PASS_PARTIAL:
        slab = materials_at(view, leg.marks[k, WHAT], in_building(z + nudge, radio.height))
    solid = slab >= 0.0
    if not any_of(solid):
        return wave
    wave = bounced(ray, z / radio.height, wave)
    normal = load(leg.items[k, NORMAL])
    cosine = absolute(normal) * ray.cos_el
    tm, mix = slab_lookup(radio.through, radio.slab_rows, maximum(slab, 0.0), cosine)
    a, b = load(leg.items[k, SKEW]), -normal * wave.rising
    t = (wave.upright * a + wave.level * b) * mix
    return Wave(
        where_complex(solid, tm * wave.upright + t * a, wave.upright),
        where_complex(solid, tm * wave.level + t * b, wave.level),
        wave.rising,
        wave.done,
    )


@jit(inline=True, fast=True)
def carried(
    view: PlanView,
    radio: Radio,
    leg: Leg,
    n: int,
    length: Lanes,
    ray: Ray,
    heights: tuple[Lanes, float],
    wave: Wave,
) -> Wave:
    """Carry a field along legs.

    Parameters
    ----------
    view, radio
        Plan view and radio.
    leg, n, length
        The legs, their number of items and their horizontal lengths [m].
    ray, heights
        Their slopes; the unfolded heights at their roots, and by how much they are taken to be
        higher where it is asked what stands there [m].
    wave
        The field at the root; the one at the end is returned.
    """
    (z_root, nudge), per_height = heights, 1.0 / radio.height
    for k in range(n):
        kind = leg.marks[k, KIND]
        if kind >= PASS_PARTIAL:
            if len(radio.through) > 0:
                wave = let_through(view, radio, leg, k, ray, heights, wave)
            continue
        z = z_root + ray.slope * load(leg.items[k, DISTANCE])
        wave = bounced(ray, z * per_height, wave)
        slab = lanes_of(float(leg.marks[k, WHAT]))
        if kind == REFLECT_PARTIAL:
            z = in_building(z + nudge, radio.height)
            slab = maximum(materials_at(view, leg.marks[k, WHAT], z), 0.0)
        normal = load(leg.items[k, NORMAL])
        tm, mix = slab_lookup(radio.slabs, radio.slab_rows, slab, absolute(normal) * ray.cos_el)
        a, b = load(leg.items[k, SKEW]), -normal * wave.rising
        t = (wave.upright * a + wave.level * b) * mix
        wave = Wave(t * a - tm * wave.upright, tm * wave.level - t * b, wave.rising, wave.done)
    return bounced(ray, (z_root + ray.slope * length) * per_height, wave)


@jit(inner=True)
def pattern_at(
    pattern: Floats, azimuths: int, x: Lanes, y: Lanes, sine: Lanes
) -> tuple[ComplexLanes, ComplexLanes]:
    """Upright and level amplitudes towards directions (see `radio.antennas.antenna_tables`).

    Parameters
    ----------
    pattern, azimuths
        Of one antenna, see `Radio`.
    x, y
        Horizontal directions, of length 1.
    sine
        Of the elevations.
    """
    elevations = len(pattern) // azimuths
    cosine = sqrt(maximum(1.0 - sine * sine, 0.0))
    rise = (1.0 + sine / (absolute(sine) + cosine)) * (0.5 * (elevations - 1))
    quarter = absolute(y) / maximum(absolute(x) + absolute(y), 1e-300)
    right = where(y >= 0.0, quarter, 4.0 - quarter)
    left = where(y >= 0.0, 2.0 - quarter, 2.0 + quarter)
    turn = where(x >= 0.0, right, left) * (0.25 * (azimuths - 1))
    i = floor(maximum(minimum(rise, elevations - 2.0), 0.0))
    j = floor(maximum(minimum(turn, azimuths - 2.0), 0.0))
    v, w = rise - i, turn - j
    below = row_between(pattern, i * float(azimuths) + j, w)
    above = row_between(pattern, (i + 1.0) * float(azimuths) + j, w)
    return below[0] * (1.0 - v) + above[0] * v, below[1] * (1.0 - v) + above[1] * v


@jit(inline=True)
def sent(radio: Radio, direction: tuple[Lanes, Lanes], ray: Ray) -> Wave:
    """What the transmitter sends out along rays.

    Parameters
    ----------
    radio, ray
        The antennas, and the rays' elevations.
    direction
        Horizontal directions of departure, of length 1.
    """
    none = lanes_of(0.0)
    if len(radio.patterns[0]) == 0:
        upright = complex_of(interpolated(radio.transmit, ray.sin_el), none)
        return Wave(upright, complex_of(none, none), ray.sin_el, none)
    upright, level = pattern_at(
        radio.patterns[0], radio.azimuths, direction[0], direction[1], ray.sin_el
    )
    return Wave(upright, level, ray.sin_el, none)


@jit(inline=True)
def received(radio: Radio, wave: Wave, direction: tuple[Lanes, Lanes]) -> ComplexLanes:
    """What the receiver takes up of a field.

    Parameters
    ----------
    radio, wave
        The antennas, and the field.
    direction
        Horizontal directions that the rays come from, of length 1.
    """
    if len(radio.patterns[1]) == 0:
        return wave.upright * interpolated(radio.receive, -wave.rising)
    upright, level = pattern_at(
        radio.patterns[1], radio.azimuths, direction[0], direction[1], -wave.rising
    )
    return upright * wave.upright - level * wave.level
