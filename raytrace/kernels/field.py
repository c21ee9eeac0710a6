"""The field along a leg: two polarisations, carried from wall to wall.

A ray of direction (u_x cos_el, u_y cos_el, sin_el) has the polarisations `upright`, along
tau = (z - (z . s) s) / cos_el, and `level`, along psi = z x s / cos_el. Floor and ceiling leave
them apart; a wall mixes them by its plan-view angles alone (docs/theory.md, eqs. 10-13).
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from raytrace.kernels.compiling import jit
from raytrace.kernels.plan_view import Floats, PlanView, folded, material_at
from raytrace.kernels.unfolding import (
    DISTANCE,
    KIND,
    NORMAL,
    NUDGE_M,
    PASS_PARTIAL,
    REFLECT_PARTIAL,
    SKEW,
    WHAT,
    Leg,
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
    slabs
        (n_slabs, steps + 2, 4) see `raytrace.materials.slab_tables`.
    through
        (n_slabs, steps + 2, 4) see `raytrace.materials.transmission_tables`; of no slab where
        paths go through no wall.
    highest
        (n_slabs, steps + 2) largest reflected share of the power at a cosine of incidence or above.
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
        (2, n_elevations, n_azimuths, 2) of transmitter and receiver else, upright and level (see
        `raytrace.antennas.antenna_tables`); empty where the above do.
    """

    wavelength: float
    height: float
    floor: int
    ceiling: int
    slabs: Floats
    through: Floats
    highest: Floats
    peak: float
    transition: Floats
    cis: Floats
    transmit: Floats
    receive: Floats
    patterns: NDArray[np.complex128]


class Ray(NamedTuple):
    """The heights of an unfolded leg.

    Attributes
    ----------
    slope
        Growth of the unfolded height over horizontal distance.
    cos_el, sin_el
        Of the elevation at the root; sin_el changes its sign at every bounce.
    first_tm, first_te, second_tm, second_te
        Reflection coefficients of the first, third, ... and of the second, fourth, ... bounce.
    """

    slope: float
    cos_el: float
    sin_el: float
    first_tm: complex
    first_te: complex
    second_tm: complex
    second_te: complex


@jit(inline=True, fast=True)
def slab_lookup(slabs: Floats, slab: int, cosine: float) -> tuple[complex, complex]:
    """R_tm and (R_te + R_tm) / sin^2, or T_tm and (T_te - T_tm) / sin^2, of a slab."""
    steps = slabs.shape[1] - 2
    t = cosine * steps
    k = min(max(int(t), 0), steps)
    w = t - k
    v = 1.0 - w
    a, b = slabs[slab, k], slabs[slab, k + 1]
    return complex(a[0] * v + b[0] * w, a[1] * v + b[1] * w), complex(
        a[2] * v + b[2] * w, a[3] * v + b[3] * w
    )


@jit(inline=True, fast=True)
def both_reflections(slabs: Floats, slab: int, cosine: float) -> tuple[complex, complex]:
    """R_tm and R_te of a slab."""
    tm, mix = slab_lookup(slabs, slab, cosine)
    return tm, mix * (1.0 - cosine * cosine) - tm


@jit(inline=True, fast=True)
def interpolated(table: Floats, sine: float) -> float:
    """Entry of a table over -1 to 1."""
    t = (sine + 1.0) * (0.5 * (len(table) - 2))
    k = min(max(int(t), 0), len(table) - 2)
    return table[k] + (table[k + 1] - table[k]) * (t - k)


@jit(inline=True, fast=True)
def phasor(cis: Floats, turns: float) -> complex:
    """exp(-2 pi j turns), to 1e-12: a table and a short Taylor series."""
    steps = len(cis) - 1
    t = (turns - math.floor(turns)) * steps
    k = min(max(int(t), 0), steps)
    d = (t - k) * (2.0 * math.pi / steps)
    d2 = d * d
    cosine = 1.0 - d2 * (0.5 - d2 * (1.0 / 24.0))
    sine = d * (1.0 - d2 * (1.0 / 6.0 - d2 * (1.0 / 120.0)))
    c, s = cis[k, 0], cis[k, 1]
    return complex(c * cosine - s * sine, -(s * cosine + c * sine))


@jit(inline=True, fast=True)
def new_ray(radio: Radio, slope: float, bounces: int) -> Ray:
    """Ray of a given slope; floor and ceiling are looked up only if it meets them."""
    cos_el = 1.0 / math.sqrt(1.0 + slope * slope)
    sin_el = slope * cos_el
    if bounces == 0:
        return Ray(slope, cos_el, sin_el, 0j, 0j, 0j, 0j)
    first, second = (radio.ceiling, radio.floor) if slope > 0.0 else (radio.floor, radio.ceiling)
    tm, te = both_reflections(radio.slabs, first, abs(sin_el))
    if first == second:
        return Ray(slope, cos_el, sin_el, tm, te, tm, te)
    tm2, te2 = both_reflections(radio.slabs, second, abs(sin_el))
    return Ray(slope, cos_el, sin_el, tm, te, tm2, te2)


EDGE_OF_STOREY = 1e-9
"""A wall met this near to floor or ceiling is met before them [storeys]."""


@jit(inline=True, fast=True)
def bounced(
    ray: Ray, storeys: float, upright: complex, level: complex, done: int
) -> tuple[complex, complex, int]:
    """Apply the floor and ceiling reflections up to an unfolded height of that many storeys."""
    due = abs(math.floor(storeys - math.copysign(EDGE_OF_STOREY, ray.slope)))
    while done < due:
        if done & 1:
            upright, level = upright * ray.second_tm, level * ray.second_te
        else:
            upright, level = upright * ray.first_tm, level * ray.first_te
        done += 1
    return upright, level, done


@jit(inner=True)
def solid_at(view: PlanView, profile: int, z: float) -> int:
    """Material of a profile at or next to a height where a leg is reflected."""
    material = material_at(view, profile, z)
    if material < 0:
        above = material_at(view, profile, z + NUDGE_M)
        material = above if above >= 0 else material_at(view, profile, z - NUDGE_M)
    return material


@jit(inner=True, fast=True)
def let_through(
    view: PlanView,
    radio: Radio,
    leg: Leg,
    k: int,
    ray: Ray,
    z_root: float,
    field: tuple[complex, complex, int],
) -> tuple[complex, complex, int]:
    """Field behind item k of a leg, which it passes (docs/theory.md, eqs. 28-30)."""
    upright, level, done = field
    slab = leg.marks[k, WHAT]
    z = z_root + ray.slope * leg.items[k, DISTANCE]
    if leg.marks[k, KIND] == PASS_PARTIAL:
        slab = material_at(view, slab, folded(z, radio.height))
        if slab < 0:
            return field
    upright, level, done = bounced(ray, z / radio.height, upright, level, done)
    normal = leg.items[k, NORMAL]
    tm, mix = slab_lookup(radio.through, slab, abs(normal) * ray.cos_el)
    a = leg.items[k, SKEW]
    b = normal * ray.sin_el if done & 1 else -normal * ray.sin_el
    t = (upright * a + level * b) * mix
    return tm * upright + t * a, tm * level + t * b, done


@jit(inline=True, fast=True)
def carried(
    view: PlanView,
    radio: Radio,
    leg: Leg,
    n: int,
    length: float,
    ray: Ray,
    z_root: float,
    field: tuple[complex, complex, int],
) -> tuple[complex, complex, int]:
    """Carry a field along a leg.

    Parameters
    ----------
    view, radio
        Plan view and radio.
    leg, n, length
        The leg, its number of items and its horizontal length [m].
    ray, z_root
        Its heights; the unfolded one at its root [m].
    field
        Upright and level polarisation at the root, and the bounces already done on this ray.

    Returns
    -------
    tuple
        The same at the end of the leg.
    """
    upright, level, done = field
    per_height = 1.0 / radio.height
    for k in range(n):
        kind, slab = leg.marks[k, KIND], leg.marks[k, WHAT]
        if kind >= PASS_PARTIAL:
            if len(radio.through) > 0:
                upright, level, done = let_through(
                    view, radio, leg, k, ray, z_root, (upright, level, done)
                )
            continue
        z = z_root + ray.slope * leg.items[k, DISTANCE]
        upright, level, done = bounced(ray, z * per_height, upright, level, done)
        if kind == REFLECT_PARTIAL:
            slab = solid_at(view, slab, folded(z, radio.height))
        normal = leg.items[k, NORMAL]
        tm, mix = slab_lookup(radio.slabs, slab, abs(normal) * ray.cos_el)
        a = leg.items[k, SKEW]
        b = normal * ray.sin_el
        if not done & 1:
            b = -b
        t = (upright * a + level * b) * mix
        upright = t * a - tm * upright
        level = tm * level - t * b
    return bounced(ray, (z_root + ray.slope * length) * per_height, upright, level, done)


@jit(inner=True)
def pattern_at(
    pattern: NDArray[np.complex128], x: float, y: float, sine: float
) -> tuple[complex, complex]:
    """Upright and level amplitude towards a direction (see `raytrace.antennas.antenna_tables`).

    Parameters
    ----------
    pattern
        (n_elevations, n_azimuths, 2) of one antenna.
    x, y
        Horizontal direction, of length 1.
    sine
        Of the elevation.
    """
    cosine = math.sqrt(max(1.0 - sine * sine, 0.0))
    row = (1.0 + sine / (abs(sine) + cosine)) * 0.5 * (pattern.shape[0] - 1)
    quarter = abs(y) / max(abs(x) + abs(y), 1e-300)
    if x >= 0.0:
        turn = quarter if y >= 0.0 else 4.0 - quarter
    else:
        turn = 2.0 - quarter if y >= 0.0 else 2.0 + quarter
    column = turn * 0.25 * (pattern.shape[1] - 1)
    i = min(max(int(row), 0), pattern.shape[0] - 2)
    j = min(max(int(column), 0), pattern.shape[1] - 2)
    v, w = row - i, column - j
    low, high = pattern[i], pattern[i + 1]
    upright = (1.0 - v) * ((1.0 - w) * low[j, 0] + w * low[j + 1, 0])
    upright += v * ((1.0 - w) * high[j, 0] + w * high[j + 1, 0])
    level = (1.0 - v) * ((1.0 - w) * low[j, 1] + w * low[j + 1, 1])
    level += v * ((1.0 - w) * high[j, 1] + w * high[j + 1, 1])
    return upright, level


@jit(inline=True)
def sent(radio: Radio, direction: tuple[float, float], sine: float) -> tuple[complex, complex]:
    """Upright and level amplitude that the transmitter sends out.

    Parameters
    ----------
    radio
        The antennas.
    direction, sine
        Horizontal direction of departure, of length 1, and sine of the elevation.
    """
    if len(radio.patterns) == 0:
        return complex(interpolated(radio.transmit, sine)), 0j
    return pattern_at(radio.patterns[0], direction[0], direction[1], sine)


@jit(inline=True)
def received(
    radio: Radio,
    field: tuple[complex, complex],
    direction: tuple[float, float],
    sine: float,
) -> complex:
    """What the receiver takes up of a field.

    Parameters
    ----------
    radio
        The antennas.
    field
        Upright and level amplitude.
    direction, sine
        Horizontal direction that the ray comes from, of length 1, and sine of its elevation.
    """
    if len(radio.patterns) == 0:
        return field[0] * interpolated(radio.receive, sine)
    upright, level = pattern_at(radio.patterns[1], direction[0], direction[1], sine)
    return upright * field[0] - level * field[1]


@jit(inline=True)
def arriving_sine(ray: Ray, done: int) -> float:
    """Sine of the elevation that a ray comes from, after so many bounces."""
    return ray.sin_el if done & 1 else -ray.sin_el
