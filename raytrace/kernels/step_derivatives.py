"""Derivatives of received powers with respect to properties of materials, by the adjoint method.

The field of a path is a product of matrices (docs/theory.md, section 15). With the field before
each interaction, and the receiver's amplitude carried backwards to behind it, one pass over a path
gives the derivatives with respect to all its slabs.
"""

from typing import NamedTuple

from raytrace.arrays import Floats, Ints
from raytrace.kernels.compiling import jit
from raytrace.kernels.field_tables import FieldTables, slab_lookup
from raytrace.kernels.guard import Guard, is_stopped
from raytrace.kernels.lanes import (
    WIDTH,
    ComplexLanes,
    Lanes,
    Mask,
    any_of,
    complex_of,
    imag_of,
    lane,
    lanes_of,
    load,
    real_of,
    store,
    where,
)
from raytrace.kernels.step_gains import (
    DIFFRACTED,
    Diffraction,
    Dyad,
    Pair,
    StepLanes,
    at_wall,
    chosen,
    components,
    diffraction_of,
    into_edge,
    propagated,
    received,
    sent_component,
    size_of,
    squared,
    taken_amplitudes,
)
from raytrace.kernels.steps import (
    ACROSS,
    ALONG,
    COSINE,
    COSINE_N,
    COSINE_O,
    IN_ACROSS,
    IN_ALONG,
    MIXED_N,
    MIXED_O,
    MIXED_SHADOW,
    OUT_ACROSS,
    OUT_ALONG,
    SHADOWS,
    SQUARED_N,
    SQUARED_O,
)


class TableSlopes(NamedTuple):
    """Derivatives of the tables of slabs with respect to properties of their materials.

    Attributes
    ----------
    reflection, transmission
        (n_slots, n_slabs * slab_rows, 4) as the tables of `FieldTables`: each slab depends on up to
        `n_slots` properties; 0 for slots that a slab does not use.
    """

    reflection: Floats
    transmission: Floats


class PowerSums(NamedTuple):
    """Sums over the paths of each receiver.

    Attributes
    ----------
    power
        (n,) received over transmitted power.
    slopes
        (n, n_slabs, n_slots) its derivatives.
    """

    power: Floats
    slopes: Floats


class Scratch(NamedTuple):
    """Working arrays: fields (most, 4, 8) before the interactions, and a row (8,)."""

    fields: Floats
    row: Floats


class Work(NamedTuple):
    """Block b of paths, in work: receivers (n, 8) of all blocks."""

    receiver: Ints
    b: int


@jit(inline=True)
def load_pair(rows: Floats) -> Pair:
    """Fields of four rows."""
    v = complex_of(load(rows[0]), load(rows[1]))
    return Pair(v, complex_of(load(rows[2]), load(rows[3])))


@jit(inline=True)
def conjugate(x: ComplexLanes) -> ComplexLanes:
    """Complex conjugates."""
    return complex_of(real_of(x), imag_of(x) * -1.0)


@jit(inner=True, fast=True)
def add_slopes(
    sums: PowerSums,
    tables: tuple[Floats, int],
    work: Work,
    mask: Mask,
    at: tuple[Lanes, Lanes],
    sensitivity: tuple[ComplexLanes, ComplexLanes],
    row: Floats,
) -> None:
    """Add the derivatives that one interaction of eight paths contributes.

    Parameters
    ----------
    sums
        Added to.
    tables
        Slopes of the table looked up, and its rows for each slab.
    work, mask
        The paths, and which of them have the interaction.
    at
        Slabs and cosines of incidence.
    sensitivity
        Derivatives of the powers with respect to both entries of the table.
    row
        Scratch.
    """
    slopes, rows = tables
    for slot in range(len(slopes)):
        tm, mix = slab_lookup(slopes[slot], rows, at[0], at[1])
        change = real_of(tm * sensitivity[0] + mix * sensitivity[1])
        store(row, where(mask, change, 0.0))
        for j in range(WIDTH):
            if row[j] != 0.0:
                slab = int(lane(at[0], j))
                sums.slopes[work.receiver[work.b, j], slab, slot] += row[j]


@jit(inline=True, fast=True)
def add_wall(
    sums: PowerSums,
    slopes: TableSlopes,
    rows: int,
    code: Lanes,
    frame: Floats,
    work: Work,
    fields: tuple[Pair, Pair],
    row: Floats,
) -> None:
    """Add what reflections and transmissions contribute; `fields` are those before and behind."""
    x, y = fields
    a, b = load(frame[ALONG]), load(frame[ACROSS])
    cosine, along = load(frame[COSINE]), x.v * a + x.h * b
    reflects, transmits = (code > 0.0) & (code < DIFFRACTED), code < 0.0
    if any_of(reflects):
        at = where(reflects, code - 1.0, 0.0), cosine
        sensitivity = y.h * x.h - y.v * x.v, along * (y.v * a - y.h * b)
        table = slopes.reflection, rows
        add_slopes(sums, table, work, reflects, at, sensitivity, row)
    if any_of(transmits):
        at = where(transmits, -1.0 - code, 0.0), cosine
        sensitivity = y.h * x.h + y.v * x.v, along * (y.v * a + y.h * b)
        table = slopes.transmission, rows
        add_slopes(sums, table, work, transmits, at, sensitivity, row)


@jit(inline=True, fast=True)
def face_sensitivity(
    coefficient: ComplexLanes,
    turn: tuple[Lanes, Lanes, Lanes],
    x: Pair,
    y: Pair,
) -> tuple[ComplexLanes, ComplexLanes]:
    """Derivatives with respect to the reflection of a face, see `step_gains.face_part`.

    Parameters
    ----------
    coefficient
        What the face's reflection is multiplied by.
    turn
        Cosine of incidence; sin^2 and sin cos of the turn of the plane of incidence.
    x, y
        Field before the wedge, and amplitudes behind it, along the edge and across it.
    """
    cosine, squared, mixed = turn
    both = y.v * x.v * (1.0 - squared) - y.h * x.h * squared
    both = both + (y.v * x.h - y.h * x.v) * mixed
    return (y.h * x.h - y.v * x.v) * coefficient, both * coefficient * (1.0 - cosine * cosine)


@jit(inner=True, fast=True)
def add_wedge(
    sums: PowerSums,
    slopes: TableSlopes,
    rows: int,
    edge: tuple[Floats, Floats],
    diffraction: Diffraction,
    work: Work,
    fields: tuple[Pair, Pair, Mask],
    row: Floats,
) -> None:
    """Add what diffractions contribute.

    Parameters
    ----------
    sums, slopes, rows
        Added to; derivatives of the tables of slabs, and their rows for each slab.
    edge
        Wedges (21, 8) and slabs of their faces (2, 8), see `StepLanes`.
    diffraction, work
        Of the eight paths.
    fields
        Before and behind the edges, along them and across them; which paths there are.
    row
        Scratch.
    """
    x, y, mask = fields
    wedge, face = edge
    at_o, at_n = diffraction.at_o, diffraction.at_n
    cosine, squared = load(wedge[COSINE_O]), load(wedge[SQUARED_O])
    at = load(face[0]), cosine
    turn = cosine, squared, load(wedge[MIXED_O])
    table = slopes.reflection, rows
    add_slopes(sums, table, work, mask, at, face_sensitivity(at_o, turn, x, y), row)
    has_n = mask & (load(wedge[COSINE_N]) > 0.0)
    if any_of(has_n):
        n_cosine = load(wedge[COSINE_N])
        turn = n_cosine, load(wedge[SQUARED_N]), load(wedge[MIXED_N])
        at_face = load(face[1]), n_cosine
        sensitivity = face_sensitivity(at_n, turn, x, y)
        add_slopes(sums, table, work, has_n, at_face, sensitivity, row)
    shadow, mixed = load(wedge[SHADOWS]), load(wedge[MIXED_SHADOW])
    has_shadow = mask & (shadow > 0.0)
    if any_of(has_shadow):
        less = diffraction.incident * (shadow * -1.0)
        both = y.v * x.v * (1.0 - squared) + y.h * x.h * squared
        both = both + (y.v * x.h + y.h * x.v) * mixed
        sensitivity = (y.v * x.v + y.h * x.h) * less, both * less * (1.0 - cosine * cosine)
        table = slopes.transmission, rows
        add_slopes(sums, table, work, has_shadow, at, sensitivity, row)


@jit(inline=True, fast=True)
def before_wedge(wedge: Floats, dyad: Dyad, behind: Pair) -> Pair:
    """Carry amplitudes along an edge and across it back to V and H before it: the transpose."""
    along = dyad.along * behind.v + dyad.across_along * behind.h
    across = dyad.along_across * behind.v + dyad.across * behind.h
    a, c = load(wedge[IN_ALONG]), load(wedge[IN_ACROSS])
    return Pair(along * a - across * c, along * c + across * a)


@jit(inline=True, fast=True)
def behind_wedge(wedge: Floats, backward: Pair) -> Pair:
    """Carry amplitudes of V and H back to those along an edge and across it: the transpose."""
    a, c = load(wedge[OUT_ALONG]), load(wedge[OUT_ACROSS])
    return Pair(backward.v * a + backward.h * c, backward.h * a - backward.v * c)


@jit(inline=True, fast=True)
def backward_from(tables: FieldTables, ends: Floats, taken: Pair, scale: Lanes) -> Pair:
    """Derivatives of powers, up to their size, with respect to the fields at the receivers."""
    if len(tables.receive) == 1:
        scale = scale * tables.receive[0]
        return Pair(conjugate(taken.v) * scale, conjugate(taken.h) * scale)
    one, zero = complex_of(lanes_of(1.0), 0.0), complex_of(lanes_of(0.0), 0.0)
    of_amplitude = conjugate(taken.v) * scale
    v = received(tables, ends, Pair(one, zero))
    return Pair(v * of_amplitude, received(tables, ends, Pair(zero, one)) * of_amplitude)


@jit(inline=True, fast=True)
def add_backwards(
    tables: FieldTables,
    slopes: TableSlopes,
    lanes: StepLanes,
    diffraction: Diffraction,
    work: Work,
    end: tuple[Pair, int],
    sums: PowerSums,
    scratch: Scratch,
) -> None:
    """Add what the interactions of a block contribute, from the last one to the first.

    Parameters
    ----------
    tables, slopes, lanes, diffraction, work
        Materials, their derivatives, and the block of paths.
    end
        Amplitudes at the receivers, and the number of the diffracted block.
    sums, scratch
        Added to; the fields before the interactions, which are known.
    """
    (y, d), b, rows, row = end, work.b, tables.slab_rows, scratch.row
    for back in range(lanes.code.shape[1]):
        k = lanes.code.shape[1] - 1 - back
        code, x = load(lanes.code[b, k]), load_pair(scratch.fields[k])
        is_edge = code >= DIFFRACTED
        if any_of((code < DIFFRACTED) & ((code > 0.0) | (code < 0.0))):
            add_wall(sums, slopes, rows, code, lanes.frame[b, k], work, (x, y), row)
            y = at_wall(tables, code, lanes.frame[b, k], y, -1.0)
        if any_of(is_edge):
            wedge = lanes.wedge[d]
            behind = behind_wedge(wedge, y)
            fields = into_edge(wedge, x), behind, is_edge
            edge = wedge, lanes.face[d]
            add_wedge(sums, slopes, rows, edge, diffraction, work, fields, row)
            y = chosen(is_edge, before_wedge(wedge, diffraction.dyad, behind), y)


@jit(allocates=False, fast=True)
def add_power_slopes(
    tables: FieldTables,
    slopes: TableSlopes,
    lanes: StepLanes,
    receiver: Ints,
    weight: Floats,
    sums: PowerSums,
    scratch: Scratch,
    guard: Guard,
) -> None:
    """Add the powers of paths, and their derivatives, to those of their receivers.

    Parameters
    ----------
    tables, slopes
        Materials and antennas, and derivatives of the materials' tables.
    lanes, receiver, weight
        The paths; (n, 8) their receivers, and their weights, 0 for what fills up a block.
    sums
        Added to.
    scratch, guard
        Working arrays, and what may end the work.
    """
    undiffracted = len(lanes.code) - len(lanes.wedge)
    for b in range(len(lanes.code)):
        if is_stopped(guard):
            break
        d, work = b - undiffracted, Work(receiver, b)
        diffraction = diffraction_of(tables, lanes, d)
        size = size_of(tables, lanes, b, d) * load(weight[b])
        for component in range(components(tables)):
            sent = sent_component(tables, lanes.ends[b], component)
            field = propagated(tables, lanes, b, d, diffraction, sent, scratch.fields)
            taken = taken_amplitudes(tables, lanes.ends[b], field)
            store(scratch.row, (squared(taken.v) + squared(taken.h)) * size)
            for j in range(WIDTH):
                sums.power[receiver[b, j]] += scratch.row[j]
            y = backward_from(tables, lanes.ends[b], taken, size * 2.0)
            add_backwards(tables, slopes, lanes, diffraction, work, (y, d), sums, scratch)
