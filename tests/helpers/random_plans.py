"""Buildings drawn at random: any angle, joined and free walls, pillars, openings, every height."""

from collections.abc import Callable
from itertools import pairwise

import numpy as np
import shapely
from buildings import GLASS, HEIGHT_M, Building, Hole, Point, Sheet, door, ring, wall, window
from numpy.random import Generator

CLEAR_M = 0.3
"""Free walls keep this far from all others, and corners from each other [m]."""

Sheets = tuple[Sheet, ...]


def random_building(seed: int, n_inside: int) -> Building:
    """Return a room with a number of walls, pillars and screens in it, at a random angle."""
    rng = np.random.default_rng(seed)
    outline = _outline(rng)
    inside: list[Sheets] = []
    for _ in range(n_inside):
        stand = rng.choice(np.array(KINDS, dtype=object))
        inside.append(stand(rng, outline, inside))
    sheets = (*ring(outline), *(s for sheets in inside for s in sheets))
    turn = rng.uniform(0.0, 2.0 * np.pi)
    matrix = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    return Building(outline, sheets).moved(matrix, rng.uniform(-30.0, 30.0, 2))


def _outline(rng: Generator) -> tuple[Point, ...]:
    """Return a star-shaped polygon of four to seven corners, convex or not."""
    n = int(rng.integers(4, 8))
    azimuth = 2.0 * np.pi * (np.arange(n) + rng.uniform(-0.3, 0.3, n)) / n
    radius = rng.uniform(2.0, 5.0, n)
    corners = np.column_stack([1.3 * radius * np.cos(azimuth), radius * np.sin(azimuth)])
    return tuple((float(x), float(y)) for x, y in corners)


def _free(rng: Generator, outline: tuple[Point, ...], inside: list[Sheets]) -> Sheets:
    """Return a wall that meets no other, if there is room."""
    taken = _lines(outline, inside).buffer(CLEAR_M)
    return _first_clear(
        rng, lambda: (_point_in(rng, outline), _point_in(rng, outline)), outline, taken
    )


def _joined(rng: Generator, outline: tuple[Point, ...], inside: list[Sheets]) -> Sheets:
    """Return a wall from somewhere along another one, across whatever comes, to a free end."""
    walls = _standing(outline, inside)
    start = _along(walls[rng.integers(len(walls))], rng.uniform(0.2, 0.8))
    return _first_clear(rng, lambda: (start, _point_in(rng, outline)), outline)


def _between(rng: Generator, outline: tuple[Point, ...], inside: list[Sheets]) -> Sheets:
    """Return a wall from one wall to another."""
    walls = ring(outline)

    def ends() -> tuple[Point, Point]:
        one, two = rng.choice(len(walls), 2, replace=False)
        return _along(walls[one], rng.uniform(0.2, 0.8)), _along(walls[two], rng.uniform(0.2, 0.8))

    return _first_clear(rng, ends, outline)


def _again(rng: Generator, outline: tuple[Point, ...], inside: list[Sheets]) -> Sheets:
    """Return a second wall over a stretch of one that is there, of another material."""
    walls = _standing(outline, inside)
    old = walls[rng.integers(len(walls))]
    start, end = _along(old, rng.uniform(0.1, 0.4)), _along(old, rng.uniform(0.6, 0.9))
    return wall(start, end, slab=GLASS, **_heights(rng))


def _pillar(rng: Generator, outline: tuple[Point, ...], inside: list[Sheets]) -> Sheets:
    """Return a closed ring of three to five walls, if there is room."""
    n = int(rng.integers(3, 6))
    azimuth = 2.0 * np.pi * (np.arange(n) + rng.uniform(-0.3, 0.3, n)) / n
    free = shapely.Polygon(outline).buffer(-1.0).difference(_lines(outline, inside).buffer(1.0))
    if free.is_empty:
        return ()
    middle, radius = free.representative_point(), rng.uniform(0.3, 0.8)
    corners = [
        (float(middle.x + radius * np.cos(a)), float(middle.y + radius * np.sin(a)))
        for a in azimuth
    ]
    return ring(corners, slab=int(rng.integers(3)))


KINDS = (_free, _joined, _between, _again, _pillar)


def _first_clear(
    rng: Generator,
    ends: Callable[[], tuple[Point, Point]],
    outline: tuple[Point, ...],
    taken: shapely.Geometry | None = None,
) -> Sheets:
    """Return the first of some walls that lies inside and clear of others; none after 20."""
    ground = shapely.Polygon(outline).buffer(1e-9)
    for _ in range(20):
        a, b = ends()
        line = shapely.LineString([a, b])
        if line.length > 0.5 and ground.covers(line) and not (taken and line.intersects(taken)):
            return _wall(rng, a, b, line.length)
    return ()


def _wall(rng: Generator, a: Point, b: Point, length: float) -> Sheets:
    """Return a wall with openings, partly high, or of several boards above each other."""
    near, middle, far = length * np.array([0.2, 0.45, 0.7])
    holes: list[tuple[Hole, ...]] = [
        (),
        (door(near, far),),
        (window(near, far),),
        (window(near, middle, GLASS), door(middle, far)),
        (door(near, middle), window(0.5 * (middle + far), far)),
        (door(near, far, filling=int(rng.integers(3))),),
        (window(near, middle), door(middle, far, head=HEIGHT_M, filling=GLASS)),
    ]
    kind = int(rng.integers(len(holes) + 2))
    if kind < len(holes):
        return wall(a, b, *holes[kind], slab=int(rng.integers(3)))
    if kind == len(holes):
        return wall(a, b, slab=int(rng.integers(3)), **_heights(rng))
    z = np.sort(rng.choice(np.arange(0.0, HEIGHT_M + 0.1, 0.25), 6, replace=False))
    boards = zip(z[::2], z[1::2], strict=True)
    if rng.integers(2):
        tops = [0.0, float(z[1]), float(z[3]), HEIGHT_M]
        boards = pairwise(dict.fromkeys(tops))
    return tuple(Sheet(a, b, float(low), float(high), k) for k, (low, high) in enumerate(boards))


def _heights(rng: Generator) -> dict[str, float]:
    return [{}, {"high": 1.25}, {"low": 1.75}][rng.integers(3)]


def _along(sheet: Sheet, part: float) -> Point:
    (x0, y0), (x1, y1) = sheet.start, sheet.end
    return x0 + part * (x1 - x0), y0 + part * (y1 - y0)


def _point_in(rng: Generator, outline: tuple[Point, ...]) -> Point:
    ground = shapely.Polygon(outline)
    x0, y0, x1, y1 = ground.bounds
    while True:
        x, y = float(rng.uniform(x0, x1)), float(rng.uniform(y0, y1))
        if ground.contains(shapely.Point(x, y)):
            return x, y


def _lines(outline: tuple[Point, ...], inside: list[Sheets]) -> shapely.Geometry:
    return shapely.union_all(
        [shapely.LineString([s.start, s.end]) for s in _standing(outline, inside)]
    )


def _standing(outline: tuple[Point, ...], inside: list[Sheets]) -> list[Sheet]:
    sheets = (*ring(outline), *(s for sheets in inside for s in sheets))
    return [s for s in sheets if s.start != s.end]
