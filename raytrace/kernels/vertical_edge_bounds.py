"""Upper bounds on the power of paths over a vertical edge."""

import math
from typing import NamedTuple

import numpy as np

from raytrace.arrays import Floats
from raytrace.kernels.beams import ORDER
from raytrace.kernels.blocks import Block
from raytrace.kernels.bounds import (
    LENGTHS,
    WEDGE_POWER,
    all_from,
    all_heights,
    at_one_metre,
    free_space,
    leg_bound,
    wedge_bound,
)
from raytrace.kernels.building import TraceGeometry
from raytrace.kernels.compiling import jit
from raytrace.kernels.field_tables import FieldTables
from raytrace.kernels.lanes import (
    WIDTH,
    Lanes,
    any_of,
    lane,
    lanes_of,
    load,
    maximum,
    sqrt,
    store,
    where,
)
from raytrace.kernels.losses import NEGLIGIBLE
from raytrace.kernels.unfolding import Leg
from raytrace.kernels.vertical_edge_legs import LegsIn, LegsOut, VerticalEdgeBeams, angles_of
from raytrace.kernels.wedge import FaceAngles, Wedge
from raytrace.kernels.workspace import Collector, Workspace, has_threshold, leave_out


class EdgeBounds(NamedTuple):
    """Bounds on what arrives at an edge and leaves it; not read without a power threshold.

    Attributes
    ----------
    shadow
        See `bounds.wedge_bound`.
    most
        Largest power behind the edge over that of a free path as long.
    columns
        (10, n_legs + 8) properties of the legs, so that eight can be loaded at once: order, length
        [m], bound (`bounds_of_legs`), and those of `FaceAngles`.
    """

    shadow: Floats
    most: float
    columns: Floats


ORDER_IN, LENGTH_IN, BOUND, ANGLES = range(4)
"""Rows of `EdgeBounds.columns`."""


def no_bounds() -> EdgeBounds:
    """Return bounds that are not read."""
    return EdgeBounds(np.empty(0), 0.0, np.empty((0, 0)))


def edge_bounds(
    geometry: TraceGeometry, tables: FieldTables, legs: LegsIn, shadow: Floats, most: float
) -> EdgeBounds:
    """Bound what arrives at an edge and leaves it."""
    bounds = bounds_of_legs(geometry, tables, legs)
    columns = np.ones((ANGLES + 7, len(legs.order) + WIDTH))
    for k, column in enumerate((legs.order, legs.length, bounds, *legs.angles.T)):
        columns[k, : len(legs.order)] = column
    return EdgeBounds(shadow, most, columns)


@jit()
def bounds_of_legs(geometry: TraceGeometry, tables: FieldTables, legs: LegsIn) -> Floats:
    """Bound on the power that arrives by each leg (n,), see `bounds.leg_bound`."""
    bounds = np.empty(len(legs.order))
    for p in range(len(legs.order)):
        leg, length = Leg(legs.interactions[p], legs.types[p]), lanes_of(legs.length[p])
        n, order = int(legs.n_interactions[p]), int(legs.order[p])
        bound = lane(leg_bound(geometry, tables, leg, n, length, order), 0)
        bounds[p] = min(bound, legs.fraction[p])
    return bounds


class BlockBounds(NamedTuple):
    """Legs of a block from the edge.

    Attributes
    ----------
    low, high
        Their angles; or the least and the largest of all, whose roots are the least of all.
    length, kept, least
        Their lengths [m], the fraction of the power that they keep at most, and the power
        thresholds; or the least, the largest, and the least of all.
    """

    low: FaceAngles
    high: FaceAngles
    length: Lanes
    kept: Lanes
    least: Lanes


@jit(inline=True)
def bounds_of_block(legs: BlockBounds, rows: Floats) -> BlockBounds:
    """Bound what legs have in common; `rows` is scratch."""
    at = legs.low
    columns = at.cos_half, at.root_o, at.root_n, legs.length, legs.kept, legs.least
    for k, values in enumerate(columns):
        store(rows[k], values)
    low = high = 0
    for j in range(1, WIDTH):
        low = j if rows[0, j] > rows[0, low] else low  # half the angle is between 0 and pi
        high = j if rows[0, j] < rows[0, high] else high
        for k in (1, 2, 3, 5):
            rows[k, 0] = min(rows[k, 0], rows[k, j])
        rows[4, 0] = max(rows[4, 0], rows[4, j])
    roots = lanes_of(rows[1, 0]), lanes_of(rows[2, 0])
    length, kept, least = lanes_of(rows[3, 0]), lanes_of(rows[4, 0]), lanes_of(rows[5, 0])
    for k, values in enumerate((at.sin_half, at.cos_part, at.sin_part)):
        store(rows[1 + k], values)
    one, other = angle_of(rows, low, roots), angle_of(rows, high, roots)
    return BlockBounds(one, other, length, kept, least)


@jit(inline=True)
def angle_of(rows: Floats, j: int, roots: tuple[Lanes, Lanes]) -> FaceAngles:
    """Angles of one leg, by columns from `cos_half` to `sin_part`, with other roots."""
    return FaceAngles(
        lanes_of(0.0), lanes_of(rows[0, j]), lanes_of(rows[1, j]), lanes_of(rows[2, j]),
        lanes_of(rows[3, j]), *roots,
    )  # fmt: skip


@jit(inline=True, fast=True)
def power_behind(
    tables: FieldTables,
    wedge: Wedge,
    directions: tuple[FaceAngles, FaceAngles, FaceAngles],
    shadow: Floats,
    lengths: tuple[Lanes, Lanes],
    rise: Lanes | float,
) -> Lanes:
    """`bounds.wedge_bound` of paths that rise at most so far [m].

    `lengths` holds the sum and the product of the lengths before and behind the edge [m, m^2].
    """
    total, product = lengths
    sin_beta = total / sqrt(total * total + rise * rise)
    sqrt_2kl = sqrt((4.0 * math.pi / tables.wavelength) * product * (1.0 / total))
    return wedge_bound(tables, wedge, directions, shadow, sqrt_2kl, sin_beta)


@jit(inline=True, fast=True)
def bounds_of_eight(
    geometry: TraceGeometry,
    tables: FieldTables,
    wedge: Wedge,
    bounds: EdgeBounds,
    p: int,
    order: int,
    whole: BlockBounds,
) -> Lanes:
    """Bounds on the power of each path over eight legs to the edge, at all receivers of a block.

    Parameters
    ----------
    geometry, tables, wedge, bounds
        As for `vertical_edges.sum_vertical_edge`.
    p, order
        The first of the legs, and the wall reflections behind the edge.
    whole
        Bounds for the block.
    """
    columns, height = bounds.columns, geometry.building.height
    length = load(columns[LENGTH_IN, p:])
    left = float(geometry.max_reflections - order) - load(columns[ORDER_IN, p:])
    total, product = whole.length + length, whole.length * length
    rise = (maximum(left, 0.0) + 1.0) * height
    incident = FaceAngles(
        left, load(columns[ANGLES + 1, p:]), load(columns[ANGLES + 2, p:]),
        load(columns[ANGLES + 3, p:]), load(columns[ANGLES + 4, p:]),
        load(columns[ANGLES + 5, p:]), load(columns[ANGLES + 6, p:]),
    )  # fmt: skip
    directions = whole.low, whole.high, incident
    behind = power_behind(tables, wedge, directions, bounds.shadow, (total, product), rise)
    return free_space(tables, total) * load(columns[BOUND, p:]) * whole.kept * behind


@jit(inline=True)
def next_legs(
    geometry: TraceGeometry,
    tables: FieldTables,
    beams: VerticalEdgeBeams,
    bounds: EdgeBounds,
    p: int,
    here: tuple[Block, BlockBounds],
    workspace: Workspace,
    collector: Collector,
) -> tuple[int, int]:
    """Find up to eight legs to the edge that may be strong at some receiver, from leg p on.

    Their numbers are written to `workspace.ways`; bounds on the others are added to what is left
    out. Returns how many there are, and the leg to go on from.

    Parameters
    ----------
    geometry, tables, beams, bounds, workspace, collector
        As for `vertical_edges.sum_vertical_edge`.
    p, here
        The leg, the block, and bounds for all of it.
    """
    (block, whole), legs, n = here, beams.legs, 0
    order, last = int(beams.tree.link[block.beam, ORDER]), len(legs.order)
    left = geometry.max_reflections - order - int(legs.order[p])
    if left < 0:
        return 0, last
    is_bounded, least = has_threshold(collector), lane(whole.least, 0)
    if len(beams.ranks) > 0:
        kept = whole.kept * (at_one_metre(tables) * bounds.most)
        rest, skips = all_from(beams.ranks, p, kept, whole.length, whole.least)
        if skips:
            leave_out(workspace, block.weight * rest * collector.heights[left, LENGTHS])
            return 0, int(beams.ranks[p, 2])
    row, together = workspace.rows[0], 0.0
    if is_bounded:
        store(row, bounds_of_eight(geometry, tables, beams.edge.wedge, bounds, p, order, whole))
    for q in range(p, min(p + WIDTH, last)):
        left = geometry.max_reflections - order - int(legs.order[q])
        if left < 0:
            break
        if is_bounded and row[q - p] < least:
            together += row[q - p] * legs.weight[q] * collector.heights[left, LENGTHS]
        else:
            workspace.ways[n] = q
            n += 1
    if is_bounded:
        leave_out(workspace, block.weight * together)
    return n, min(p + WIDTH, last)


@jit(inner=True, fast=True)
def pair_bound(
    geometry: TraceGeometry,
    tables: FieldTables,
    beams: VerticalEdgeBeams,
    p: int,
    out: LegsOut,
    limit: tuple[Floats, Lanes, Lanes],
    collector: Collector,
) -> tuple[Lanes, tuple[float, Lanes]]:
    """Bound on the power of each path of a pair of legs.

    `limit` holds the shadow of `EdgeBounds`, a bound on what all walls on the way leave, and the
    power threshold. Also returns how many paths there are, and all of them together over the bound.
    """
    shadow, arriving, least = limit
    legs, height = beams.legs, geometry.building.height
    left = geometry.max_reflections - out.order - int(legs.order[p])
    total, product = out.length + legs.length[p], out.length * legs.length[p]
    several = 2.0 * left + 1.0, all_heights(collector.heights, left, total, height)
    free = free_space(tables, total) * arriving
    if not any_of(free * WEDGE_POWER >= least * NEGLIGIBLE):
        return free * WEDGE_POWER, several
    rise, directions = (left + 1.0) * height, (out.angles, out.angles, angles_of(legs, p))
    behind = power_behind(tables, beams.edge.wedge, directions, shadow, (total, product), rise)
    few = free * WEDGE_POWER < least * NEGLIGIBLE
    return free * where(few, WEDGE_POWER, behind), several
