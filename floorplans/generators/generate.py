"""The generator: a kind of building and a seed in, a floor plan out."""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal, get_args

import numpy as np
from shapely.geometry import Polygon

from floorplans.generators import layouts
from floorplans.generators.building import build
from floorplans.generators.furniture import furnish
from floorplans.generators.places import source_and_start, transmitters
from floorplans.generators.rooms import Room
from floorplans.generators.style import Style
from floorplans.plan import FloorPlan
from floorplans.transmitters import MAX_TRANSMITTERS
from floorplans.walls import Wall

Kind = Literal["flat", "office", "hotel", "school", "hall"]
KINDS: tuple[Kind, ...] = get_args(Kind)
"""Kinds of buildings."""

SHAPES: tuple[layouts.Shape, ...] = get_args(layouts.Shape)
"""Shapes of buildings."""

GENERATOR_VERSION = 1
"""Grows whenever the same arguments would give another plan."""

LAYOUTS: dict[Kind, Callable[[np.random.Generator, float, layouts.Shape], list[Room]]] = {
    "flat": layouts.flat,
    "office": layouts.office,
    "hotel": layouts.hotel,
    "school": layouts.school,
    "hall": layouts.hall,
}
AREA_M2: dict[Kind, tuple[int, int]] = {
    "flat": (50, 160), "office": (300, 3000), "hotel": (400, 2500), "school": (500, 4000),
    "hall": (500, 6000),
}  # fmt: skip
"""Range from which the area is drawn where none is given [m^2]."""
LEAST_M2, LARGEST_M2 = 50.0, 10_000.0
LEAST_WITH_WING_M2: dict[Kind, float] = {
    "flat": 80.0, "office": 450.0, "hotel": 500.0, "school": 1000.0, "hall": 300.0,
}  # fmt: skip
"""Least area of a building with a wing [m^2]."""


def generate(
    kind: str,
    seed: int,
    *,
    area_m2: float | None = None,
    furniture: bool = True,
    shape: str = "rectangle",
    n_transmitters: int = 3,
    connecting_doors: float = 0.0,
) -> FloorPlan:
    """Generate a building; the same arguments give the same plan on any machine.

    Parameters
    ----------
    kind : {"flat", "office", "hotel", "school", "hall"}
        What it is. A hotel's layout is also that of a hospital ward.
    seed : int
        From 0 to 2^63 - 1.
    area_m2 : float, optional
        About how large it is, 50 to 10 000 m^2; by default drawn from what is usual for its kind.
    furniture : bool
        Whether cabinets, shelves and racks stand in it, as clutter.
    shape : {"rectangle", "L"}
        Of its outline: an L has a wing.
    n_transmitters : int
        How many access points hang under the ceiling, spread evenly: 0 to 1000.
    connecting_doors : float
        Chance of a door between two neighbouring rooms that have none, beside those that lead to
        each room: with them there is more than one way. Walls and all other doors do not depend on
        it.

    Returns
    -------
    FloorPlan
        Every room can be reached through doors, some of which are shut. It has a source and a
        start.

    Raises
    ------
    ValueError
        For an unknown kind or shape, or a number out of range.
    """
    if kind not in KINDS:
        raise ValueError(f"kind = {kind!r}: expected one of {', '.join(KINDS)}")
    if shape not in SHAPES:
        raise ValueError(f"shape = {shape!r}: expected one of {', '.join(SHAPES)}")
    if not _is_integer(seed, 0, 2**63 - 1):
        raise ValueError(f"seed = {seed!r}: expected an integer from 0 to 2^63 - 1")
    if area_m2 is not None and not LEAST_M2 <= area_m2 <= LARGEST_M2:
        raise ValueError(f"area_m2 = {area_m2}: expected {LEAST_M2:g} to {LARGEST_M2:g} m^2")
    if not _is_integer(n_transmitters, 0, MAX_TRANSMITTERS):
        raise ValueError(
            f"n_transmitters = {n_transmitters}: expected an integer from 0 to {MAX_TRANSMITTERS}"
        )
    if not 0.0 <= connecting_doors <= 1.0:
        raise ValueError(f"connecting_doors = {connecting_doors}: expected a chance from 0 to 1")
    rng = np.random.Generator(np.random.PCG64([KINDS.index(kind), int(seed)]))
    doors_rng = np.random.Generator(np.random.PCG64([KINDS.index(kind), int(seed), 1]))
    low, high = AREA_M2[kind]
    if shape == "L":
        least = LEAST_WITH_WING_M2[kind]
        if area_m2 is not None and area_m2 < least:
            raise ValueError(f"area_m2 = {area_m2}: expected {least:g} m^2 or more in the shape L")
        low = max(low, round(least))
    wanted_m2 = float(rng.integers(low, high + 1)) if area_m2 is None else area_m2
    rooms = LAYOUTS[kind](rng, wanted_m2, shape)
    style = Style.of(kind, rng)
    walls = build(rooms, style, rng, (connecting_doors, doors_rng))
    return _furnished(f"{kind} {int(seed)}", rooms, style, walls, rng, furniture, n_transmitters)


def _is_integer(value: float, least: int, most: int) -> bool:
    return not isinstance(value, bool) and least <= value <= most and value % 1 == 0


def _furnished(
    name: str,
    rooms: list[Room],
    style: Style,
    walls: tuple[Wall, ...],
    rng: np.random.Generator,
    furniture: bool,
    n_transmitters: int,
) -> FloorPlan:
    clutter = furnish(rooms, style.height_m, rng) if furniture else ()
    standing = (*walls, *clutter)
    source, start = source_and_start(rooms, standing, rng)
    return FloorPlan(
        name=name,
        outline=_outline(rooms),
        walls=standing,
        height_m=style.height_m,
        floor_material="concrete",
        ceiling_material="concrete",
        source=source,
        start=start,
        transmitters=transmitters(rooms, standing, style.height_m, int(n_transmitters)),
    )


def _outline(rooms: list[Room]) -> Polygon:
    """Return what the rooms cover [m]: a rectangle, or one with its upper right corner cut off."""
    x, y = (max(room.high[axis] for room in rooms) for axis in (0, 1))
    at_right = max(room.high[1] for room in rooms if room.high[0] == x)
    at_top = max(room.high[0] for room in rooms if room.high[1] == y)
    corners = [(0, 0), (x, 0), (x, at_right), (at_top, at_right), (at_top, y), (0, y)]
    if at_right == y:
        corners = [(0, 0), (x, 0), (x, y), (0, y)]
    return Polygon([(cx / 100, cy / 100) for cx, cy in corners])
