"""The tables of materials, antennas and special functions that the field kernels interpolate.

They depend on materials, antennas and the frequency alone, not on the geometry of a trace.
"""

import math
from collections.abc import Callable
from typing import Any, NamedTuple

from raytrace.arrays import Floats
from raytrace.kernels.compiling import chosen_by_type, jit
from raytrace.kernels.lanes import (
    ComplexLanes,
    Lanes,
    complex_of,
    floor,
    gather2,
    gather_pairs1,
    gather_pairs4,
    lanes_of,
    maximum,
    minimum,
)

Unknown = tuple[float, float]


class FieldTables(NamedTuple):
    """Materials, antennas and special functions at one frequency.

    Attributes
    ----------
    wavelength
        [m]
    slab_rows
        Rows of a slab in the tables that follow: steps of the cosine of incidence, and 2.
    reflection
        (n_slabs * slab_rows, 4) see `raytrace.radio.tables.slab_tables`.
    transmission
        (n_slabs * slab_rows, 4) see `raytrace.radio.tables.transmission_tables`; empty where
        paths go through no wall.
    max_reflectance
        (n_slabs * slab_rows,) largest reflected fraction of the power at a cosine of incidence
        or above.
    peak_gain
        Largest power gain of both antennas together.
    transition
        (steps + 2, 2) F(s^2) / s of the UTD transition function, see `raytrace.kernels.utd`.
    cis
        (steps + 1, 2) cosine and sine over one turn.
    transmit, receive
        (steps + 2,) antenna amplitudes over the direction's z component from -1 to 1, where both
        antennas are rotationally symmetric and V-polarised.
    patterns
        (n_elevations * n_azimuths, 4) otherwise, of transmitter and receiver: real and imaginary
        parts of V and H, elevation by elevation (see `raytrace.radio.tables.pattern_tables`);
        empty where `transmit` and `receive` are used.
    azimuths
        Number of azimuths in `patterns`.
    unknown
        Where the polarisation of an antenna is unknown: of transmitter and receiver, the amplitude
        of either component, 0 where it is known (docs/theory.md, eq. 48). Otherwise None. Kernels
        are compiled for each of the two.
    """

    wavelength: float
    slab_rows: int
    reflection: Floats
    transmission: Floats
    max_reflectance: Floats
    peak_gain: float
    transition: Floats
    cis: Floats
    transmit: Floats
    receive: Floats
    patterns: tuple[Floats, Floats]
    azimuths: int
    unknown: Unknown | None = None


class OtherTables(NamedTuple):
    """Those of n other `FieldTables` that fields depend on, along one more axis, the first.

    Attributes
    ----------
    wavelength
        (n,) [m]
    reflection, transmission, transmit, receive, patterns
        See `FieldTables`.
    """

    wavelength: Floats
    reflection: Floats
    transmission: Floats
    transmit: Floats
    receive: Floats
    patterns: tuple[Floats, Floats]


class FrequencyTables(NamedTuple):
    """Field tables that the same paths are evaluated with, such as those of several frequencies.

    Attributes
    ----------
    first
        The first ones. The power of paths is compared with thresholds by these.
    others
        The others; None where there are none. Kernels are compiled for each of the two.
    """

    first: FieldTables
    others: OtherTables | None = None


@jit(inline=True)
def tables_at(every: FrequencyTables, f: int) -> FieldTables:
    """Tables of other f, as far as fields depend on them; its bounds are those of the first."""
    first = every.first
    others: Any = every.others
    return FieldTables(
        others.wavelength[f], first.slab_rows, others.reflection[f], others.transmission[f],
        first.max_reflectance, first.peak_gain, first.transition, first.cis, others.transmit[f],
        others.receive[f], (others.patterns[0][f], others.patterns[1][f]), first.azimuths,
        first.unknown,
    )  # fmt: skip


def for_others(kernel: Callable[[FrequencyTables, Any], None]) -> Callable[..., None]:
    """Let kernels call one that adds paths with other tables; where there are none, no code is."""

    def add_to_others(every: FrequencyTables, paths: Any) -> None:
        kernel(every, paths)

    def add_nothing(every: FrequencyTables, paths: Any) -> None:
        pass

    chosen_by_type("others", add_nothing, add_to_others)(add_to_others)
    return add_to_others


@jit(inline=True)
def row_and_fraction(t: Lanes, steps: int) -> tuple[Lanes, Lanes]:
    """Row below, and fraction of the step above it, in a table of that many steps and one more."""
    t = maximum(minimum(t, float(steps)), 0.0)
    row = floor(t)
    return row, t - row


@jit(inline=True, fast=True)
def between_rows(table: Floats, row: Lanes, w: Lanes) -> tuple[ComplexLanes, ComplexLanes]:
    """Two complex entries, interpolated between a row of a table and the next."""
    a, b, c, d, a2, b2, c2, d2 = gather_pairs4(table, row)
    return (
        complex_of(a + (a2 - a) * w, b + (b2 - b) * w),
        complex_of(c + (c2 - c) * w, d + (d2 - d) * w),
    )


@jit(inline=True, fast=True)
def slab_lookup(
    table: Floats, rows: int, slab: Lanes, cosine: Lanes
) -> tuple[ComplexLanes, ComplexLanes]:
    """R_tm and (R_te + R_tm) / sin^2, or T_tm and (T_te - T_tm) / sin^2, of slabs."""
    row, w = row_and_fraction(cosine * (rows - 2.0), rows - 2)
    return between_rows(table, slab * float(rows) + row, w)


@jit(inline=True, fast=True)
def both_reflections(
    tables: FieldTables, slab: int, cosine: Lanes
) -> tuple[ComplexLanes, ComplexLanes]:
    """R_tm and R_te of a slab."""
    tm, mix = slab_lookup(tables.reflection, tables.slab_rows, lanes_of(float(slab)), cosine)
    return tm, mix * (1.0 - cosine * cosine) - tm


@jit(inline=True, fast=True)
def interpolated(table: Floats, sine: Lanes) -> Lanes:
    """Entries of a table over -1 to 1."""
    steps = len(table) - 2
    row, w = row_and_fraction((sine + 1.0) * (0.5 * steps), steps)
    a, b = gather_pairs1(table, row)
    return a + (b - a) * w


@jit(inline=True, fast=True)
def phasor(cis: Floats, turns: Lanes) -> ComplexLanes:
    """exp(-2 pi j turns), to 1e-12: a table and a short Taylor series."""
    steps = len(cis) - 1
    row, w = row_and_fraction((turns - floor(turns)) * float(steps), steps)
    d = w * (2.0 * math.pi / steps)
    d2 = d * d
    cosine = 1.0 - d2 * (0.5 - d2 * (1.0 / 24.0))
    sine = d * (1.0 - d2 * (1.0 / 6.0 - d2 * (1.0 / 120.0)))
    c, s = gather2(cis, row)
    return complex_of(c * cosine - s * sine, -(s * cosine + c * sine))
