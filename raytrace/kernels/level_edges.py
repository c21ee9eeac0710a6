"""Paths that are diffracted at a level edge: the rim of a wall over or under an opening."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from raytrace.kernels.beams import ORDER, PARENT, Tree
from raytrace.kernels.compiling import jit
from raytrace.kernels.field import Radio, Ray, carried, interpolated, new_ray, phasor
from raytrace.kernels.plan_view import Floats, Ints, PlanView
from raytrace.kernels.strips import StripTree, from_frame
from raytrace.kernels.tracing import Record, Sums, Trace, recorded
from raytrace.kernels.unfolding import (
    Leg,
    heights_fit,
    most_items,
    new_leg,
    unfold,
)
from raytrace.kernels.upright_edges import write_angles
from raytrace.kernels.utd import common_factor, diffraction, new_wedge, wedge_terms


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
    lit: tuple[NDArray[np.int32], Floats],
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
    for hit in range(len(hits)):
        r, i = hits[hit, 0], hits[hit, 1]
        x, h, low, high = seen[hit]
        z_out = trace.image_z[trace.level[r]]
        for p in range(len(legs_in.order)):
            order = strips.link[i, ORDER] + legs_in.order[p]
            budget = trace.max_order - order
            if budget < 0:
                break
            first, last = max(low, legs_in.low[p]), min(high, legs_in.high[p])
            if last <= first:
                continue
            for a in range(2 * budget + 1):
                across_in = math.sqrt(legs_in.h[p] ** 2 + (z_in[a] - rim.z) ** 2)
                for b in range(2 * (budget - bounces[a]) + 1):
                    across_out = math.sqrt(h * h + (z_out[b] - rim.z) ** 2)
                    # Keller's point: equal angles with the edge before and behind it
                    u = (legs_in.x[p] * across_out + x * across_in) / (across_in + across_out)
                    if u <= first or u >= last:
                        continue
                    path = RimPath(
                        u,
                        math.hypot(across_in, u - legs_in.x[p]),
                        math.hypot(across_out, u - x),
                        z_in[a],
                        z_out[b],
                        bounces[a],
                        bounces[b],
                    )
                    at = (legs_in.beam[p], legs_in.h[p], i, h)
                    valid, gain = rim_gain(trace, rim, path, (tree, strips), at, r, work)
                    if not valid:
                        continue
                    sums.field[r] += gain
                    sums.power[r] += gain.real * gain.real + gain.imag * gain.imag
                    sums.n_paths[r, order + bounces[a] + bounces[b]] += 1
                    recorded(record, hit, p, (a, b), gain)


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
def fits(view: PlanView, leg: Leg, n: int, z_root: float, slope: float, height: float) -> bool:
    """`unfolding.heights_fit`, compiled apart."""
    return heights_fit(view, leg, n, z_root, slope, height)


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
) -> tuple[bool, complex]:
    """Whether the heights of a path fit the walls, and its gain.

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
    (n_in, length_in, _, _), (n_out, length_out, ux, uy) = legs
    rise_in, rise_out = rim.z - path.z_source, path.z_receiver - rim.z
    start = -rise_in if path.bounces_in & 1 else rise_in
    slope_in, slope_out = start / length_in, rise_out / length_out
    if not (
        fits(view, work.leg_in, n_in, trace.source[2], slope_in, radio.height)
        and fits(view, work.leg_out, n_out, rim.z, slope_out, radio.height)
    ):
        return False, 0j
    ray_in = new_ray(radio, slope_in, path.bounces_in)
    ray_out = new_ray(radio, slope_out, path.bounces_out)
    upright, level, _ = carry(
        view, radio, work.leg_in, n_in, length_in, ray_in, trace.source[2], (1.0 + 0j, 0j, 0)
    )
    # direction of arrival at the edge, from the image of the source in the last beam
    tree = trees[0]
    x, y = from_frame(rim.frame, path.u)
    vx, vy = (x - tree.beam[at[0], 0]) / length_in, (y - tree.beam[at[0], 1]) / length_in
    sin_el_in = rise_in / path.before
    sin_beta = math.hypot(rise_in, at[1]) / path.before
    soft, hard = rim_diffraction(radio, rim, path, (at[1], at[3]), sin_beta, work)
    # into the edge's polarisations, along it and across, and out again: two rotations
    along, across = turned_to_edge(rim.frame, vx, vy, sin_el_in)
    parallel = soft * (upright * along + level * across) / (sin_beta * sin_beta)
    normal = hard * (level * along - upright * across) / (sin_beta * sin_beta)
    along, across = turned_to_edge(rim.frame, ux, uy, ray_out.sin_el)
    field = (parallel * along - normal * across, parallel * across + normal * along, 0)
    upright, level, done = carry(
        view, radio, work.leg_out, n_out, length_out, ray_out, rim.z, field
    )
    arriving = ray_out.sin_el if done & 1 else -ray_out.sin_el
    size = interpolated(radio.transmit, ray_in.sin_el) * interpolated(radio.receive, arriving)
    total = path.before + path.after
    size *= radio.wavelength / (4.0 * math.pi * math.sqrt(path.before * path.after * total))
    turns = phasor(radio.cis, total / radio.wavelength)
    return True, upright * turns * common_factor(2.0, radio.wavelength) * (size / sin_beta)


@jit(inline=True, fast=True)
def turned_to_edge(frame: Floats, ux: float, uy: float, sin_el: float) -> tuple[float, float]:
    """Components of tau and psi along a level edge (docs/theory.md, eqs. 23-24)."""
    tx, ty = frame[0], frame[1]
    return -sin_el * (ux * tx + uy * ty), ux * ty - uy * tx


@jit(fast=True, inner=True)
def rim_diffraction(
    radio: Radio, rim: Rim, path: RimPath, h: tuple[float, float], sin_beta: float, work: Work
) -> tuple[complex, complex]:
    """Soft and hard coefficient of the half plane, without their common factor."""
    # angles from the wall, on the receiver's side; the source may lie on either
    phi_in = math.atan2(abs(h[0]), rim.up * (path.z_source - rim.z))
    if h[0] < 0.0:
        phi_in = 2.0 * math.pi - phi_in
    phi_out = math.atan2(h[1], rim.up * (path.z_receiver - rim.z))
    write_angles(phi_in, 2.0, work.angles_in)
    write_angles(phi_out, 2.0, work.angles_out)
    wedge = new_wedge(2.0, rim.slab, rim.slab)
    terms = wedge_terms(wedge, phi_out, work.angles_out, phi_in, work.angles_in)
    product = path.before * path.after / (path.before + path.after)
    spread = math.sqrt(4.0 * math.pi / radio.wavelength * product) * sin_beta
    return diffraction(radio, wedge, terms, spread, sin_beta)
