"""Paths that are diffracted at a level edge: the rim of a wall over or under an opening."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from raytrace.kernels.beams import ORDER, PARENT, Hits, Tree
from raytrace.kernels.compiling import jit
from raytrace.kernels.field import (
    Radio,
    Ray,
    arriving_sine,
    carried,
    new_ray,
    phasor,
    received,
    sent,
)
from raytrace.kernels.plan_view import TIE_M, Floats, Ints, PlanView
from raytrace.kernels.strips import StripTree, from_frame
from raytrace.kernels.tracing import (
    Record,
    Sums,
    Trace,
    arrived,
    free_space,
    leave_out,
    recorded,
    straight_line,
)
from raytrace.kernels.unfolding import (
    NUDGE_M,
    TOUCHING,
    Leg,
    most_items,
    new_leg,
    unfold,
    walls_met,
)
from raytrace.kernels.upright_edges import write_angles
from raytrace.kernels.utd import common_factor, diffracted, new_wedge, wedge_terms


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
    slab
        Of the wall.
    """

    frame: Floats
    z: float
    up: float
    slab: int


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


class RimPath(NamedTuple):
    """One path over a level edge.

    Attributes
    ----------
    u
        Where it crosses the edge, from its start [m].
    before, after
        Lengths before and behind the edge [m].
    z_source, z_receiver
        Images of the two heights as seen from the edge [m].
    bounces_in, bounces_out
        Reflections at floor and ceiling before and behind the edge.
    """

    u: float
    before: float
    after: float
    z_source: float
    z_receiver: float
    bounces_in: int
    bounces_out: int


class Work(NamedTuple):
    """Room that the path evaluation writes to."""

    leg_in: Leg
    leg_out: Leg
    images: Floats
    angles_in: Floats
    angles_out: Floats


@jit()
def new_work(tree: Tree, strips: StripTree) -> Work:
    """Room for the paths between two sets of beams."""
    return Work(
        new_leg(most_items(tree.link)),
        new_leg(most_items(strips.link)),
        np.empty((len(strips.link), 2)),
        np.empty(6),
        np.empty(6),
    )


@jit(fast=True, allocates=False)
def sum_level_edge(
    trace: Trace,
    rim: Rim,
    source: tuple[Tree, RimLegsIn],
    strips: StripTree,
    lit: tuple[Hits, Floats],
    work: Work,
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
    tree, legs_in = source
    hits, seen = lit
    z_in, bounces = trace.source_z, trace.image_bounces
    for hit in range(len(hits.pair)):
        r, i = hits.pair[hit, 0], hits.pair[hit, 1]
        h = seen[hit, 1]
        z_out = trace.image_z[trace.level[r]]
        for p in range(len(legs_in.order)):
            order = strips.link[i, ORDER] + legs_in.order[p]
            budget = trace.max_order - order
            if budget < 0:
                break
            stretch = max(seen[hit, 2], legs_in.low[p]), min(seen[hit, 3], legs_in.high[p])
            if stretch[1] - stretch[0] <= TIE_M:
                continue
            ends = (legs_in.x[p], seen[hit, 0])
            if trace.least_power > 0.0:
                bound = free_space(trace, math.hypot(abs(legs_in.h[p]) + h, ends[1] - ends[0]))
                if bound < trace.least_power:
                    left = 2 * budget * (budget + 1) + 1
                    leave_out(trace, sums, r, bound, left * hits.share[hit])
                    continue
            at = (legs_in.beam[p], legs_in.h[p], i, h)
            for a in range(2 * budget + 1):
                across_in = math.sqrt(legs_in.h[p] ** 2 + (z_in[a] - rim.z) ** 2)
                for b in range(2 * (budget - bounces[a]) + 1):
                    across_out = math.sqrt(h * h + (z_out[b] - rim.z) ** 2)
                    u, share = crossing(ends, (across_in, across_out), stretch)
                    if share == 0.0:
                        continue
                    path = RimPath(
                        u,
                        math.hypot(across_in, u - ends[0]),
                        math.hypot(across_out, u - ends[1]),
                        z_in[a],
                        z_out[b],
                        bounces[a],
                        bounces[b],
                    )
                    fitting, gain = rim_gain(trace, rim, path, (tree, strips), at, r, work)
                    share *= fitting * hits.share[hit]
                    if share == 0.0:
                        continue
                    add_rim_path(trace, r, path, i, order, (gain, share), work, sums)
                    recorded(record, hit, p, (a, b), gain, share)


@jit(inline=True)
def crossing(
    ends: tuple[float, float], across: tuple[float, float], stretch: tuple[float, float]
) -> tuple[float, float]:
    """Keller's point, of equal angles with the edge before and behind it, and its share.

    Parameters
    ----------
    ends, across
        Where source and receiver are along the edge, and how far off it [m].
    stretch
        The part of the edge that both see [m].
    """
    u = (ends[0] * across[1] + ends[1] * across[0]) / (across[0] + across[1])
    inside = min(u - stretch[0], stretch[1] - u)
    if inside <= -TIE_M:
        return u, 0.0
    return u, 1.0 if inside >= TIE_M else 0.5


@jit(inner=True)
def add_rim_path(
    trace: Trace,
    r: int,
    path: RimPath,
    beam: int,
    order: int,
    heard: tuple[complex, float],
    work: Work,
    sums: Sums,
) -> None:
    """Add a path, whose images stand in `work`, with its gain and share to the sums."""
    order += path.bounces_in + path.bounces_out
    detour = path.before + path.after - straight_line(trace, r)
    gain, share = heard
    arrived(sums, r, order, (gain, detour, share), arriving_direction(trace, r, work, beam))


@jit(inner=True)
def arriving_direction(trace: Trace, r: int, work: Work, beam: int) -> tuple[float, float]:
    """Horizontal direction that a path with its images in `work` comes from."""
    x = work.images[beam, 0] - trace.receivers[r, 0]
    y = work.images[beam, 1] - trace.receivers[r, 1]
    per_length = 1.0 / math.hypot(x, y)
    return x * per_length, y * per_length


@jit(inner=True)
def unfold_leg(
    view: PlanView,
    link: NDArray[np.int32],
    images: Floats,
    i: int,
    target: tuple[float, float],
    leg: Leg,
) -> tuple[int, float, float, float]:
    """`unfolding.unfold`, compiled apart: this family calls it too seldom to be inlined."""
    return unfold(view, link, images, i, target, leg)


@jit(fast=True, inner=True)
def carry(
    view: PlanView,
    radio: Radio,
    leg: Leg,
    n: int,
    length: float,
    ray: Ray,
    z_root: float,
    field: tuple[complex, complex, int],
) -> tuple[complex, complex, int]:
    """`field.carried`, compiled apart."""
    return carried(view, radio, leg, n, length, ray, z_root, field)


@jit(inner=True)
def met(
    view: PlanView, leg: Leg, n: int, z_root: float, slope: float, height: float, nudge: float
) -> int:
    """`unfolding.walls_met`, compiled apart."""
    return walls_met(view, leg, n, z_root, slope, height, nudge)


@jit(inner=True)
def rim_fitting(
    trace: Trace,
    rim: Rim,
    legs: tuple[int, int],
    slopes: tuple[float, float],
    work: Work,
) -> float:
    """Share of a path that the walls allow at its heights (see `unfolding.fitting`)."""
    view, height = trace.plan, trace.radio.height
    z_in, z_out = trace.source[2], rim.z
    before = met(view, work.leg_in, legs[0], z_in, slopes[0], height, 0.0)
    behind = met(view, work.leg_out, legs[1], z_out, slopes[1], height, 0.0)
    if before != TOUCHING and behind != TOUCHING:
        fits = before >= 0 and behind >= 0 and before + behind <= trace.max_walls
        return 1.0 if fits else 0.0
    share = 0.0
    for a in (-NUDGE_M, NUDGE_M):
        for b in (-NUDGE_M, NUDGE_M):
            before = met(view, work.leg_in, legs[0], z_in, slopes[0], height, a)
            behind = met(view, work.leg_out, legs[1], z_out, slopes[1], height, b)
            if before >= 0 and behind >= 0 and before + behind <= trace.max_walls:
                share += 0.25
    return share


@jit(inner=True)
def unfold_over_rim(
    trace: Trace,
    rim: Rim,
    u: float,
    trees: tuple[Tree, StripTree],
    beams: tuple[int, int],
    receiver: int,
    work: Work,
) -> tuple[tuple[int, float, float, float], tuple[int, float, float, float]]:
    """Unfold both legs of a path that crosses the edge at u (see `unfolding.unfold`)."""
    tree, strips = trees
    x, y = from_frame(rim.frame, u)
    leg_in = unfold_leg(trace.plan, tree.link, tree.beam, beams[0], (x, y), work.leg_in)
    i = beams[1]
    while i >= 0:
        work.images[i, 0], work.images[i, 1] = from_frame(strips.frame[i], u)
        i = strips.link[i, PARENT]
    target = (trace.receivers[receiver, 0], trace.receivers[receiver, 1])
    leg_out = unfold_leg(trace.plan, strips.link, work.images, beams[1], target, work.leg_out)
    return leg_in, leg_out


@jit(fast=True, inner=True)
def rim_gain(
    trace: Trace,
    rim: Rim,
    path: RimPath,
    trees: tuple[Tree, StripTree],
    at: tuple[int, float, int, float],
    receiver: int,
    work: Work,
) -> tuple[float, complex]:
    """Share of a path that the walls allow at its heights, and its gain.

    Parameters
    ----------
    trace, rim, path
        The trace, the edge, and where the path crosses it.
    trees
        Beams from the source and from the edge.
    at
        Beam that lights the edge, distance of the source's image from it [m], beam that lights
        the receiver, distance of the receiver from it [m].
    receiver
        Which one.
    work
        Room.
    """
    view, radio = trace.plan, trace.radio
    legs = unfold_over_rim(trace, rim, path.u, trees, (at[0], at[2]), receiver, work)
    (n_in, length_in, wx, wy), (n_out, length_out, ux, uy) = legs
    rise_in, rise_out = rim.z - path.z_source, path.z_receiver - rim.z
    start = -rise_in if path.bounces_in & 1 else rise_in
    slope_in, slope_out = start / length_in, rise_out / length_out
    share = rim_fitting(trace, rim, (n_in, n_out), (slope_in, slope_out), work)
    if share == 0.0:
        return 0.0, 0j
    ray_in = new_ray(radio, slope_in, path.bounces_in)
    ray_out = new_ray(radio, slope_out, path.bounces_out)
    upright, level = sent(radio, (wx, wy), ray_in.sin_el)
    upright, level, _ = carry(
        view, radio, work.leg_in, n_in, length_in, ray_in, trace.source[2], (upright, level, 0)
    )
    # direction of arrival at the edge, from the image of the source in the last beam
    tree = trees[0]
    x, y = from_frame(rim.frame, path.u)
    vx, vy = (x - tree.beam[at[0], 0]) / length_in, (y - tree.beam[at[0], 1]) / length_in
    sin_el_in = rise_in / path.before
    sin_beta = math.hypot(rise_in, at[1]) / path.before
    cos_beta = -rim.up * ray_out.cos_el * (ux * rim.frame[0] + uy * rim.frame[1])
    # into the edge's polarisations, along it and across, and out again: two rotations
    along, across = turned_to_edge(rim.frame, vx, vy, sin_el_in)
    per_turn = 1.0 / (sin_beta * sin_beta)
    at_edge = (
        (upright * along + level * across) * per_turn,
        (level * along - upright * across) * per_turn,
    )
    beta = (sin_beta, cos_beta)
    walls = met(view, work.leg_in, n_in, trace.source[2], slope_in, radio.height, NUDGE_M)
    walls += met(view, work.leg_out, n_out, rim.z, slope_out, radio.height, NUDGE_M)
    more = 0 <= walls < trace.max_walls
    parallel, normal = over_rim(radio, rim, path, (at[1], at[3]), beta, at_edge, work, more)
    along, across = turned_to_edge(rim.frame, ux, uy, ray_out.sin_el)
    field = (parallel * along - normal * across, parallel * across + normal * along, 0)
    upright, level, done = carry(
        view, radio, work.leg_out, n_out, length_out, ray_out, rim.z, field
    )
    arriving = arriving_direction(trace, receiver, work, at[2])
    gain = received(radio, (upright, level), arriving, arriving_sine(ray_out, done))
    total = path.before + path.after
    size = radio.wavelength / (4.0 * math.pi * math.sqrt(path.before * path.after * total))
    turns = phasor(radio.cis, total / radio.wavelength)
    return share, gain * turns * common_factor(2.0, radio.wavelength) * (size / sin_beta)


@jit(inline=True, fast=True)
def turned_to_edge(frame: Floats, ux: float, uy: float, sin_el: float) -> tuple[float, float]:
    """Components of tau and psi along a level edge (docs/theory.md, eqs. 23-24)."""
    tx, ty = frame[0], frame[1]
    return -sin_el * (ux * tx + uy * ty), ux * ty - uy * tx


@jit(fast=True, inner=True)
def over_rim(
    radio: Radio,
    rim: Rim,
    path: RimPath,
    h: tuple[float, float],
    beta: tuple[float, float],
    field: tuple[complex, complex],
    work: Work,
    shines_through: bool,
) -> tuple[complex, complex]:
    """Field behind the half plane, without its common factor."""
    # angles from the wall, on the receiver's side; the source may lie on either
    phi_in = math.atan2(abs(h[0]), rim.up * (path.z_source - rim.z))
    if h[0] < 0.0:
        phi_in = 2.0 * math.pi - phi_in
    phi_out = math.atan2(h[1], rim.up * (path.z_receiver - rim.z))
    write_angles(phi_in, 2.0, work.angles_in)
    write_angles(phi_out, 2.0, work.angles_out)
    wedge = new_wedge(2.0, rim.slab, rim.slab)
    across_in = math.hypot(h[0], path.z_source - rim.z)
    across_out = math.hypot(h[1], path.z_receiver - rim.z)
    tie = 0.5 * TIE_M * (abs(h[0]) + h[1]) / (across_in * across_out)
    terms = wedge_terms(wedge, phi_out, work.angles_out, phi_in, work.angles_in, tie)
    product = path.before * path.after / (path.before + path.after)
    spread = math.sqrt(4.0 * math.pi / radio.wavelength * product) * beta[0]
    return diffracted(radio, wedge, terms, spread, beta, field, shines_through)
