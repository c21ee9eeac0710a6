"""Paths that are diffracted at a level edge: the rim of a wall over or under an opening."""

import math
from typing import NamedTuple

import numpy as np

from raytrace.kernels.beams import IMAGE_X, IMAGE_Y, ORDER, PARENT, Hits, Tree
from raytrace.kernels.compiling import jit
from raytrace.kernels.field import (
    Radio,
    Ray,
    Wave,
    carried,
    new_ray,
    phasor,
    received,
    sent,
)
from raytrace.kernels.lanes import (
    WIDTH,
    ComplexLanes,
    Lanes,
    Mask,
    any_of,
    lanes_of,
    load,
    maximum,
    minimum,
    sqrt,
    store,
    where,
)
from raytrace.kernels.plan_view import GRAZING_M, Floats, Ints, PlanView
from raytrace.kernels.strips import StripTree, from_frame
from raytrace.kernels.tracing import (
    Block,
    Bundle,
    Record,
    Room,
    Sums,
    Trace,
    add_bundle,
    counted,
    free_space,
    new_room,
    next_block,
    no_paths,
    recorded,
    strong,
    with_path,
)
from raytrace.kernels.unfolding import (
    NUDGE_M,
    Leg,
    fitting,
    most_items,
    new_leg,
    share_of_look,
    unfold,
    walls_met,
)
from raytrace.kernels.utd import Wedge, common_factor, diffracted, face_angles, wedge_terms

RIM_LOOKS = (
    (0.0, 0.0),
    (-NUDGE_M, -NUDGE_M),
    (-NUDGE_M, NUDGE_M),
    (NUDGE_M, -NUDGE_M),
    (NUDGE_M, NUDGE_M),
)
"""Nudges before and behind the edge, as `unfolding.LOOKS`; a further look counts a quarter."""


class Rim(NamedTuple):
    """A level edge.

    Attributes
    ----------
    frame
        (7,) of its edge of the plan view, seen from the side the paths leave to.
    z
        Its height [m].
    up
        1 where the wall is above it, -1 where below.
    wedge
        The end of the wall's sheet.
    """

    frame: Floats
    z: float
    up: float
    wedge: Wedge


class RimLegsIn(NamedTuple):
    """Beams from the source that light a level edge, by rising number of reflections.

    Attributes
    ----------
    order, beam
        (n,) reflections, and the beam.
    x, h
        (n,) image of the source in the frame of the edge [m]; h < 0 behind it.
    low, high
        (n,) the stretch of the edge that is lit [m].
    """

    order: Ints
    beam: Ints
    x: Floats
    h: Floats
    low: Floats
    high: Floats


class Seen(NamedTuple):
    """Eight receivers as an edge sees them.

    Attributes
    ----------
    x, h
        Where they are along the edge, and how far off it in the plan view [m].
    low, high
        The stretch of the edge that sees them [m].
    """

    x: Lanes
    h: Lanes
    low: Lanes
    high: Lanes


class RimPath(NamedTuple):
    """Eight paths over a level edge, from the same image of the source.

    Attributes
    ----------
    u
        Where they cross the edge, from its start [m].
    before, after
        Lengths before and behind the edge [m].
    h_source, h_receiver
        How far source and receivers are off the edge in the plan view [m].
    z_source, z_receiver
        Images of the heights as seen from the edge [m].
    bounces_in, bounces_out
        Reflections at floor and ceiling before and behind the edge.
    beam_in, beam_out
        Beams that light the edge, and the receivers.
    """

    u: Lanes
    before: Lanes
    after: Lanes
    h_source: float
    h_receiver: Lanes
    z_source: float
    z_receiver: Lanes
    bounces_in: int
    bounces_out: int
    beam_in: int
    beam_out: int


class RimWork(NamedTuple):
    """Room that this family works in.

    Attributes
    ----------
    room
        What every family needs, and the legs from the edge.
    leg_in
        The legs to the edge.
    images
        (n_beams, 2, 8) images of the points where paths cross the edge [m].
    across
        (2 max_order + 1, 8) distances of the receivers' images from the edge's line [m].
    """

    room: Room
    leg_in: Leg
    images: Floats
    across: Floats


@jit()
def new_work(max_order: int, tree: Tree, strips: StripTree) -> RimWork:
    """Room for the paths between two sets of beams."""
    return RimWork(
        new_room(max_order, most_items(strips.link)),
        new_leg(most_items(tree.link)),
        np.empty((len(strips.link), 2, WIDTH)),
        np.empty((2 * max_order + 1, WIDTH)),
    )


@jit(inline=True)
def seen_by(rim: Rim, seen: Floats, block: Block, work: RimWork) -> Seen:
    """Receivers of a block as the edge sees them; their distances from its line are noted."""
    rows = work.room.rows
    for j in range(WIDTH):
        hit = block.first + min(j, block.n - 1)
        rows[0, j], rows[1, j] = seen[hit, 0], seen[hit, 1]
        rows[2, j], rows[3, j] = seen[hit, 2], seen[hit, 3]
    h = load(rows[1])
    for k in range(len(work.across)):
        store(work.across[k], root_of_squares(h, load(work.room.image_z[k]) - rim.z))
    return Seen(load(rows[0]), h, load(rows[2]), load(rows[3]))


@jit(inline=True)
def root_of_squares(a: Lanes, b: Lanes) -> Lanes:
    """Length of vectors with two components."""
    return sqrt(a * a + b * b)


@jit(fast=True, allocates=False)
def sum_level_edge(
    trace: Trace,
    rim: Rim,
    source: tuple[Tree, RimLegsIn],
    strips: StripTree,
    lit: tuple[Hits, Floats],
    work: RimWork,
    sums: Sums,
    record: Record,
) -> None:
    """Add the paths that leave one side of a level edge.

    Parameters
    ----------
    trace, rim
        The trace and the edge.
    source
        Beams from the source, and those that light the edge.
    strips, lit
        Beams from the edge, and the receivers they light (see `strips.hit_from_strip`).
    work
        Room.
    sums, record
        Added to.
    """
    (tree, legs_in), (hits, seen_hits), room = source, lit, work.room
    z_in, bounces = trace.source_z, trace.image_bounces
    first = 0
    while first < len(hits.pair):
        block = next_block(trace, hits, first, room)
        first += block.n
        seen = seen_by(rim, seen_hits, block, work)
        bundle = no_paths()
        for p in range(len(legs_in.order)):
            order = strips.link[block.beam, ORDER] + legs_in.order[p]
            budget = trace.max_order - order
            if budget < 0:
                break
            low, high = maximum(seen.low, legs_in.low[p]), minimum(seen.high, legs_in.high[p])
            share_here = where(high - low > GRAZING_M, block.share, 0.0)
            if not any_of(share_here > 0.0):
                continue
            x, h = legs_in.x[p], legs_in.h[p]
            if trace.least_power > 0.0:
                bound = free_space(trace, root_of_squares(abs(h) + seen.h, seen.x - x))
                n_images = 2.0 * budget * (budget + 1.0) + 1.0
                share_here = strong(trace, sums, room, bound, share_here, n_images)
            for a in range(2 * budget + 1):
                across_in = math.sqrt(h * h + (z_in[a] - rim.z) ** 2)
                for b in range(2 * (budget - bounces[a]) + 1):
                    across_out = load(work.across[b])
                    u = (across_out * x + seen.x * across_in) / (across_out + across_in)
                    share = share_here * share_inside(u, low, high)
                    if not any_of(share > 0.0):
                        continue
                    path = RimPath(
                        u, root_of_squares(lanes_of(across_in), u - x),
                        root_of_squares(across_out, u - seen.x), h, seen.h, z_in[a],
                        load(room.image_z[b]), bounces[a], bounces[b], legs_in.beam[p], block.beam,
                    )  # fmt: skip
                    images, n_bounces = (p, a, b), order + bounces[a] + bounces[b]
                    bundle = with_rim_path(
                        bundle, trace, rim, path, (tree, strips), block, share, work, record,
                        images, n_bounces,
                    )  # fmt: skip
        add_bundle(sums, block, bundle, room)


@jit(inline=True)
def share_inside(u: Lanes, low: Lanes, high: Lanes) -> Lanes:
    """1 for points inside the stretch from low to high, one half at its ends, else 0."""
    inside = minimum(u - low, high - u)
    half = where(inside > -GRAZING_M, lanes_of(0.5), 0.0)
    return where(inside >= GRAZING_M, 1.0, half)


@jit(inline=True)
def unfold_over_rim(
    trace: Trace,
    rim: Rim,
    u: Lanes,
    trees: tuple[Tree, StripTree],
    beams: tuple[int, int],
    receivers: tuple[Lanes, Lanes],
    work: RimWork,
) -> tuple[tuple[int, Lanes, Lanes, Lanes], tuple[int, Lanes, Lanes, Lanes]]:
    """Unfold both legs of paths that cross the edge at u (see `unfolding.unfold`)."""
    tree, strips = trees
    target = from_frame(rim.frame, u)
    leg_in = unfold(trace.plan, tree.link, tree.beam, beams[0], target, work.leg_in)
    i = beams[1]
    while i >= 0:
        x, y = from_frame(strips.frame[i], u)
        store(work.images[i, IMAGE_X], x)
        store(work.images[i, IMAGE_Y], y)
        i = strips.link[i, PARENT]
    leg = work.room.leg
    leg_out = unfold(trace.plan, strips.link, work.images, beams[1], receivers, leg)
    return leg_in, leg_out


@jit(inner=True)
def met(
    view: PlanView, leg: Leg, n: int, z_root: Lanes, slope: Lanes, height: float, nudge: float
) -> tuple[Lanes, Mask]:
    """`unfolding.walls_met`, compiled apart."""
    return walls_met(view, leg, n, z_root, slope, height, nudge)


@jit(fast=True, inner=True)
def carry(
    view: PlanView,
    radio: Radio,
    leg: Leg,
    n: int,
    length: Lanes,
    ray: Ray,
    heights: tuple[Lanes, float],
    wave: Wave,
) -> Wave:
    """`field.carried`, compiled apart."""
    return carried(view, radio, leg, n, length, ray, heights, wave)


class RimLegs(NamedTuple):
    """Both legs of eight paths over a level edge.

    Attributes
    ----------
    n_in, n_out
        Number of their items.
    length_in, length_out
        Horizontal lengths [m].
    departure, leaving
        Horizontal directions at the source, and from the edge.
    arriving
        Horizontal directions that they come from.
    slope_in, slope_out
        Growth of the unfolded heights over horizontal distance.
    """

    n_in: int
    n_out: int
    length_in: Lanes
    length_out: Lanes
    departure: tuple[Lanes, Lanes]
    leaving: tuple[Lanes, Lanes]
    arriving: tuple[Lanes, Lanes]
    slope_in: Lanes
    slope_out: Lanes


@jit(inner=True)
def rim_legs(
    trace: Trace,
    rim: Rim,
    path: RimPath,
    trees: tuple[Tree, StripTree],
    block: Block,
    work: RimWork,
) -> RimLegs:
    """Unfold both legs of paths; what they meet stands in `work`."""
    beams, receivers = (path.beam_in, path.beam_out), (block.x, block.y)
    legs = unfold_over_rim(trace, rim, path.u, trees, beams, receivers, work)
    (n_in, length_in, wx, wy), (n_out, length_out, ux, uy) = legs
    per_length = 1.0 / length_out
    arriving = (
        (load(work.images[path.beam_out, IMAGE_X]) - block.x) * per_length,
        (load(work.images[path.beam_out, IMAGE_Y]) - block.y) * per_length,
    )
    rise_in = rim.z - path.z_source
    start = -rise_in if path.bounces_in & 1 else rise_in
    slope_out = (path.z_receiver - rim.z) * per_length
    return RimLegs(
        n_in,
        n_out,
        length_in,
        length_out,
        (wx, wy),
        (ux, uy),
        arriving,
        start / length_in,
        slope_out,
    )


@jit(inner=True)
def rim_met(
    trace: Trace, rim: Rim, legs: RimLegs, nudges: tuple[float, float], work: RimWork
) -> tuple[Lanes, Mask]:
    """How many walls paths go through, and which touch a rim, as for `unfolding.walls_met`."""
    view, height, z = trace.plan, trace.radio.height, lanes_of(trace.source[2])
    before, at_rims = met(view, work.leg_in, legs.n_in, z, legs.slope_in, height, nudges[0])
    leg, z = work.room.leg, lanes_of(rim.z)
    behind, also = met(view, leg, legs.n_out, z, legs.slope_out, height, nudges[1])
    return before + behind, at_rims | also


@jit(inner=True, fast=True)
def with_rim_path(
    bundle: Bundle,
    trace: Trace,
    rim: Rim,
    path: RimPath,
    trees: tuple[Tree, StripTree],
    block: Block,
    share: Lanes,
    work: RimWork,
    record: Record,
    images: tuple[int, int, int],
    order: int,
) -> Bundle:
    """Sums with paths over the rim, those that touch another rim looked at from both sides."""
    legs = rim_legs(trace, rim, path, trees, block, work)
    touching, detour = share >= 0.0, path.before + path.after - block.straight
    for look in range(len(RIM_LOOKS)):
        nudges = RIM_LOOKS[look]
        through, at_rims = rim_met(trace, rim, legs, nudges, work)
        fits = share * fitting(through, trace.max_walls)
        fits, touching = share_of_look(look, fits, touching, at_rims, 0.25)
        if any_of(fits > 0.0):
            gain = rim_gain(trace, rim, path, legs, trees[0].beam, nudges, through, work)
            counted(work.room, order, fits)
            bundle = with_path(bundle, gain, detour, fits, legs.arriving)
            if record.used[0] >= 0:
                at = (images[1], images[2], look)
                recorded(record, (block.first, block.n), images[0], at, gain, fits)
        if not any_of(touching):
            break
    return bundle


@jit(fast=True, inner=True)
def rim_gain(
    trace: Trace,
    rim: Rim,
    path: RimPath,
    legs: RimLegs,
    images: Floats,
    nudges: tuple[float, float],
    through: Lanes,
    work: RimWork,
) -> ComplexLanes:
    """Gains of paths.

    Parameters
    ----------
    trace, rim, path, legs
        The trace, the edge, where the paths cross it, and their legs.
    images
        (n, >= 2) of the source in its beams [m].
    nudges, through
        How they are looked at before and behind the edge, and how many walls they go through.
    work
        What they meet.
    """
    view, radio, frame = trace.plan, trace.radio, rim.frame
    ray_in = new_ray(radio, legs.slope_in, path.bounces_in)
    ray_out = new_ray(radio, legs.slope_out, path.bounces_out)
    heights = lanes_of(trace.source[2]), nudges[0]
    wave = sent(radio, legs.departure, ray_in)
    wave = carry(view, radio, work.leg_in, legs.n_in, legs.length_in, ray_in, heights, wave)
    # direction of arrival at the edge, from the image of the source in the last beam
    x, y = from_frame(frame, path.u)
    vx = (x - images[path.beam_in, IMAGE_X]) / legs.length_in
    vy = (y - images[path.beam_in, IMAGE_Y]) / legs.length_in
    rise_in, per_before = rim.z - path.z_source, 1.0 / path.before
    sin_beta = math.hypot(rise_in, path.h_source) * per_before
    ux, uy = legs.leaving
    cos_beta = ray_out.cos_el * (ux * frame[0] + uy * frame[1]) * -rim.up
    # into the edge's polarisations, along it and across, and out again: two rotations
    along, across = turned_to_edge(frame, vx, vy, rise_in * per_before)
    per_turn = 1.0 / (sin_beta * sin_beta)
    at_edge = (
        (wave.upright * along + wave.level * across) * per_turn,
        (wave.level * along - wave.upright * across) * per_turn,
    )
    shining = fitting(through, trace.max_walls - 1)
    parallel, normal = over_rim(radio, rim, path, (sin_beta, cos_beta), at_edge, shining, work)
    along, across = turned_to_edge(frame, ux, uy, ray_out.sin_el)
    none, leg = lanes_of(0.0), work.room.leg
    upright, level = parallel * along - normal * across, parallel * across + normal * along
    wave, heights = Wave(upright, level, ray_out.sin_el, none), (lanes_of(rim.z), nudges[1])
    wave = carry(view, radio, leg, legs.n_out, legs.length_out, ray_out, heights, wave)
    total = path.before + path.after
    product = path.before * path.after
    size = (radio.wavelength / (4.0 * math.pi)) / (sqrt(product * total) * sin_beta)
    turned = phasor(radio.cis, total * (1.0 / radio.wavelength))
    gain = received(radio, wave, legs.arriving) * (turned * size)
    return gain * common_factor(2.0, radio.wavelength)


@jit(inline=True, fast=True)
def turned_to_edge(frame: Floats, ux: Lanes, uy: Lanes, sin_el: Lanes) -> tuple[Lanes, Lanes]:
    """Components of tau and psi along a level edge (docs/theory.md, eqs. 23-24)."""
    tx, ty = frame[0], frame[1]
    return -sin_el * (ux * tx + uy * ty), ux * ty - uy * tx


@jit(fast=True, inner=True)
def over_rim(
    radio: Radio,
    rim: Rim,
    path: RimPath,
    beta: tuple[Lanes, Lanes],
    field: tuple[ComplexLanes, ComplexLanes],
    shining: Lanes,
    work: RimWork,
) -> tuple[ComplexLanes, ComplexLanes]:
    """Fields behind the half plane, without its common factor."""
    # angles from the wall, on the receivers' side; the source may lie on either
    z_in, z_out = rim.up * (path.z_source - rim.z), (path.z_receiver - rim.z) * rim.up
    h_in, h_out = path.h_source, path.h_receiver
    per_in, per_out = 1.0 / math.hypot(h_in, z_in), 1.0 / root_of_squares(h_out, z_out)
    rows = work.room.rows
    source = face_angles(rim.wedge, lanes_of(z_in * per_in), lanes_of(h_in * per_in), rows)
    at = face_angles(rim.wedge, z_out * per_out, h_out * per_out, rows)
    tie = (abs(h_in) + h_out) * per_out * (0.5 * GRAZING_M * per_in)
    terms = wedge_terms(rim.wedge, at, source, tie)
    product = path.before * path.after / (path.before + path.after)
    spread = sqrt((4.0 * math.pi / radio.wavelength) * product) * beta[0]
    return diffracted(radio, rim.wedge, terms, spread, beta, field, shining)
