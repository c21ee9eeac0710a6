"""Paths that are diffracted at a vertical edge.

Height is linear in the unfolded distance through the edge too, so a path is a leg from the
source to the edge, a leg from the edge to the receiver, and one image height for both.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from raytrace.kernels.beams import IMAGE_X, IMAGE_Y, ORDER, Hits, Tree
from raytrace.kernels.compiling import jit
from raytrace.kernels.field import arriving_sine, carried, new_ray, phasor, received, sent
from raytrace.kernels.plan_view import TIE_M, Floats, Ints, folded
from raytrace.kernels.tracing import (
    Record,
    Sums,
    Trace,
    add_bundle,
    free_space,
    leave_out,
    leg_bound,
    no_paths,
    recorded,
    straight_line,
    with_path,
)
from raytrace.kernels.unfolding import (
    MISFIT,
    NUDGE_M,
    TOUCHING,
    Leg,
    is_constrained,
    most_items,
    unfold,
    walls_met,
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
    diffracted,
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
    share
        (n,) share at a tie.
    departure
        (n, 2) horizontal direction at the source.
    bound
        (n,) see `tracing.leg_bound`.
    constrained
        (n,) whether heights matter to it, see `unfolding.is_constrained`.
    angles
        (n, 6) see `write_angles`.
    items, marks
        (n, most, 5), (n, most, 2) their legs.
    """

    order: Ints
    n_items: Ints
    length: Floats
    phi: Floats
    share: Floats
    departure: Floats
    bound: Floats
    constrained: NDArray[np.bool_]
    angles: Floats
    items: Floats
    marks: Ints


ALONG_FACE_RAD = 1e-9
"""A direction this near to a face of a wedge lies in it."""


@jit(inline=True)
def from_face(azimuth: float, o_face: float) -> float:
    """Angle of a direction from the o-face, 0 to 2 pi."""
    phi = azimuth - o_face + ALONG_FACE_RAD
    return phi - 2.0 * math.pi * math.floor(phi / (2.0 * math.pi)) - ALONG_FACE_RAD


@jit(inline=True)
def write_angles(phi: float, n: float, row: Floats) -> None:
    """Functions of an angle from the o-face that the wedge terms are made of."""
    row[COSINE_HALF], row[SINE_HALF] = math.cos(phi / 2.0), math.sin(phi / 2.0)
    row[COSINE_WEDGE], row[SINE_WEDGE] = math.cos(phi / (2.0 * n)), math.sin(phi / (2.0 * n))
    row[ROOT_O] = root_of_sine(phi)
    row[ROOT_N] = root_of_sine(n * math.pi - phi)


@jit(inline=True)
def root_of_sine(phi: float) -> float:
    """sqrt(|sin phi|), 0 along a face, where the root of a rounding error would be large."""
    size = abs(math.sin(phi))
    return math.sqrt(size) if size > 1e-12 else 0.0


@jit()
def legs_to_edge(
    trace: Trace, tree: Tree, beams: NDArray[np.int32], share: Floats, edge: Edge
) -> LegsIn:
    """Unfold the legs from the source to an edge.

    Parameters
    ----------
    trace, tree
        The trace and the beams from the source.
    beams, share
        (n,) beams that light the edge, by rising order, and shares at a tie.
    edge
        The edge; legs that arrive within its wall or along a face are left out: a face reflects
        a grazing ray with -1, so that nothing is left.
    """
    n_beams, most = len(beams), most_items(tree.link)
    legs = LegsIn(
        np.empty(n_beams, np.int64),
        np.empty(n_beams, np.int64),
        np.empty(n_beams),
        np.empty(n_beams),
        np.empty(n_beams),
        np.empty((n_beams, 2)),
        np.empty(n_beams),
        np.empty(n_beams, np.bool_),
        np.empty((n_beams, 6)),
        np.empty((n_beams, most, 5)),
        np.empty((n_beams, most, 2), np.int64),
    )
    kept = 0
    for b in range(n_beams):
        i = beams[b]
        azimuth = math.atan2(tree.beam[i, 1] - edge.y, tree.beam[i, 0] - edge.x)
        phi = from_face(azimuth, edge.o_face)
        if not ALONG_FACE_RAD < phi < edge.wedge.n * math.pi - ALONG_FACE_RAD:
            continue
        leg = Leg(legs.items[kept], legs.marks[kept])
        n, length, ux, uy = unfold(trace.plan, tree.link, tree.beam, i, (edge.x, edge.y), leg)
        legs.departure[kept, 0], legs.departure[kept, 1] = ux, uy
        legs.order[kept], legs.n_items[kept] = tree.link[i, ORDER], n
        legs.length[kept], legs.phi[kept], legs.share[kept] = length, phi, share[b]
        legs.constrained[kept] = is_constrained(leg, n)
        legs.bound[kept] = leg_bound(trace, leg, n, length, tree.link[i, ORDER])
        write_angles(phi, edge.wedge.n, legs.angles[kept])
        kept += 1
    return LegsIn(
        legs.order[:kept],
        legs.n_items[:kept],
        legs.length[:kept],
        legs.phi[:kept],
        legs.share[:kept],
        legs.departure[:kept],
        legs.bound[:kept],
        legs.constrained[:kept],
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
    departure, arriving
        Horizontal directions in which it leaves the source, and which it comes from.
    constrained_in, constrained_out
        Whether heights matter to the legs, see `unfolding.is_constrained`.
    """

    leg_in: Leg
    n_in: int
    length_in: float
    leg_out: Leg
    n_out: int
    length_out: float
    terms: WedgeTerms
    departure: tuple[float, float]
    arriving: tuple[float, float]
    constrained_in: bool
    constrained_out: bool


@jit(inline=True)
def pair_met(trace: Trace, edge: Edge, pair: Pair, slope: float, nudge: float) -> int:
    """How many walls a path goes through; `MISFIT` or `TOUCHING` as for `unfolding.walls_met`."""
    height, z_root = trace.radio.height, trace.source[2]
    z = z_root + slope * pair.length_in
    z_edge = folded(z + nudge, height)
    if nudge == 0.0 and min(abs(z_edge - edge.z_low), abs(z_edge - edge.z_high)) < TIE_M:
        return TOUCHING
    if not edge.z_low < z_edge < edge.z_high:
        return MISFIT
    through = 0
    if pair.constrained_in:
        through = walls_met(trace.plan, pair.leg_in, pair.n_in, z_root, slope, height, nudge)
    if through >= 0 and pair.constrained_out:
        behind = walls_met(trace.plan, pair.leg_out, pair.n_out, z, slope, height, nudge)
        through = through + behind if behind >= 0 else behind
    return through


@jit(inner=True)
def met_beside(trace: Trace, edge: Edge, pair: Pair, slope: float, nudge: float) -> int:
    """`pair_met`, compiled apart: few paths touch a rim."""
    return pair_met(trace, edge, pair, slope, nudge)


@jit(inline=True)
def pair_fitting(trace: Trace, edge: Edge, pair: Pair, slope: float) -> float:
    """Share of a path that edge and walls allow at its heights (see `unfolding.fitting`)."""
    met = pair_met(trace, edge, pair, slope, 0.0)
    if met != TOUCHING:
        return 1.0 if 0 <= met <= trace.max_walls else 0.0
    share = 0.0
    for side in range(2):
        met = met_beside(trace, edge, pair, slope, NUDGE_M if side else -NUDGE_M)
        if 0 <= met <= trace.max_walls:
            share += 0.5
    return share


@jit(inner=True)
def shines(trace: Trace, edge: Edge, pair: Pair, slope: float) -> bool:
    """Whether a path may go through one wall more."""
    return 0 <= met_beside(trace, edge, pair, slope, NUDGE_M) < trace.max_walls


@jit(inline=True, fast=True)
def pair_gain(
    trace: Trace, edge: Edge, pair: Pair, slope: float, bounces: int, shines_through: bool
) -> complex:
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
    upright, level = sent(radio, pair.departure, ray.sin_el)
    upright, level, done = carried(
        plan, radio, pair.leg_in, pair.n_in, pair.length_in, ray, z_root, (upright, level, 0)
    )
    spread = math.sqrt(4.0 * math.pi / radio.wavelength * product / total) * root
    rising = -ray.sin_el if done & 1 else ray.sin_el
    upright, level = diffracted(
        radio,
        edge.wedge,
        pair.terms,
        spread,
        (ray.cos_el, rising),
        (upright, level),
        shines_through,
    )
    z_edge = z_root + slope * pair.length_in
    upright, level, done = carried(
        plan, radio, pair.leg_out, pair.n_out, pair.length_out, ray, z_edge, (upright, level, done)
    )
    size = radio.wavelength / (4.0 * math.pi * math.sqrt(product * total))
    gain = received(radio, (upright, level), pair.arriving, arriving_sine(ray, done))
    return gain * (size * root) * phasor(radio.cis, total / (ray.cos_el * radio.wavelength))


@jit(inner=True, fast=True)
def wedge_bound(
    trace: Trace, wedge: Wedge, terms: WedgeTerms, lengths: tuple[float, float], order: int
) -> float:
    """Bound on a diffracted power over that of a free path as long.

    A term of a half plane has at most half the field there, and at most 1 / (2 sqrt(pi) s) of it,
    s the argument of its transition function; a wedge has four.
    """
    if not wedge.is_sheet:
        return 4.0
    total = lengths[0] + lengths[1]
    rise = (trace.max_order - order + 1) * trace.radio.height
    cos_el = total / math.sqrt(total * total + rise * rise)
    reduced = lengths[0] * lengths[1] / total
    spread = math.sqrt(4.0 * math.pi / trace.radio.wavelength * reduced * cos_el)
    share = 0.0
    for cosine in (terms.cos_minus, terms.cos_plus):
        s = 2.0 * math.sqrt(math.pi) * spread * abs(cosine)
        share += 0.5 if s < 2.0 else 1.0 / s
    return share * share


@jit(fast=True, allocates=False)
def sum_upright_edge(
    trace: Trace,
    edge: Edge,
    legs_in: LegsIn,
    tree: Tree,
    hits: Hits,
    work: tuple[Leg, Floats],
    sums: Sums,
    record: Record,
) -> None:
    """Add the paths that one edge diffracts; at the edge itself it has no field.

    Parameters
    ----------
    trace, edge
        The trace and the edge.
    legs_in
        Legs from the source.
    tree, hits
        Beams from the edge, and the receivers they light.
    work
        Room for the longest leg and for six functions of an angle.
    sums, record
        Added to.
    """
    leg, angles = work
    common = common_factor(edge.wedge.n, trace.radio.wavelength)
    for hit in range(len(hits.pair)):
        r, i = hits.pair[hit, 0], hits.pair[hit, 1]
        x, y = trace.receivers[r, 0], trace.receivers[r, 1]
        n, length, ux, uy = unfold(trace.plan, tree.link, tree.beam, i, (x, y), leg)
        arriving = (tree.beam[i, IMAGE_X] - x) / length, (tree.beam[i, IMAGE_Y] - y) / length
        if length < TIE_M:
            continue
        phi = from_face(math.atan2(uy, ux), edge.o_face)
        write_angles(phi, edge.wedge.n, angles)
        straight = straight_line(trace, r)
        bound_out = 1.0
        if trace.least_power > 0.0:
            bound_out = leg_bound(trace, leg, n, length, tree.link[i, ORDER])
        tie = 0.5 * TIE_M / length
        constrained_out = is_constrained(leg, n)
        bundle = no_paths()
        for p in range(len(legs_in.order)):
            order = tree.link[i, ORDER] + legs_in.order[p]
            if order > trace.max_order:
                break
            leg_in = Leg(legs_in.items[p], legs_in.marks[p])
            total = legs_in.length[p] + length
            terms = wedge_terms(edge.wedge, phi, angles, legs_in.phi[p], legs_in.angles[p], tie)
            departure = legs_in.departure[p, 0], legs_in.departure[p, 1]
            pair = Pair(
                leg_in, legs_in.n_items[p], legs_in.length[p], leg, n, length, terms, departure,
                arriving, legs_in.constrained[p], constrained_out,
            )  # fmt: skip
            share_here = legs_in.share[p] * hits.share[hit]
            if trace.least_power > 0.0:
                lengths = (legs_in.length[p], length)
                bound = wedge_bound(trace, edge.wedge, terms, lengths, order)
                bound *= free_space(trace, total) * bound_out * legs_in.bound[p]
                if bound < trace.least_power:
                    left = 2 * (trace.max_order - order) + 1
                    leave_out(trace, sums, r, bound, left * share_here)
                    continue
            for k in range(2 * (trace.max_order - order) + 1):
                rise = trace.image_z[trace.level[r], k] - trace.source[2]
                slope = rise / total
                share = share_here * pair_fitting(trace, edge, pair, slope)
                if share == 0.0:
                    continue
                bounces = trace.image_bounces[k]
                through = trace.max_walls > 0 and shines(trace, edge, pair, slope)
                gain = pair_gain(trace, edge, pair, slope, bounces, through) * common
                detour = math.sqrt(total * total + rise * rise) - straight
                sums.n_paths[r, order + bounces] += share
                bundle = with_path(bundle, gain, detour, share)
                recorded(record, hit, p, (-1, k), gain, share)
        add_bundle(sums, r, bundle, arriving)
