"""The field along a leg: two polarisations, carried from wall to wall.

A ray of direction (u_x cos_el, u_y cos_el, sin_el) has the polarisations `upright`, along
tau = (z - (z . s) s) / cos_el, and `level`, along psi = z x s / cos_el. Floor and ceiling leave
them apart; a wall mixes them by its plan-view angles alone (docs/theory.md, eqs. 10-13).
"""

import math
from typing import NamedTuple

from raytrace.kernels.compiling import jit
from raytrace.kernels.plan_view import Floats, PlanView, folded, material_at
from raytrace.kernels.unfolding import (
    DISTANCE,
    KIND,
    NORMAL,
    PASS_PARTIAL,
    REFLECT_WALL,
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
    transition
        (steps + 2, 2) F(s^2) / s of the UTD transition function, see `raytrace.kernels.utd`.
    cis
        (steps + 1, 2) cosine and sine of a turn.
    transmit, receive
        (steps + 2,) antenna amplitudes over the direction's z component from -1 to 1.
    """

    wavelength: float
    height: float
    floor: int
    ceiling: int
    slabs: Floats
    transition: Floats
    cis: Floats
    transmit: Floats
    receive: Floats


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
def slab_reflection(slabs: Floats, slab: int, cosine: float) -> tuple[complex, complex]:
    """R_tm and (R_te + R_tm) / sin^2 of a slab, by linear interpolation."""
    steps = slabs.shape[1] - 2
    t = cosine * steps
    k = int(t)
    w = t - k
    v = 1.0 - w
    a, b = slabs[slab, k], slabs[slab, k + 1]
    return complex(a[0] * v + b[0] * w, a[1] * v + b[1] * w), complex(
        a[2] * v + b[2] * w, a[3] * v + b[3] * w
    )


@jit(inline=True, fast=True)
def both_reflections(slabs: Floats, slab: int, cosine: float) -> tuple[complex, complex]:
    """R_tm and R_te of a slab."""
    tm, mix = slab_reflection(slabs, slab, cosine)
    return tm, mix * (1.0 - cosine * cosine) - tm


@jit(inline=True, fast=True)
def interpolated(table: Floats, sine: float) -> float:
    """Entry of a table over -1 to 1."""
    t = (sine + 1.0) * (0.5 * (len(table) - 2))
    k = int(t)
    return table[k] + (table[k + 1] - table[k]) * (t - k)


@jit(inline=True, fast=True)
def phasor(cis: Floats, turns: float) -> complex:
    """exp(-2 pi j turns), to 1e-12: a table and a short Taylor series."""
    steps = len(cis) - 1
    t = (turns - math.floor(turns)) * steps
    k = int(t)
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


@jit(inline=True, fast=True)
def bounced(
    ray: Ray, storeys: float, upright: complex, level: complex, done: int
) -> tuple[complex, complex, int]:
    """Apply the floor and ceiling reflections up to an unfolded height of that many storeys."""
    due = abs(math.floor(storeys))
    while done < due:
        if done & 1:
            upright, level = upright * ray.second_tm, level * ray.second_te
        else:
            upright, level = upright * ray.first_tm, level * ray.first_te
        done += 1
    return upright, level, done


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
        kind, what = leg.marks[k, KIND], leg.marks[k, WHAT]
        if kind == PASS_PARTIAL:
            continue
        z = z_root + ray.slope * leg.items[k, DISTANCE]
        upright, level, done = bounced(ray, z * per_height, upright, level, done)
        slab = what
        if kind != REFLECT_WALL:
            slab = material_at(view, what, folded(z, radio.height))
        normal = leg.items[k, NORMAL]
        tm, mix = slab_reflection(radio.slabs, slab, abs(normal) * ray.cos_el)
        a = leg.items[k, SKEW]
        b = normal * ray.sin_el
        if not done & 1:
            b = -b
        t = (upright * a + level * b) * mix
        upright = t * a - tm * upright
        level = tm * level - t * b
    return bounced(ray, (z_root + ray.slope * length) * per_height, upright, level, done)


@jit(inline=True, fast=True)
def antenna_gain(radio: Radio, ray: Ray, done: int) -> float:
    """Amplitude of both antennas on a ray that leaves and arrives at the same elevation."""
    arriving = ray.sin_el if done & 1 else -ray.sin_el
    return interpolated(radio.transmit, ray.sin_el) * interpolated(radio.receive, arriving)
