"""Upper bounds on the power of paths over a vertical edge."""

import math
from typing import NamedTuple

import numpy as np

from raytrace.arrays import Floats
from raytrace.kernels.bounds import WEDGE_POWER, all_heights, free_space, leg_bound, wedge_bound
from raytrace.kernels.building import TraceGeometry
from raytrace.kernels.compiling import jit
from raytrace.kernels.field_tables import FieldTables
from raytrace.kernels.lanes import Lanes, any_of, lane, lanes_of, sqrt, where
from raytrace.kernels.losses import NEGLIGIBLE
from raytrace.kernels.unfolding import Leg
from raytrace.kernels.vertical_edge_legs import LegsIn, LegsOut, VerticalEdgeBeams, angles_of
from raytrace.kernels.workspace import Collector


class EdgeBounds(NamedTuple):
    """Bounds on what arrives at an edge and leaves it; not read without a power threshold.

    Attributes
    ----------
    legs
        (n_legs,) see `vertical_edge_legs.bounds_of_legs`.
    shadow
        See `bounds.wedge_bound`.
    most
        Largest power behind the edge over that of a free path as long.
    """

    legs: Floats
    shadow: Floats
    most: float


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
    sqrt_2kl = sqrt((4.0 * math.pi / tables.wavelength) * product * (1.0 / total))
    rise = (left + 1.0) * height
    sin_beta = total / sqrt(total * total + rise * rise)
    directions = out.angles, angles_of(legs, p)
    behind = wedge_bound(tables, beams.edge.wedge, directions, shadow, sqrt_2kl, sin_beta)
    few = free * WEDGE_POWER < least * NEGLIGIBLE
    return free * where(few, WEDGE_POWER, behind), several
