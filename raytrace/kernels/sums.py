"""Sums over the paths that arrive at receivers: for all of them, and for eight side by side."""

from typing import NamedTuple

import numpy as np

from raytrace.arrays import Bools, Complexes, Floats
from raytrace.kernels.compiling import chosen_by_type, jit
from raytrace.kernels.field_tables import FieldTables
from raytrace.kernels.lanes import (
    ComplexLanes,
    Lanes,
    MatrixLanes,
    complex_of,
    elements_of,
    imag_of,
    lanes_of,
    load,
    matrix_of,
    maximum,
    real_of,
    row_of,
    squared_size,
    store,
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
    not_grown
        (1,) bound on the power of the paths in beams that are not grown, at any receiver.
    touched
        (n,) whether anything was added at a receiver.
    bins
        (LEVELS,) paths below the threshold by their bounds, in steps of 1 dB downwards from 0 dB;
        counted only for an infinite threshold.
    """

    field: Complexes
    power: Floats
    n_paths: Floats
    moments: Floats
    left_out: Floats
    not_grown: Floats
    touched: Bools
    bins: Floats


LEVELS = 400
"""Rows of `Sums.bins`."""

N_MOMENTS = 5
EXCESS, EXCESS_SQUARED, COSINE, SINE, STRONGEST = range(N_MOMENTS)
"""Columns of `Sums.moments`."""

PAIRS = 4
"""Pairs of polarisations where one is unknown."""


def new_sums(
    n_receivers: int, max_reflections: int, n_pairs: int = 1, shape: tuple[int, ...] = ()
) -> Sums:
    """Sums over no paths, with gains between so many pairs of polarisations.

    `shape` is that of further axes in front of those of all arrays.
    """
    return Sums(
        np.zeros((*shape, n_receivers, n_pairs), np.complex128),
        np.zeros((*shape, n_receivers)),
        np.zeros((*shape, n_receivers, max_reflections + 1)),
        np.zeros((*shape, n_receivers, N_MOMENTS)),
        np.zeros((*shape, n_receivers)),
        np.zeros((*shape, 1)),
        np.zeros((*shape, n_receivers), np.bool_),
        np.zeros((*shape, LEVELS)),
    )


def sums_of(sums: Sums, f: int) -> Sums:
    """Sums number f along the first axis of all arrays."""
    return Sums(
        sums.field[f], sums.power[f], sums.n_paths[f], sums.moments[f], sums.left_out[f],
        sums.not_grown[f], sums.touched[f], sums.bins[f],
    )  # fmt: skip


sums_at = jit(inline=True)(sums_of)
"""`sums_of` for kernels."""


def sums_bytes(n_receivers: int, max_reflections: int, n_pairs: int = 1) -> int:
    """Size of `Sums`."""
    return 8 * (n_receivers * (max_reflections + 8 + 2 * n_pairs) + LEVELS + 1) + n_receivers


def add_sums(total: Sums, part: Sums) -> None:
    """Add the sums over other paths to `total`, at the receivers where there are some."""
    add_touched(total, part)
    for whole, addend in ((total.not_grown, part.not_grown), (total.bins, part.bins)):
        whole += addend


@jit(allocates=False)
def add_touched(total: Sums, part: Sums) -> None:
    """Add what `add_sums` adds at each receiver."""
    for r in range(len(part.touched)):
        if not part.touched[r]:
            continue
        total.touched[r] = True
        for k in range(part.field.shape[1]):
            total.field[r, k] += part.field[r, k]
        total.power[r] += part.power[r]
        for k in range(part.n_paths.shape[1]):
            total.n_paths[r, k] += part.n_paths[r, k]
        strongest = max(total.moments[r, STRONGEST], part.moments[r, STRONGEST])
        for k in range(STRONGEST):
            total.moments[r, k] += part.moments[r, k]
        total.moments[r, STRONGEST] = strongest
        total.left_out[r] += part.left_out[r]


def sums_from(sums: Sums, first: int) -> Sums:
    """Copy the sums at the receivers from a given one on."""
    return Sums(
        sums.field[first:].copy(), sums.power[first:].copy(), sums.n_paths[first:].copy(),
        sums.moments[first:].copy(), sums.left_out[first:].copy(), sums.not_grown.copy(),
        sums.touched[first:].copy(), sums.bins.copy(),
    )  # fmt: skip


class Bundle(NamedTuple):
    """Sums over the paths that arrive at eight receivers; see `Sums`."""

    field: ComplexLanes | MatrixLanes
    power: Lanes
    excess: Lanes
    excess_squared: Lanes
    cosine: Lanes
    sine: Lanes
    strongest: Lanes


BUNDLE_ROWS = 1 + N_MOMENTS + 2 * PAIRS
"""Rows of a `Bundle` in memory: its power and moments, real and imaginary parts of its fields."""

FIELDS = 1 + N_MOMENTS
"""First row of the fields."""


@jit(inline=True)
def store_bundle(rows: Floats, bundle: Bundle) -> None:
    """Write a bundle to rows (BUNDLE_ROWS, 8)."""
    for k, part in enumerate(bundle[1:]):
        store(rows[k], part)
    for k, gain in enumerate(elements_of(bundle.field)):
        store(rows[FIELDS + 2 * k], real_of(gain))
        store(rows[FIELDS + 2 * k + 1], imag_of(gain))


@jit(inline=True)
def element(rows: Floats, k: int) -> ComplexLanes:
    """Read a field of a bundle."""
    return complex_of(load(rows[FIELDS + 2 * k]), load(rows[FIELDS + 2 * k + 1]))


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


def _field(tables: FieldTables, rows: Floats) -> ComplexLanes | MatrixLanes:
    return element(rows, 0)


def _matrices(tables: FieldTables, rows: Floats) -> ComplexLanes | MatrixLanes:
    one = row_of(element(rows, 0), element(rows, 1))
    return matrix_of(one, row_of(element(rows, 2), element(rows, 3)))


def loaded_field(tables: FieldTables, rows: Floats) -> ComplexLanes | MatrixLanes:
    """Read the field of a bundle, of gains as `waves.receive` returns them."""
    return _field(tables, rows) if tables.unknown is None else _matrices(tables, rows)


chosen_by_type("unknown", _field, _matrices)(loaded_field)


@jit(inline=True)
def loaded_bundle(tables: FieldTables, rows: Floats) -> Bundle:
    """Read a bundle from rows (BUNDLE_ROWS, 8)."""
    return Bundle(
        loaded_field(tables, rows), load(rows[0]), load(rows[1]), load(rows[2]), load(rows[3]),
        load(rows[4]), load(rows[5]),
    )  # fmt: skip


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
