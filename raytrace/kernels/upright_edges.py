"""Paths that are diffracted at a vertical edge.

Height is linear in the unfolded distance through the edge too, so a path is a leg from the
source to the edge, a leg from the edge to the receiver, and one image height for both.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from raytrace.kernels.beams import ORDER, Tree
from raytrace.kernels.compiling import jit
from raytrace.kernels.field import antenna_gain, carried, new_ray, phasor
from raytrace.kernels.plan_view import Floats, Ints, folded
from raytrace.kernels.tracing import Record, Sums, Trace, recorded
from raytrace.kernels.unfolding import (
    Leg,
    heights_fit,
    is_constrained,
    most_items,
    unfold,
)
from raytrace.kernels.utd import (
    COSINE_HALF,
    COSINE_WEDGE,
    ROOT_N,
    ROOT_O,
    SINE_HALF,
    SINE_WEDGE,
    Wedge,
    WedgeTerms,
    common_factor,
    diffraction,
    wedge_terms,
)


class Edge(NamedTuple):
    """A vertical edge.

    Attributes
    ----------
    x, y, z_low, z_high
        Where it stands [m].
    o_face
        Azimuth of its o-face [rad].
    wedge
        Its angle and faces.
    """

    x: float
    y: float
    z_low: float
    z_high: float
    o_face: float
    wedge: Wedge


class LegsIn(NamedTuple):
    """The legs from the source to an edge, by rising number of reflections.

    Attributes
    ----------
    order, n_items, length, phi
        (n,) reflections, items, horizontal length [m] and angle from the o-face [rad].
    angles
        (n, 6) see `write_angles`.
    items, marks
        (n, most, 5), (n, most, 2) their legs.
    """

    order: Ints
    n_items: Ints
    length: Floats
    phi: Floats
    angles: Floats
    items: Floats
    marks: Ints


@jit(inline=True)
def from_face(azimuth: float, o_face: float) -> float:
    """Angle of a direction from the o-face, 0 to 2 pi."""
    phi = azimuth - o_face
    return phi - 2.0 * math.pi * math.floor(phi / (2.0 * math.pi))


@jit(inline=True)
def write_angles(phi: float, n: float, row: Floats) -> None:
    """Functions of an angle from the o-face that the wedge terms are made of."""
    row[COSINE_HALF], row[SINE_HALF] = math.cos(phi / 2.0), math.sin(phi / 2.0)
    row[COSINE_WEDGE], row[SINE_WEDGE] = math.cos(phi / (2.0 * n)), math.sin(phi / (2.0 * n))
    row[ROOT_O] = math.sqrt(abs(math.sin(phi)))
    row[ROOT_N] = math.sqrt(abs(math.sin(n * math.pi - phi)))


@jit()
def legs_to_edge(trace: Trace, tree: Tree, beams: NDArray[np.int32], edge: Edge) -> LegsIn:
    """Unfold the legs from the source to an edge.

    Parameters
    ----------
    trace, tree
        The trace and the beams from the source.
    beams
        (n,) beams that light the edge, by rising order.
    edge
        The edge; legs that arrive within its wall are left out.
    """
    n_beams, most = len(beams), most_items(tree.link)
    legs = LegsIn(
        np.empty(n_beams, np.int64),
        np.empty(n_beams, np.int64),
        np.empty(n_beams),
        np.empty(n_beams),
        np.empty((n_beams, 6)),
        np.empty((n_beams, most, 5)),
        np.empty((n_beams, most, 2), np.int64),
    )
    kept = 0
    for i in beams:
        azimuth = math.atan2(tree.beam[i, 1] - edge.y, tree.beam[i, 0] - edge.x)
        phi = from_face(azimuth, edge.o_face)
        if phi > edge.wedge.n * math.pi + 1e-12:
            continue
        leg = Leg(legs.items[kept], legs.marks[kept])
        n, length, _, _ = unfold(trace.plan, tree.link, tree.beam, i, (edge.x, edge.y), leg)
        legs.order[kept], legs.n_items[kept] = tree.link[i, ORDER], n
        legs.length[kept], legs.phi[kept] = length, phi
        write_angles(phi, edge.wedge.n, legs.angles[kept])
        kept += 1
    return LegsIn(
        legs.order[:kept],
        legs.n_items[:kept],
        legs.length[:kept],
        legs.phi[:kept],
        legs.angles[:kept],
        legs.items[:kept],
        legs.marks[:kept],
    )


class Pair(NamedTuple):
    """A leg to the edge with a leg from it, and what does not depend on heights.

    Attributes
    ----------
    leg_in, n_in, length_in
        The leg to the edge, its items, its horizontal length [m].
    leg_out, n_out, length_out
        The leg from the edge.
    terms
        The two directions at the wedge.
    """

    leg_in: Leg
    n_in: int
    length_in: float
    leg_out: Leg
    n_out: int
    length_out: float
    terms: WedgeTerms


@jit(inline=True)
def pair_fits(trace: Trace, edge: Edge, pair: Pair, slope: float) -> bool:
    """Whether the edge stands where the path meets it, and the walls fit the path's heights."""
    height = trace.radio.height
    z_root = trace.source[2]
    z = z_root + slope * pair.length_in
    z_edge = folded(z, height)
    fits = edge.z_low < z_edge < edge.z_high
    if fits and is_constrained(pair.leg_in, pair.n_in):
        fits = heights_fit(trace.plan, pair.leg_in, pair.n_in, z_root, slope, height)
    if fits and is_constrained(pair.leg_out, pair.n_out):
        fits = heights_fit(trace.plan, pair.leg_out, pair.n_out, z, slope, height)
    return fits


@jit(inline=True, fast=True)
def pair_gain(trace: Trace, edge: Edge, pair: Pair, slope: float, bounces: int) -> complex:
    """Gain of a path, without the wedge's common factor (docs/theory.md, eqs. 16-20).

    With every length its horizontal part over cos_el, and sin beta = cos_el, the spreading factor
    1 / (sqrt(s s' (s + s')) sin beta) is sqrt(cos_el) over the root of the horizontal parts.
    """
    plan, radio = trace.plan, trace.radio
    total = pair.length_in + pair.length_out
    product = pair.length_in * pair.length_out
    z_root = trace.source[2]
    ray = new_ray(radio, slope, bounces)
    root = math.sqrt(ray.cos_el)
    field = (1.0 + 0j, 0j, 0)
    upright, level, done = carried(
        plan, radio, pair.leg_in, pair.n_in, pair.length_in, ray, z_root, field
    )
    spread = math.sqrt(4.0 * math.pi / radio.wavelength * product / total) * root
    soft, hard = diffraction(radio, edge.wedge, pair.terms, spread, ray.cos_el)
    z_edge = z_root + slope * pair.length_in
    field = (upright * soft, level * hard, done)
    upright, level, done = carried(
        plan, radio, pair.leg_out, pair.n_out, pair.length_out, ray, z_edge, field
    )
    size = radio.wavelength / (4.0 * math.pi * math.sqrt(product * total))
    size *= root * antenna_gain(radio, ray, done)
    return upright * size * phasor(radio.cis, total / (ray.cos_el * radio.wavelength))


@jit(fast=True, allocates=False)
def sum_upright_edge(
    trace: Trace,
    edge: Edge,
    legs_in: LegsIn,
    tree: Tree,
    hits: NDArray[np.int32],
    work: tuple[Leg, Floats],
    sums: Sums,
    record: Record,
) -> None:
    """Add the paths that one edge diffracts.

    Parameters
    ----------
    trace, edge
        The trace and the edge.
    legs_in
        Legs from the source.
    tree, hits
        Beams from the edge, and the receivers they light (n, 2).
    work
        Room for the longest leg and for six functions of an angle.
    sums, record
        Added to.
    """
    leg, angles = work
    common = common_factor(edge.wedge.n, trace.radio.wavelength)
    for hit in range(len(hits)):
        r, i = hits[hit, 0], hits[hit, 1]
        target = (trace.receivers[r, 0], trace.receivers[r, 1])
        n, length, ux, uy = unfold(trace.plan, tree.link, tree.beam, i, target, leg)
        phi = from_face(math.atan2(uy, ux), edge.o_face)
        write_angles(phi, edge.wedge.n, angles)
        field, power = 0j, 0.0
        for p in range(len(legs_in.order)):
            order = tree.link[i, ORDER] + legs_in.order[p]
            if order > trace.max_order:
                break
            leg_in = Leg(legs_in.items[p], legs_in.marks[p])
            length_in = legs_in.length[p]
            terms = wedge_terms(edge.wedge, phi, angles, legs_in.phi[p], legs_in.angles[p])
            pair = Pair(leg_in, legs_in.n_items[p], length_in, leg, n, length, terms)
            for k in range(2 * (trace.max_order - order) + 1):
                rise = trace.image_z[trace.level[r], k] - trace.source[2]
                slope = rise / (length_in + length)
                if not pair_fits(trace, edge, pair, slope):
                    continue
                bounces = trace.image_bounces[k]
                gain = pair_gain(trace, edge, pair, slope, bounces)
                field += gain
                power += gain.real * gain.real + gain.imag * gain.imag
                sums.n_paths[r, order + bounces] += 1
                recorded(record, hit, p, (-1, k), gain * common)
        sums.field[r] += field * common
        sums.power[r] += power * (common.real * common.real + common.imag * common.imag)
