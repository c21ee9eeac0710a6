"""Walls between rooms, for files that contain rooms but no walls."""

from __future__ import annotations

from collections.abc import Sequence

import shapely
from shapely.geometry import LineString, Polygon
from shapely.geometry.base import BaseGeometry

from floorplans.importers.centrelines.areas import walls_of_area
from floorplans.importers.draft import RawWall, walls_along

WALL_GAP_M = 0.8
"""Rooms nearer to each other than this have a wall between them [m]."""

_WITHIN = 0.5
"""A room overlapped by more than this fraction of its area lies within the other."""


def walls_of_rooms(
    rooms: Sequence[Polygon], is_open: Sequence[bool], tolerance_m: float
) -> list[RawWall]:
    """Return a wall around all rooms, and one between each two.

    Rooms that touch have a wall of unknown thickness on their common border; a gap between rooms is
    filled by a wall.

    Parameters
    ----------
    rooms : sequence of shapely.geometry.Polygon
        [m].
    is_open : sequence of bool
        For each room; there is no wall between two open ones.
    tolerance_m : float
        Rooms nearer than this touch [m].

    Returns
    -------
    list of RawWall
    """
    whole = shapely.union_all(list(rooms))
    closed = _closed(whole, WALL_GAP_M)
    gaps = _opened(closed.difference(whole), tolerance_m)
    edge = closed.boundary.simplify(tolerance_m)
    borders = shapely.union_all(_borders(rooms, is_open, tolerance_m))
    borders = borders.difference(edge.buffer(tolerance_m)).simplify(tolerance_m)
    between = [] if gaps.is_empty else walls_of_area(gaps, tolerance_m)
    return [*_straight(edge), *_straight(borders), *between]


def _borders(
    rooms: Sequence[Polygon], is_open: Sequence[bool], tolerance_m: float
) -> list[BaseGeometry]:
    """Sections of the edge of one room that run along another."""
    tree = shapely.STRtree(list(rooms))
    near = tree.query(list(rooms), predicate="dwithin", distance=tolerance_m).T.tolist()
    pairs = [(i, j) for i, j in near if i < j and not (is_open[i] and is_open[j])]
    return [_border(rooms[i], rooms[j], tolerance_m) for i, j in pairs]


def _border(one: Polygon, other: Polygon, tolerance_m: float) -> BaseGeometry:
    """Section of the edge of one room along the other; of a room within another, its own edge."""
    small, large = sorted((one, other), key=lambda room: room.area)
    if small.intersection(large).area > _WITHIN * small.area:
        one, other = small, large
    return one.boundary.intersection(other.buffer(tolerance_m))


def _closed(area: BaseGeometry, gap_m: float) -> BaseGeometry:
    grown = area.buffer(gap_m / 2, join_style="mitre")
    return grown.buffer(-gap_m / 2, join_style="mitre")


def _opened(area: BaseGeometry, width_m: float) -> BaseGeometry:
    """Remove what is narrower than a width."""
    core = area.buffer(-width_m / 2, join_style="mitre")
    return core.buffer(width_m / 2, join_style="mitre")


def _straight(lines: BaseGeometry) -> list[RawWall]:
    merged = shapely.get_parts(shapely.line_merge(lines))
    chains = [line for line in merged if isinstance(line, LineString)]
    return [wall for line in chains for wall in walls_along(line)]
