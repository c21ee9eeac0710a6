"""Where transmitters, the source and the start of a generated building are."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely
from numpy.typing import NDArray

from floorplans.generators.rooms import Room
from floorplans.transmitters import PlanTransmitter
from floorplans.walls import Wall, centre_lines

CLEAR_M = 0.25
"""Least distance of a place from the centre line of any wall."""
BELOW_CEILING_M = 0.3
PHONE_M = 1.2

Point = tuple[float, float]
Ints = NDArray[np.int64]
_ROUNDS = 20


def transmitters(
    rooms: Sequence[Room], walls: Sequence[Wall], height_m: float, count: int
) -> tuple[PlanTransmitter, ...]:
    """Spread access points under the ceiling, each in the middle of the cells nearest to it.

    Lloyd's algorithm over the cells' centres, in half metres, so that it rounds nowhere.
    """
    points = _free_points(rooms, walls)
    count = min(count, len(points))
    if not count:
        return ()
    at = points[np.linspace(0, len(points) - 1, count).round().astype(np.int64)]
    for _ in range(_ROUNDS):
        owner = _squared(points, at).argmin(axis=1)
        sums = np.array([points[owner == k].sum(axis=0) for k in range(count)])
        middle = sums // np.maximum(np.bincount(owner, minlength=count), 1)[:, None]
        at = points[_squared(middle, points).argmin(axis=1)]
    z = round(height_m - BELOW_CEILING_M, 2)
    unique = sorted({(int(x), int(y)) for x, y in at})
    return tuple(
        PlanTransmitter(f"ap{number}", (x / 2, y / 2, z))
        for number, (x, y) in enumerate(unique, start=1)
    )


def source_and_start(
    rooms: Sequence[Room], walls: Sequence[Wall], rng: np.random.Generator
) -> tuple[tuple[float, float, float], Point]:
    """Put a phone anywhere, and the start of a flight in the cell of 1 m farthest from it."""
    points = _free_points(rooms, walls)
    phone = points[int(rng.integers(len(points)))]
    start = points[int(_squared(phone[None], points)[0].argmax())]
    x, y = (int(c) / 2 + 0.1 for c in phone)
    return (x, y, PHONE_M), (int(start[0]) / 2, int(start[1]) / 2)


def _squared(one: Ints, other: Ints) -> Ints:
    """Squared distances (n, m) between points (n, 2) and (m, 2)."""
    return ((one[:, None] - other[None]) ** 2).sum(axis=-1)


def _free_points(rooms: Sequence[Room], walls: Sequence[Wall]) -> Ints:
    """Centres (n, 2) of the cells of 1 m that are clear of walls and furniture [0.5 m]."""
    width, depth = (max(room.high[axis] for room in rooms) // 100 for axis in (0, 1))
    x, y = np.meshgrid(np.arange(width), np.arange(depth))
    points = 2 * np.column_stack([x.ravel(), y.ravel()]) + 1
    tree = shapely.STRtree(centre_lines(walls))
    near, _ = tree.query(shapely.points(points / 2), predicate="dwithin", distance=CLEAR_M)
    return np.delete(points, np.unique(near), axis=0)
