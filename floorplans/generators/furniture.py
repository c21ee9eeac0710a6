"""Furniture: cabinets, screens, wardrobes, shelves and racks as sheets of clutter."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from floorplans.generators.rooms import Room, Use
from floorplans.generators.style import FURNITURE
from floorplans.walls import Wall

CLEAR_CM = 40
"""Distance of furniture from the walls."""
AISLE_CM = 280
RACK_M = 0.8
"""Height of racks over that of the hall."""

PIECES: dict[Use, tuple[tuple[float, tuple[int, int]], ...]] = {
    "office": ((2.0, (160, 240)), (1.4, (120, 160))),
    "open office": ((1.4, (160, 320)), (1.4, (160, 320)), (2.0, (160, 240)), (1.4, (160, 320))),
    "meeting": ((0.9, (120, 200)),),
    "living": ((2.0, (120, 240)), (0.8, (160, 220))),
    "bedroom": ((2.1, (120, 240)),),
    "kitchen": ((2.1, (60, 180)),),
    "guest": ((2.1, (80, 120)),),
    "class": ((2.0, (120, 200)), (1.8, (120, 180))),
    "store": ((2.0, (100, 220)),),
}
"""Height [m], and least and largest length [cm], of the pieces in a room."""


def furnish(rooms: Sequence[Room], height_m: float, rng: np.random.Generator) -> tuple[Wall, ...]:
    """Place furniture in rooms, clear of all walls and of other pieces."""
    return tuple(
        wall
        for room in rooms
        for wall in (_racks(room, height_m) if room.use == "hall" else _in_room(room, rng))
    )


def _in_room(room: Room, rng: np.random.Generator) -> Iterator[Wall]:
    """Stand pieces parallel to the longer side, each in a band of its own across the room."""
    pieces = PIECES.get(room.use, ())
    along = int(room.size[1] > room.size[0])
    length, depth = room.size[along], room.size[1 - along]
    bands = [CLEAR_CM + k * 120 for k in range((depth - 2 * CLEAR_CM) // 120 + 1)]
    order = rng.permutation(len(bands))[: len(pieces)]
    for band, (height_m, lengths) in zip(order, pieces, strict=False):
        free = length - 2 * CLEAR_CM
        if free < lengths[0]:
            continue
        most = min(lengths[1], free)
        long = lengths[0] + 10 * int(rng.integers(0, (most - lengths[0]) // 10 + 1))
        begin = CLEAR_CM + 10 * int(rng.integers(0, (free - long) // 10 + 1))
        yield _sheet(room, along, (begin, long), bands[int(band)], height_m)


def _racks(room: Room, height_m: float) -> Iterator[Wall]:
    """Stand rows of racks along the longer side, with aisles between and a cross aisle."""
    along = int(room.size[1] > room.size[0])
    length, depth = room.size[along], room.size[1 - along]
    top_m = round(RACK_M * height_m, 2)
    half = (length - 3 * AISLE_CM) // 2
    if half < 300:
        return
    for across in range(AISLE_CM, depth - AISLE_CM + 1, AISLE_CM + 120):
        for begin in (AISLE_CM, 2 * AISLE_CM + half):
            yield _sheet(room, along, (begin, half), across, top_m)


def _sheet(room: Room, along: int, piece: tuple[int, int], across: int, height_m: float) -> Wall:
    """Make a sheet of clutter, at distances [cm] from the room's lower left corner."""
    begin, long = piece
    one, other = [0, 0], [0, 0]
    one[along], other[along] = room.low[along] + begin, room.low[along] + begin + long
    one[1 - along] = other[1 - along] = room.low[1 - along] + across
    ends = [(x / 100, y / 100) for x, y in (one, other)]
    return Wall(ends[0], ends[1], *FURNITURE, height_m, kind="clutter")
