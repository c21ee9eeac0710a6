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
from raytrace.kernels.plan_view import WALL, Floats, Ints, PlanView, cross, folded, material_at

REFLECT_WALL, REFLECT_PARTIAL, PASS_PARTIAL = 0, 1, 2
"""What a leg does at an item: is reflected by a wall, by a partial wall, or passes it."""

DISTANCE, SKEW, NORMAL, ITEM_X, ITEM_Y = range(5)
"""Columns of `Leg.items`: horizontal distance from the root [m]; sine and cosine of the plan-view
direction against the wall's normal; where it is [m]."""

KIND, WHAT = range(2)
"""Columns of `Leg.marks`: one of the three above; the slab (full wall) or the profile."""


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
        return REFLECT_WALL, int(view.bin_material[view.profile_bins[profile]])
    if passed:
        return PASS_PARTIAL, profile
    return REFLECT_PARTIAL, profile


@jit(inline=True)
def heights_fit(
    view: PlanView, leg: Leg, n: int, z_root: float, slope: float, height: float
) -> bool:
    """Whether a leg finds wall where it is reflected and none where it passes.

    Parameters
    ----------
    view, leg, n
        Plan view, the leg and its number of items.
    z_root, slope
        Unfolded height [m] at the root, and its growth over horizontal distance.
    height
        Of the ceiling [m].
    """
    for k in range(n):
        kind = leg.marks[k, KIND]
        if kind == REFLECT_WALL:
            continue
        z = folded(z_root + slope * leg.items[k, DISTANCE], height)
        if (material_at(view, leg.marks[k, WHAT], z) < 0) != (kind == PASS_PARTIAL):
            return False
    return True


@jit(inline=True)
def is_constrained(leg: Leg, n: int) -> bool:
    """Whether a leg meets a partial wall, so that its heights matter."""
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
