"""Checks of one wall and its openings; the first problem found raises `PlanError`."""

from bisect import bisect_left
from collections.abc import Sequence
from heapq import heappop, heappush
from typing import get_args

from floorplans.checks.materials import check_slab
from floorplans.errors import Place, PlanError, unknown_name
from floorplans.materials import Own
from floorplans.values import (
    COORDINATE,
    LENGTH,
    MAX_OPENINGS,
    check_count,
    check_number,
)
from floorplans.walls import TOLERANCE_M, Opening, OpeningKind, Wall, WallKind

WALL_KINDS: tuple[WallKind, ...] = get_args(WallKind)
OPENING_KINDS: tuple[OpeningKind, ...] = get_args(OpeningKind)


def check_wall(wall: Wall, ceiling_m: float, own: Own, place: Place) -> None:
    """Check a single wall: its ends, numbers, material and openings.

    Parameters
    ----------
    wall : Wall
    ceiling_m : float
        Height of the ceiling above the floor [m].
    own : Own
        The plan's own materials.
    place : Place
        The wall's table, for the message.

    Raises
    ------
    PlanError
    """
    for key, point in (("start", wall.start), ("end", wall.end)):
        for coordinate in point:
            check_number(coordinate, COORDINATE, (*place, key))
    if wall.length_m < TOLERANCE_M:
        x, y = wall.start
        raise PlanError(
            f"the wall has no length: it starts and ends at ({x:g}, {y:g}); "
            "give two different points",
            place,
        )
    check_slab(wall.material, wall.thickness_m, own, place)
    check_number(wall.thickness_m, LENGTH, (*place, "thickness_m"))
    check_number(wall.height_m, LENGTH, (*place, "height_m"))
    if wall.height_m > ceiling_m:
        raise PlanError(
            f"the wall rises above the ceiling at {ceiling_m:g} m; lower it, or leave height_m out",
            (*place, "height_m"),
            wall.height_m,
        )
    check_openings(wall, own, place)


def check_openings(wall: Wall, own: Own, place: Place) -> None:
    """Check that the openings of a wall lie inside it and do not overlap.

    Parameters
    ----------
    wall : Wall
    own : Own
        The plan's own materials.
    place : Place
        The wall's table, for the message.

    Raises
    ------
    PlanError
    """
    openings = wall.openings
    check_count(openings, MAX_OPENINGS, (*place, "openings"))
    for index, opening in enumerate(openings):
        here = (*place, "openings", index)
        _check_extent_along(opening, wall.length_m, here)
        _check_extent_upwards(opening, wall.height_m, here)
        _check_filling(opening, wall.thickness_m, own, here)
    if (pair := overlapping_pair(openings)) is not None:
        first, second = pair
        o = openings[first]
        raise PlanError(
            f"the opening overlaps openings[{first}], which reaches from {o.offset_m:g} m to "
            f"{o.end_m:g} m along the wall and from {o.sill_m:g} m to {o.head_m:g} m above "
            "the floor; move or shrink one of them",
            (*place, "openings", second),
        )


def overlapping_pair(openings: Sequence[Opening]) -> tuple[int, int] | None:
    """Find two openings of a wall that overlap.

    A sweep along the wall: the openings at a place do not overlap, so they are sorted by height,
    and a new one can overlap only the next below and above it. Takes n log n comparisons.

    Returns
    -------
    (int, int) or None
        Their indices, ascending.
    """
    wide = [k for k, o in enumerate(openings) if min(o.width_m, o.head_m - o.sill_m) > TOLERANCE_M]
    here: list[tuple[float, int]] = []  # (sill_m, index), ascending
    ends: list[tuple[float, int]] = []  # (end_m, index), a heap
    for k in sorted(wide, key=lambda k: openings[k].offset_m):
        new = openings[k]
        while ends and ends[0][0] <= new.offset_m + TOLERANCE_M:
            _, past = heappop(ends)
            del here[bisect_left(here, (openings[past].sill_m, past))]
        at = bisect_left(here, (new.sill_m, k))
        for _, other in here[max(at - 1, 0) : at + 1]:
            if new.overlaps(openings[other]):
                return min(k, other), max(k, other)
        here.insert(at, (new.sill_m, k))
        heappush(ends, (new.end_m, k))
    return None


def wall_kind(name: str, place: Place) -> WallKind:
    """Return the kind of wall with this name; raise `PlanError` if there is none."""
    for kind in WALL_KINDS:
        if kind == name:
            return kind
    raise PlanError(unknown_name("kind of wall", name, WALL_KINDS), place, name)


def opening_kind(name: str, place: Place) -> OpeningKind:
    """Return the kind of opening with this name; raise `PlanError` if there is none."""
    for kind in OPENING_KINDS:
        if kind == name:
            return kind
    raise PlanError(unknown_name("kind of opening", name, OPENING_KINDS), place, name)


def _check_extent_along(opening: Opening, length_m: float, place: Place) -> None:
    check_number(opening.width_m, LENGTH, (*place, "width_m"))
    if not opening.offset_m >= 0:
        raise PlanError(
            "the opening begins before its wall; expected 0 or more [m]",
            (*place, "offset_m"),
            opening.offset_m,
        )
    if not opening.end_m <= length_m + TOLERANCE_M:
        raise PlanError(
            f"the opening ends {opening.end_m:g} m along a wall of {length_m:g} m; with its width "
            f"of {opening.width_m:g} m, expected at most {max(length_m - opening.width_m, 0):g}",
            (*place, "offset_m"),
            opening.offset_m,
        )


def _check_extent_upwards(opening: Opening, height_m: float, place: Place) -> None:
    if not opening.sill_m >= 0:
        raise PlanError(
            "the opening begins below the floor; expected 0 or more [m]",
            (*place, "sill_m"),
            opening.sill_m,
        )
    if not opening.head_m <= height_m:
        raise PlanError(
            f"the opening is higher than its wall; expected at most {height_m:g} [m]",
            (*place, "head_m"),
            opening.head_m,
        )
    if not opening.sill_m < opening.head_m:
        raise PlanError(
            f"the sill is not below the head; expected less than {opening.head_m:g} [m]",
            (*place, "sill_m"),
            opening.sill_m,
        )


def _check_filling(opening: Opening, wall_m: float, own: Own, place: Place) -> None:
    opening_kind(opening.kind, (*place, "kind"))
    if opening.material is not None:
        thickness_m = wall_m if opening.thickness_m is None else opening.thickness_m
        check_slab(opening.material, thickness_m, own, place)
    if opening.thickness_m is not None:
        check_number(opening.thickness_m, LENGTH, (*place, "thickness_m"))
        if opening.material is None:
            raise PlanError(
                "thickness without a material; name the filling's material, "
                "or leave thickness_m out",
                (*place, "thickness_m"),
                opening.thickness_m,
            )
