"""Layouts: how each kind of building divides its storey into rooms and corridors.

A floor of corridors is made of blocks side by side. A block has a corridor with a row of rooms on
each side; a corridor across joins them all. A flat has one corridor, a hall none.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Literal

import numpy as np

from floorplans.generators.rooms import Room, Use, divided

Rng = np.random.Generator

Shape = Literal["rectangle", "L"]
"""Of a building: a rectangle, or with a wing."""


@dataclass(frozen=True)
class Rows:
    """Sizes of a building with corridors [cm].

    Attributes
    ----------
    depth : (int, int)
        Least and largest depth of the rooms beside a corridor.
    corridor : (int, int)
        Least and largest width of a corridor.
    width : (int, int)
        Least and largest width of a room along its corridor.
    """

    depth: tuple[int, int]
    corridor: tuple[int, int]
    width: tuple[int, int]


OFFICE = Rows((450, 620), (160, 240), (280, 620))
HOTEL = Rows((580, 760), (150, 200), (360, 420))
SCHOOL = Rows((700, 800), (240, 320), (650, 960))


def rectangle(rng: Rng, area_m2: float, depth: tuple[int, int]) -> tuple[int, int]:
    """Choose width and depth [cm] of a building at most four times as wide as it is deep."""
    most = 10 * (min(depth[1], int(100.0 * math.sqrt(area_m2))) // 10)
    low = min(max(depth[0], 10 * int(5.0 * math.sqrt(area_m2))), most)
    y = low + 10 * int(rng.integers(0, (most - low) // 10 + 1))
    return 10 * round(1e3 * area_m2 / y), y


def office(rng: Rng, area_m2: float, shape: Shape) -> list[Room]:
    """Blocks of offices, some of them open, with meeting rooms, stores and a core."""
    return _in_blocks(rng, area_m2, shape, OFFICE, _office_row)


def hotel(rng: Rng, area_m2: float, shape: Shape) -> list[Room]:
    """Blocks of guest rooms, each with a bath beside its door; also a ward."""
    return _in_blocks(rng, area_m2, shape, HOTEL, _guest_row)


def school(rng: Rng, area_m2: float, shape: Shape) -> list[Room]:
    """Blocks of classrooms with stores between them."""
    return _in_blocks(rng, area_m2, shape, SCHOOL, _class_row)


Row = Callable[[Rng, Room, bool, Rows], Iterator[Room]]
"""Divides the row of rooms beside a corridor; the flag says whether the corridor is above it."""


def _in_blocks(rng: Rng, area_m2: float, shape: Shape, rows: Rows, row: Row) -> list[Room]:
    """Stack blocks of row, corridor, row, and join their corridors by one across.

    In a building with a wing the upper blocks are shorter than the others.
    """
    depth, corridor = (_within(rng, limits) for limits in (rows.depth, rows.corridor))
    pitch = 2 * depth + corridor
    n_blocks = max(1, round(math.sqrt(area_m2 * 1e4 / 2.2) / pitch))
    while n_blocks > 1 and area_m2 * 1e4 / (n_blocks * pitch) < 2 * rows.width[1]:
        n_blocks -= 1
    wing, n_long = 1.0, n_blocks
    if shape == "L":
        n_blocks = max(2, n_blocks)
        wing, n_long = float(rng.uniform(0.35, 0.6)), (n_blocks + 1) // 2
    in_lengths = n_long + wing * (n_blocks - n_long)
    width = 10 * round(area_m2 * 1e3 / (in_lengths * pitch))
    across = _within(rng, rows.corridor) if n_blocks > 1 else 0
    left = 10 * int(rng.integers(0, max(width - across, 0) // 20 + 1)) if across else 0
    left = 0 if left < 2 * rows.width[0] else left
    rooms = [Room((left, 0), (left + across, n_blocks * pitch), "corridor")] if across else []
    for block in range(n_blocks):
        end = width
        if block >= n_long:
            end = min(max(10 * round(wing * width / 10), left + across + rows.width[1]), width)
        parts = [(low, high) for low, high in ((0, left), (left + across, end)) if high > low]
        for low, high in parts:
            rooms += _block(rng, (low, high), (block * pitch, depth, corridor), rows, row)
    return rooms


def _block(
    rng: Rng, along: tuple[int, int], across: tuple[int, int, int], rows: Rows, row: Row
) -> Iterator[Room]:
    """Lay out a corridor between two rows, from its lower edge up: depths [cm]."""
    (low, high), (bottom, depth, corridor) = along, across
    middle = bottom + depth
    first = Room((low, bottom), (high, middle), "office")
    second = Room((low, middle + corridor), (high, middle + corridor + depth), "office")
    yield from row(rng, first, True, rows)
    yield Room((low, middle), (high, middle + corridor), "corridor")
    yield from row(rng, second, False, rows)


def _office_row(rng: Rng, strip: Room, above: bool, rows: Rows) -> Iterator[Room]:
    uses: list[Use] = ["office", "office", "office", "meeting", "store", "core"]
    chances = [0.5, 0.15, 0.1, 0.14, 0.06, 0.05]
    cells = _cells(rng, strip, rows.width)
    while cells:
        n_open = min(len(cells), int(rng.integers(2, 5)))
        if len(cells) > 3 and rng.random() < 0.15:
            yield Room(cells[0].low, cells[n_open - 1].high, "open office")
            cells = cells[n_open:]
        else:
            yield cells[0].of(uses[int(rng.choice(len(uses), p=chances))])
            cells = cells[1:]


def _guest_row(rng: Rng, strip: Room, above: bool, rows: Rows) -> Iterator[Room]:
    """Guest rooms: a bath at the corridor, and the room beside and behind it."""
    for number, cell in enumerate(_cells(rng, strip, rows.width)):
        group = 1 + cell.low[0] * 10_000 + cell.low[1]
        if cell.size[0] < 330 or rng.random() < 0.06:
            yield cell.of("store")
            continue
        at = cell.high[1] - 220 if above else cell.low[1] + 220
        far, near = cell.cut(1, at) if above else cell.cut(1, at)[::-1]
        side = near.low[0] + 170 if number % 2 else near.high[0] - 170
        left, right = near.cut(0, side)
        bath, entry = (left, right) if number % 2 else (right, left)
        yield bath.of("bath")
        yield replace(entry, use="guest", group=group)
        yield replace(far, use="guest", group=group)


def _class_row(rng: Rng, strip: Room, above: bool, rows: Rows) -> Iterator[Room]:
    for cell in _cells(rng, strip, rows.width):
        if cell.size[0] >= rows.width[0] + 250 and rng.random() < 0.4:
            first, store = cell.cut(0, cell.high[0] - 250)
            yield first.of("class")
            yield store.of("store")
        else:
            yield cell.of("class" if rng.random() < 0.9 else "office")


def _cells(rng: Rng, strip: Room, widths: tuple[int, int]) -> list[Room]:
    """Divide a row into rooms of random widths."""
    rooms: list[Room] = []
    for at in divided(rng, strip.low[0], strip.high[0], widths)[1:-1]:
        first, strip = strip.cut(0, at)
        rooms.append(first)
    return [*rooms, strip]


def flat(rng: Rng, area_m2: float, shape: Shape) -> list[Room]:
    """One corridor, living room and kitchen on one side, bedrooms and bath on the other.

    With a wing, the side of the bedrooms is shorter.
    """
    width, depth = rectangle(rng, area_m2 if shape == "rectangle" else 1.15 * area_m2, (700, 1100))
    corridor = _within(rng, (110, 160))
    bottom = 10 * round((depth - corridor) * float(rng.uniform(0.42, 0.58)) / 10)
    south = Room((0, 0), (width, bottom), "living")
    north = Room((0, bottom + corridor), (width, depth), "bedroom")
    rooms = [Room((0, bottom), (width, bottom + corridor), "corridor")]
    kitchen = south.low[0] + max(240, 10 * round(width * float(rng.uniform(0.25, 0.4)) / 10))
    first, living = south.cut(0, kitchen)
    rooms.append(first.of("kitchen"))
    if living.size[0] > 800:
        living, study = living.cut(0, living.high[0] - _within(rng, (280, 380)))
        rooms.append(study.of("bedroom"))
    rooms.append(living)
    if shape == "L":
        north, _ = north.cut(0, 10 * round(width * float(rng.uniform(0.6, 0.75)) / 10))
    bath, bedrooms = north.cut(0, north.low[0] + _within(rng, (180, 260)))
    rooms.append(bath.of("bath"))
    return rooms + [cell.of("bedroom") for cell in _cells(rng, bedrooms, (280, 480))]


def hall(rng: Rng, area_m2: float, shape: Shape) -> list[Room]:
    """One large room; at its end a row of offices and stores of one storey's height.

    With a wing, a second part of the room stands across the first.
    """
    width, depth = rectangle(rng, area_m2 if shape == "rectangle" else area_m2 / 1.4, (1200, 6000))
    if shape == "L":
        x = 10 * round(width * float(rng.uniform(0.35, 0.6)) / 10)
        y = depth + 10 * round(0.4 * width * depth / x / 10)
        return [
            Room((0, 0), (width, depth), "hall", 1),
            Room((0, depth), (x, y), "hall", 1),
        ]
    end = _within(rng, (400, 700))
    if end * 3 > width:
        return [Room((0, 0), (width, depth), "hall")]
    rooms = [Room((0, 0), (width - end, depth), "hall")]
    ends = divided(rng, 0, depth, (350, 900))
    for low, high in pairwise(ends):
        use: Use = "office" if rng.random() < 0.6 else "store"
        rooms.append(Room((width - end, low), (width, high), use))
    return rooms


def _within(rng: Rng, limits: tuple[int, int]) -> int:
    """Draw a multiple of 10 cm within limits."""
    return limits[0] + 10 * int(rng.integers(0, (limits[1] - limits[0]) // 10 + 1))
