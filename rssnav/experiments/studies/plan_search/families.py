"""Random floor plans of the paper's two scenarios.

Sizes, heights, source and start are the paper's. Walls and door jambs stand on whole metres, so
that the UAV keeps half a metre from them. What varies is where hallways, halls, rooms and doors
are. The ranges of their numbers are those in which draws with wider ones found plans that allow the
printed flights, so shares of drawn plans depend on them.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache
from itertools import pairwise

import numpy as np

import floorplans
from floorplans import FloorPlan, Opening, PlanError, Wall

Doors = Sequence[tuple[int, int]]
"""Offset along the wall and width of each door [m]."""

Corner = tuple[int, int]
"""Whole metres (x, y)."""

WALL_M, HEIGHT_M, DOOR_HEAD_M = 0.1, 3.0, 2.7


def draw(scenario: int, rng: np.random.Generator) -> FloorPlan | None:
    """Draw a plan of a scenario; None where the drawn numbers make none.

    Parameters
    ----------
    scenario : int
        1 or 2.
    rng : numpy.random.Generator
        Draws the numbers.

    Returns
    -------
    FloorPlan or None
    """
    walls = _FAMILIES[scenario](rng)
    if walls is None:
        return None
    shell = _shell(scenario)
    try:
        return replace(shell, walls=(*shell.walls, *walls))
    except PlanError:
        return None


@cache
def _shell(scenario: int) -> FloorPlan:
    """Return the outer walls with all that the paper states."""
    known = floorplans.load(f"scenario{scenario}")
    return replace(known, walls=tuple(w for w in known.walls if w.material == "concrete"))


def _scenario_1(rng: np.random.Generator) -> list[Wall] | None:
    """Two halls, joined by a hallway with rooms on both sides; partitions with doors across."""
    west, east = _integer(rng, 9, 30), _integer(rng, 68, 86)
    width, south = _integer(rng, 3, 6), _integer(rng, 9, 14)
    north = south + width
    if north > 20:
        return None
    cuts = _divided(west, east, _integer(rng, 2, 5))
    door_m = _integer(rng, 2, 3)
    sides = [_doors(cuts, _integer(rng, 1, 12), door_m) for _ in range(2)]
    walls = [
        _wall((west, south), (east, south), sides[0]),
        _wall((west, north), (east, north), sides[1]),
    ]
    for x in cuts:
        walls += [_wall((x, 0), (x, south)), _wall((x, north), (x, 26))]
    doors = [(west + offset, west + offset + width_m) for side in sides for offset, width_m in side]
    for x in sorted(rng.choice(np.arange(8, 92), _integer(rng, 1, 4), replace=False)):
        if not any(near <= x <= far for near, far in doors):
            in_hallway = west <= x <= east
            low, high = (south, north) if in_hallway else (0, 26)
            gap = _integer(rng, 2, width - 1)
            at = _integer(rng, south, north - gap) if in_hallway else _integer(rng, 8, 18 - gap)
            walls.append(_wall((int(x), low), (int(x), high), [(at - low, gap)]))
    return walls


def _scenario_2(rng: np.random.Generator) -> list[Wall]:
    """Hallways around and between blocks of rooms, an assembly area, store rooms in the south."""
    store, south_m = _integer(rng, 3, 4), _integer(rng, 4, 5)
    low, middle = store + south_m, _integer(rng, 22, 30)
    high, top = middle + _integer(rng, 2, 5), _integer(rng, 45, 51)
    west, spine = _integer(rng, 4, 8), _integer(rng, 32, 42)
    inner, east = spine + _integer(rng, 2, 5), _integer(rng, 68, 74)
    door_m = _integer(rng, 2, 4)
    walls: list[Wall] = []

    def block(x0: int, x1: int, y0: int, y1: int, n: int, below: bool, above: bool) -> None:
        """Rooms side by side, with doors below, above or both."""
        cuts = _divided(x0, x1, n)
        for y, has_doors in ((y0, below), (y1, above)):
            offset = _integer(rng, 0, 12)
            doors = _doors(cuts, offset, door_m) if has_doors else ()
            walls.append(_wall((x0, y), (x1, y), doors))
        walls.extend(_wall((x, y0), (x, y1)) for x in cuts)

    block(inner, east, high, top, _integer(rng, 1, 4), below=True, above=True)
    block(west, spine, low, middle, _integer(rng, 2, 4), below=True, above=False)
    block(inner, _integer(rng, 63, 67), low, middle, 1, below=True, above=False)
    block(8, _integer(rng, 40, 70), 0, store, _integer(rng, 2, 4), below=False, above=True)
    rooms = _divided(high, top, 3)
    walls += [_wall((west, y), (spine, y)) for y in rooms]
    walls += [_wall((west, high), (west, top), _doors(rooms, 1, door_m))]
    walls += [_wall((spine, high), (spine, top))]
    return [wall for wall in walls if wall.start[1] != 0 or wall.end[1] != 0]  # but the outer one


_FAMILIES: dict[int, Callable[[np.random.Generator], list[Wall] | None]] = {
    1: _scenario_1,
    2: _scenario_2,
}


def _integer(rng: np.random.Generator, least: int, most: int) -> int:
    return int(rng.integers(least, most, endpoint=True))


def _divided(first: int, last: int, n: int) -> list[int]:
    """Whole metres that divide an interval into ``n`` about equal parts, ends included."""
    return [round(first + (last - first) * k / n) for k in range(n + 1)]


def _doors(cuts: Sequence[int], offset: int, door_m: int) -> list[tuple[int, int]]:
    """One door in each part of a wall, so far from the part's start as there is room."""
    return [
        (near - cuts[0] + min(offset, far - near - door_m - 1), door_m)
        for near, far in pairwise(cuts)
        if far - near > door_m + 1
    ]


def _wall(start: Corner, end: Corner, doors: Doors = ()) -> Wall:
    openings = tuple(
        Opening(float(offset), float(width), 0.0, DOOR_HEAD_M, "door") for offset, width in doors
    )
    ends = [(float(x), float(y)) for x, y in (start, end)]
    return Wall(ends[0], ends[1], "plasterboard", WALL_M, HEIGHT_M, openings)
