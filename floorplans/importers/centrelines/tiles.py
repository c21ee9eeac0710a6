"""A large area in tiles: a building's walls are one area, of which a line meets little."""

from __future__ import annotations

from math import ceil, floor, log2

import shapely
from shapely.geometry import box
from shapely.geometry.base import BaseGeometry

_SIDE_M = 2.0
_N_LEVELS = 9
_FEW = 200
"""An area of so few corners is not cut."""


class Tiles:
    """What an area covers around places, cut out by halves and kept."""

    def __init__(self, area: BaseGeometry) -> None:
        self._area = area
        self._tiles: dict[tuple[int, int, int], BaseGeometry] = {}

    def around(self, x: float, y: float, reach_m: float) -> BaseGeometry:
        """Area of all that is near a place in both directions, and of some more.

        Parameters
        ----------
        x, y : float
            [m].
        reach_m : float
            How near [m].
        """
        level = ceil(log2(max(2 * reach_m / _SIDE_M, 1.0)))
        side_m = _SIDE_M * 2**level
        return self._tile(level, floor(x / side_m), floor(y / side_m))

    def _tile(self, level: int, i: int, j: int) -> BaseGeometry:
        """Square of 2 ** level times the side, with half as much on each side."""
        if level >= _N_LEVELS:
            return self._area
        if (level, i, j) not in self._tiles:
            larger = self._tile(level + 1, i // 2, j // 2)
            side_m = _SIDE_M * 2**level
            x, y = (i - 0.5) * side_m, (j - 0.5) * side_m
            self._tiles[level, i, j] = _cut(larger, x, y, x + 2 * side_m, y + 2 * side_m)
        return self._tiles[level, i, j]


def _cut(area: BaseGeometry, x_0: float, y_0: float, x_1: float, y_1: float) -> BaseGeometry:
    """Part of an area in a rectangle, or all of it if it is small."""
    if shapely.get_num_coordinates(area) <= _FEW:
        return area
    low_x, low_y, high_x, high_y = area.bounds
    if x_0 <= low_x and y_0 <= low_y and x_1 >= high_x and y_1 >= high_y:
        return area
    part = shapely.clip_by_rect(area, x_0, y_0, x_1, y_1)
    return part if part.is_valid else shapely.intersection(area, box(x_0, y_0, x_1, y_1))
