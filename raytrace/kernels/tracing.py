"""What the three families of paths share: the trace's constants, sums and records."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from raytrace.kernels.compiling import jit
from raytrace.kernels.field import Radio
from raytrace.kernels.plan_view import Floats, Ints, PlanView


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
    """

    field: NDArray[np.complex128]
    power: Floats
    n_paths: Floats
    moments: Floats


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
    size = gain.real * gain.real + gain.imag * gain.imag
    sums.field[r] += gain * share
    sums.n_paths[r, order] += share
    moments = sums.moments[r]
    moments[STRONGEST] = max(moments[STRONGEST], size)
    size *= share
    sums.power[r] += size
    moments[DETOUR] += size * detour
    moments[DETOUR_SQUARED] += size * detour * detour
    moments[COSINE] += size * direction[0]
    moments[SINE] += size * direction[1]


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
