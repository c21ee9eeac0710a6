"""A path in the plan view: its leg from a root to a point, unfolded to a straight line.

Heights are linear in the unfolded horizontal distance, with floor and ceiling unfolded too, so
a leg is described by the distances at which it meets walls (docs/theory.md, section 4). Eight
legs are unfolded side by side: those of one beam to eight points, which meet the same walls.
"""

from typing import NamedTuple

import numpy as np

from raytrace.arrays import Floats, Int32s, Ints
from raytrace.kernels.beams import CELL, EDGE, IMAGE_X, IMAGE_Y, INTERACTIONS, PARENT, REFLECTED
from raytrace.kernels.compiling import jit
from raytrace.kernels.lanes import (
    WIDTH,
    Lanes,
    absolute,
    all_of,
    lanes_of,
    load,
    maximum,
    sqrt,
    store,
)
from raytrace.kernels.plan_view import WALL, PlanView, cross

REFLECT_WALL, REFLECT_PARTIAL, PASS_PARTIAL, PASS_WALL = 0, 1, 2, 3
"""Types of interaction: reflection by a wall, or by a partial wall; passage of a partial wall,
which is a transmission where it is solid; transmission through a wall."""

DISTANCE, SKEW, NORMAL, POINT_X, POINT_Y = range(5)
"""Columns of `Leg.interactions`: horizontal distance from the root [m]; sine and cosine of the
plan-view direction against the wall's normal; the point [m]."""

TYPE, SURFACE, OUTDOORS, FIRST = range(4)
"""Columns of `Leg.types`: one of the four above; the slab (full wall) or the profile; whether the
leg is outdoors before the interaction, where the row after the last one holds that of the end; and
the first interaction of the leg that has the same coefficients at any height, or it itself."""

NEAREST_M = 1e-9
"""Shortest horizontal leg [m]: a receiver straight above the transmitter is moved this far off."""


class Leg(NamedTuple):
    """Eight unfolded legs that meet the same walls.

    Attributes
    ----------
    interactions
        (n + 1, 5, 8) float64, see `DISTANCE` and its neighbours; the last row holds the distance of
        the end.
    types
        (n + 1, 4) int64, see `TYPE` and its neighbours.
    """

    interactions: Floats
    types: Ints


def new_leg(link: Int32s) -> Leg:
    """Legs, uninitialised, with capacity for the interactions of any of the beams."""
    n = max_interactions(link) + 1
    return Leg(np.empty((n, 5, WIDTH)), np.empty((n, 4), np.int64))


def max_interactions(link: Int32s) -> int:
    """Largest number of interactions of any beam's leg."""
    return int(link[:, INTERACTIONS].max(initial=0))


@jit(inline=True)
def image_of(images: Floats, i: int, k: int) -> Lanes:
    """Coordinate of the root's image in beam i: one for all, or one each."""
    if images.ndim == 3:
        return load(images[i, k])
    return lanes_of(images[i, k])


@jit(inline=True)
def unfold(
    view: PlanView,
    link: Int32s,
    images: Floats,
    i: int,
    target: tuple[Lanes, Lanes],
    leg: Leg,
) -> tuple[int, Lanes, Lanes, Lanes]:
    """Walk back from eight points to the root of the beam that they are visible from.

    Parameters
    ----------
    view, link
        Plan view and beams.
    images
        (n_beams, >= 2) image of the root in each beam [m], or (n_beams, 2, 8) those of eight roots.
    i
        The beam.
    target
        The points [m].
    leg
        Filled from the root on.

    Returns
    -------
    n, length, ux, uy
        Number of interactions, horizontal lengths [m], plan-view directions at the root.
    """
    x, y = target
    px, py = image_of(images, i, IMAGE_X), image_of(images, i, IMAGE_Y)
    length = maximum(sqrt((x - px) * (x - px) + (y - py) * (y - py)), NEAREST_M)
    ux, uy = (x - px) / length, (y - py) / length
    n = link[i, INTERACTIONS]
    rest, k = length, n
    store(leg.interactions[n, DISTANCE], length)
    leg.types[n, OUTDOORS] = view.is_outdoors[link[i, CELL]]
    while k > 0:
        e = link[i, EDGE]
        if e < 0:
            break
        passed = link[i, REFLECTED] == 0
        if passed and view.profile[e] < 0:
            i = link[i, PARENT]
            continue
        k -= 1
        px, py = image_of(images, i, IMAGE_X), image_of(images, i, IMAGE_Y)
        x1, y1 = view.ends[e, 0], view.ends[e, 1]
        dx, dy = view.ends[e, 2] - x1, view.ends[e, 3] - y1
        t = cross(x1 - px, y1 - py, dx, dy) / cross(x - px, y - py, dx, dy)
        x, y = px + t * (x - px), py + t * (y - py)
        rest = rest * t
        i = link[i, PARENT]
        leg.types[k, OUTDOORS] = view.is_outdoors[link[i, CELL]]
        nx, ny = view.plane[e, 0], view.plane[e, 1]
        normal = nx * ux + ny * uy
        if not passed:  # the direction is mirrored, since the reflection may be at the root itself
            ux, uy, normal = ux - 2.0 * normal * nx, uy - 2.0 * normal * ny, -normal
        store(leg.interactions[k, DISTANCE], rest)
        store(leg.interactions[k, SKEW], nx * uy - ny * ux)
        store(leg.interactions[k, NORMAL], normal)
        store(leg.interactions[k, POINT_X], x)
        store(leg.interactions[k, POINT_Y], y)
        leg.types[k, TYPE], leg.types[k, SURFACE] = type_and_surface(view, e, passed)
    mark_equal(leg, n)
    return n, length, ux, uy


@jit(inline=True)
def mark_equal(leg: Leg, n: int) -> None:
    """Set `FIRST` of n interactions: walls of one slab, met at the same angle in the plan view."""
    for k in range(n):
        first, kind = k, leg.types[k, TYPE]
        normal = absolute(load(leg.interactions[k, NORMAL]))
        for j in range(k if kind in (REFLECT_WALL, PASS_WALL) else 0):
            if leg.types[j, TYPE] != kind or leg.types[j, SURFACE] != leg.types[k, SURFACE]:
                continue
            other = absolute(load(leg.interactions[j, NORMAL]))
            if leg.types[j, FIRST] == j and all_of((normal <= other) & (normal >= other)):
                first = j
                break
        leg.types[k, FIRST] = first


@jit(inline=True)
def type_and_surface(view: PlanView, e: int, passed: bool) -> tuple[int, int]:
    """Type of the interaction at an edge, and its slab or profile."""
    profile = int(view.profile[e])
    if view.kind[e] == WALL:
        slab = int(view.interval_slab[view.profile_intervals[profile]])
        return (PASS_WALL if passed else REFLECT_WALL), slab
    if passed:
        return PASS_PARTIAL, profile
    return REFLECT_PARTIAL, profile


@jit(inline=True)
def has_height_limits(leg: Leg, n: int) -> bool:
    """Whether validity varies: legs meet a partial wall, go through a wall, or are outdoors."""
    met = leg.types[n, OUTDOORS] > 0
    for k in range(n):
        met = met or leg.types[k, TYPE] != REFLECT_WALL or leg.types[k, OUTDOORS] > 0
    return met
