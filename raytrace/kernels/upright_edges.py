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


@jit(inline="always")
def from_face(azimuth: float, o_face: float) -> float:
    """Angle of a direction from the o-face, 0 to 2 pi."""
    phi = azimuth - o_face
    return phi - 2.0 * math.pi * math.floor(phi / (2.0 * math.pi))


@jit(inline="always")
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
    z_source = trace.source[2]
    common = common_factor(edge.wedge.n, trace.radio.wavelength)
    for hit in range(len(hits)):
        r, i = hits[hit, 0], hits[hit, 1]
        target = (trace.receivers[r, 0], trace.receivers[r, 1])
        n, length, ux, uy = unfold(trace.plan, tree.link, tree.beam, i, target, leg)
        phi = from_face(math.atan2(uy, ux), edge.o_face)
        write_angles(phi, edge.wedge.n, angles)
        free = not is_constrained(leg, n)
        heights = trace.image_z[trace.level[r]]
        field, power = 0j, 0.0
        for p in range(len(legs_in.order)):
            order = tree.link[i, ORDER] + legs_in.order[p]
            if order > trace.max_order:
                break
            leg_in = Leg(legs_in.items[p], legs_in.marks[p])
            n_in, length_in = legs_in.n_items[p], legs_in.length[p]
            free_in = not is_constrained(leg_in, n_in)
            total = length_in + length
            terms = wedge_terms(edge.wedge, phi, angles, legs_in.phi[p], legs_in.angles[p])
            size = trace.radio.wavelength / (4.0 * math.pi * math.sqrt(length_in * length * total))
            spread = math.sqrt(4.0 * math.pi / trace.radio.wavelength * length_in * length / total)
            for k in range(2 * (trace.max_order - order) + 1):
                slope = (heights[k] - z_source) / total
                z = z_source + slope * length_in
                z_edge = folded(z, trace.radio.height)
                if z_edge <= edge.z_low or z_edge >= edge.z_high:
                    continue
                if not free_in and not heights_fit(
                    trace.plan, leg_in, n_in, z_source, slope, trace.radio.height
                ):
                    continue
                if not free and not heights_fit(trace.plan, leg, n, z, slope, trace.radio.height):
                    continue
                bounces = trace.image_bounces[k]
                ray = new_ray(trace.radio, slope, bounces)
                upright, level, done = carried(
                    trace.plan,
                    trace.radio,
                    leg_in,
                    n_in,
                    length_in,
                    ray,
                    z_source,
                    (1.0 + 0j, 0j, 0),
                )
                root = math.sqrt(ray.cos_el)
                soft, hard = diffraction(trace.radio, edge.wedge, terms, spread * root, ray.cos_el)
                upright, level, done = carried(
                    trace.plan,
                    trace.radio,
                    leg,
                    n,
                    length,
                    ray,
                    z,
                    (upright * soft, level * hard, done),
                )
                turns = total / (ray.cos_el * trace.radio.wavelength)
                scale = size * root * antenna_gain(trace.radio, ray, done)
                gain = upright * scale * phasor(trace.radio.cis, turns)
                field += gain
                power += gain.real * gain.real + gain.imag * gain.imag
                sums.n_paths[r, order + bounces] += 1
                recorded(record, hit, p, (-1, k), gain * common)
        sums.field[r] += field * common
        sums.power[r] += power * (common.real * common.real + common.imag * common.imag)
