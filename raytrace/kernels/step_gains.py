"""Gains of paths from their steps: eight paths at a time, of any kinds.

The steps are those of `raytrace.kernels.steps` in blocks of eight paths, one block after the other:
an evaluation reads memory once from its beginning to its end, which takes most of its time. The
paths of a block should have the same kinds of interactions in the same order: what any of the eight
has is computed for all.
"""

import math
from typing import Any, NamedTuple

from raytrace.arrays import Floats, Ints
from raytrace.kernels.compiling import jit
from raytrace.kernels.field_tables import FieldTables, phasor, slab_lookup
from raytrace.kernels.lanes import (
    WIDTH,
    ComplexLanes,
    Lanes,
    Mask,
    any_of,
    complex_of,
    imag_of,
    lanes_of,
    load,
    minimum,
    real_of,
    store,
    where,
    where_complex,
)
from raytrace.kernels.steps import (
    ACROSS,
    ALONG,
    ARRIVAL_SINE,
    ARRIVAL_X,
    ARRIVAL_Y,
    COSINE,
    COSINE_N,
    COSINE_O,
    FACTOR_0,
    IN_ACROSS,
    IN_ALONG,
    LAUNCH_SINE,
    LAUNCH_X,
    LAUNCH_Y,
    LENGTH,
    MIXED_N,
    MIXED_O,
    MIXED_SHADOW,
    OUT_ACROSS,
    OUT_ALONG,
    ROOT_2KL,
    SHADOWS,
    SPREADING,
    SQUARED_N,
    SQUARED_O,
)
from raytrace.kernels.utd import common_factor, transition_ratio
from raytrace.kernels.waves import Wave, launch, receive

DIFFRACTED = 1e6
"""Code of a diffraction in `StepLanes.code`."""


class StepLanes(NamedTuple):
    """The steps of n blocks of eight paths.

    Attributes
    ----------
    code
        (n, most, 8) of each interaction: slab + 1 of a reflection, -slab - 1 of a transmission,
        `DIFFRACTED`, or 0 for none.
    frame
        (n, most, 3, 8) see `Steps.frame`.
    ends
        (n, 8, 8) see `Steps.ends`.
    wedge
        (n_diffracted, 21, 8) see `Steps.wedge`; of the last blocks, whose paths have a diffraction.
    face
        (n_diffracted, 2, 8) slabs of the faces.
    """

    code: Floats
    frame: Floats
    ends: Floats
    wedge: Floats
    face: Floats


class Pair(NamedTuple):
    """Components of the fields of eight paths in two polarisations."""

    v: ComplexLanes
    h: ComplexLanes


class Dyad(NamedTuple):
    """What a wedge makes of a field along its edge and across it, see `utd.diffracted`."""

    along: ComplexLanes
    along_across: ComplexLanes
    across_along: ComplexLanes
    across: ComplexLanes


class Diffraction(NamedTuple):
    """The wedges of eight paths.

    Attributes
    ----------
    incident, at_n, at_o
        Coefficients of the incident field, and of reflections at the n-face and the o-face, which
        no material changes.
    dyad
        What they make of a field.
    """

    incident: ComplexLanes
    at_n: ComplexLanes
    at_o: ComplexLanes
    dyad: Dyad


@jit(inline=True, fast=True)
def at_wall(tables: FieldTables, code: Lanes, frame: Floats, field: Pair, way: float) -> Pair:
    """Carry eight paths through a reflection or a transmission; the others stay as they are.

    Parameters
    ----------
    tables
        The materials.
    code, frame
        The interactions (8,) and (3, 8), see `StepLanes`.
    field, way
        Fields before it to those behind it for 1; for -1 amplitudes behind it to those before it,
        by the transpose, which is that of the opposite `ACROSS` for a reflection, and the same for
        a transmission.
    """
    a, b = load(frame[ALONG]), load(frame[ACROSS])
    cosine = load(frame[COSINE])
    v, h = field
    reflects, transmits = (code > 0.0) & (code < DIFFRACTED), code < 0.0
    if any_of(reflects):
        slab, across = where(reflects, code - 1.0, 0.0), b * way
        tm, mix = slab_lookup(tables.reflection, tables.slab_rows, slab, cosine)
        t = (field.v * a + field.h * across) * mix
        v = where_complex(reflects, t * a - tm * field.v, v)
        h = where_complex(reflects, tm * field.h - t * across, h)
    if any_of(transmits):
        slab = where(transmits, -1.0 - code, 0.0)
        tm, mix = slab_lookup(tables.transmission, tables.slab_rows, slab, cosine)
        t = (field.v * a + field.h * b) * mix
        v = where_complex(transmits, tm * field.v + t * a, v)
        h = where_complex(transmits, tm * field.h + t * b, h)
    return Pair(v, h)


@jit(inline=True, fast=True)
def wedge_term_of(tables: FieldTables, wedge: Floats, k: int, scale: Lanes) -> ComplexLanes:
    """One of the four terms (docs/theory.md, eq. 17)."""
    factor, size = load(wedge[FACTOR_0 + 2 * k]), load(wedge[FACTOR_0 + 2 * k + 1])
    if not any_of((size > 0.0) | (size < 0.0)):
        return complex_of(lanes_of(0.0), 0.0)
    return transition_ratio(tables.transition, scale * factor) * (scale * size)


@jit(inline=True, fast=True)
def face_part(
    tables: FieldTables, slab: Lanes, cosine: Lanes, squared: Lanes, mixed: Lanes
) -> tuple[ComplexLanes, ComplexLanes, ComplexLanes]:
    """Reflection of a face: along to along, mixed, across to across (see `utd.face_dyad`)."""
    tm, mix = slab_lookup(tables.reflection, tables.slab_rows, slab, cosine)
    both = mix * (1.0 - cosine * cosine)
    return both * (1.0 - squared) - tm, both * mixed, tm - both * squared


@jit(inline=True, fast=True)
def dyad_of(tables: FieldTables, wedge: Floats, face: Floats, terms: tuple[Any, Any, Any]) -> Dyad:
    """What the wedges of eight paths make of a field."""
    incident, at_n, at_o = terms
    cosine, squared = load(wedge[COSINE_O]), load(wedge[SQUARED_O])
    slab, mixed = load(face[0]), load(wedge[MIXED_O])
    te, mx, tm = face_part(tables, slab, cosine, squared, mixed)
    te, mx, tm = te * at_o, mx * at_o, tm * at_o
    if any_of(load(wedge[COSINE_N]) > 0.0):
        n_cosine, n_squared = load(wedge[COSINE_N]), load(wedge[SQUARED_N])
        n_te, n_mx, n_tm = face_part(
            tables, load(face[1]), n_cosine, n_squared, load(wedge[MIXED_N])
        )
        te, mx, tm = te + n_te * at_n, mx + n_mx * at_n, tm + n_tm * at_n
    shadow = load(wedge[SHADOWS])
    along, across = incident, incident
    crossed = complex_of(lanes_of(0.0), 0.0)
    if any_of(shadow > 0.0):
        through_tm, mix = slab_lookup(tables.transmission, tables.slab_rows, slab, cosine)
        difference = mix * (1.0 - cosine * cosine)
        crossed = incident * difference * (load(wedge[MIXED_SHADOW]) * -shadow)
        along = incident * (1.0 - (through_tm + difference * (1.0 - squared)) * shadow)
        across = incident * (1.0 - (through_tm + difference * squared) * shadow)
    return Dyad(along + te, crossed + mx, crossed - mx, across + tm)


@jit(inline=True, fast=True)
def into_edge(wedge: Floats, field: Pair) -> Pair:
    """Components of a field along an edge and across it."""
    along, across = load(wedge[IN_ALONG]), load(wedge[IN_ACROSS])
    return Pair(field.v * along + field.h * across, field.h * along - field.v * across)


@jit(inline=True, fast=True)
def out_of_edge(wedge: Floats, field: Pair) -> Pair:
    """V and H of a field that is given along an edge and across it."""
    along, across = load(wedge[OUT_ALONG]), load(wedge[OUT_ACROSS])
    return Pair(field.v * along - field.h * across, field.v * across + field.h * along)


@jit(inline=True, fast=True)
def after_wedge(dyad: Dyad, field: Pair) -> Pair:
    """Field behind a wedge, along its edge and across it."""
    return Pair(
        field.v * dyad.along + field.h * dyad.along_across,
        field.v * dyad.across_along + field.h * dyad.across,
    )


@jit(inline=True, fast=True)
def launched(tables: FieldTables, ends: Floats) -> Pair:
    """Fields that the transmitter radiates along eight paths."""
    direction = load(ends[LAUNCH_X]), load(ends[LAUNCH_Y])
    wave = launch(tables, direction, load(ends[LAUNCH_SINE]))
    return Pair(wave.v, wave.h)


@jit(inline=True, fast=True)
def received(tables: FieldTables, ends: Floats, field: Pair) -> ComplexLanes:
    """Amplitudes that the receivers' antenna takes from fields."""
    direction = load(ends[ARRIVAL_X]), load(ends[ARRIVAL_Y])
    wave = Wave(field.v, field.h, load(ends[ARRIVAL_SINE]), lanes_of(0.0))
    return receive(tables, wave, direction)


@jit(inline=True, fast=True)
def no_wedge() -> Diffraction:
    """What stands for the wedges of paths without a diffraction."""
    zero = complex_of(lanes_of(0.0), 0.0)
    return Diffraction(zero, zero, zero, Dyad(zero, zero, zero, zero))


@jit(inline=True, fast=True)
def diffraction_of(tables: FieldTables, lanes: StepLanes, d: int) -> Diffraction:
    """What diffracts the paths of diffracted block d; d < 0 for blocks without diffraction."""
    if d < 0:
        return no_wedge()
    wedge = lanes.wedge[d]
    scale = load(wedge[ROOT_2KL]) * (1.0 / math.sqrt(tables.wavelength))
    incident = wedge_term_of(tables, wedge, 0, scale) + wedge_term_of(tables, wedge, 1, scale)
    at_n, at_o = wedge_term_of(tables, wedge, 2, scale), wedge_term_of(tables, wedge, 3, scale)
    dyad = dyad_of(tables, wedge, lanes.face[d], (incident, at_n, at_o))
    return Diffraction(incident, at_n, at_o, dyad)


@jit(inline=True, fast=True)
def propagated(
    tables: FieldTables,
    lanes: StepLanes,
    b: int,
    d: int,
    diffraction: Diffraction,
    field: Pair,
    fields: Floats,
) -> Pair:
    """Fields at the ends of the paths of a block.

    Parameters
    ----------
    tables, lanes
        Materials, antennas and paths.
    b, d
        Number of the block, and its number among those with a diffraction; below 0 for others.
    diffraction
        Of the block.
    field
        What is launched.
    fields
        (most, 4, 8) is filled with the fields before each interaction; (0, 4, 8) if these are not
        wanted.
    """
    for k in range(lanes.code.shape[1]):
        code = load(lanes.code[b, k])
        if not any_of((code > 0.0) | (code < 0.0)):
            break
        if k < len(fields):
            store_pair(fields[k], field)
        is_edge = code >= DIFFRACTED
        if any_of(is_edge):
            wedge = lanes.wedge[d]
            after = after_wedge(diffraction.dyad, into_edge(wedge, field))
            field = chosen(is_edge, out_of_edge(wedge, after), field)
        if any_of((code < DIFFRACTED) & ((code > 0.0) | (code < 0.0))):
            field = at_wall(tables, code, lanes.frame[b, k], field, 1.0)
    return field


@jit(inline=True)
def store_pair(rows: Floats, field: Pair) -> None:
    """Write fields to four rows."""
    store(rows[0], real_of(field.v))
    store(rows[1], imag_of(field.v))
    store(rows[2], real_of(field.h))
    store(rows[3], imag_of(field.h))


@jit(inline=True, fast=True)
def chosen(mask: Mask, one: Pair, other: Pair) -> Pair:
    """The first field where the mask is true, the other one elsewhere."""
    return Pair(where_complex(mask, one.v, other.v), where_complex(mask, one.h, other.h))


@jit(inline=True)
def components(tables: FieldTables) -> int:
    """Number of fields to launch: 2 if the transmitter's polarisation is unknown."""
    return 2 if len(tables.transmit) == 1 else 1


@jit(inline=True, fast=True)
def sent_component(tables: FieldTables, ends: Floats, component: int) -> Pair:
    """Field to launch, or one of the two components of an unknown polarisation."""
    if len(tables.transmit) != 1:
        return launched(tables, ends)
    zero, size = complex_of(lanes_of(0.0), 0.0), complex_of(lanes_of(tables.transmit[0]), 0.0)
    return Pair(size, zero) if component == 0 else Pair(zero, size)


@jit(inline=True, fast=True)
def taken_amplitudes(tables: FieldTables, ends: Floats, field: Pair) -> Pair:
    """Amplitudes that the receiver takes, whose powers add up; one of them is 0 if it takes one."""
    if len(tables.receive) == 1:
        return Pair(field.v * tables.receive[0], field.h * tables.receive[0])
    return Pair(received(tables, ends, field), complex_of(lanes_of(0.0), 0.0))


@jit(inline=True, fast=True)
def squared(x: ComplexLanes) -> Lanes:
    """Squared magnitudes."""
    re, im = real_of(x), imag_of(x)
    return re * re + im * im


@jit(inline=True, fast=True)
def scale_of(tables: FieldTables, lanes: StepLanes, b: int, d: int) -> ComplexLanes:
    """What multiplies received amplitudes: spreading, phase, the factor of diffraction."""
    turns = load(lanes.ends[b, LENGTH]) * (1.0 / tables.wavelength)
    spreading = load(lanes.ends[b, SPREADING]) * (tables.wavelength / (4.0 * math.pi))
    scale = phasor(tables.cis, turns) * spreading
    if d >= 0:
        scale = scale * common_factor(1.0, tables.wavelength)
    return scale


@jit(inline=True, fast=True)
def size_of(tables: FieldTables, lanes: StepLanes, b: int, d: int) -> Lanes:
    """Squared magnitudes of what multiplies received amplitudes, see `scale_of`."""
    spreading = load(lanes.ends[b, SPREADING]) * (tables.wavelength / (4.0 * math.pi))
    size = spreading * spreading
    if d >= 0:
        size = size * (tables.wavelength * (1.0 / (16.0 * math.pi * math.pi)))
    return size


@jit(allocates=False, fast=True)
def write_gains(
    tables: FieldTables, lanes: StepLanes, fields: Floats, real: Floats, imag: Floats
) -> None:
    """Write the gains of all paths to two arrays (n, 8); `fields` is (0, 4, 8)."""
    undiffracted = len(lanes.code) - len(lanes.wedge)
    for b in range(len(lanes.code)):
        d = b - undiffracted
        field = launched(tables, lanes.ends[b])
        field = propagated(tables, lanes, b, d, diffraction_of(tables, lanes, d), field, fields)
        gain = received(tables, lanes.ends[b], field) * scale_of(tables, lanes, b, d)
        store(real[b], real_of(gain))
        store(imag[b], imag_of(gain))


@jit(allocates=False, fast=True)
def add_powers(
    tables: FieldTables,
    lanes: StepLanes,
    receiver: Ints,
    weight: Floats,
    scratch: tuple[Floats, Floats],
    power: Floats,
) -> None:
    """Add the powers of paths, each at most 1, to those of their receivers.

    Parameters
    ----------
    tables, lanes
        Materials, antennas (`transmit` or `receive` of one element for an unknown polarisation)
        and paths.
    receiver, weight
        (n, 8) of the paths; the weight is 0 for what fills up a block.
    scratch
        Working arrays (0, 4, 8) and (8,).
    power
        (n_receivers,) added to.
    """
    (fields, row), undiffracted = scratch, len(lanes.code) - len(lanes.wedge)
    for b in range(len(lanes.code)):
        d = b - undiffracted
        diffraction, power_of_all = diffraction_of(tables, lanes, d), lanes_of(0.0)
        for component in range(components(tables)):
            sent = sent_component(tables, lanes.ends[b], component)
            field = propagated(tables, lanes, b, d, diffraction, sent, fields)
            taken = taken_amplitudes(tables, lanes.ends[b], field)
            power_of_all = power_of_all + squared(taken.v) + squared(taken.h)
        one = minimum(power_of_all * size_of(tables, lanes, b, d), 1.0)
        store(row, one * load(weight[b]))
        for j in range(WIDTH):
            power[receiver[b, j]] += row[j]
