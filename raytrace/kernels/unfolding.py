"""A path in the plan view: its leg from a root to a point, unfolded to a straight line.

Heights are linear in the unfolded horizontal distance, with floor and ceiling unfolded too, so
a leg is known by the distances at which it meets walls (docs/theory.md, section 4). Eight legs are
unfolded side by side: those of one beam to eight points, which meet the same walls.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from raytrace.kernels.beams import EDGE, IMAGE_X, IMAGE_Y, ITEMS, PARENT, REFLECTED
from raytrace.kernels.compiling import jit
from raytrace.kernels.lanes import (
    WIDTH,
    Lanes,
    Mask,
    absolute,
    any_of,
    floor,
    lanes_of,
    load,
    maximum,
    none_chosen,
    sqrt,
    store,
    where,
)
from raytrace.kernels.plan_view import GRAZING_M, WALL, Floats, Ints, PlanView, cross

REFLECT_WALL, REFLECT_PARTIAL, PASS_PARTIAL, PASS_WALL = 0, 1, 2, 3
"""What a leg does at an item: is reflected by a wall, by a partial wall, passes one that is open
at some heights, or goes through a wall."""

DISTANCE, SKEW, NORMAL, ITEM_X, ITEM_Y = range(5)
"""Columns of `Leg.items`: horizontal distance from the root [m]; sine and cosine of the plan-view
direction against the wall's normal; where it is [m]."""

KIND, WHAT = range(2)
"""Columns of `Leg.marks`: one of the four above; the slab (full wall) or the profile."""

MISFIT = -1e6
"""Number of walls that a leg goes through whose heights rule it out; it stays below 0."""

NUDGE_M = 2.0 * GRAZING_M
"""How far above and below a leg that touches a rim it is looked at."""

LOOKS = (0.0, -NUDGE_M, NUDGE_M)
"""Nudges with which a path is looked at: as it is, and if it touches a rim from both sides, where
it counts half each, as it is there (docs/theory.md, section 14)."""

NEAREST_M = 1e-9
"""Shortest horizontal leg [m]: a receiver straight above the source is taken this far off."""


class Leg(NamedTuple):
    """Room for eight unfolded legs that meet the same walls.

    Attributes
    ----------
    items
        (n, 5, 8) float64, see `DISTANCE` and its neighbours.
    marks
        (n, 2) int64, see `KIND` and `WHAT`.
    """

    items: Floats
    marks: Ints


@jit()
def new_leg(n_items: int) -> Leg:
    """Room for legs of that many items."""
    return Leg(np.empty((n_items, 5, WIDTH)), np.empty((n_items, 2), np.int64))


@jit()
def most_items(link: NDArray[np.int32]) -> int:
    """Most items that any beam's leg has."""
    most = 0
    for i in range(len(link)):
        most = max(most, link[i, ITEMS])
    return most


@jit(inline=True)
def image_of(images: Floats, i: int, k: int) -> Lanes:
    """Coordinate of the root's image in beam i: one for all, or one each."""
    if images.ndim == 3:
        return load(images[i, k])
    return lanes_of(images[i, k])


@jit(inline=True)
def unfold(
    view: PlanView,
    link: NDArray[np.int32],
    images: Floats,
    i: int,
    target: tuple[Lanes, Lanes],
    leg: Leg,
) -> tuple[int, Lanes, Lanes, Lanes]:
    """Walk back from eight points to the root of the beam that lights them.

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
        Number of items, horizontal lengths [m], plan-view directions at the root.
    """
    x, y = target
    px, py = image_of(images, i, IMAGE_X), image_of(images, i, IMAGE_Y)
    length = maximum(sqrt((x - px) * (x - px) + (y - py) * (y - py)), NEAREST_M)
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
        px, py = image_of(images, i, IMAGE_X), image_of(images, i, IMAGE_Y)
        x1, y1 = view.ends[e, 0], view.ends[e, 1]
        dx, dy = view.ends[e, 2] - x1, view.ends[e, 3] - y1
        t = cross(x1 - px, y1 - py, dx, dy) / cross(x - px, y - py, dx, dy)
        x, y = px + t * (x - px), py + t * (y - py)
        rest = rest * t
        i = link[i, PARENT]
        per_length = 1.0 / rest
        ux = (x - image_of(images, i, IMAGE_X)) * per_length
        uy = (y - image_of(images, i, IMAGE_Y)) * per_length
        nx, ny = view.plane[e, 0], view.plane[e, 1]
        store(leg.items[k, DISTANCE], rest)
        store(leg.items[k, SKEW], nx * uy - ny * ux)
        store(leg.items[k, NORMAL], nx * ux + ny * uy)
        store(leg.items[k, ITEM_X], x)
        store(leg.items[k, ITEM_Y], y)
        leg.marks[k, KIND], leg.marks[k, WHAT] = mark_of(view, e, passed)
    ux = (x - image_of(images, i, IMAGE_X)) / rest
    uy = (y - image_of(images, i, IMAGE_Y)) / rest
    return n, length, ux, uy


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
def in_building(z: Lanes, height: float) -> Lanes:
    """Heights in the building of unfolded heights (see `plan_view.folded`)."""
    storeys = floor(z / height)
    rest = z - storeys * height
    odd = storeys - 2.0 * floor(0.5 * storeys)
    return where(odd > 0.5, height - rest, rest)


@jit(inline=True)
def materials_at(view: PlanView, profile: int, z: Lanes) -> Lanes:
    """Materials of a profile at heights z, -1 where it is open."""
    k = int(view.profile_bins[profile + 1]) - 1
    material = lanes_of(float(view.bin_material[k]))
    while k > view.profile_bins[profile]:
        k -= 1
        material = where(z <= view.bin_top[k], float(view.bin_material[k]), material)
    return material


@jit(inline=True)
def at_rim(view: PlanView, profile: int, z: Lanes) -> Mask:
    """Which heights are that of a rim of a profile."""
    near = none_chosen()
    for k in range(view.profile_bins[profile], view.profile_bins[profile + 1] - 1):
        near = near | (absolute(z - view.bin_top[k]) < GRAZING_M)
    return near


@jit(inline=True)
def walls_met(
    view: PlanView,
    leg: Leg,
    n: int,
    z_root: Lanes,
    slope: Lanes,
    height: float,
    nudge: float,
) -> tuple[Lanes, Mask]:
    """How many walls legs go through; below 0 for one that is reflected where there is no wall.

    Parameters
    ----------
    view, leg, n
        Plan view, the legs and their number of items.
    z_root, slope
        Unfolded heights [m] at the root, and their growth over horizontal distance.
    height
        Of the ceiling [m].
    nudge
        By how much the legs are taken to be higher [m].

    Returns
    -------
    through, touching
        Number of walls, and which legs go through the rim of a wall.
    """
    through, touching = lanes_of(0.0), none_chosen()
    for k in range(n):
        kind, what = leg.marks[k, KIND], leg.marks[k, WHAT]
        if kind == REFLECT_WALL:
            continue
        if kind == PASS_WALL:
            through = through + 1.0
            continue
        z = in_building(z_root + slope * load(leg.items[k, DISTANCE]) + nudge, height)
        touching = touching | at_rim(view, what, z)
        solid = materials_at(view, what, z) >= 0.0
        if kind == PASS_PARTIAL:
            through = where(solid, through + 1.0, through)
        else:
            through = where(solid, through, MISFIT)
    return through, touching


@jit(inline=True)
def fitting(through: Lanes, most_walls: int) -> Lanes:
    """1 for paths that fit and go through no more walls than they may, else 0."""
    return where((through >= 0.0) & (through <= float(most_walls)), lanes_of(1.0), 0.0)


@jit(inline=True)
def share_of_look(
    look: int, share: Lanes, touching: Mask, at_rims: Mask, part: float
) -> tuple[Lanes, Mask]:
    """Shares of paths with which a look at them counts, and which of them touch a rim.

    Parameters
    ----------
    look, share
        Which look, 0 the first, and the shares of the paths that fit in it.
    touching, at_rims
        Which paths touched a rim in the first look, and which do in this.
    part
        With which part of them the further looks at such a path count.
    """
    if look == 0:
        return where(at_rims, 0.0, share), at_rims
    return where(touching, share * part, 0.0), touching


@jit(inline=True)
def next_look(k: int, look: int, touching: Mask) -> tuple[int, int]:
    """Image height and look that follow: another look if a path touches a rim."""
    if look + 1 < len(LOOKS) and any_of(touching):
        return k, look + 1
    return k + 1, 0


@jit(inline=True)
def is_constrained(leg: Leg, n: int) -> bool:
    """Whether legs meet a partial wall, or go through one, so that they have to be looked at."""
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
