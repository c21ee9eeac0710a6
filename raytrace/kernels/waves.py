"""The field along eight rays in two polarisations, and the antennas at its ends.

A ray of direction s has the polarisations V, along tau = (z - (z . s) s) / cos_el, and H, along
psi = z x s / cos_el (docs/conventions.md).
"""

from typing import NamedTuple

from raytrace.arrays import Floats
from raytrace.kernels.compiling import chosen_by_type, jit
from raytrace.kernels.field_tables import FieldTables, between_rows, interpolated
from raytrace.kernels.lanes import (
    ComplexLanes,
    Lanes,
    MatrixLanes,
    RowLanes,
    absolute,
    complex_of,
    floor,
    lanes_of,
    matrix_of,
    maximum,
    minimum,
    row_of,
    sqrt,
    where,
)

Component = ComplexLanes | RowLanes
"""Of a field; rows where a polarisation is unknown, for both that are sent."""


class Wave(NamedTuple):
    """The field along eight rays.

    Attributes
    ----------
    v, h
        Its V and H components.
    sin_elevation
        Of the rays; a reflection at floor or ceiling changes its sign.
    bounce_count
        Reflections at floor and ceiling so far.
    """

    v: Component
    h: Component
    sin_elevation: Lanes
    bounce_count: Lanes


@jit(inner=True)
def pattern_at(
    pattern: Floats, azimuths: int, x: Lanes, y: Lanes, sine: Lanes
) -> tuple[ComplexLanes, ComplexLanes]:
    """V and H amplitudes in given directions (see `radio.tables.pattern_tables`).

    Parameters
    ----------
    pattern, azimuths
        Of one antenna, see `FieldTables`.
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
    below = between_rows(pattern, i * float(azimuths) + j, w)
    above = between_rows(pattern, (i + 1.0) * float(azimuths) + j, w)
    return below[0] * (1.0 - v) + above[0] * v, below[1] * (1.0 - v) + above[1] * v


@jit(inline=True)
def radiated(
    tables: FieldTables, direction: tuple[Lanes, Lanes], sin_elevation: Lanes
) -> tuple[ComplexLanes, ComplexLanes]:
    """V and H amplitudes of a transmitter of known polarisation."""
    if len(tables.patterns[0]) == 0:
        none = lanes_of(0.0)
        v = complex_of(interpolated(tables.transmit, sin_elevation), none)
        return v, complex_of(none, none)
    return pattern_at(
        tables.patterns[0], tables.azimuths, direction[0], direction[1], sin_elevation
    )


@jit(inline=True)
def received(tables: FieldTables, wave: Wave, direction: tuple[Lanes, Lanes]) -> Component:
    """Amplitude that a receiver of known polarisation takes."""
    if len(tables.patterns[1]) == 0:
        return wave.v * interpolated(tables.receive, -wave.sin_elevation)
    v, h = pattern_at(
        tables.patterns[1], tables.azimuths, direction[0], direction[1], -wave.sin_elevation
    )
    return v * wave.v - h * wave.h


def _launch(tables: FieldTables, direction: tuple[Lanes, Lanes], sin_elevation: Lanes) -> Wave:
    v, h = radiated(tables, direction, sin_elevation)
    return Wave(v, h, sin_elevation, lanes_of(0.0))


def _launch_rows(tables: FieldTables, direction: tuple[Lanes, Lanes], sin_elevation: Lanes) -> Wave:
    none, unknown = lanes_of(0.0), tables.unknown[0]  # pyright: ignore[reportOptionalSubscript]
    zero = complex_of(none, none)
    if unknown > 0.0:
        size = complex_of(lanes_of(unknown), none)
        return Wave(row_of(size, zero), row_of(zero, size), sin_elevation, none)
    v, h = radiated(tables, direction, sin_elevation)
    return Wave(row_of(v, zero), row_of(h, zero), sin_elevation, none)


def launch(tables: FieldTables, direction: tuple[Lanes, Lanes], sin_elevation: Lanes) -> Wave:
    """Field that the transmitter radiates along rays.

    Parameters
    ----------
    tables, sin_elevation
        The antennas, and the sines of the rays' elevations.
    direction
        Horizontal directions of departure, of length 1.
    """
    of_kind = _launch if tables.unknown is None else _launch_rows
    return of_kind(tables, direction, sin_elevation)


def _receive_rows(
    tables: FieldTables, wave: Wave, direction: tuple[Lanes, Lanes]
) -> ComplexLanes | MatrixLanes:
    unknown = tables.unknown[1]  # pyright: ignore[reportOptionalSubscript]
    if unknown > 0.0:
        return matrix_of(wave.v * unknown, wave.h * -unknown)
    row = received(tables, wave, direction)
    return matrix_of(row, row * 0.0)


def _receive(
    tables: FieldTables, wave: Wave, direction: tuple[Lanes, Lanes]
) -> ComplexLanes | MatrixLanes:
    return received(tables, wave, direction)


def receive(
    tables: FieldTables, wave: Wave, direction: tuple[Lanes, Lanes]
) -> ComplexLanes | MatrixLanes:
    """Amplitude that the receiver's antenna takes from a field.

    Where a polarisation is unknown: matrices, a row for each component that is received, a column
    for each that is sent.

    Parameters
    ----------
    tables, wave
        The antennas, and the field.
    direction
        Horizontal directions that the rays come from, of length 1.
    """
    of_kind = _receive if tables.unknown is None else _receive_rows
    return of_kind(tables, wave, direction)


chosen_by_type("unknown", _launch, _launch_rows)(launch)
chosen_by_type("unknown", _receive, _receive_rows)(receive)
