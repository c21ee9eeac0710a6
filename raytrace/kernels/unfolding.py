"""A path in the plan view: its leg from a root to a point, unfolded to a straight line.

Heights are linear in the unfolded horizontal distance, with floor and ceiling unfolded too, so
a leg is known by the distances at which it meets walls (docs/theory.md, section 4).
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from raytrace.kernels.beams import EDGE, IMAGE_X, IMAGE_Y, ITEMS, PARENT, REFLECTED
from raytrace.kernels.compiling import jit
from raytrace.kernels.plan_view import (
    TIE_M,
    WALL,
    Floats,
    Ints,
    PlanView,
    cross,
    folded,
    material_at,
)

REFLECT_WALL, REFLECT_PARTIAL, PASS_PARTIAL, PASS_WALL = 0, 1, 2, 3
"""What a leg does at an item: is reflected by a wall, by a partial wall, passes one that is open
at some heights, or goes through a wall."""

DISTANCE, SKEW, NORMAL, ITEM_X, ITEM_Y = range(5)
"""Columns of `Leg.items`: horizontal distance from the root [m]; sine and cosine of the plan-view
direction against the wall's normal; where it is [m]."""

KIND, WHAT = range(2)
"""Columns of `Leg.marks`: one of the four above; the slab (full wall) or the profile."""

MISFIT, TOUCHING = -1, -2
"""What `walls_met` finds of a leg that its heights rule out, or that just touches a rim."""


NUDGE_M = 2.0 * TIE_M
"""How far above and below a leg that touches a rim it is looked at."""

NEAREST_M = 1e-9
"""Shortest horizontal leg [m]: a receiver straight above the source is taken this far off."""


class Leg(NamedTuple):
    """Room for one unfolded leg.

    Attributes
    ----------
    items
        (n, 5) float64, see `DISTANCE` and its neighbours.
    marks
        (n, 2) int64, see `KIND` and `WHAT`.
    """

    items: Floats
    marks: Ints


@jit()
def new_leg(n_items: int) -> Leg:
    """Room for a leg of that many items."""
    return Leg(np.empty((n_items, 5)), np.empty((n_items, 2), np.int64))


@jit()
def most_items(link: NDArray[np.int32]) -> int:
    """Most items that any beam's leg has."""
    most = 0
    for i in range(len(link)):
        most = max(most, link[i, ITEMS])
    return most


@jit(inline=True)
def unfold(
    view: PlanView,
    link: NDArray[np.int32],
    images: Floats,
    i: int,
    target: tuple[float, float],
    leg: Leg,
) -> tuple[int, float, float, float]:
    """Walk back from a point to the root of the beam that lights it.

    Parameters
    ----------
    view, link
        Plan view and beams.
    images
        (n_beams, >= 2) image of the root in each beam [m].
    i
        The beam.
    target
        The point [m].
    leg
        Filled from the root on.

    Returns
    -------
    n, length, ux, uy
        Number of items, horizontal length [m], plan-view direction at the root.
    """
    x, y = target
    px, py = images[i, IMAGE_X], images[i, IMAGE_Y]
    length = max(math.sqrt((x - px) ** 2 + (y - py) ** 2), NEAREST_M)
    n = link[i, ITEMS]
    rest, k = length, n
    while k > 0:
        e = link[i, EDGE]
        if e < 0:
            break
        passed = link[i, REFLECTED] == 0
        if passed and view.profile[e] < 0:
            i = link[i, PARENT]
            continue
        k -= 1
        px, py = images[i, IMAGE_X], images[i, IMAGE_Y]
        x1, y1 = view.ends[e, 0], view.ends[e, 1]
        dx, dy = view.ends[e, 2] - x1, view.ends[e, 3] - y1
        t = cross(x1 - px, y1 - py, dx, dy) / cross(x - px, y - py, dx, dy)
        x, y = px + t * (x - px), py + t * (y - py)
        rest *= t
        i = link[i, PARENT]
        ux, uy = (x - images[i, IMAGE_X]) / rest, (y - images[i, IMAGE_Y]) / rest
        nx, ny = view.plane[e, 0], view.plane[e, 1]
        leg.items[k, DISTANCE] = rest
        leg.items[k, SKEW] = nx * uy - ny * ux
        leg.items[k, NORMAL] = nx * ux + ny * uy
        leg.items[k, ITEM_X], leg.items[k, ITEM_Y] = x, y
        leg.marks[k, KIND], leg.marks[k, WHAT] = mark_of(view, e, passed)
    return n, length, (x - images[i, IMAGE_X]) / rest, (y - images[i, IMAGE_Y]) / rest


@jit(inline=True)
def mark_of(view: PlanView, e: int, passed: bool) -> tuple[int, int]:
    """Kind of an item and what it stands for."""
    profile = int(view.profile[e])
    if view.kind[e] == WALL:
        slab = int(view.bin_material[view.profile_bins[profile]])
        return (PASS_WALL if passed else REFLECT_WALL), slab
    if passed:
        return PASS_PARTIAL, profile
    return REFLECT_PARTIAL, profile


@jit(inline=True)
def walls_met(
    view: PlanView,
    leg: Leg,
    n: int,
    z_root: float,
    slope: float,
    height: float,
    nudge: float,
) -> int:
    """How many walls a leg goes through; `MISFIT` if it is reflected where there is no wall.

    Parameters
    ----------
    view, leg, n
        Plan view, the leg and its number of items.
    z_root, slope
        Unfolded height [m] at the root, and its growth over horizontal distance.
    height
        Of the ceiling [m].
    nudge
        By how much the leg is taken to be higher [m]; with 0, `TOUCHING` is returned for one that
        goes through the rim of a wall.
    """
    through = 0
    for k in range(n):
        kind = leg.marks[k, KIND]
        if kind == REFLECT_WALL:
            continue
        if kind == PASS_WALL:
            through += 1
            continue
        z = folded(z_root + slope * leg.items[k, DISTANCE] + nudge, height)
        if nudge == 0.0 and is_at_rim(view, leg.marks[k, WHAT], z):
            return TOUCHING
        is_open = material_at(view, leg.marks[k, WHAT], z) < 0
        if kind == PASS_PARTIAL:
            through += 0 if is_open else 1
        elif is_open:
            return MISFIT
    return through


@jit(inline=True)
def is_at_rim(view: PlanView, profile: int, z: float) -> bool:
    """Whether a height is that of a rim of a profile."""
    near = False
    for k in range(view.profile_bins[profile], view.profile_bins[profile + 1] - 1):
        near = near or abs(z - view.bin_top[k]) < TIE_M
    return near


@jit(inline=True)
def fitting(
    view: PlanView, leg: Leg, n: int, z_root: float, slope: float, height: float, most_walls: int
) -> float:
    """Share of a leg that its heights allow: 1, 0, or one half where it touches a rim."""
    met = walls_met(view, leg, n, z_root, slope, height, 0.0)
    if met != TOUCHING:
        return 1.0 if 0 <= met <= most_walls else 0.0
    share = 0.0
    for nudge in (-NUDGE_M, NUDGE_M):
        if 0 <= walls_met(view, leg, n, z_root, slope, height, nudge) <= most_walls:
            share += 0.5
    return share


@jit(inline=True)
def is_constrained(leg: Leg, n: int) -> bool:
    """Whether a leg meets a partial wall, or goes through one, so that it has to be looked at."""
    met = False
    for k in range(n):
        met = met or leg.marks[k, KIND] != REFLECT_WALL
    return met


@jit()
def image_heights(z: float, height: float, max_bounces: int) -> tuple[Floats, Ints]:
    """Images of a height in floor and ceiling.

    Returns
    -------
    heights
        (2 max_bounces + 1,) unfolded heights [m]: the height itself, then for 1, 2, ...
        reflections the image above and the image below.
    bounces
        (2 max_bounces + 1,) number of reflections of each.
    """
    heights = np.empty(2 * max_bounces + 1)
    bounces = np.zeros(2 * max_bounces + 1, np.int64)
    heights[0] = z
    for m in range(1, max_bounces + 1):
        up = z if m % 2 == 0 else height - z
        heights[2 * m - 1] = m * height + up
        heights[2 * m] = -m * height + up
        bounces[2 * m - 1] = bounces[2 * m] = m
    return heights, bounces
