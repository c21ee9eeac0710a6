"""Large buildings drawn at random: walls in line with gaps between them, turned and rounded."""

import numpy as np
from buildings import CONCRETE, Building, Point, Sheet, door, ring, wall
from numpy.random import Generator

RASTER_M = 0.5
"""Coordinates before the building is turned are multiples of this [m]."""


def rounded_building(seed: int, size_m: float, n_rows: int, decimals: int) -> Building:
    """Return a square building with rows of walls, turned and moved, its coordinates rounded.

    Parameters
    ----------
    seed
        Of everything random.
    size_m
        Of its sides [m].
    n_rows
        Rows of walls in line; half of them cross or meet the others at right angles.
    decimals
        To which coordinates are rounded.
    """
    rng = np.random.default_rng(seed)
    rows = [line for _ in range(n_rows) for line in _row(rng, size_m)]
    corners = ((0.0, 0.0), (size_m, 0.0), (size_m, size_m), (0.0, size_m))
    turn = rng.uniform(0.0, 2.0 * np.pi)
    matrix = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    shift = rng.uniform(-size_m, size_m, 2)

    def at(p: Point) -> Point:
        x, y = np.round(matrix @ np.array(p) + shift, decimals)
        return float(x), float(y)

    outline = tuple(map(at, corners))
    inside = [sheet for a, b in rows for sheet in _wall(rng, at(a), at(b))]
    return Building(outline, (*ring(outline), *inside))


def _row(rng: Generator, size_m: float) -> list[tuple[Point, Point]]:
    """Return walls in one line, with gaps between them."""
    across, one, other = (RASTER_M * rng.integers(0, int(size_m / RASTER_M) + 1, 3)).tolist()
    start, stop = min(one, other), max(one, other)
    turned = rng.random() < 0.5
    walls: list[tuple[Point, Point]] = []
    while start < stop:
        end = min(stop, start + RASTER_M * int(rng.integers(1, 20)))
        row = ((start, across), (end, across))
        walls.append(((across, start), (across, end)) if turned else row)
        start = end + RASTER_M * int(rng.integers(1, 10))
    return walls


def _wall(rng: Generator, a: Point, b: Point) -> tuple[Sheet, ...]:
    length = float(np.hypot(b[0] - a[0], b[1] - a[1]))
    holes = (door(0.4 * length, 0.6 * length),) if rng.random() < 0.2 else ()
    return wall(a, b, *holes, slab=CONCRETE if rng.random() < 0.5 else 1)
