"""Rooms of a layout: rectangles in whole centimetres that cover a building without overlap."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Literal, NamedTuple

import numpy as np

Use = Literal[
    "corridor", "office", "open office", "meeting", "core", "store", "living", "bedroom", "kitchen",
    "bath", "guest", "class", "hall",
]  # fmt: skip
"""What a room is for; it decides on walls, windows and furniture."""

Axis = Literal[0, 1]


@dataclass(frozen=True)
class Room:
    """A rectangle of the storey.

    Attributes
    ----------
    low, high : (int, int)
        Lower left and upper right corner (x, y) [cm].
    use : str
        What it is for.
    group : int
        Rectangles of the same group are one room; 0 is a room of its own.
    """

    low: tuple[int, int]
    high: tuple[int, int]
    use: Use
    group: int = 0

    @property
    def size(self) -> tuple[int, int]:
        """Width and depth [cm]."""
        return self.high[0] - self.low[0], self.high[1] - self.low[1]

    @property
    def area_m2(self) -> float:
        """Floor area [m^2]."""
        return self.size[0] * self.size[1] / 1e4

    def cut(self, axis: Axis, at: int) -> tuple[Room, Room]:
        """Cut it in two, `at` [cm] along an axis."""
        assert self.low[axis] < at < self.high[axis]
        middle_high, middle_low = list(self.high), list(self.low)
        middle_high[axis] = middle_low[axis] = at
        return (
            replace(self, high=(middle_high[0], middle_high[1])),
            replace(self, low=(middle_low[0], middle_low[1])),
        )

    def of(self, use: Use) -> Room:
        """Return the same rectangle for another use."""
        return replace(self, use=use)

    def is_one_with(self, other: Room) -> bool:
        """Whether nothing separates two adjacent rectangles."""
        same = self.group == other.group != 0
        return same or self.use == other.use == "corridor"


class Border(NamedTuple):
    """A straight piece of border between two rooms, or of a room and the outside.

    Attributes
    ----------
    axis
        0 where it runs along x, 1 along y.
    at
        Its coordinate across [cm].
    low, high
        Where it begins and ends along the axis [cm].
    below, above
        Numbers of the rooms on the side of smaller and of larger coordinates; -1 for outside.
    """

    axis: Axis
    at: int
    low: int
    high: int
    below: int
    above: int

    @property
    def length(self) -> int:
        """Its length [cm]."""
        return self.high - self.low

    def other(self, room: int) -> int:
        """Number of the room on the other side of one of them."""
        return self.above if room == self.below else self.below


def borders(rooms: Sequence[Room]) -> list[Border]:
    """List the borders of rooms that do not overlap, each as long as both its sides stay."""
    found: list[Border] = []
    for axis in (0, 1):
        across = 1 - axis
        lines = sorted({c for room in rooms for c in (room.low[across], room.high[across])})
        for at in lines:
            touching = [
                (number, room)
                for number, room in enumerate(rooms)
                if at in (room.low[across], room.high[across])
            ]
            found += _along(axis, at, touching)  # pyright: ignore[reportArgumentType]
    return found


def _along(axis: Axis, at: int, touching: list[tuple[int, Room]]) -> list[Border]:
    """List the borders on one line, given the rooms that touch it."""
    across: Axis = 1 if axis == 0 else 0
    ends = sorted({c for _, room in touching for c in (room.low[axis], room.high[axis])})
    found: list[Border] = []
    for low, high in pairwise(ends):
        covering = [
            (number, room)
            for number, room in touching
            if room.low[axis] <= low and high <= room.high[axis]
        ]
        below = next((n for n, room in covering if room.high[across] == at), -1)
        above = next((n for n, room in covering if room.low[across] == at), -1)
        last = found[-1] if found else None
        if last and last.high == low and (last.below, last.above) == (below, above):
            found[-1] = last._replace(high=high)
        elif below >= 0 or above >= 0:
            found.append(Border(axis, at, low, high, below, above))
    return found


def divided(
    rng: np.random.Generator, low: int, high: int, widths: tuple[int, int], step: int = 10
) -> list[int]:
    """Divide an interval into parts of random widths.

    Parameters
    ----------
    rng
        Source of randomness.
    low, high
        The interval [cm].
    widths
        Smallest and largest width wanted [cm]; the last part takes up the rest, and is the only
        one that may be narrower or wider.
    step
        Widths are multiples of it [cm].

    Returns
    -------
    list of int
        The ends of the parts, both ends of the interval included.
    """
    ends = [low]
    while high - ends[-1] >= 2 * widths[0] and high - ends[-1] > widths[1]:
        largest = min(widths[1], high - ends[-1] - widths[0])
        n_steps = (largest - widths[0]) // step
        ends.append(ends[-1] + widths[0] + step * int(rng.integers(0, n_steps + 1)))
    return [*ends, high]
