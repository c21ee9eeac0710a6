"""Shapes of walls and openings in the plan view, as arrays of points (n, 2) [m]."""

from collections import defaultdict
from math import pi

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import LineString, MultiLineString, Point

from floorplans.unchecked import UncheckedPlan
from floorplans.walls import TOLERANCE_M, Opening, Wall, complement
from floorplans.walls import Point as PlanPoint

Shape = NDArray[np.float64]

DOUBLE_DOOR_M = 1.4
"""Doors wider than this have two leaves [m]."""


def strip(wall: Wall, s_min: float, s_max: float, width_m: float) -> Shape:
    """Four corners, in order, of a strip around a section of a wall's centre line."""
    along, across = _directions(wall)
    ends = np.array(wall.start) + np.outer((s_min, s_max), along)
    half = across * width_m / 2
    return np.array([ends[0] - half, ends[1] - half, ends[1] + half, ends[0] + half])


def strip_edges(wall: Wall, s_min: float, s_max: float, width_m: float) -> list[Shape]:
    """Two long edges of `strip`, each (2, 2) [m]."""
    corners = strip(wall, s_min, s_max, width_m)
    return [corners[:2], corners[2:]]


class WallStrips:
    """Strips of a plan's walls, interrupted at openings, extended where walls meet in a corner.

    Parameters
    ----------
    plan : UncheckedPlan
    min_width_m : float
        Thinner walls are drawn this wide [m].
    """

    def __init__(self, plan: UncheckedPlan, min_width_m: float) -> None:
        self._min_width_m = min_width_m
        self._walls_at: defaultdict[PlanPoint, list[Wall]] = defaultdict(list)
        for wall in plan.walls:
            self._walls_at[wall.start].append(wall)
            self._walls_at[wall.end].append(wall)

    def width_m(self, wall: Wall) -> float:
        """Width a wall is drawn with [m]."""
        return max(wall.thickness_m, self._min_width_m)

    def strips(self, wall: Wall) -> list[Shape]:
        """Corners of the strips of a wall, each (4, 2) [m]."""
        openings = ((opening.offset_m, opening.end_m) for opening in wall.openings)
        ends = {0.0: -self._cap_m(wall, wall.start)}
        ends[wall.length_m] = wall.length_m + self._cap_m(wall, wall.end)
        return [
            strip(wall, ends.get(low, low), ends.get(high, high), self.width_m(wall))
            for low, high in complement(openings, wall.length_m)
        ]

    def _cap_m(self, wall: Wall, end: PlanPoint) -> float:
        """How far a wall extends beyond its end, to fill the corner with other walls' ends [m]."""
        others = [other for other in self._walls_at[end] if other is not wall]
        return max((self.width_m(other) / 2 for other in others), default=0.0)


class DoorSwings:
    """Symbols of a plan's doors: open leaves, and the quarter circles of their edges.

    A door opens to the side where the next wall is farther away: from a corridor into a room.

    Parameters
    ----------
    plan : UncheckedPlan
    """

    def __init__(self, plan: UncheckedPlan) -> None:
        lines = [[wall.start, wall.end] for wall in plan.walls]
        self._walls = MultiLineString(lines)
        x_min, y_min, x_max, y_max = plan.bounds
        self._reach_m = x_max - x_min + y_max - y_min

    def symbol(self, wall: Wall, opening: Opening) -> list[Shape]:
        """Leaf and arc of a door, or two of each if it is wide; each (n, 2) [m]."""
        along, across = _directions(wall)
        near, far = (np.array(wall.start) + s * along for s in (opening.offset_m, opening.end_m))
        sides = (across, -across)
        side = max(sides, key=lambda side: self._depth((near + far) / 2, side))
        if opening.width_m <= DOUBLE_DOOR_M:
            return leaf_and_arc(near, opening.width_m * along, opening.width_m * side)
        half = opening.width_m / 2
        return [
            *leaf_and_arc(near, half * along, half * side),
            *leaf_and_arc(far, -half * along, half * side),
        ]

    def _depth(self, point: Shape, side: Shape) -> float:
        """Distance from a point of a wall to the next wall on one side [m]; 0 if there is none."""
        ray = LineString([point + 2 * TOLERANCE_M * side, point + self._reach_m * side])
        hits = ray.intersection(self._walls)
        return 0.0 if shapely.is_empty(hits) else Point(point).distance(hits)


def leaf_and_arc(hinge: Shape, closed: Shape, opened: Shape) -> list[Shape]:
    """Open leaf of a door hinged at a point, and the arc of its edge."""
    angle = np.linspace(0, pi / 2, 24)
    arc = hinge + np.outer(np.cos(angle), closed) + np.outer(np.sin(angle), opened)
    return [np.array([hinge, hinge + opened]), arc]


def _directions(wall: Wall) -> tuple[Shape, Shape]:
    """Unit vectors along a wall and to its left."""
    along = (np.array(wall.end) - np.array(wall.start)) / wall.length_m
    return along, np.array([-along[1], along[0]])
