"""Paths that are diffracted at a horizontal edge: a lintel, a sill or the top of a wall."""

import math
from typing import NamedTuple

import numpy as np

from raytrace.arrays import Floats
from raytrace.kernels.beams import CELL, ORDER, Tree
from raytrace.kernels.blocks import Block, next_block
from raytrace.kernels.bounds import SHEET_POWER, SHEET_POWER_THROUGH_WALLS, free_space
from raytrace.kernels.building import TraceGeometry
from raytrace.kernels.compiling import jit
from raytrace.kernels.field_tables import FieldTables
from raytrace.kernels.guard import is_stopped
from raytrace.kernels.horizontal_edge_field import edge_gain, hypot
from raytrace.kernels.horizontal_edge_legs import (
    EdgePath,
    EdgeWorkspace,
    HorizontalEdgeArrays,
    HorizontalEdgeBeams,
    legs_over_edge,
    walls_over_edge,
)
from raytrace.kernels.lanes import (
    WIDTH,
    Lanes,
    any_of,
    lanes_of,
    load,
    maximum,
    minimum,
    store,
    where,
)
from raytrace.kernels.plan_view import GRAZING_M
from raytrace.kernels.records import Record, record_paths
from raytrace.kernels.strips import FRACTION, StripTree
from raytrace.kernels.sums import Bundle, empty_bundle, with_path
from raytrace.kernels.validity import OFFSET_M, one_sided_weight, validity_weight
from raytrace.kernels.workspace import (
    Collector,
    add_bundle,
    apply_power_threshold,
    count_path,
    least_power,
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


class Seen(NamedTuple):
    """Eight receivers in the frame of an edge.

    Attributes
    ----------
    x, h
        Where they are along the edge, and how far off it in the plan view [m].
    low, high
        The interval of the edge that is visible from them [m].
    """

    x: Lanes
    h: Lanes
    low: Lanes
    high: Lanes


@jit(inline=True)
def seen_from(edge: HorizontalEdgeArrays, seen: Floats, block: Block, work: EdgeWorkspace) -> Seen:
    """Receivers of a block in the frame of an edge; sets `work.across`."""
    rows = work.workspace.rows
    for j in range(WIDTH):
        hit = block.first + min(j, block.n - 1)
        rows[0, j], rows[1, j] = seen[hit, 0], seen[hit, 1]
        rows[2, j], rows[3, j] = seen[hit, 2], seen[hit, 3]
    h = load(rows[1])
    for k in range(len(work.across)):
        store(work.across[k], hypot(h, load(work.workspace.image_z[k]) - edge.z))
    return Seen(load(rows[0]), h, load(rows[2]), load(rows[3]))


@jit(inline=True)
def weight_inside(u: Lanes, low: Lanes, high: Lanes) -> Lanes:
    """1 for points inside the interval from low to high, one half at its ends, 0 outside."""
    inside = minimum(u - low, high - u)
    half = where(inside > -GRAZING_M, lanes_of(0.5), 0.0)
    return where(inside >= GRAZING_M, 1.0, half)


@jit(inner=True, fast=True)
def add_edge_paths(
    bundle: Bundle,
    geometry: TraceGeometry,
    tables: FieldTables,
    trees: tuple[Tree, StripTree],
    path: EdgePath,
    block: Block,
    work: EdgeWorkspace,
    record: Record,
) -> Bundle:
    """Add paths over an edge; one-sided evaluations of those that graze another edge."""
    legs = legs_over_edge(geometry.building.plan, path, trees, block, work)
    grazing, excess = path.weight >= 0.0, path.before + path.after - block.straight
    for side in range(len(OFFSETS_OF_LEGS_M)):
        offsets = OFFSETS_OF_LEGS_M[side]
        n_transmissions, grazes = walls_over_edge(geometry, path.edge, legs, offsets, work)
        weight = path.weight * validity_weight(n_transmissions, geometry.max_transmissions)
        weight, grazing = one_sided_weight(side, weight, grazing, grazes, 0.25)
        if any_of(weight > 0.0):
            gain = edge_gain(
                geometry, tables, path, legs, trees[0].beam, offsets, n_transmissions, work
            )
            count_path(work.workspace, path.order, weight)
            bundle = with_path(bundle, gain, excess, weight, legs.arriving)
            if record.used[0] >= 0:
                at, numbers = (block.first, block.n), (path.image_in, path.image_out, side)
                record_paths(record, at, path.leg, numbers, gain, weight)
        if not any_of(grazing):
            break
    return bundle


@jit(fast=True, allocates=False)
def sum_horizontal_edge(
    geometry: TraceGeometry,
    tables: FieldTables,
    beams: HorizontalEdgeBeams,
    work: EdgeWorkspace,
    collector: Collector,
) -> None:
    """Add the paths that leave one side of a horizontal edge.

    Parameters
    ----------
    geometry, tables
        The geometry of the trace, and the tables of its fields.
    beams
        The edge, the beams to it and from it, and the receivers.
    work
        Scratch.
    collector
        Added to.
    """
    edge, images, hits, workspace = beams.edge, beams.images, beams.hits, work.workspace
    z_in, bounces = geometry.transmitter_z, geometry.image_bounces
    trees = beams.tree, beams.strips
    through_walls = len(tables.transmission) > 0
    power_behind = SHEET_POWER_THROUGH_WALLS if through_walls else SHEET_POWER
    first = int(np.int64(0))  # a literal would be compiled as a type of its own
    while first < len(hits.pair) and not is_stopped(collector.guard):
        block = next_block(geometry, hits, first, workspace)
        first += block.n
        least = least_power(collector, beams.strips.link[block.beam, CELL])
        seen = seen_from(edge, beams.seen, block, work)
        kept = beams.strips.frame[block.beam, FRACTION] * power_behind
        bundle = empty_bundle()
        for p in range(len(images.order)):
            order = beams.strips.link[block.beam, ORDER] + images.order[p]
            budget = geometry.max_reflections - order
            if budget < 0 or is_stopped(collector.guard):
                break
            low, high = maximum(seen.low, images.low[p]), minimum(seen.high, images.high[p])
            weight_here = where(high - low > GRAZING_M, block.weight, 0.0)
            if not any_of(weight_here > 0.0):
                continue
            x, h = images.x[p], images.h[p]
            if least > 0.0:
                bound = free_space(tables, hypot(abs(h) + seen.h, seen.x - x)) * kept
                bound = bound * images.fraction[p]
                n_images = 2.0 * budget * (budget + 1.0) + 1.0
                weight_here = apply_power_threshold(
                    collector, workspace, least, bound, weight_here, n_images
                )
            for a in range(2 * budget + 1):
                across_in = math.sqrt(h * h + (z_in[a] - edge.z) ** 2)
                for b in range(2 * (budget - bounces[a]) + 1):
                    across_out = load(work.across[b])
                    u = (across_out * x + seen.x * across_in) / (across_out + across_in)
                    weight = weight_here * weight_inside(u, low, high)
                    if not any_of(weight > 0.0):
                        continue
                    path = EdgePath(
                        edge, u, hypot(lanes_of(across_in), u - x),
                        hypot(across_out, u - seen.x), h, seen.h, z_in[a],
                        load(workspace.image_z[b]), bounces[a], bounces[b], images.beam[p],
                        block.beam, p, a, b, order + bounces[a] + bounces[b], weight,
                    )  # fmt: skip
                    bundle = add_edge_paths(
                        bundle, geometry, tables, trees, path, block, work, collector.record
                    )
        add_bundle(collector.sums, workspace, block.n, bundle)
