"""Checks of a whole plan: all that makes it unusable."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from itertools import islice

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.errors import ShapelyError
from shapely.geometry import LineString, Point, Polygon
from shapely.geometry.base import BaseGeometry
from shapely.strtree import STRtree

from floorplans.checks.materials import check_materials, check_slab
from floorplans.checks.walls import check_wall
from floorplans.errors import Place, PlanError
from floorplans.frame import check_frame
from floorplans.georeference import check_origin
from floorplans.transmitters import check_transmitters
from floorplans.unchecked import UncheckedPlan
from floorplans.values import (
    COORDINATE,
    LENGTH,
    MAX_CORNERS,
    MAX_HOLES,
    MAX_SIDE_M,
    MAX_WALLS,
    check_count,
    check_number,
    type_faults,
)
from floorplans.walls import (
    TOLERANCE_M,
    Wall,
    centre_lines,
    closed_intervals,
    complement,
    solid_heights,
)

MAX_FAULTS = 1000
"""No more faults than this are listed."""

_BATCH = 256
_PARALLEL_SINE = 0.01


def check_plan(plan: UncheckedPlan) -> None:
    """Raise `PlanError` unless the plan describes a closed storey."""
    for fault in faults(plan):
        raise fault


def faults(plan: UncheckedPlan) -> Iterator[PlanError]:
    """Yield wrong numbers and names or, if there are none, what is wrong about the building."""
    wrong_numbers = False
    for fault in number_faults(plan):
        wrong_numbers = True
        yield fault
    if not wrong_numbers:
        yield from building_faults(plan)


def building_faults(plan: UncheckedPlan) -> Iterator[PlanError]:
    """Yield what is wrong about a building whose numbers are valid, up to `MAX_FAULTS`."""
    try:
        with geos_flags_ignored():
            found = list(islice(_building_faults(plan), MAX_FAULTS))
    except ShapelyError as error:
        problem = f"the geometry cannot be computed ({error}); round coordinates to the millimetre"
        found = [PlanError(problem)]
    yield from found


def geos_flags_ignored() -> np.errstate:
    """Context in which the divisions by zero that GEOS makes and handles warn nobody."""
    return np.errstate(divide="ignore", over="ignore", invalid="ignore")


def _building_faults(plan: UncheckedPlan) -> Iterator[PlanError]:
    yield from _walls_outside(plan)
    yield from _duplicate_walls(plan.walls)
    yield from _open_edges(plan)
    for place, name, position in _placed(plan):
        yield from _caught(partial(_check_transmitter, plan, place, name, position))
    yield from _caught(lambda: _check_start(plan))


def number_faults(plan: UncheckedPlan) -> Iterator[PlanError]:
    """Yield values of wrong types or, if there are none, invalid numbers and names."""
    wrong_types = list(islice(type_faults(plan, UncheckedPlan), MAX_FAULTS))
    yield from wrong_types or islice(_value_faults(plan), MAX_FAULTS)


def _value_faults(plan: UncheckedPlan) -> Iterator[PlanError]:
    yield from _caught(lambda: _check_name(plan.name))
    yield from _caught(lambda: check_materials(plan.materials, plan.material_edition))
    yield from _caught(lambda: _check_slabs(plan))
    yield from _caught(lambda: _check_outline(plan.outline))
    yield from _caught(lambda: check_count(plan.walls, MAX_WALLS, ("walls",)))
    yield from _caught(lambda: _check_points(plan))
    yield from _caught(lambda: check_transmitters(plan.transmitters))
    for index, wall in enumerate(plan.walls):
        place: Place = ("walls", index)
        for fault in _caught(partial(check_wall, wall, plan.height_m, plan.own_materials, place)):
            yield fault.located(at=_middle(wall))
    origin = plan.origin
    if origin is not None:
        yield from _caught(lambda: check_origin(origin))
    frame = plan.frame
    if frame is not None:
        yield from _caught(lambda: check_frame(frame))


def _caught(check: Callable[[], None]) -> Iterator[PlanError]:
    """Yield the error that a check raises."""
    try:
        check()
    except PlanError as fault:
        yield fault


def _middle(wall: Wall) -> tuple[float, float]:
    """Midpoint of a wall."""
    return (wall.start[0] + wall.end[0]) / 2, (wall.start[1] + wall.end[1]) / 2


def _check_name(name: str) -> None:
    if not (name and name.isprintable()):
        raise PlanError("expected one line of printable text", ("name",), name)


def _check_slabs(plan: UncheckedPlan) -> None:
    check_number(plan.height_m, LENGTH, ("height_m",))
    own = plan.own_materials
    check_slab(plan.floor_material, plan.floor_thickness_m, own, (), "floor_")
    check_slab(plan.ceiling_material, plan.ceiling_thickness_m, own, (), "ceiling_")
    check_number(plan.floor_thickness_m, LENGTH, ("floor_thickness_m",))
    check_number(plan.ceiling_thickness_m, LENGTH, ("ceiling_thickness_m",))
    if plan.ground_margin_m is not None:
        check_number(plan.ground_margin_m, LENGTH, ("ground_margin_m",))


def _check_points(plan: UncheckedPlan) -> None:
    for key, point in (("source", plan.source), ("start", plan.start)):
        for index, coordinate in enumerate(point or ()):
            check_number(coordinate, COORDINATE, (key, index))


def _check_outline(outline: Polygon) -> None:
    place: Place = ("outline",)
    if outline.has_z:
        raise PlanError("the outline has heights; give points (x, y)", place)
    check_count(outline.interiors, MAX_HOLES, ("holes",))
    corners = shapely.get_coordinates(outline)
    check_count(corners, MAX_CORNERS, place)
    for number in corners.flat:
        check_number(float(number), COORDINATE, place)
    x_min, y_min, x_max, y_max = outline.bounds
    side_m = max(x_max - x_min, y_max - y_min)
    if side_m > MAX_SIDE_M:
        raise PlanError(
            f"the outline extends over {side_m:g} m; expected at most {MAX_SIDE_M:g}", place
        )
    if not outline.is_valid:
        reason = shapely.is_valid_reason(outline)
        raise PlanError(
            f"the ring is not a simple polygon: {reason}; no edge may cross or repeat another",
            place,
        )
    if not outline.area > 0:
        raise PlanError("the outline has no area; give at least three corners", place)


def _walls_outside(plan: UncheckedPlan) -> Iterator[PlanError]:
    room = plan.outline.buffer(TOLERANCE_M)
    shapely.prepare(room)
    for index, line in enumerate(centre_lines(plan.walls)):
        if not room.covers(line):
            outside = max(_lines(line.difference(room)), key=lambda part: part.length, default=line)
            yield PlanError(
                f"the wall leaves the outline from {_ends_text(outside)}; shorten it or widen the "
                "outline",
                ("walls", index),
                at=_first_point(outside),
            )


def _duplicate_walls(walls: tuple[Wall, ...]) -> Iterator[PlanError]:
    lines = centre_lines(walls)
    for first, second in _parallel_pairs(lines):
        shared = shapely.intersection(lines.item(first), lines.item(second))
        if shared.length > TOLERANCE_M:
            section = _longest(shared)
            yield PlanError(
                f"the wall runs along another wall from {_ends_text(section)}; "
                "one wall is one sheet: remove this section from one of them",
                ("walls", second),
                at=_first_point(section),
            )


def _parallel_pairs(lines: NDArray[np.object_]) -> Iterator[tuple[int, int]]:
    """Yield lines that touch and are nearly parallel; a batch of lines at a time, for memory."""
    tree = STRtree(lines)
    along = np.diff(shapely.get_coordinates(lines).reshape(-1, 2, 2), axis=1)[:, 0]
    along /= np.hypot(*along.T)[:, None]
    for begin in range(0, len(lines), _BATCH):
        first, second = tree.query(lines[begin : begin + _BATCH], predicate="intersects")
        first += begin
        (x0, y0), (x1, y1) = along[first].T, along[second].T
        kept = (first < second) & (np.abs(x0 * y1 - y0 * x1) < _PARALLEL_SINE)
        yield from zip(first[kept].tolist(), second[kept].tolist(), strict=True)


def _open_edges(plan: UncheckedPlan) -> Iterator[PlanError]:
    """Yield where no full-height walls without unfilled openings cover the outline."""
    edge = plan.outline.boundary
    high_m = plan.height_m - TOLERANCE_M
    full = [wall for wall in plan.walls if wall.kind == "wall" and wall.height_m > high_m]
    near = np.flatnonzero(shapely.dwithin(centre_lines(full), edge, 2 * TOLERANCE_M))
    closed = [
        (full[k].point_at(low), full[k].point_at(high))
        for k in near
        for low, high in closed_intervals(full[k])
    ]
    lines = shapely.linestrings(np.array(closed).reshape(-1, 2, 2))
    cover = shapely.union_all(shapely.buffer(lines, 2 * TOLERANCE_M))
    for ring in (plan.outline.exterior, *plan.outline.interiors):
        for gap in _lines(ring.difference(cover)):
            if gap.length > 10 * TOLERANCE_M:
                side = LineString(gap.coords[:2])
                yield PlanError(
                    f"the outline is open from {_ends_text(side)}; put a wall from floor to "
                    "ceiling there, and give a door or window in it a material",
                    ("outline",),
                    at=_first_point(side),
                )


def _placed(
    plan: UncheckedPlan,
) -> Iterator[tuple[Place, str, tuple[float, float, float]]]:
    """Place in the file, name for messages and position [m] of the source and all transmitters."""
    if plan.source is not None:
        yield ("source",), "source", plan.source
    for index, transmitter in enumerate(plan.transmitters):
        place: Place = ("transmitters", index, "position")
        yield place, f"transmitter {transmitter.id!r}", transmitter.position


def _check_transmitter(
    plan: UncheckedPlan, place: Place, name: str, position: tuple[float, float, float]
) -> None:
    """Raise for a source or transmitter outside the rooms, or inside a wall."""
    x, y, z = position
    if not 0 < z < plan.height_m:
        raise PlanError(
            f"the {name} is not between floor and ceiling; expected a height above 0 and below "
            f"{plan.height_m:g} [m]",
            place,
            position,
            at=(x, y),
        )
    _check_inside(plan, (x, y), name, place, position)
    if any(low <= z <= high for low, high in solid_heights(plan.walls, (x, y))):
        raise PlanError(f"the {name} is in a wall; move it into a room", place, position, at=(x, y))
    _check_not_solid(plan, (x, y), z, name, place, position)


def _check_start(plan: UncheckedPlan) -> None:
    """Raise for a start outside, or inside a wall at every height; a doorway is allowed."""
    start, place = plan.start, ("start",)
    if start is None:
        return
    _check_inside(plan, start, "start", place, start)
    if not any(complement(solid_heights(plan.walls, start), plan.height_m)):
        raise PlanError("the start is in a wall; move it into a room", place, start, at=start)
    _check_not_solid(plan, start, plan.height_m, "start", place, start)


def _check_not_solid(
    plan: UncheckedPlan,
    point: tuple[float, float],
    height_m: float,
    name: str,
    place: Place,
    value: object,
) -> None:
    for region in plan.solid_regions:
        if height_m <= region.top_m and region.polygon.covers(Point(point)):
            raise PlanError(
                f"the {name} is in a column or shaft: walls without an opening enclose "
                f"{region.polygon.area:.3g} m² around it; move it into a room",
                place,
                value,
                at=point,
            )


def _check_inside(
    plan: UncheckedPlan, point: tuple[float, float], name: str, place: Place, value: object
) -> None:
    if not plan.outline.covers(Point(point)):
        x_min, y_min, x_max, y_max = plan.bounds
        raise PlanError(
            f"the {name} is outside the outline, which reaches from ({x_min:g}, {y_min:g}) to "
            f"({x_max:g}, {y_max:g}); move it into a room",
            place,
            value,
            at=point,
        )


def _lines(geometry: BaseGeometry) -> list[LineString]:
    """Lines of a geometry, connected ones merged."""
    merged = shapely.line_merge(geometry)
    parts = shapely.get_parts(merged)
    return [part for part in parts if isinstance(part, LineString) and not part.is_empty]


def _longest(geometry: BaseGeometry) -> LineString:
    return max(_lines(geometry), key=lambda line: line.length)


def _ends_text(line: LineString) -> str:
    """Write the ends of a line as "(x, y) to (x, y)", rounded to 0.1 mm."""
    return " to ".join(
        f"({_rounded(x)}, {_rounded(y)})" for x, y in (line.coords[0], line.coords[-1])
    )


def _first_point(line: LineString) -> tuple[float, float]:
    x, y = line.coords[0]
    return x, y


def _rounded(number: float) -> str:
    return f"{round(number, 4) + 0.0:g}"
