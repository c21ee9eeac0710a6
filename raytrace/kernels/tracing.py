"""What the three families of paths share: the trace's constants, sums and records."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from raytrace.kernels.compiling import jit
from raytrace.kernels.field import Radio
from raytrace.kernels.plan_view import Floats, Ints, PlanView
from raytrace.kernels.unfolding import KIND, NORMAL, REFLECT_WALL, WHAT, Leg


class Trace(NamedTuple):
    """Everything that stays the same through a trace.

    Attributes
    ----------
    plan, radio
        Plan view, and wavelength, materials and antennas.
    source
        (3,) the transmitter [m].
    source_z
        (2 max_order + 1,) images of its height in floor and ceiling [m].
    receivers
        (n, 2) plan-view positions [m].
    level
        (n,) which of the receiver heights each is at.
    image_z
        (n_levels, 2 max_order + 1) images of each height in floor and ceiling [m].
    image_bounces
        (2 max_order + 1,) how many reflections each image has.
    max_order, max_walls
        Most reflections on a path, and most walls it goes through.
    least_power
        Paths whose power is known to be below this are left out [share of the transmitted].
    """

    plan: PlanView
    radio: Radio
    source: Floats
    source_z: Floats
    receivers: Floats
    level: Ints
    image_z: Floats
    image_bounces: Ints
    max_order: int
    max_walls: int
    least_power: float


class Sums(NamedTuple):
    """What arrives at each receiver; a path at a tie counts with its share.

    Attributes
    ----------
    field
        (n,) complex sum of the paths' gains.
    power
        (n,) sum of their squared magnitudes.
    n_paths
        (n, max_order + 1) number of paths by reflections.
    moments
        (n, 5) sums of power times detour and times its square, the detour being what a path is
        longer than the straight line [m]; sums of power times cosine and times sine of the
        azimuth it arrives at; power of the strongest path.
    left_out
        (n,) bound on the power of the paths that were left out.
    bins
        (LEVELS,) paths left out by their bounds, in steps of 1 dB downwards from 0 dB; counted
        only where everything is left out.
    """

    field: NDArray[np.complex128]
    power: Floats
    n_paths: Floats
    moments: Floats
    left_out: Floats
    bins: Floats


LEVELS = 400
"""Rows of `Sums.bins`."""

DETOUR, DETOUR_SQUARED, COSINE, SINE, STRONGEST = range(5)
"""Columns of `Sums.moments`."""


class Record(NamedTuple):
    """Room for single paths, filled until it is full.

    Attributes
    ----------
    key
        (n, 4) int32 hit, leg to the edge, height image before and after it; -1 where the path
        has none.
    gain, share
        (n,) complex path gain, and share at a tie.
    used
        (1,) number of paths met, also of those there was no room for.
    """

    key: NDArray[np.int32]
    gain: NDArray[np.complex128]
    share: Floats
    used: Ints


def new_sums(n_receivers: int, max_order: int) -> Sums:
    """Sums of no paths."""
    return Sums(
        np.zeros(n_receivers, np.complex128),
        np.zeros(n_receivers),
        np.zeros((n_receivers, max_order + 1)),
        np.zeros((n_receivers, 5)),
        np.zeros(n_receivers),
        np.zeros(LEVELS),
    )


def new_record(n_paths: int) -> Record:
    """Room for that many paths."""
    return Record(
        np.empty((n_paths, 4), np.int32),
        np.empty(n_paths, np.complex128),
        np.empty(n_paths),
        np.zeros(1, np.int64),
    )


@jit(inline=True)
def straight_line(trace: Trace, r: int) -> float:
    """Distance from the source to a receiver [m]."""
    x, y = trace.receivers[r, 0] - trace.source[0], trace.receivers[r, 1] - trace.source[1]
    z = trace.image_z[trace.level[r], 0] - trace.source[2]
    return math.sqrt(x * x + y * y + z * z)


class Bundle(NamedTuple):
    """Sums over paths that arrive at a receiver from one direction; see `Sums`."""

    field: complex
    power: float
    detour: float
    detour_squared: float
    strongest: float


@jit(inline=True)
def no_paths() -> Bundle:
    """Sums of no paths."""
    return Bundle(0j, 0.0, 0.0, 0.0, 0.0)


@jit(inline=True, fast=True)
def with_path(bundle: Bundle, gain: complex, detour: float, share: float) -> Bundle:
    """Sums with one path more: its gain, its detour [m] and its share."""
    size = gain.real * gain.real + gain.imag * gain.imag
    counted = size * share
    return Bundle(
        bundle.field + gain * share,
        bundle.power + counted,
        bundle.detour + counted * detour,
        bundle.detour_squared + counted * detour * detour,
        max(bundle.strongest, size),
    )


@jit(inline=True, fast=True)
def add_bundle(sums: Sums, r: int, bundle: Bundle, direction: tuple[float, float]) -> None:
    """Add paths that arrive from a direction, cosine and sine of its azimuth, to the sums."""
    sums.field[r] += bundle.field
    sums.power[r] += bundle.power
    moments = sums.moments[r]
    moments[STRONGEST] = max(moments[STRONGEST], bundle.strongest)
    moments[DETOUR] += bundle.detour
    moments[DETOUR_SQUARED] += bundle.detour_squared
    moments[COSINE] += bundle.power * direction[0]
    moments[SINE] += bundle.power * direction[1]


@jit(inline=True, fast=True)
def arrived(
    sums: Sums,
    r: int,
    order: int,
    path: tuple[complex, float, float],
    direction: tuple[float, float],
) -> None:
    """Add a path to the sums.

    Parameters
    ----------
    sums, r, order
        To what, at which receiver, and the path's number of reflections.
    path
        Its gain, its detour [m] and its share.
    direction
        Cosine and sine of the azimuth it arrives at.
    """
    gain, detour, share = path
    sums.n_paths[r, order] += share
    add_bundle(sums, r, with_path(no_paths(), gain, detour, share), direction)


@jit(inner=True)
def leave_out(trace: Trace, sums: Sums, r: int, bound: float, n_paths: float) -> None:
    """Note that paths are left out, so many, each of a power below a bound."""
    sums.left_out[r] += n_paths * bound
    if math.isinf(trace.least_power):
        level = int(-10.0 * math.log10(max(bound, 1e-39)))
        sums.bins[max(level, 0)] += n_paths


@jit(inner=True, fast=True)
def leg_bound(trace: Trace, leg: Leg, n: int, length: float, order: int) -> float:
    """Bound on the share of the power that the walls on a leg reflect.

    Parameters
    ----------
    trace
        The trace.
    leg, n, length
        The leg, its items, its horizontal length [m].
    order
        Its reflections at walls; what is left to floor and ceiling bounds its slope.
    """
    rise = (trace.max_order - order + 1) * trace.radio.height
    cos_el = length / math.sqrt(length * length + rise * rise)
    bound, steps = 1.0, trace.radio.highest.shape[1] - 2
    for k in range(n):
        if leg.marks[k, KIND] == REFLECT_WALL:
            at = min(int(abs(leg.items[k, NORMAL]) * cos_el * steps), steps)
            bound *= trace.radio.highest[leg.marks[k, WHAT], at]
    return bound


@jit(inline=True)
def free_space(trace: Trace, length: float) -> float:
    """Bound on the received share of the power over a distance [m]."""
    size = trace.radio.wavelength / (4.0 * math.pi * length)
    return trace.radio.peak * size * size


@jit(inline=True)
def recorded(
    record: Record, hit: int, leg: int, images: tuple[int, int], gain: complex, share: float
) -> None:
    """Write a path down if there is room."""
    k = record.used[0]
    if k < len(record.gain):
        record.key[k, 0], record.key[k, 1] = hit, leg
        record.key[k, 2], record.key[k, 3] = images
        record.gain[k], record.share[k] = gain, share
    record.used[0] = k + 1
