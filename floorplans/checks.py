"""Checks of a whole plan; the first problem found raises `PlanError`."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite
from typing import TYPE_CHECKING

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import LineString, MultiLineString, Point, Polygon
from shapely.geometry.base import BaseGeometry
from shapely.strtree import STRtree

from floorplans.errors import Place, PlanError
from floorplans.georeference import check_origin
from floorplans.materials import check_materials, check_slab
from floorplans.wall_checks import check_positive, check_wall
from floorplans.walls import TOLERANCE_M, Wall, closed_intervals

if TYPE_CHECKING:
    from floorplans.plan import FloorPlan


def check_plan(plan: FloorPlan) -> None:
    """Raise `PlanError` unless the plan describes a closed storey a search can be run in."""
    _check_name(plan.name)
    check_materials(plan.materials, plan.material_edition)
    _check_slabs(plan)
    _check_outline(plan.outline)
    for index, wall in enumerate(plan.walls):
        check_wall(wall, plan.height_m, plan.own_materials, ("walls", index))
    _check_walls_inside(plan)
    _check_no_double_walls(plan.walls)
    _check_enclosure(plan)
    _check_source(plan)
    _check_start(plan)
    if plan.origin is not None:
        check_origin(plan.origin)


def _check_name(name: str) -> None:
    if not (name and name.isprintable()):
        raise PlanError("expected one line of printable text", ("name",), name)


def _check_slabs(plan: FloorPlan) -> None:
    check_positive(plan.height_m, ("height_m",))
    own = plan.own_materials
    check_slab(plan.floor_material, plan.floor_thickness_m, own, (), "floor_")
    check_slab(plan.ceiling_material, plan.ceiling_thickness_m, own, (), "ceiling_")
    check_positive(plan.floor_thickness_m, ("floor_thickness_m",))
    check_positive(plan.ceiling_thickness_m, ("ceiling_thickness_m",))


def _check_outline(outline: Polygon) -> None:
    place: Place = ("outline",)
    if outline.has_z:
        raise PlanError("the outline has heights; give points (x, y)", place)
    if not all(isfinite(number) for number in shapely.get_coordinates(outline).flat):
        raise PlanError("expected finite numbers [m]", place)
    if not outline.is_valid:
        reason = shapely.is_valid_reason(outline)
        raise PlanError(
            f"the ring is not a simple polygon: {reason}; no edge may cross or repeat another",
            place,
        )
    if not outline.area > 0:
        raise PlanError("the outline has no area; give at least three corners", place)


def _check_walls_inside(plan: FloorPlan) -> None:
    room = plan.outline.buffer(TOLERANCE_M)
    shapely.prepare(room)
    for index, wall in enumerate(plan.walls):
        line = LineString([wall.start, wall.end])
        if not room.covers(line):
            where = _stretch(line.difference(room))
            raise PlanError(
                f"the wall leaves the outline from {where}; shorten it or widen the outline",
                ("walls", index),
            )


def _check_no_double_walls(walls: tuple[Wall, ...]) -> None:
    lines = _centre_lines(walls)
    for first, second in STRtree(_array(lines)).query(_array(lines), predicate="intersects").T:
        if first < second:
            shared = lines[first].intersection(lines[second])
            if shared.length > TOLERANCE_M:
                raise PlanError(
                    f"the wall runs along another wall from {_stretch(shared)}; "
                    "one wall is one sheet: remove the stretch from one of them",
                    ("walls", int(second)),
                )


def _check_enclosure(plan: FloorPlan) -> None:
    """Raise unless walls without unfilled openings, floor to ceiling, cover the outline's edge."""
    edge = plan.outline.boundary
    full = [wall for wall in plan.walls if wall.height_m > plan.height_m - TOLERANCE_M]
    near = np.flatnonzero(shapely.dwithin(_array(_centre_lines(full)), edge, 2 * TOLERANCE_M))
    closed = [
        LineString([full[k].point_at(low), full[k].point_at(high)])
        for k in near
        for low, high in closed_intervals(full[k])
    ]
    cover = shapely.union_all(closed).buffer(2 * TOLERANCE_M)
    for ring in (plan.outline.exterior, *plan.outline.interiors):
        for gap in _lines(ring.difference(cover)):
            if gap.length > 10 * TOLERANCE_M:
                side = LineString(gap.coords[:2])
                raise PlanError(
                    f"the outline is open from {_stretch(side)}; put a wall from floor to ceiling "
                    "there, and give a door or window in it a material",
                    ("outline",),
                )


def _check_source(plan: FloorPlan) -> None:
    place: Place = ("source",)
    x, y, z = plan.source
    if not 0 < z < plan.height_m:
        raise PlanError(
            f"the source is not between floor and ceiling; expected a height above 0 and below "
            f"{plan.height_m:g} [m]",
            place,
            plan.source,
        )
    _check_inside(plan, (x, y), "source", plan.source)
    if _in_wall(plan, (x, y), z):
        raise PlanError("the source is in a wall; move it into a room", place, plan.source)


def _check_start(plan: FloorPlan) -> None:
    """Raise for a start outside, or with a wall at every height; it may stand in a doorway."""
    _check_inside(plan, plan.start, "start", plan.start)
    if all(_in_wall(plan, plan.start, height_m) for height_m in plan.layer_heights()):
        raise PlanError("the start is in a wall; move it into a room", ("start",), plan.start)


def _check_inside(plan: FloorPlan, point: tuple[float, float], key: str, value: object) -> None:
    if not plan.outline.covers(Point(point)):
        x_min, y_min, x_max, y_max = plan.bounds
        raise PlanError(
            f"the {key} is outside the outline, which reaches from ({x_min:g}, {y_min:g}) to "
            f"({x_max:g}, {y_max:g}); move it into a room",
            (key,),
            value,
        )


def _in_wall(plan: FloorPlan, point: tuple[float, float], height_m: float) -> bool:
    walls = MultiLineString(list(plan.solid_segments(height_m)))
    return Point(point).distance(walls) < TOLERANCE_M


def _centre_lines(walls: Sequence[Wall]) -> list[LineString]:
    return [LineString([wall.start, wall.end]) for wall in walls]


def _array(lines: list[LineString]) -> NDArray[np.object_]:
    return np.array(lines, dtype=np.object_)  # of this type also when there is none


def _lines(geometry: BaseGeometry) -> list[LineString]:
    """Straight or bent lines of a geometry, joined where one goes on from another."""
    merged = shapely.line_merge(geometry)
    parts = shapely.get_parts(merged)
    return [part for part in parts if isinstance(part, LineString) and not part.is_empty]


def _stretch(geometry: BaseGeometry) -> str:
    """Say "(x, y) to (x, y)" of the longest line of a geometry, rounded to 0.1 mm."""
    longest = max(_lines(geometry), key=lambda line: line.length)
    first, last = longest.coords[0], longest.coords[-1]
    return " to ".join(f"({_tidy(x)}, {_tidy(y)})" for x, y in (first, last))


def _tidy(number: float) -> str:
    return f"{round(number, 4) + 0.0:g}"
