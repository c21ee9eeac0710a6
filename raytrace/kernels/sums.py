"""Sums over the paths that arrive at receivers: for all of them, and for eight side by side."""

from typing import NamedTuple

import numpy as np

from raytrace.arrays import Complexes, Floats
from raytrace.kernels.compiling import chosen_by_type, jit
from raytrace.kernels.field_tables import FieldTables
from raytrace.kernels.lanes import (
    ComplexLanes,
    Lanes,
    MatrixLanes,
    complex_of,
    lanes_of,
    matrix_of,
    maximum,
    row_of,
    squared_size,
    where_complex,
)


class Sums(NamedTuple):
    """What arrives at each receiver; a grazing path counts with its weight.

    Attributes
    ----------
    field
        (n, k) complex sums of the paths' gains: one, or those between k = 4 pairs of polarisations
        where one is unknown (see `waves.receive`).
    power
        (n,) sum of their squared magnitudes, of all pairs together.
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

PAIRS = 4
"""Pairs of polarisations where one is unknown."""


def new_sums(n_receivers: int, max_reflections: int, n_pairs: int = 1) -> Sums:
    """Sums over no paths, with gains between so many pairs of polarisations."""
    return Sums(
        np.zeros((n_receivers, n_pairs), np.complex128),
        np.zeros(n_receivers),
        np.zeros((n_receivers, max_reflections + 1)),
        np.zeros((n_receivers, N_MOMENTS)),
        np.zeros(n_receivers),
        np.zeros(LEVELS),
    )


def sums_bytes(n_receivers: int, max_reflections: int, n_pairs: int = 1) -> int:
    """Size of `Sums`."""
    return 8 * (n_receivers * (max_reflections + 8 + 2 * n_pairs) + LEVELS)


def add_sums(total: Sums, part: Sums) -> None:
    """Add the sums over other paths to `total`."""
    strongest = np.maximum(total.moments[:, STRONGEST], part.moments[:, STRONGEST])
    for whole, addend in zip(total, part, strict=True):
        whole += addend
    total.moments[:, STRONGEST] = strongest


class Bundle(NamedTuple):
    """Sums over the paths that arrive at eight receivers; see `Sums`."""

    field: ComplexLanes | MatrixLanes
    power: Lanes
    excess: Lanes
    excess_squared: Lanes
    cosine: Lanes
    sine: Lanes
    strongest: Lanes


def _empty(tables: FieldTables) -> Bundle:
    none = lanes_of(0.0)
    return Bundle(complex_of(none, none), none, none, none, none, none, none)


def _empty_matrices(tables: FieldTables) -> Bundle:
    none = lanes_of(0.0)
    zero = complex_of(none, none)
    row = row_of(zero, zero)
    return Bundle(matrix_of(row, row), none, none, none, none, none, none)


def empty_bundle(tables: FieldTables) -> Bundle:
    """Sums over no paths, of gains as `waves.receive` returns them."""
    return _empty(tables) if tables.unknown is None else _empty_matrices(tables)


chosen_by_type("unknown", _empty, _empty_matrices)(empty_bundle)


@jit(inline=True, fast=True)
def with_path(
    bundle: Bundle,
    gain: ComplexLanes | MatrixLanes,
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
    counted = where_complex(weight > 0.0, gain, complex_of(lanes_of(0.0), 0.0))
    size = squared_size(counted)
    power = size * weight
    power_excess = power * excess
    return Bundle(
        bundle.field + counted * weight,
        bundle.power + power,
        bundle.excess + power_excess,
        bundle.excess_squared + power_excess * excess,
        bundle.cosine + power * direction[0],
        bundle.sine + power * direction[1],
        maximum(bundle.strongest, size),
    )
