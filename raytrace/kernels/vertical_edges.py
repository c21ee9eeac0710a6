"""Paths that are diffracted at a vertical edge.

Height is linear in the unfolded distance through the edge too, so a path is a leg from the
transmitter to the edge, a leg from the edge to the receiver, and one image height for both.
"""

import math
from typing import NamedTuple

import numpy as np

from raytrace.arrays import Floats
from raytrace.kernels.beams import FRACTION, IMAGE_X, IMAGE_Y, ORDER
from raytrace.kernels.blocks import Block, next_block
from raytrace.kernels.bounds import (
    image_bound,
    leg_bound,
)
from raytrace.kernels.building import TraceGeometry
from raytrace.kernels.compiling import jit
from raytrace.kernels.field import new_ray, propagate
from raytrace.kernels.field_tables import (
    FieldTables,
    FrequencyTables,
    for_others,
    phasor,
    tables_at,
)
from raytrace.kernels.guard import is_stopped
from raytrace.kernels.lanes import (
    ComplexLanes,
    Lanes,
    Mask,
    MatrixLanes,
    absolute,
    all_false,
    any_of,
    lanes_of,
    load,
    minimum,
    sqrt,
    where,
)
from raytrace.kernels.plan_view import GRAZING_M, in_building
from raytrace.kernels.records import record_paths
from raytrace.kernels.sums import (
    Bundle,
    empty_bundle,
    loaded_bundle,
    store_bundle,
    with_path,
)
from raytrace.kernels.unfolding import Leg, has_height_limits, unfold
from raytrace.kernels.utd import WedgeTerms, common_factor, diffracted, wedge_terms
from raytrace.kernels.validity import (
    INVALID,
    ONE_SIDED_OFFSETS_M,
    next_evaluation,
    one_sided_weight,
    validity_weight,
    walls_met,
)
from raytrace.kernels.vertical_edge_bounds import (
    BOUND,
    BlockBounds,
    EdgeBounds,
    bounds_of_block,
    next_legs,
    pair_bound,
)
from raytrace.kernels.vertical_edge_legs import (
    LegsIn,
    LegsOut,
    VerticalEdgeArrays,
    VerticalEdgeBeams,
    angles_of,
    angles_towards,
)
from raytrace.kernels.waves import Wave, launch, receive
from raytrace.kernels.workspace import (
    Collector,
    Workspace,
    add_bundle,
    add_left_out,
    apply_power_threshold,
    count_path,
    has_threshold,
    least_powers,
)


class Pair(NamedTuple):
    """A leg to the edge with eight legs from it, and what does not depend on heights.

    Attributes
    ----------
    edge
        The edge.
    number, order
        Number of the leg to the edge, and reflections at walls of both legs.
    leg_in, n_in, length_in
        The leg to the edge, its interactions, its horizontal length [m].
    out
        The legs from the edge.
    total
        Their lengths together [m].
    terms
        The directions at the wedge.
    departure
        Horizontal direction in which the paths leave the transmitter.
    limits_in
        Whether heights matter to the leg to the edge, see `unfolding.has_height_limits`.
    spreading, sqrt_2kl
        Spreading factor, and sqrt(2 k L) of the UTD, for horizontal paths.
    """

    edge: VerticalEdgeArrays
    number: int
    order: int
    leg_in: Leg
    n_in: int
    length_in: float
    out: LegsOut
    total: Lanes
    terms: WedgeTerms
    departure: tuple[Lanes, Lanes]
    limits_in: bool
    spreading: Lanes
    sqrt_2kl: Lanes


@jit(inline=True, fast=True)
def legs_from_edge(
    geometry: TraceGeometry, beams: VerticalEdgeBeams, block: Block, leg: Leg, rows: Floats
) -> LegsOut:
    """Unfold the legs from the edge to the receivers of a block; `rows` is scratch."""
    tree, i = beams.tree, block.beam
    view, target = geometry.building.plan, (block.x, block.y)
    n, length, ux, uy = unfold(view, tree.link, tree.beam, i, target, leg)
    inv_length = 1.0 / length
    arriving = (
        (tree.beam[i, IMAGE_X] - block.x) * inv_length,
        (tree.beam[i, IMAGE_Y] - block.y) * inv_length,
    )
    angles = angles_towards(beams.edge, ux, uy, rows)
    order = tree.link[i, ORDER]
    return LegsOut(leg, n, length, inv_length, order, angles, arriving, has_height_limits(leg, n))


@jit(inline=True, fast=True)
def pair_of(
    tables: FieldTables, edge: VerticalEdgeArrays, legs: LegsIn, p: int, out: LegsOut
) -> Pair:
    """Join leg p to the edge to legs from it."""
    wavelength = tables.wavelength
    total = out.length + legs.length[p]
    product = out.length * legs.length[p]
    spreading = (wavelength / (4.0 * math.pi)) / sqrt(product * total)
    sqrt_2kl = sqrt((4.0 * math.pi / wavelength) * product * (1.0 / total))
    grazing = (0.5 * GRAZING_M) * out.inv_length
    terms = wedge_terms(edge.wedge, out.angles, angles_of(legs, p), grazing)
    departure = lanes_of(legs.departure[p, 0]), lanes_of(legs.departure[p, 1])
    return Pair(
        edge, p, out.order + legs.order[p], Leg(legs.interactions[p], legs.types[p]),
        legs.n_interactions[p], legs.length[p], out, total, terms, departure,
        legs.has_height_limits[p], spreading, sqrt_2kl,
    )  # fmt: skip


@jit(inline=True)
def pair_walls(
    geometry: TraceGeometry, pair: Pair, slope: Lanes, offset: float
) -> tuple[Lanes, Mask]:
    """Transmissions on paths, and which graze an edge, as for `validity.walls_met`."""
    building, z_root = geometry.building, lanes_of(geometry.transmitter[2])
    height, edge, out = building.height, pair.edge, pair.out
    z = z_root + slope * pair.length_in
    n_transmissions, grazing = lanes_of(0.0), all_false()
    if edge.z_low > 0.0 or edge.z_high < height:
        z_edge = in_building(z + offset, height)
        beyond = (z_edge <= edge.z_low) | (z_edge >= edge.z_high)
        n_transmissions = where(beyond, INVALID, n_transmissions)
        inside = minimum(absolute(z_edge - edge.z_low), absolute(z_edge - edge.z_high))
        grazing = inside < GRAZING_M
    if pair.limits_in:
        met, grazes = walls_met(building, pair.leg_in, pair.n_in, z_root, slope, offset)
        n_transmissions, grazing = n_transmissions + met, grazing | grazes
    if out.has_height_limits:
        met, grazes = walls_met(building, out.leg, out.n, z, slope, offset)
        n_transmissions, grazing = n_transmissions + met, grazing | grazes
    return n_transmissions, grazing


@jit(inline=True, fast=True)
def pair_gain(
    geometry: TraceGeometry,
    tables: FieldTables,
    pair: Pair,
    slope: Lanes,
    bounces: int,
    offset: float,
    n_transmissions: Lanes,
    seen: Floats,
) -> tuple[ComplexLanes | MatrixLanes, Lanes]:
    """Gains of paths with some transmissions, without the common factor, and their lengths [m].

    With every length its horizontal part over cos_el, and sin beta = cos_el, the spreading factor
    1 / (sqrt(s s' (s + s')) sin beta) is sqrt(cos_el) over the root of the horizontal parts
    (docs/theory.md, eqs. 16-20). `seen` is scratch, see `field.propagate`.
    """
    building, out = geometry.building, pair.out
    z_root = lanes_of(geometry.transmitter[2])
    ray = new_ray(building, tables, slope, bounces)
    root = sqrt(ray.cos_elevation)
    wave = launch(tables, pair.departure, ray.sin_elevation)
    heights, length_in = (z_root, offset), lanes_of(pair.length_in)
    wave = propagate(building, tables, pair.leg_in, pair.n_in, length_in, ray, heights, seen, wave)
    field = diffracted(
        tables,
        pair.edge.wedge,
        pair.terms,
        pair.sqrt_2kl * root,
        (ray.cos_elevation, wave.sin_elevation),
        (wave.v, wave.h),
        validity_weight(n_transmissions, geometry.max_transmissions - 1),
    )
    wave = Wave(field[0], field[1], wave.sin_elevation, wave.bounce_count)
    heights = z_root + slope * pair.length_in, offset
    wave = propagate(building, tables, out.leg, out.n, out.length, ray, heights, seen, wave)
    distance = pair.total * ray.sec_elevation
    phase = phasor(tables.cis, distance * (1.0 / tables.wavelength))
    amplitude = receive(tables, wave, out.arriving)
    return amplitude * (phase * (pair.spreading * root)), distance


@jit(inline=True, fast=True)
def pair_at(pair: Pair, wavelength: float) -> Pair:
    """Return the same legs at another wavelength."""
    product = pair.out.length * pair.length_in
    spreading = (wavelength / (4.0 * math.pi)) / sqrt(product * pair.total)
    sqrt_2kl = sqrt((4.0 * math.pi / wavelength) * product * (1.0 / pair.total))
    return Pair(
        pair.edge, pair.number, pair.order, pair.leg_in, pair.n_in, pair.length_in, pair.out,
        pair.total, pair.terms, pair.departure, pair.limits_in, spreading, sqrt_2kl,
    )  # fmt: skip


OtherPaths = tuple[
    TraceGeometry, Pair, tuple[Lanes, int, float], tuple[Lanes, Lanes, Lanes], Workspace
]
"""Geometry; legs; slopes, reflections at floor and ceiling, and the offset of heights; numbers of
transmissions, weights, and distances from transmitter to receivers [m]; what is added to."""


@for_others
@jit(inline=True, fast=True)
def add_to_others(every: FrequencyTables, paths: OtherPaths) -> None:
    """Add paths with each of the other tables to `Workspace.bundles`."""
    geometry, pair, (slope, bounces, offset), of_paths, workspace = paths
    n_transmissions, weight, straight = of_paths
    for f in range(len(workspace.bundles)):
        tables, rows = tables_at(every, f), workspace.bundles[f]
        gain, distance = pair_gain(
            geometry, tables, pair_at(pair, tables.wavelength), slope, bounces, offset,
            n_transmissions, workspace.coefficients,
        )  # fmt: skip
        gain = gain * common_factor(pair.edge.wedge.n, tables.wavelength)
        bundle = loaded_bundle(tables, rows)
        bundle = with_path(bundle, gain, distance - straight, weight, pair.out.arriving)
        store_bundle(rows, bundle)


@jit(inline=True, fast=True)
def add_pair(
    bundle: Bundle,
    geometry: TraceGeometry,
    every: FrequencyTables,
    block: Block,
    pair: Pair,
    here: tuple[Lanes, Lanes, Lanes],
    workspace: Workspace,
    collector: Collector,
) -> Bundle:
    """Add the paths of a pair of legs, one for every image height.

    `here` holds the weights of the receivers, a bound on the power of horizontal paths, and the
    thresholds of `workspace.least_powers`.
    """
    (weight_here, bound, least), tables = here, every.first
    n_images = 2 * (geometry.max_reflections - pair.order) + 1
    common, inv_total = common_factor(pair.edge.wedge.n, tables.wavelength), 1.0 / pair.total
    k = side = int(np.int64(0))  # a literal would be compiled as a type of its own
    grazing = all_false()
    while k < n_images:
        slope = (load(workspace.image_z[k]) - geometry.transmitter[2]) * inv_total
        bounces, offset = geometry.image_bounces[k], ONE_SIDED_OFFSETS_M[side]
        n_transmissions, grazes = pair_walls(geometry, pair, slope, offset)
        weight = weight_here * validity_weight(n_transmissions, geometry.max_transmissions)
        weight, grazing = one_sided_weight(side, weight, grazing, grazes, 0.5)
        if has_threshold(collector):
            of_image = bound * image_bound(geometry.building, tables, slope, bounces)
            one = 1.0, lanes_of(1.0)
            weight = apply_power_threshold(collector, workspace, least, of_image, weight, one)
        if any_of(weight > 0.0):
            seen = workspace.coefficients
            gain, distance = pair_gain(
                geometry, tables, pair, slope, bounces, offset, n_transmissions, seen
            )
            gain = gain * common
            count_path(workspace, pair.order + bounces, weight)
            excess = distance - block.straight
            bundle = with_path(bundle, gain, excess, weight, pair.out.arriving)
            image, of_paths = (slope, bounces, offset), (n_transmissions, weight, block.straight)
            add_to_others(every, (geometry, pair, image, of_paths, workspace))
            if collector.record.used[0] >= 0:
                at, images = (block.first, block.n), (-1, k, side)
                record_paths(collector.record, at, pair.number, images, gain, weight)
        k, side = next_evaluation(k, side, grazing)
    return bundle


@jit(fast=True, allocates=False)
def sum_vertical_edge(
    geometry: TraceGeometry,
    every: FrequencyTables,
    beams: VerticalEdgeBeams,
    bounds: EdgeBounds,
    leg: Leg,
    workspace: Workspace,
    collector: Collector,
) -> None:
    """Add the paths that one edge diffracts; at the edge itself it has no field.

    Parameters
    ----------
    geometry, every
        The geometry of the trace, and the tables of its fields.
    beams
        The edge, the legs and beams, and the receivers.
    bounds
        Bounds on powers.
    leg, workspace
        Scratch.
    collector
        Added to.
    """
    tables, edge, legs, hits = every.first, beams.edge, beams.legs, beams.hits
    is_bounded = has_threshold(collector)
    first = int(np.int64(0))  # a literal would be compiled as a type of its own
    while first < len(hits.pair) and not is_stopped(collector.guard):
        block = next_block(geometry, hits, first, workspace)
        first += block.n
        least = least_powers(collector, workspace)
        weakest = where(least < math.inf, least, 0.0)  # paths may only be counted by their bounds
        out = legs_from_edge(geometry, beams, block, leg, workspace.rows)
        off_edge = where(out.length < GRAZING_M, 0.0, block.weight)
        bound_out = bound = lanes_of(1.0)
        if is_bounded:
            bound_out = leg_bound(geometry, tables, leg, out.n, out.length, out.order)
            bound_out = minimum(bound_out, beams.tree.beam[block.beam, FRACTION])
        whole = BlockBounds(out.angles, out.angles, out.length, bound_out, weakest)
        if is_bounded:
            whole = bounds_of_block(whole, workspace.rows)
        bundle, p = empty_bundle(tables), int(np.int64(0))
        while p < len(legs.order) and not is_stopped(collector.guard):
            n_legs, p = next_legs(
                geometry, tables, beams, bounds, p, (block, whole), workspace, collector
            )
            for way in range(n_legs):
                q = int(workspace.ways[way])
                weight = off_edge * legs.weight[q]
                if is_bounded:
                    limit = bounds.shadow, bound_out * bounds.columns[BOUND, q], weakest
                    bound, several = pair_bound(geometry, tables, beams, q, out, limit, collector)
                    weight = apply_power_threshold(
                        collector, workspace, least, bound, weight, several
                    )
                if any_of(weight > 0.0):
                    pair, here = pair_of(tables, edge, legs, q, out), (weight, bound, least)
                    bundle = add_pair(
                        bundle, geometry, every, block, pair, here, workspace, collector
                    )
        add_bundle(collector, workspace, block.n, bundle)
        if is_bounded:
            add_left_out(collector.sums, workspace, block.n)
