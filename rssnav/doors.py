"""The doors of a plan, and the same plan with some of them opened or shut."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection
from contextlib import suppress
from dataclasses import replace
from typing import NamedTuple

from floorplans import FloorPlan, Opening, PlanError

LEAF, LEAF_M = "wood", 0.04
"""A shut door where the plan has none to go by, and its thickness [m]."""


class Door(NamedTuple):
    """Number of a door's wall in the plan, and of the opening in the wall."""

    wall: int
    opening: int


def doors_of(plan: FloorPlan) -> tuple[Door, ...]:
    """List the doors of a plan that may be in either state."""
    found: list[Door] = []
    for w, wall in enumerate(plan.walls):
        for o, opening in enumerate(wall.openings):
            if opening.kind == "door":
                with suppress(PlanError):
                    with_changed(plan, [Door(w, o)])
                    found.append(Door(w, o))
    return tuple(found)


def shut_doors(plan: FloorPlan) -> tuple[Door, ...]:
    """List those of them that are shut."""
    return tuple(
        door
        for door in doors_of(plan)
        if plan.walls[door.wall].openings[door.opening].material is not None
    )


def with_changed(plan: FloorPlan, doors: Collection[Door]) -> FloorPlan:
    """Return a plan with open doors shut, and shut ones open.

    Raises
    ------
    PlanError
        Where the plan needs a door as it is, such as one to the outside.
    """
    material, thickness_m = _leaf(plan)

    def changed(w: int, o: int, opening: Opening) -> Opening:
        if Door(w, o) not in doors:
            return opening
        if opening.material is None:
            return replace(opening, material=material, thickness_m=thickness_m)
        return replace(opening, material=None, thickness_m=None)

    walls = tuple(
        replace(wall, openings=tuple(changed(w, o, each) for o, each in enumerate(wall.openings)))
        for w, wall in enumerate(plan.walls)
    )
    return replace(plan, walls=walls)


def _leaf(plan: FloorPlan) -> tuple[str, float | None]:
    """Return what most shut doors of a plan are made of."""
    leaves = Counter(
        (opening.material, opening.thickness_m)
        for wall in plan.walls
        for opening in wall.openings
        if opening.kind == "door" and opening.material is not None
    )
    for (material, thickness_m), _ in leaves.most_common(1):
        assert material is not None
        return material, thickness_m
    return LEAF, LEAF_M
