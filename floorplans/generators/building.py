"""Walls, doors and windows of a layout; every room can be reached."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from floorplans.generators.rooms import Border, Room, Use, borders
from floorplans.generators.style import DOOR, WINDOW, Made, Style
from floorplans.walls import Opening, Point, Wall

DOOR_CM, WIDE_DOOR_CM, GATE_CM = 90, 130, 360
"""Widths of doors: of a room, of a large one, of a hall."""
JAMB_CM, CLEAR_CM = 20, 20
"""Least distance of an opening from the end of its wall."""
DOOR_HEAD_M, GATE_HEAD_M = 2.1, 3.6
SILL_M, WINDOW_HEAD_M, HIGH_SILL_M = 0.9, 2.2, 3.0
MULLION_CM, LARGEST_WINDOW_CM = 30, 240
LARGE_M2 = 60.0
SECOND_DOOR = 0.12
"""Chance of a door between two rooms that have one already."""

CONNECTED: frozenset[Use] = frozenset(
    ("office", "open office", "meeting", "living", "bedroom", "kitchen", "guest", "class")
)
"""Uses of rooms that may have connecting doors."""

PREFERRED = ("corridor", "hall", "living", "guest", "class", "open office", "office")
"""Where a room without a corridor beside it has its door, best first."""


def build(
    rooms: Sequence[Room],
    style: Style,
    rng: np.random.Generator,
    connecting: tuple[float, np.random.Generator],
) -> tuple[Wall, ...]:
    """Make all walls of a layout with their openings, in a fixed order.

    Parameters
    ----------
    rooms
        The layout.
    style
        Materials, height, and how much is glazed or open.
    rng
        Source of randomness.
    connecting
        Chance of a door between two rooms that have none, and its own source of randomness: all
        else is as without.
    """
    lines = [
        (border, made)
        for border in borders(rooms)
        if (made := style.wall(*_sides(border, rooms))) is not None
    ]
    inner = [border for border, _ in lines if min(border.below, border.above) >= 0]
    doors = _doors(rooms, inner, rng)
    more = _connecting_doors(rooms, inner, doors, *connecting)
    walls: list[Wall] = []
    for border, made in lines:
        wall = _wall(border, made, style.height_m)
        if border in doors:
            wall = replace(wall, openings=(_door(border, rooms, style, rng),))
        elif border in more:
            wall = replace(wall, openings=(_door(border, rooms, style, connecting[1]),))
        elif min(border.below, border.above) < 0:
            room = rooms[max(border.below, border.above)]
            wall = replace(wall, openings=tuple(_windows(border, room, style)))
        walls.append(wall)
    return _with_entrance(walls, lines, rooms, style)


def _sides(border: Border, rooms: Sequence[Room]) -> tuple[Room | None, Room | None]:
    below, above = (rooms[n] if n >= 0 else None for n in (border.below, border.above))
    return below, above


def _wall(border: Border, made: Made, height_m: float) -> Wall:
    ends = [(border.low, border.at), (border.high, border.at)]
    if border.axis == 1:
        ends = [(y, x) for x, y in ends]
    (x0, y0), (x1, y1) = ends
    return Wall(_metres(x0, y0), _metres(x1, y1), *made, height_m)


def _metres(x: int, y: int) -> Point:
    return x / 100, y / 100


def _doors(rooms: Sequence[Room], inner: Sequence[Border], rng: np.random.Generator) -> set[Border]:
    """Choose borders for doors: a tree over all rooms from the corridors on, and a few more."""
    around: list[list[Border]] = [[] for _ in rooms]
    for border in inner:
        if border.length >= DOOR_CM + 2 * JAMB_CM:
            around[border.below].append(border)
            around[border.above].append(border)
    doors: set[Border] = set()
    reached: set[int] = set()
    waiting = deque(_merged(rooms, _first(rooms)))
    reached.update(waiting)
    while waiting or len(reached) < len(rooms):
        assert waiting, "a room of the layout has no border that is wide enough for a door"
        here = waiting.popleft()
        for border in sorted(around[here], key=lambda b: -b.length):
            there = border.other(here)
            if there in reached or not _leads_on(rooms[here], rooms[there], around[there], rooms):
                continue
            doors.add(border)
            together = _merged(rooms, there)
            reached.update(together)
            waiting.extend(together)
    spare = [b for b in inner if b not in doors and b.length >= DOOR_CM + 2 * JAMB_CM]
    for border in spare:
        uses = {rooms[border.below].use, rooms[border.above].use}
        if uses <= {"office", "living", "kitchen", "class"} and rng.random() < SECOND_DOOR:
            doors.add(border)
    return doors


def _connecting_doors(
    rooms: Sequence[Room],
    inner: Sequence[Border],
    doors: set[Border],
    chance: float,
    rng: np.random.Generator,
) -> set[Border]:
    """Choose borders for further doors, at most one between two rooms and none to a corridor."""

    def joined(border: Border) -> frozenset[int]:
        return frozenset(min(_merged(rooms, n)) for n in (border.below, border.above))

    pairs = {joined(border) for border in doors}
    found: set[Border] = set()
    for border in inner:
        uses = {rooms[border.below].use, rooms[border.above].use}
        wide = border.length >= DOOR_CM + 2 * JAMB_CM
        if not wide or not uses <= CONNECTED or joined(border) in pairs:
            continue
        pairs.add(joined(border))
        if rng.random() < chance:
            found.add(border)
    return found


def _first(rooms: Sequence[Room]) -> int:
    """Return the room that doors lead from: the largest one of the use that leads on best."""
    return min(
        range(len(rooms)),
        key=lambda n: (_rank(rooms[n]), -rooms[n].area_m2, n),
    )


def _rank(room: Room) -> int:
    return PREFERRED.index(room.use) if room.use in PREFERRED else len(PREFERRED)


def _leads_on(here: Room, there: Room, around: Sequence[Border], rooms: Sequence[Room]) -> bool:
    """Whether a room has its door here: no neighbour of it leads on better."""
    best = min(
        _rank(other)
        for border in around
        for other in (rooms[border.below], rooms[border.above])
        if other is not there
    )
    return _rank(here) <= best


def _merged(rooms: Sequence[Room], number: int) -> list[int]:
    """Return the rectangles of which a room consists; all corridors are one room."""
    room = rooms[number]
    if room.use == "corridor":
        return [n for n, other in enumerate(rooms) if other.use == "corridor"]
    if room.group:
        return [n for n, other in enumerate(rooms) if other.group == room.group]
    return [number]


def _door(border: Border, rooms: Sequence[Room], style: Style, rng: np.random.Generator) -> Opening:
    """Place a door at random along its border; it stands open or is shut."""
    area_m2 = min(rooms[border.below].area_m2, rooms[border.above].area_m2)
    width = WIDE_DOOR_CM if area_m2 > LARGE_M2 else DOOR_CM
    width = min(width, border.length - 2 * JAMB_CM)
    free = border.length - 2 * JAMB_CM - width
    offset = JAMB_CM + 10 * int(rng.integers(0, free // 10 + 1))
    offset = _around_a_line(border.low, offset, width, JAMB_CM + free)
    filling = (None, None) if rng.random() < style.open_doors else DOOR
    return Opening(offset / 100, width / 100, 0.0, DOOR_HEAD_M, "door", *filling)


def _around_a_line(low: int, offset: int, width: int, most: int) -> int:
    """Move a door so that the middle line of cells of 1 m passes through it, where it can.

    Parameters
    ----------
    low
        Where the wall begins [cm].
    offset, width, most
        Of the door, and its largest offset [cm].
    """
    for moved in sorted(range(JAMB_CM, most + 1, 10), key=lambda other: abs(other - offset)):
        first = low + moved + CLEAR_CM
        if first + (50 - first) % 100 <= low + moved + width - CLEAR_CM:
            return moved
    return offset


def _windows(border: Border, room: Room, style: Style) -> Iterator[Opening]:
    """Place windows of equal width along an exterior wall, as much as the style glazes."""
    if not style.has_window(room):
        return
    sill, head = SILL_M, WINDOW_HEAD_M
    if room.use == "hall":
        sill, head = HIGH_SILL_M, style.height_m - 0.5
    glazed = 10 * int(style.glazing * border.length / 10)
    count = -(-glazed // LARGEST_WINDOW_CM)
    if count == 0:
        return
    width = 10 * (glazed // count // 10)
    gap = (border.length - count * width) / (count + 1)
    if width < 50 or gap < MULLION_CM:
        return
    for k in range(count):
        offset = round(gap + k * (width + gap))
        yield Opening(offset / 100, width / 100, sill, head, "window", *WINDOW)


def _with_entrance(
    walls: list[Wall],
    lines: Sequence[tuple[Border, Made]],
    rooms: Sequence[Room],
    style: Style,
) -> tuple[Wall, ...]:
    """Put a shut door into an exterior wall of the corridor or the hall, or else of a room."""
    outer = [k for k, (border, _) in enumerate(lines) if min(border.below, border.above) < 0]

    def rank(k: int) -> tuple[int, int, int]:
        border = lines[k][0]
        return _rank(rooms[max(border.below, border.above)]), -border.length, k

    wide = [k for k in outer if lines[k][0].length >= DOOR_CM + 2 * JAMB_CM]
    chosen = min(wide, key=rank)
    border = lines[chosen][0]
    is_hall = rooms[max(border.below, border.above)].use == "hall"
    width = min(GATE_CM if is_hall else WIDE_DOOR_CM, border.length - 2 * JAMB_CM)
    head_m = GATE_HEAD_M if is_hall else DOOR_HEAD_M
    offset = (border.length - width) // 2
    gate = Opening(offset / 100, width / 100, 0.0, head_m, "door", *DOOR)
    kept = tuple(o for o in walls[chosen].openings if not o.overlaps(gate) and _apart(o, gate))
    openings = tuple(sorted((*kept, gate), key=lambda o: o.offset_m))
    walls[chosen] = replace(walls[chosen], openings=openings)
    return tuple(walls)


def _apart(one: Opening, other: Opening) -> bool:
    """Whether two openings have a jamb between them."""
    between = max(one.offset_m, other.offset_m) - min(one.end_m, other.end_m)
    return between >= JAMB_CM / 100
