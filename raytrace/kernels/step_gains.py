"""Gains of paths from their steps: eight paths at a time, of any kinds.

The steps are those of `raytrace.kernels.steps`, with the paths along the last axis, so that eight
neighbours are loaded at once. Neighbours should have the same kinds of interactions in the same
order: what any of the eight has is computed for all.
"""

import math
from typing import Any, NamedTuple

from raytrace.arrays import Floats
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
    """The steps of n paths, n a multiple of eight, path by path along the last axis.

    Attributes
    ----------
    code
        (most, n) of each interaction: slab + 1 of a reflection, -slab - 1 of a transmission,
        `DIFFRACTED`, or 0 for none.
    frame
        (most, 3, n) see `Steps.frame`.
    ends
        (8, n) see `Steps.ends`.
    wedge
        (21, n_diffracted) see `Steps.wedge`; of the last paths, which are those with a diffraction.
    face
        (2, n_diffracted) slabs of the faces, 0 for paths without diffraction.
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
def at_wall(
    tables: FieldTables, code: Lanes, frame: Floats, i: int, field: Pair, way: float
) -> Pair:
    """Carry eight paths through a reflection or a transmission; the others stay as they are.

    Parameters
    ----------
    tables
        The materials.
    code, frame, i
        The interactions, see `StepLanes`; of the paths from i on.
    field, way
        Fields before it to those behind it for 1; for -1 amplitudes behind it to those before it,
        by the transpose, which is that of the opposite `ACROSS` for a reflection, and the same for
        a transmission.
    """
    a, b = load(frame[ALONG, i:]), load(frame[ACROSS, i:])
    cosine = load(frame[COSINE, i:])
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
def wedge_term_of(tables: FieldTables, wedge: Floats, i: int, k: int, scale: Lanes) -> ComplexLanes:
    """One of the four terms (docs/theory.md, eq. 17)."""
    factor, size = load(wedge[FACTOR_0 + 2 * k, i:]), load(wedge[FACTOR_0 + 2 * k + 1, i:])
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
def dyad_of(tables: FieldTables, lanes: StepLanes, i: int, terms: tuple[Any, Any, Any]) -> Dyad:
    """What the wedges of eight paths make of a field."""
    wedge, face = lanes.wedge, lanes.face
    incident, at_n, at_o = terms
    cosine, squared = load(wedge[COSINE_O, i:]), load(wedge[SQUARED_O, i:])
    slab, mixed = load(face[0, i:]), load(wedge[MIXED_O, i:])
    te, mx, tm = face_part(tables, slab, cosine, squared, mixed)
    te, mx, tm = te * at_o, mx * at_o, tm * at_o
    if any_of(load(wedge[COSINE_N, i:]) > 0.0):
        n_cosine, n_squared = load(wedge[COSINE_N, i:]), load(wedge[SQUARED_N, i:])
        n_te, n_mx, n_tm = face_part(
            tables, load(face[1, i:]), n_cosine, n_squared, load(wedge[MIXED_N, i:])
        )
        te, mx, tm = te + n_te * at_n, mx + n_mx * at_n, tm + n_tm * at_n
    shadow = load(wedge[SHADOWS, i:])
    along, across = incident, incident
    crossed = complex_of(lanes_of(0.0), 0.0)
    if any_of(shadow > 0.0):
        through_tm, mix = slab_lookup(tables.transmission, tables.slab_rows, slab, cosine)
        difference = mix * (1.0 - cosine * cosine)
        crossed = incident * difference * (load(wedge[MIXED_SHADOW, i:]) * -shadow)
        along = incident * (1.0 - (through_tm + difference * (1.0 - squared)) * shadow)
        across = incident * (1.0 - (through_tm + difference * squared) * shadow)
    return Dyad(along + te, crossed + mx, crossed - mx, across + tm)


@jit(inline=True, fast=True)
def into_edge(wedge: Floats, i: int, field: Pair) -> Pair:
    """Components of a field along an edge and across it."""
    along, across = load(wedge[IN_ALONG, i:]), load(wedge[IN_ACROSS, i:])
    return Pair(field.v * along + field.h * across, field.h * along - field.v * across)


@jit(inline=True, fast=True)
def out_of_edge(wedge: Floats, i: int, field: Pair) -> Pair:
    """V and H of a field that is given along an edge and across it."""
    along, across = load(wedge[OUT_ALONG, i:]), load(wedge[OUT_ACROSS, i:])
    return Pair(field.v * along - field.h * across, field.v * across + field.h * along)


@jit(inline=True, fast=True)
def after_wedge(dyad: Dyad, field: Pair) -> Pair:
    """Field behind a wedge, along its edge and across it."""
    return Pair(
        field.v * dyad.along + field.h * dyad.along_across,
        field.v * dyad.across_along + field.h * dyad.across,
    )


@jit(inline=True, fast=True)
def launched(tables: FieldTables, ends: Floats, i: int) -> Pair:
    """Fields that the transmitter radiates along eight paths."""
    direction = load(ends[LAUNCH_X, i:]), load(ends[LAUNCH_Y, i:])
    wave = launch(tables, direction, load(ends[LAUNCH_SINE, i:]))
    return Pair(wave.v, wave.h)


@jit(inline=True, fast=True)
def received(tables: FieldTables, ends: Floats, i: int, field: Pair) -> ComplexLanes:
    """Amplitudes that the receivers' antenna takes from fields."""
    direction = load(ends[ARRIVAL_X, i:]), load(ends[ARRIVAL_Y, i:])
    wave = Wave(field.v, field.h, load(ends[ARRIVAL_SINE, i:]), lanes_of(0.0))
    return receive(tables, wave, direction)


@jit(inline=True, fast=True)
def no_wedge() -> Diffraction:
    """What stands for the wedges of paths without a diffraction."""
    zero = complex_of(lanes_of(0.0), 0.0)
    return Diffraction(zero, zero, zero, Dyad(zero, zero, zero, zero))


@jit(inline=True, fast=True)
def diffraction_of(tables: FieldTables, lanes: StepLanes, w: int) -> Diffraction:
    """What diffracts eight paths, the first of which is diffracted path w; w < 0 for none."""
    if w < 0:
        return no_wedge()
    scale = load(lanes.wedge[ROOT_2KL, w:]) * (1.0 / math.sqrt(tables.wavelength))
    incident = wedge_term_of(tables, lanes.wedge, w, 0, scale)
    incident = incident + wedge_term_of(tables, lanes.wedge, w, 1, scale)
    at_n = wedge_term_of(tables, lanes.wedge, w, 2, scale)
    at_o = wedge_term_of(tables, lanes.wedge, w, 3, scale)
    return Diffraction(incident, at_n, at_o, dyad_of(tables, lanes, w, (incident, at_n, at_o)))


@jit(inline=True, fast=True)
def propagated(
    tables: FieldTables,
    lanes: StepLanes,
    i: int,
    w: int,
    diffraction: Diffraction,
    fields: Floats,
) -> Pair:
    """Fields at the ends of eight paths.

    Parameters
    ----------
    tables, lanes
        Materials, antennas and paths.
    i, w
        The first of the eight, and its number among those with a diffraction; below 0 for none.
    diffraction
        Of the eight.
    fields
        (most, 4, 8) is filled with the fields before each interaction; (0, 4, 8) if these are not
        wanted.
    """
    field = launched(tables, lanes.ends, i)
    for k in range(len(lanes.code)):
        if k < len(fields):
            store_pair(fields[k], field)
        code = load(lanes.code[k, i:])
        is_edge = code >= DIFFRACTED
        if any_of(is_edge):
            after = after_wedge(diffraction.dyad, into_edge(lanes.wedge, w, field))
            field = chosen(is_edge, out_of_edge(lanes.wedge, w, after), field)
        if any_of((code < DIFFRACTED) & ((code > 0.0) | (code < 0.0))):
            field = at_wall(tables, code, lanes.frame[k], i, field, 1.0)
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


@jit(inline=True, fast=True)
def scale_of(tables: FieldTables, lanes: StepLanes, i: int, w: int) -> ComplexLanes:
    """What multiplies received amplitudes: spreading, phase, the factor of diffraction."""
    turns = load(lanes.ends[LENGTH, i:]) * (1.0 / tables.wavelength)
    spreading = load(lanes.ends[SPREADING, i:]) * (tables.wavelength / (4.0 * math.pi))
    scale = phasor(tables.cis, turns) * spreading
    if w >= 0:
        is_diffracted = load(lanes.wedge[ROOT_2KL, w:]) > 0.0
        factor = common_factor(1.0, tables.wavelength)
        scale = where_complex(is_diffracted, scale * factor, scale)
    return scale


@jit(allocates=False, fast=True)
def write_gains(
    tables: FieldTables, lanes: StepLanes, fields: Floats, real: Floats, imag: Floats
) -> None:
    """Write the gains of all paths to two arrays (n,); `fields` is (0, 4, 8)."""
    undiffracted = lanes.code.shape[1] - lanes.wedge.shape[1]
    for i in range(0, lanes.code.shape[1], WIDTH):
        w = i - undiffracted
        field = propagated(tables, lanes, i, w, diffraction_of(tables, lanes, w), fields)
        gain = received(tables, lanes.ends, i, field) * scale_of(tables, lanes, i, w)
        store(real[i:], real_of(gain))
        store(imag[i:], imag_of(gain))
