"""Sums over the paths that arrive at receivers: for all of them, and for eight side by side."""

from typing import NamedTuple

import numpy as np

from raytrace.arrays import Complexes, Floats
from raytrace.kernels.compiling import jit
from raytrace.kernels.lanes import (
    ComplexLanes,
    Lanes,
    imag_of,
    lanes_of,
    maximum,
    real_of,
    where,
)


class Sums(NamedTuple):
    """What arrives at each receiver; a grazing path counts with its weight.

    Attributes
    ----------
    field
        (n,) complex sum of the paths' gains.
    power
        (n,) sum of their squared magnitudes.
    n_paths
        (n, max_reflections + 1) number of paths by reflections.
    moments
        (n, N_MOMENTS) sums of power times excess path length over the straight line and times its
        square [m, m^2]; sums of power times cosine and times sine of the azimuth of arrival; power
        of the strongest path.
    left_out
        (n,) bound on the power of the paths below the power threshold.
    bins
        (LEVELS,) paths below the threshold by their bounds, in steps of 1 dB downwards from 0 dB;
        counted only for an infinite threshold.
    """

    field: Complexes
    power: Floats
    n_paths: Floats
    moments: Floats
    left_out: Floats
    bins: Floats


LEVELS = 400
"""Rows of `Sums.bins`."""

N_MOMENTS = 5
EXCESS, EXCESS_SQUARED, COSINE, SINE, STRONGEST = range(N_MOMENTS)
"""Columns of `Sums.moments`."""

FIRST_MOMENT = 3
"""Number of the fields of `Bundle` before its moments."""


def new_sums(n_receivers: int, max_reflections: int) -> Sums:
    """Sums over no paths."""
    return Sums(
        np.zeros(n_receivers, np.complex128),
        np.zeros(n_receivers),
        np.zeros((n_receivers, max_reflections + 1)),
        np.zeros((n_receivers, N_MOMENTS)),
        np.zeros(n_receivers),
        np.zeros(LEVELS),
    )


def sums_bytes(n_receivers: int, max_reflections: int) -> int:
    """Size of `Sums`."""
    return 8 * (n_receivers * (max_reflections + 10) + LEVELS)


def add_sums(total: Sums, part: Sums) -> None:
    """Add the sums over other paths to `total`."""
    strongest = np.maximum(total.moments[:, STRONGEST], part.moments[:, STRONGEST])
    for whole, addend in zip(total, part, strict=True):
        whole += addend
    total.moments[:, STRONGEST] = strongest


class Bundle(NamedTuple):
    """Sums over the paths that arrive at eight receivers; see `Sums`."""

    real: Lanes
    imag: Lanes
    power: Lanes
    excess: Lanes
    excess_squared: Lanes
    cosine: Lanes
    sine: Lanes
    strongest: Lanes


@jit(inline=True)
def empty_bundle() -> Bundle:
    """Sums over no paths."""
    none = lanes_of(0.0)
    return Bundle(none, none, none, none, none, none, none, none)


@jit(inline=True, fast=True)
def with_path(
    bundle: Bundle,
    gain: ComplexLanes,
    excess: Lanes,
    weight: Lanes,
    direction: tuple[Lanes, Lanes],
) -> Bundle:
    """Sums with one more path to each receiver.

    Parameters
    ----------
    bundle
        The sums.
    gain, excess, weight
        Of the paths: gains, lengths beyond the straight line [m], weights.
    direction
        Cosine and sine of the azimuths of arrival.
    """
    counts = weight > 0.0
    real, imag = where(counts, real_of(gain), 0.0), where(counts, imag_of(gain), 0.0)
    size = real * real + imag * imag
    power = size * weight
    power_excess = power * excess
    return Bundle(
        bundle.real + real * weight,
        bundle.imag + imag * weight,
        bundle.power + power,
        bundle.excess + power_excess,
        bundle.excess_squared + power_excess * excess,
        bundle.cosine + power * direction[0],
        bundle.sine + power * direction[1],
        maximum(bundle.strongest, size),
    )
