"""Warnings about a plan: walls that almost meet, slivers, duplicate walls, rooms without a door."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import dist
from typing import ClassVar, Literal

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import MultiLineString, Point, Polygon

from floorplans.errors import format_place
from floorplans.solid_regions import faces_of
from floorplans.unchecked import PlanFile, UncheckedPlan
from floorplans.walls import TOLERANCE_M, Wall, centre_lines
from floorplans.walls import Point as PlanPoint

GAP_M = 0.05
"""A free wall end this near to another wall's body should probably meet it [m]."""

SLIVER_M = 0.05
"""Walls shorter than this, and regions narrower, are slivers [m]."""

ROOM_WALL_M = 1.5
"""Walls at least this high separate rooms [m]."""

SOURCE_GAP_M = 0.1
START_GAP_M = 0.2
"""Least distances of source and start from walls [m]."""

_PARALLEL_SINE = 0.03
_SIDE_BY_SIDE_M = 0.2
_JAMB_M = 0.01
_LARGE_M2 = 1000.0

Severity = Literal["error", "warning"]


@dataclass(frozen=True)
class Finding:
    """An error or warning about a plan.

    Attributes
    ----------
    severity : {"error", "warning"}
        An error makes the plan unusable.
    kind : str
        Short name, the same for all findings of a kind.
    text : str
        What is wrong, where in the file, and what would be right.
    at : (float, float) or None
        Where in the building, (x, y) [m]; None if nowhere in particular.
    """

    FLIGHT_KINDS: ClassVar[tuple[str, ...]] = (
        "start",
        "start near wall",
        "no door",
        "not reached",
        "source not reached",
    )
    """Kinds of findings that matter to flights only."""

    severity: Severity
    kind: str
    text: str
    at: PlanPoint | None

    @property
    def concerns(self) -> Literal["map", "flight"]:
        """Whether it matters to a map, and so to a flight too, or to flights only."""
        return "flight" if self.kind in self.FLIGHT_KINDS else "map"


@dataclass(frozen=True)
class _Walls:
    """Walls with their centre lines and their names in the file."""

    walls: tuple[Wall, ...]
    lines: NDArray[np.object_]
    names: tuple[str, ...]


def warnings_of(file: PlanFile) -> Iterator[Finding]:
    """Yield the warnings about a plan whose numbers are valid."""
    plan = file.plan
    lines = centre_lines(plan.walls)
    places = (file.place_in_file(("walls", index)) for index in range(len(lines)))
    walls = _Walls(plan.walls, lines, tuple(format_place(place) for place in places))
    yield from _walls_that_almost_meet(walls)
    yield from _walls_side_by_side(walls)
    yield from _short_walls(walls)
    yield from _walls_in_openings(walls)
    yield from _slivers_and_closed_rooms(plan)
    yield from _near_walls(plan)


def _walls_that_almost_meet(walls: _Walls) -> Iterator[Finding]:
    """Yield free wall ends that stop just short of another wall, or within its thickness."""
    tree = shapely.STRtree(walls.lines)
    reach = np.array([wall.thickness_m / 2 + GAP_M for wall in walls.walls])
    reach_m = float(reach.max(initial=0.0))
    for index, wall in enumerate(walls.walls):
        for end in (wall.start, wall.end):
            near = tree.query(Point(end), predicate="dwithin", distance=reach_m)
            others = near[near != index]
            gaps = shapely.distance(walls.lines[others], Point(end))
            meant = gaps <= reach[others]
            if meant.any() and gaps.min() > TOLERANCE_M:
                k = int(np.argmin(np.where(meant, gaps, np.inf)))
                yield Finding(
                    "warning",
                    "almost meets",
                    f"an end of {walls.names[index]} is {gaps[k]:.4g} m from "
                    f"{walls.names[int(others[k])]}, and waves pass between them: make them meet",
                    end,
                )


def _walls_side_by_side(walls: _Walls) -> Iterator[Finding]:
    """Yield walls that run beside each other within their thickness: duplicate walls."""
    for first, second in _parallel_neighbours(walls):
        overlap = _overlap(walls.walls[first], walls.walls[second])
        if overlap is not None and overlap[1] > TOLERANCE_M:
            length, apart, at = overlap
            yield Finding(
                "warning",
                "side by side",
                f"{walls.names[second]} runs beside {walls.names[first]} for {length:.4g} m, "
                f"{apart:.4g} m off: one wall is one sheet on its centre line",
                at,
            )


def _parallel_neighbours(walls: _Walls) -> list[tuple[int, int]]:
    """Pairs of nearly parallel walls that are no farther apart than the thickest is thick."""
    reach = max((wall.thickness_m for wall in walls.walls), default=0.0)
    pairs = shapely.STRtree(walls.lines).query(walls.lines, "dwithin", distance=reach)
    first, second = pairs[:, pairs[0] < pairs[1]]
    along = np.array([np.subtract(wall.end, wall.start) for wall in walls.walls]).reshape(-1, 2)
    along /= np.hypot(along[:, 0], along[:, 1])[:, None]
    (x0, y0), (x1, y1) = along[first].T, along[second].T
    kept = np.abs(x0 * y1 - y0 * x1) <= 1.01 * _PARALLEL_SINE
    return list(zip(first[kept].tolist(), second[kept].tolist(), strict=True))


def _overlap(a: Wall, b: Wall) -> tuple[float, float, PlanPoint] | None:
    """Length, distance and middle of the section on which wall b runs within wall a's body."""
    along = (np.array(a.end) - a.start) / a.length_m
    across = np.array([-along[1], along[0]])
    ends = np.array([b.start, b.end]) - a.start
    if abs((ends[1] - ends[0]) @ across) > _PARALLEL_SINE * b.length_m:
        return None
    s = np.clip(np.sort(ends @ along), 0.0, a.length_m)
    apart = float(np.abs(ends @ across).mean())
    if s[1] - s[0] < _SIDE_BY_SIDE_M or apart > (a.thickness_m + b.thickness_m) / 2:
        return None
    return float(s[1] - s[0]), apart, a.point_at(float(s.mean()))


def _short_walls(walls: _Walls) -> Iterator[Finding]:
    for wall, name in zip(walls.walls, walls.names, strict=True):
        if wall.length_m < SLIVER_M:
            text = f"{name} is only {wall.length_m:.4g} m long: remove it and make the others meet"
            yield Finding("warning", "sliver", text, wall.start)


def _walls_in_openings(walls: _Walls) -> Iterator[Finding]:
    """Yield ends of walls that lie in an opening of another wall."""
    ends = [end for wall in walls.walls for end in (wall.start, wall.end)]
    openings = [
        (name, opening.kind, wall.point_at(opening.offset_m), wall.point_at(opening.end_m))
        for name, wall in zip(walls.names, walls.walls, strict=True)
        for opening in wall.openings
    ]
    sides = np.array([(near, far) for *_, near, far in openings], dtype=np.float64)
    lines = shapely.linestrings(sides.reshape(-1, 2, 2))
    tree = shapely.STRtree(np.array(shapely.points(np.reshape(ends, (-1, 2)))))
    for o, k in tree.query(lines, predicate="dwithin", distance=TOLERANCE_M).T.tolist():
        name, kind, near, far = openings[o]
        if min(dist(ends[k], near), dist(ends[k], far)) > _JAMB_M:
            yield Finding(
                "warning",
                "wall in opening",
                f"{walls.names[k // 2]} ends in a {kind} of {name}: move one of them",
                ends[k],
            )


def _slivers_and_closed_rooms(plan: UncheckedPlan) -> Iterator[Finding]:
    """Yield regions too narrow to be rooms, and rooms without a door."""
    least_m = min(ROOM_WALL_M, plan.height_m)
    separating = [w for w in plan.walls if w.kind == "wall" and w.height_m >= least_m]
    doors = [
        Point(wall.point_at(opening.offset_m + opening.width_m / 2))
        for wall in separating
        for opening in wall.openings
        if opening.kind != "window"
    ]
    tree = shapely.STRtree(np.array(doors, dtype=np.object_))
    solid = shapely.STRtree([region.polygon for region in plan.solid_regions])
    for room in faces_of(separating):
        inner = room.representative_point()
        at = (float(inner.x), float(inner.y))
        if not plan.outline.contains(inner):
            continue
        if room.buffer(-SLIVER_M / 2).is_empty:
            text = f"a sliver of {room.area:.3g} m² between walls; merge them into one wall"
            yield Finding("warning", "sliver", text, at)
        elif len(solid.query(inner, predicate="within")):
            continue
        elif not len(tree.query(room, predicate="dwithin", distance=1e-4)):
            yield Finding("warning", "no door", _no_door(room), at)


def _no_door(room: Polygon) -> str:
    x_min, y_min, x_max, y_max = (round(side, 2) + 0.0 for side in room.bounds)
    area = f"{room.area:.4g}" if room.area < _LARGE_M2 else f"{room.area:.0f}"
    return (
        f"no door or passage leads to the room of {area} m² from ({x_min:g}, {y_min:g}) "
        f"to ({x_max:g}, {y_max:g})"
    )


def _near_walls(plan: UncheckedPlan) -> Iterator[Finding]:
    """Yield a source, transmitter or start too close to a wall."""
    placed = [("transmitter", t.position, SOURCE_GAP_M) for t in plan.transmitters]
    if plan.source is not None:
        placed = [("source", plan.source, SOURCE_GAP_M), *placed]
    if plan.start is not None:
        placed.append(("start", (*plan.start, plan.height_m / 2), START_GAP_M))
    for name, (x, y, height_m), least in placed:
        if not 0 <= height_m <= plan.height_m:
            continue
        walls = MultiLineString(list(plan.solid_segments(height_m)))
        gap = Point(x, y).distance(walls)
        if TOLERANCE_M <= gap < least:
            text = f"the {name} is {gap:.4g} m from a wall; keep it at least {least:g} m away"
            yield Finding("warning", f"{name} near wall", text, (x, y))
