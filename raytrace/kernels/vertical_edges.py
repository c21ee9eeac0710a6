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
from raytrace.kernels.field import Wave, carried, new_ray, phasor, received, sent
from raytrace.kernels.lanes import (
    WIDTH,
    ComplexLanes,
    Lanes,
    Mask,
    absolute,
    any_of,
    lane,
    lanes_of,
    load,
    minimum,
    none_chosen,
    sqrt,
    where,
)
from raytrace.kernels.plan_view import GRAZING_M, Floats, Ints
from raytrace.kernels.tracing import (
    Record,
    Room,
    Sums,
    Trace,
    add_bundle,
    counted,
    free_space,
    leg_bound,
    next_block,
    no_paths,
    recorded,
    strong,
    with_path,
)
from raytrace.kernels.unfolding import (
    LOOKS,
    MISFIT,
    Leg,
    fitting,
    in_building,
    is_constrained,
    most_items,
    next_look,
    share_of_look,
    unfold,
    walls_met,
)
from raytrace.kernels.utd import (
    ALONG_FACE,
    FaceAngles,
    Wedge,
    WedgeTerms,
    angle_from,
    common_factor,
    diffracted,
    face_angles,
    wedge_terms,
)


class Edge(NamedTuple):
    """A vertical edge.

    Attributes
    ----------
    x, y, z_low, z_high
        Where it stands [m]; it ends beyond floor and ceiling where it reaches them.
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
    order, n_items, length
        (n,) reflections, items, and horizontal length [m].
    share
        (n,) share at a tie.
    departure
        (n, 2) horizontal direction at the source.
    bound
        (n,) see `tracing.leg_bound`.
    constrained
        (n,) whether heights matter to it, see `unfolding.is_constrained`.
    angles
        (n, 7) see `utd.FaceAngles`.
    items, marks
        (n, most, 5, 8), (n, most, 2) their legs, eight times the same.
    """

    order: Ints
    n_items: Ints
    length: Floats
    share: Floats
    departure: Floats
    bound: Floats
    constrained: NDArray[np.bool_]
    angles: Floats
    items: Floats
    marks: Ints


@jit(inline=True)
def angles_towards(edge: Edge, ux: Lanes, uy: Lanes, room: Floats) -> FaceAngles:
    """Angles of horizontal directions from the o-face."""
    c, s = math.cos(edge.o_face), math.sin(edge.o_face)
    return face_angles(edge.wedge, ux * c + uy * s, uy * c - ux * s, room)


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
        np.empty((n_beams, 2)),
        np.empty(n_beams),
        np.empty(n_beams, np.bool_),
        np.empty((n_beams, 7)),
        np.empty((n_beams, most, 5, WIDTH)),
        np.empty((n_beams, most, 2), np.int64),
    )
    room, kept = np.empty((3, WIDTH)), 0
    target = lanes_of(edge.x), lanes_of(edge.y)
    for b in range(n_beams):
        i = beams[b]
        dx, dy = tree.beam[i, IMAGE_X] - edge.x, tree.beam[i, IMAGE_Y] - edge.y
        phi = angle_from(math.atan2(dy, dx), edge.o_face)
        if not ALONG_FACE < phi < edge.wedge.n * math.pi - ALONG_FACE:
            continue
        leg, order = Leg(legs.items[kept], legs.marks[kept]), tree.link[i, ORDER]
        n, length, ux, uy = unfold(trace.plan, tree.link, tree.beam, i, target, leg)
        legs.departure[kept, 0], legs.departure[kept, 1] = lane(ux, 0), lane(uy, 0)
        legs.order[kept], legs.n_items[kept] = order, n
        legs.length[kept], legs.share[kept] = lane(length, 0), share[b]
        legs.constrained[kept] = is_constrained(leg, n)
        legs.bound[kept] = lane(leg_bound(trace, leg, n, length, order), 0)
        per_length = 1.0 / math.hypot(dx, dy)
        angles = angles_towards(edge, lanes_of(dx * per_length), lanes_of(dy * per_length), room)
        for k, angle in enumerate(angles):
            legs.angles[kept, k] = lane(angle, 0)
        kept += 1
    return LegsIn(
        legs.order[:kept],
        legs.n_items[:kept],
        legs.length[:kept],
        legs.share[:kept],
        legs.departure[:kept],
        legs.bound[:kept],
        legs.constrained[:kept],
        legs.angles[:kept],
        legs.items[:kept],
        legs.marks[:kept],
    )


@jit(inline=True)
def angles_of(legs_in: LegsIn, p: int) -> FaceAngles:
    """Angles from the o-face in which leg p arrives."""
    a = legs_in.angles[p]
    return FaceAngles(
        lanes_of(a[0]), lanes_of(a[1]), lanes_of(a[2]), lanes_of(a[3]), lanes_of(a[4]),
        lanes_of(a[5]), lanes_of(a[6]),
    )  # fmt: skip


class Pair(NamedTuple):
    """A leg to the edge with eight legs from it, and what does not depend on heights.

    Attributes
    ----------
    leg_in, n_in, length_in
        The leg to the edge, its items, its horizontal length [m].
    leg_out, n_out, length_out
        The legs from the edge.
    total
        Their lengths together [m].
    terms
        The directions at the wedge.
    departure, arriving
        Horizontal directions in which they leave the source, and which they come from.
    constrained_in, constrained_out
        Whether heights matter to the legs, see `unfolding.is_constrained`.
    size, spread
        Spreading factor, and sqrt(2 k L), for a level path.
    """

    leg_in: Leg
    n_in: int
    length_in: float
    leg_out: Leg
    n_out: int
    length_out: Lanes
    total: Lanes
    terms: WedgeTerms
    departure: tuple[Lanes, Lanes]
    arriving: tuple[Lanes, Lanes]
    constrained_in: bool
    constrained_out: bool
    size: Lanes
    spread: Lanes


@jit(inline=True)
def pair_met(
    trace: Trace, edge: Edge, pair: Pair, slope: Lanes, nudge: float
) -> tuple[Lanes, Mask]:
    """How many walls paths go through, and which touch a rim, as for `unfolding.walls_met`."""
    height, z_root = trace.radio.height, lanes_of(trace.source[2])
    z = z_root + slope * pair.length_in
    through, touching = lanes_of(0.0), none_chosen()
    if edge.z_low > 0.0 or edge.z_high < height:
        z_edge = in_building(z + nudge, height)
        beyond = (z_edge <= edge.z_low) | (z_edge >= edge.z_high)
        through = where(beyond, MISFIT, through)
        inside = minimum(absolute(z_edge - edge.z_low), absolute(z_edge - edge.z_high))
        touching = inside < GRAZING_M
    if pair.constrained_in:
        met, at_rims = walls_met(trace.plan, pair.leg_in, pair.n_in, z_root, slope, height, nudge)
        through, touching = through + met, touching | at_rims
    if pair.constrained_out:
        met, at_rims = walls_met(trace.plan, pair.leg_out, pair.n_out, z, slope, height, nudge)
        through, touching = through + met, touching | at_rims
    return through, touching


@jit(inline=True, fast=True)
def pair_gain(
    trace: Trace,
    edge: Edge,
    pair: Pair,
    slope: Lanes,
    bounces: int,
    nudge: float,
    through: Lanes,
) -> tuple[ComplexLanes, Lanes]:
    """Gains of paths through so many walls, without the common factor, and their lengths [m].

    With every length its horizontal part over cos_el, and sin beta = cos_el, the spreading factor
    1 / (sqrt(s s' (s + s')) sin beta) is sqrt(cos_el) over the root of the horizontal parts
    (docs/theory.md, eqs. 16-20).
    """
    plan, radio = trace.plan, trace.radio
    z_root = lanes_of(trace.source[2])
    ray = new_ray(radio, slope, bounces)
    root = sqrt(ray.cos_el)
    wave = sent(radio, pair.departure, ray)
    heights, length_in = (z_root, nudge), lanes_of(pair.length_in)
    wave = carried(plan, radio, pair.leg_in, pair.n_in, length_in, ray, heights, wave)
    field = diffracted(
        radio,
        edge.wedge,
        pair.terms,
        pair.spread * root,
        (ray.cos_el, wave.rising),
        (wave.upright, wave.level),
        fitting(through, trace.max_walls - 1),
    )
    wave = Wave(field[0], field[1], wave.rising, wave.done)
    heights = z_root + slope * pair.length_in, nudge
    wave = carried(plan, radio, pair.leg_out, pair.n_out, pair.length_out, ray, heights, wave)
    distance = pair.total * ray.stretch
    turned = phasor(radio.cis, distance * (1.0 / radio.wavelength))
    return received(radio, wave, pair.arriving) * (turned * (pair.size * root)), distance


@jit(inner=True, fast=True)
def wedge_bound(
    trace: Trace,
    is_sheet: bool,
    cosines: tuple[Lanes, Lanes],
    spread: Lanes,
    total: Lanes,
    order: int,
) -> Lanes:
    """Bounds on diffracted powers, the walls on the way not counted.

    A term of a half plane has at most half the field of a free path as long, and at most
    1 / (2 sqrt(pi) s) of it, s the argument of its transition function; a wedge has four.

    Parameters
    ----------
    trace, is_sheet
        The trace, and whether the wedge is a half plane.
    cosines
        Of half the angles to the two shadow boundaries.
    spread, total, order
        See `Pair`, and the number of reflections at walls.
    """
    if not is_sheet:
        return free_space(trace, total) * 4.0
    rise = (trace.max_order - order + 1) * trace.radio.height
    cos_el = total / sqrt(total * total + rise * rise)
    share = lanes_of(0.0)
    for cosine in cosines:
        s = (2.0 * math.sqrt(math.pi)) * spread * sqrt(cos_el) * absolute(cosine)
        share = share + where(s < 2.0, lanes_of(0.5), 1.0 / s)
    return share * share * free_space(trace, total)


@jit(fast=True, allocates=False)
def sum_upright_edge(
    trace: Trace,
    edge: Edge,
    legs_in: LegsIn,
    tree: Tree,
    hits: Hits,
    room: Room,
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
    room
        To work in.
    sums, record
        Added to.
    """
    leg, wavelength = room.leg, trace.radio.wavelength
    common = common_factor(edge.wedge.n, wavelength)
    first = 0
    while first < len(hits.pair):
        block = next_block(trace, hits, first, room)
        first += block.n
        i = block.beam
        n, length, ux, uy = unfold(trace.plan, tree.link, tree.beam, i, (block.x, block.y), leg)
        per_length = 1.0 / length
        arriving = (
            (tree.beam[i, IMAGE_X] - block.x) * per_length,
            (tree.beam[i, IMAGE_Y] - block.y) * per_length,
        )
        angles = angles_towards(edge, ux, uy, room.rows)
        tie = (0.5 * GRAZING_M) * per_length
        constrained_out = is_constrained(leg, n)
        off_edge = where(length < GRAZING_M, 0.0, block.share)
        bound_out = lanes_of(1.0)
        if trace.least_power > 0.0:
            bound_out = leg_bound(trace, leg, n, length, tree.link[i, ORDER])
        bundle = no_paths()
        for p in range(len(legs_in.order)):
            order = tree.link[i, ORDER] + legs_in.order[p]
            n_images = 2 * (trace.max_order - order) + 1
            if n_images < 0:
                break
            total = length + legs_in.length[p]
            product = length * legs_in.length[p]
            size = (wavelength / (4.0 * math.pi)) / sqrt(product * total)
            per_total = 1.0 / total
            spread = sqrt((4.0 * math.pi / wavelength) * product * per_total)
            terms = wedge_terms(edge.wedge, angles, angles_of(legs_in, p), tie)
            departure = lanes_of(legs_in.departure[p, 0]), lanes_of(legs_in.departure[p, 1])
            pair = Pair(
                Leg(legs_in.items[p], legs_in.marks[p]), legs_in.n_items[p], legs_in.length[p],
                leg, n, length, total, terms, departure, arriving, legs_in.constrained[p],
                constrained_out, size, spread,
            )  # fmt: skip
            share_here = off_edge * legs_in.share[p]
            if trace.least_power > 0.0:
                cosines = (terms.cos_minus, terms.cos_plus)
                bound = wedge_bound(trace, edge.wedge.is_sheet, cosines, spread, total, order)
                bound = bound * bound_out * legs_in.bound[p]
                share_here = strong(trace, sums, room, bound, share_here, float(n_images))
            k, look, touching = 0, 0, none_chosen()
            while k < n_images:
                slope = (load(room.image_z[k]) - trace.source[2]) * per_total
                bounces, nudge = trace.image_bounces[k], LOOKS[look]
                through, at_rims = pair_met(trace, edge, pair, slope, nudge)
                share = share_here * fitting(through, trace.max_walls)
                share, touching = share_of_look(look, share, touching, at_rims, 0.5)
                if any_of(share > 0.0):
                    gain, distance = pair_gain(trace, edge, pair, slope, bounces, nudge, through)
                    gain = gain * common
                    counted(room, order + bounces, share)
                    detour = distance - block.straight
                    bundle = with_path(bundle, gain, detour, share, arriving)
                    if record.used[0] >= 0:
                        hit = (block.first, block.n)
                        recorded(record, hit, p, (-1, k, look), gain, share)
                k, look = next_look(k, look, touching)
        add_bundle(sums, block, bundle, room)
