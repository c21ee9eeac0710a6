"""Paths that are diffracted at a horizontal edge: a lintel, a sill or the top of a wall."""

import math
from typing import NamedTuple

import numpy as np

from raytrace.arrays import Floats
from raytrace.kernels.beams import ORDER, Tree
from raytrace.kernels.blocks import Block, next_block
from raytrace.kernels.bounds import (
    all_from,
    at_one_metre,
    free_space,
)
from raytrace.kernels.building import TraceGeometry
from raytrace.kernels.compiling import jit
from raytrace.kernels.field_tables import FieldTables, FrequencyTables, for_others, tables_at
from raytrace.kernels.guard import is_stopped
from raytrace.kernels.horizontal_edge_bounds import distance_bins
from raytrace.kernels.horizontal_edge_field import (
    edge_gain,
    hypot,
)
from raytrace.kernels.horizontal_edge_images import (
    Seen,
    halves_of,
    may_cross,
    path_bound,
    quick_bound,
    seen_from,
    set_images,
    weight_inside,
)
from raytrace.kernels.horizontal_edge_legs import (
    EdgeLegs,
    EdgePath,
    EdgeWorkspace,
    HorizontalEdgeBeams,
    ImagesIn,
    legs_over_edge,
    walls_over_edge,
)
from raytrace.kernels.lanes import (
    Lanes,
    any_of,
    gather_pairs1,
    lanes_of,
    load,
    maximum,
    minimum,
    where,
)
from raytrace.kernels.losses import NEGLIGIBLE
from raytrace.kernels.records import Record, record_paths
from raytrace.kernels.strips import FRACTION, StripTree
from raytrace.kernels.sums import (
    Bundle,
    empty_bundle,
    loaded_bundle,
    store_bundle,
    with_path,
)
from raytrace.kernels.validity import OFFSET_M, one_sided_weight, validity_weight
from raytrace.kernels.workspace import (
    Collector,
    Workspace,
    add_bundle,
    add_left_out,
    apply_power_threshold,
    count_path,
    has_threshold,
    least_powers,
    leave_out,
)

OFFSETS_OF_LEGS_M = (
    (0.0, 0.0),
    (-OFFSET_M, -OFFSET_M),
    (-OFFSET_M, OFFSET_M),
    (OFFSET_M, -OFFSET_M),
    (OFFSET_M, OFFSET_M),
)
"""Height offsets before and behind the edge with which a path is evaluated [m], as
`validity.ONE_SIDED_OFFSETS_M`; in a one-sided evaluation it has a quarter of its weight."""

OtherPaths = tuple[
    TraceGeometry, EdgePath, EdgeLegs, tuple[Floats, tuple[float, float], Lanes, Lanes, Lanes],
    EdgeWorkspace,
]  # fmt: skip
"""Geometry; paths; legs; images of the transmitter in its beams, height offsets, numbers of
transmissions, lengths beyond the straight line [m] and weights; what is added to."""


@for_others
@jit(inline=True, fast=True)
def add_to_others(every: FrequencyTables, paths: OtherPaths) -> None:
    """Add paths with each of the other tables to `Workspace.bundles`."""
    geometry, path, legs, of_paths, work = paths
    images, offsets, n_transmissions, excess, weight = of_paths
    for f in range(len(work.workspace.bundles)):
        tables, rows = tables_at(every, f), work.workspace.bundles[f]
        gain = edge_gain(geometry, tables, path, legs, images, offsets, n_transmissions, work)
        bundle = with_path(loaded_bundle(tables, rows), gain, excess, weight, legs.arriving)
        store_bundle(rows, bundle)


@jit(inner=True, fast=True)
def add_edge_paths(
    bundle: Bundle,
    geometry: TraceGeometry,
    every: FrequencyTables,
    trees: tuple[Tree, StripTree],
    path: EdgePath,
    here: tuple[Block, Lanes],
    work: EdgeWorkspace,
    record: Record,
) -> Bundle:
    """Add paths over an edge; one-sided evaluations of those that graze another edge.

    `here` holds the receivers, and the weights of the paths.
    """
    (block, weight_here), tables = here, every.first
    legs = legs_over_edge(geometry.building.plan, path, trees, block, work)
    grazing, excess = weight_here >= 0.0, path.before + path.after - block.straight
    for side in range(len(OFFSETS_OF_LEGS_M)):
        offsets = OFFSETS_OF_LEGS_M[side]
        n_transmissions, grazes = walls_over_edge(geometry, path.edge, legs, offsets, work)
        weight = weight_here * validity_weight(n_transmissions, geometry.max_transmissions)
        weight, grazing = one_sided_weight(side, weight, grazing, grazes, 0.25)
        if any_of(weight > 0.0):
            gain = edge_gain(
                geometry, tables, path, legs, trees[0].beam, offsets, n_transmissions, work
            )
            count_path(work.workspace, path.order, weight)
            bundle = with_path(bundle, gain, excess, weight, legs.arriving)
            of_paths = trees[0].beam, offsets, n_transmissions, excess, weight
            add_to_others(every, (geometry, path, legs, of_paths, work))
            if record.used[0] >= 0:
                at, numbers = (block.first, block.n), (path.image_in, path.image_out, side)
                record_paths(record, at, path.leg, numbers, gain, weight)
        if not any_of(grazing):
            break
    return bundle


class Arriving(NamedTuple):
    """The paths from one image of the transmitter to eight receivers, over all heights.

    Attributes
    ----------
    p, left
        Number of the image, and the reflections left to floor and ceiling.
    low, high
        The interval of the edge that is visible from both ends [m].
    weight
        Weights of the receivers.
    walls, least
        Largest fraction of the power that the walls leave, and the power thresholds.
    """

    p: int
    left: int
    low: Lanes
    high: Lanes
    weight: Lanes
    walls: float
    least: Lanes


@jit(inline=True)
def n_pairs(left: int) -> float:
    """Pairs of images in floor and ceiling with so many reflections together, or fewer."""
    return 2.0 * left * (left + 1.0) + 1.0


@jit(inline=True)
def arriving_strongly(
    tables: FieldTables,
    images: ImagesIn,
    seen: Seen,
    way: Arriving,
    limit: tuple[float, Lanes],
    workspace: Workspace,
    collector: Collector,
) -> Arriving:
    """Set the weights of receivers at which all paths are below the threshold to 0.

    `limit` holds the largest power behind the edge over that of a free path as long, and a bound
    on the power of each path.
    """
    h, aside = abs(images.h[way.p]) + seen.h, seen.x - images.x[way.p]
    several, (behind, bound) = (n_pairs(way.left), lanes_of(n_pairs(way.left))), limit
    bound = minimum(bound, free_space(tables, hypot(h, aside)) * (way.walls * behind))
    weight = apply_power_threshold(collector, workspace, way.least, bound, way.weight, several)
    return Arriving(way.p, way.left, way.low, way.high, weight, way.walls, way.least)


@jit(inline=True, fast=True)
def add_images(
    bundle: Bundle,
    geometry: TraceGeometry,
    every: FrequencyTables,
    beams: HorizontalEdgeBeams,
    here: tuple[Block, Seen, Arriving],
    shadow: Floats,
    work: EdgeWorkspace,
    collector: Collector,
) -> Bundle:
    """Add the paths from one image of the transmitter, one for every pair of image heights."""
    (block, seen, way), edge, workspace = here, beams.edge, work.workspace
    tables = every.first
    p, x, h = way.p, beams.images.x[way.p], beams.images.h[way.p]
    z_in, bounces, one = geometry.transmitter_z, geometry.image_bounces, (1.0, lanes_of(1.0))
    is_bounded, half = has_threshold(collector), (lanes_of(0.0), lanes_of(0.0))
    order = int(beams.strips.link[block.beam, ORDER]) + int(beams.images.order[p])
    for a in range(2 * way.left + 1):
        across_in = math.sqrt(h * h + (z_in[a] - edge.z) ** 2)
        if is_bounded:
            half = halves_of(edge, lanes_of(h), lanes_of(z_in[a]), workspace.rows)
        for b in range(2 * (way.left - bounces[a]) + 1):
            across_out = load(work.across[b])
            u = (across_out * x + seen.x * across_in) / (across_out + across_in)
            weight = way.weight * weight_inside(u, way.low, way.high)
            if is_bounded and any_of(weight > 0.0):
                bound = quick_bound(tables, half, lanes_of(across_in), shadow[0], work, b)
                bound = bound * way.walls
                weight = apply_power_threshold(collector, workspace, way.least, bound, weight, one)
            if not any_of(weight > 0.0):
                continue
            path = EdgePath(
                edge, u, hypot(lanes_of(across_in), u - x), hypot(across_out, u - seen.x), h,
                seen.h, z_in[a], load(workspace.image_z[b]), bounces[a], bounces[b],
                beams.images.beam[p], block.beam, p, a, b, order + bounces[a] + bounces[b],
            )  # fmt: skip
            if is_bounded:
                bound = way.walls * path_bound(geometry, tables, path, shadow, work)
                weight = apply_power_threshold(collector, workspace, way.least, bound, weight, one)
            if any_of(weight > 0.0):
                trees = beams.tree, beams.strips
                bundle = add_edge_paths(
                    bundle, geometry, every, trees, path, (block, weight), work, collector.record
                )
    return bundle


@jit(fast=True, allocates=False)
def sum_horizontal_edge(
    geometry: TraceGeometry,
    every: FrequencyTables,
    beams: HorizontalEdgeBeams,
    shadow: Floats,
    work: EdgeWorkspace,
    collector: Collector,
) -> None:
    """Add the paths that leave one side of a horizontal edge.

    Parameters
    ----------
    geometry, every
        The geometry of the trace, and the tables of its fields.
    beams
        The edge, the beams to it and from it, and the receivers.
    shadow
        See `bounds.wedge_bound`; not read without a power threshold.
    work
        Scratch.
    collector
        Added to.
    """
    edge, images, hits, workspace = beams.edge, beams.images, beams.hits, work.workspace
    tables = every.first
    is_bounded, at_1m = has_threshold(collector), at_one_metre(tables)
    behind = 0.25 * (1.0 + math.sqrt(shadow[0])) ** 2 if is_bounded else 0.0
    first = int(np.int64(0))  # a literal would be compiled as a type of its own
    while first < len(hits.pair) and not is_stopped(collector.guard):
        block = next_block(geometry, hits, first, workspace)
        first += block.n
        least = least_powers(collector, workspace)
        weakest = where(least < math.inf, least, 0.0)  # paths may only be counted by their bounds
        seen, has_images = seen_from(beams.seen, block, workspace.rows), False
        bins, over = distance_bins(seen.h), lanes_of(math.inf)
        out = geometry.max_reflections - int(beams.strips.link[block.beam, ORDER])
        kept = beams.strips.frame[block.beam, FRACTION]
        bundle, p = empty_bundle(tables), int(np.int64(0))
        while p < len(images.order):
            left = out - int(images.order[p])
            if left < 0 or is_stopped(collector.guard):
                break
            if len(beams.ranks) > 0:
                rest, skips = all_from(beams.ranks, p, lanes_of(kept * at_1m), seen.h, weakest)
                over, _ = gather_pairs1(beams.over_edge[p, left], bins)
                over = over * (kept * images.fraction[p] * at_1m)
                if skips or not any_of(over >= weakest * NEGLIGIBLE):
                    leave_out(workspace, block.weight * (rest if skips else over) * n_pairs(left))
                    p = int(beams.ranks[p, 2]) if skips else p + 1
                    continue
            if not has_images:
                set_images(edge, seen.h, is_bounded, work)
                has_images = True
            low, high = maximum(seen.low, images.low[p]), minimum(seen.high, images.high[p])
            weight = where(may_cross(images, seen, p, left, work), block.weight, 0.0)
            way = Arriving(p, left, low, high, weight, kept * images.fraction[p], least)
            if is_bounded and any_of(weight > 0.0):
                limit = behind, over
                way = arriving_strongly(tables, images, seen, way, limit, workspace, collector)
            if any_of(way.weight > 0.0):
                here = block, seen, way
                bundle = add_images(bundle, geometry, every, beams, here, shadow, work, collector)
            p += 1
        add_bundle(collector, workspace, block.n, bundle)
        if is_bounded:
            add_left_out(collector.sums, workspace, block.n)
