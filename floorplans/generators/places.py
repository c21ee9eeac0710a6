"""Where transmitters, the source and the start of a generated building are."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from floorplans.generators.rooms import Room
from floorplans.transmitters import PlanTransmitter
from floorplans.walls import Wall, centre_lines, solid_segments

CLEAR_M = 0.25
"""Least distance of a place from the centre line of any wall."""
BELOW_CEILING_M = 0.3
PHONE_M, FLYING_M = 1.2, 2.0

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
    """Put a phone and, as far away as a flight can begin, the start.

    Both are in the largest part of the building that flights through open doors connect.
    """
    points = _connected(_free_points(rooms, walls), walls)
    phone = points[int(rng.integers(len(points)))]
    start = points[int(_squared(phone[None], points)[0].argmax())]
    x, y = (int(c) / 2 + 0.1 for c in phone)
    return (x, y, PHONE_M), (int(start[0]) / 2, int(start[1]) / 2)


def _connected(points: Ints, walls: Sequence[Wall]) -> Ints:
    """Return the largest set of cells among which a UAV can fly, a metre at a time."""
    number = {(int(x), int(y)): k for k, (x, y) in enumerate(points)}
    steps = np.array(
        [
            (k, number[x + dx, y + dy])
            for (x, y), k in number.items()
            for dx, dy in ((2, 0), (0, 2))
            if (x + dx, y + dy) in number
        ]
    )
    solid = np.array(shapely.linestrings(solid_segments(walls, FLYING_M)), dtype=np.object_)
    flown = shapely.linestrings(points[steps] / 2)
    crossing, _ = shapely.STRtree(solid).query(flown, predicate="intersects")
    steps = np.delete(steps, np.unique(crossing), axis=0)
    moves = coo_array((np.ones(len(steps)), steps.T), shape=(len(points), len(points)))
    _, part = connected_components(moves, directed=False)
    return points[part == np.bincount(part).argmax()]


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
    outside = np.flatnonzero(~_in_rooms(50 * points, rooms))
    return np.delete(points, np.union1d(near, outside), axis=0)


def _in_rooms(points: Ints, rooms: Sequence[Room]) -> NDArray[np.bool_]:
    """Which points (n, 2) [cm] are in a room (n,)."""
    low, high = (np.array([getattr(room, end) for room in rooms]) for end in ("low", "high"))
    inside = np.zeros(len(points), dtype=np.bool_)
    for lower, upper in zip(low, high, strict=True):
        inside |= ((points >= lower) & (points <= upper)).all(axis=1)
    return inside
