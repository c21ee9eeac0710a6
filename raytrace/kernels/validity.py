"""Whether the heights of a path agree with the walls that its legs meet.

A path that grazes a horizontal edge (`GRAZING_M`) exists on one side of it only. It is replaced by
paths that pass beside it, with their weight halved: one-sided evaluations (docs/theory.md, section
14).
"""

from raytrace.kernels.building import Building
from raytrace.kernels.compiling import jit
from raytrace.kernels.lanes import Lanes, Mask, all_false, any_of, floor, lanes_of, load, where
from raytrace.kernels.plan_view import GRAZING_M, at_horizontal_edge, in_building, slabs_at
from raytrace.kernels.unfolding import (
    DISTANCE,
    OUTDOORS,
    PASS_PARTIAL,
    PASS_WALL,
    REFLECT_WALL,
    SURFACE,
    TYPE,
    Leg,
)

INVALID = -1e6
"""Number of transmissions of a path whose heights rule it out; it stays below 0 when others are
added."""

OFFSET_M = 2.0 * GRAZING_M
"""Offset of the heights in a one-sided evaluation [m]."""

ONE_SIDED_OFFSETS_M = (0.0, -OFFSET_M, OFFSET_M)
"""Height offsets with which a path is evaluated [m]: none, and where it grazes a horizontal edge,
below and above it."""


@jit(inline=True)
def meets_sky(building: Building, leg: Leg, n: int, z_root: Lanes, slope: Lanes) -> Mask:
    """Which legs are reflected at the ceiling where there is none; arguments as for `walls_met`."""
    half = 0.5 / building.height
    before, found = floor(z_root * half + 0.5), all_false()
    for k in range(n + 1):
        z = z_root + slope * load(leg.interactions[k, DISTANCE])
        storey = floor(z * half + 0.5)
        if leg.types[k, OUTDOORS]:
            found = found | (storey > before) | (storey < before)
        before = storey
    return found


@jit(inline=True)
def walls_met(
    building: Building, leg: Leg, n: int, z_root: Lanes, slope: Lanes, offset: float
) -> tuple[Lanes, Mask]:
    """Numbers of transmissions on legs; below 0 for one that is reflected where nothing stands.

    Parameters
    ----------
    building, leg, n
        The building, the legs and their number of interactions.
    z_root, slope
        Unfolded heights [m] at the root, and their growth over horizontal distance.
    offset
        Added to the heights [m].

    Returns
    -------
    n_transmissions, grazing
        Numbers of transmissions, and which legs graze a horizontal edge.
    """
    n_transmissions, grazing = lanes_of(0.0), all_false()
    if building.has_outdoors:
        n_transmissions = where(
            meets_sky(building, leg, n, z_root, slope), INVALID, n_transmissions
        )
    for k in range(n):
        kind, surface = leg.types[k, TYPE], leg.types[k, SURFACE]
        if kind == REFLECT_WALL:
            continue
        if kind == PASS_WALL:
            n_transmissions = n_transmissions + 1.0
            continue
        z = z_root + slope * load(leg.interactions[k, DISTANCE]) + offset
        z = in_building(z, building.height)
        grazing = grazing | at_horizontal_edge(building.plan, surface, z)
        solid = slabs_at(building.plan, surface, z) >= 0.0
        if kind == PASS_PARTIAL:
            n_transmissions = where(solid, n_transmissions + 1.0, n_transmissions)
        else:
            n_transmissions = where(solid, n_transmissions, INVALID)
    return n_transmissions, grazing


@jit(inline=True)
def validity_weight(n_transmissions: Lanes, max_transmissions: int) -> Lanes:
    """1 for valid paths with no more transmissions than allowed, 0 for others."""
    return where(
        (n_transmissions >= 0.0) & (n_transmissions <= float(max_transmissions)), lanes_of(1.0), 0.0
    )


@jit(inline=True)
def one_sided_weight(
    side: int, weight: Lanes, grazing: Mask, grazes_now: Mask, fraction: float
) -> tuple[Lanes, Mask]:
    """Weights of paths in one evaluation, and which of them graze a horizontal edge.

    Parameters
    ----------
    side, weight
        Number of the evaluation, 0 for that without offset, and the weights of the paths valid in
        it.
    grazing, grazes_now
        Which paths graze in the evaluation without offset, and which do in this one.
    fraction
        Of the weight, in each one-sided evaluation.
    """
    if side == 0:
        return where(grazes_now, 0.0, weight), grazes_now
    return where(grazing, weight * fraction, 0.0), grazing


@jit(inline=True)
def next_evaluation(k: int, side: int, grazing: Mask) -> tuple[int, int]:
    """Image height and evaluation that follow: a one-sided one if a path grazes an edge."""
    if side + 1 < len(ONE_SIDED_OFFSETS_M) and any_of(grazing):
        return k, side + 1
    return k + 1, 0
