"""Walls and openings of classified features in metres."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import shapely
from shapely.geometry import GeometryCollection, LineString, Point, Polygon
from shapely.geometry.base import BaseGeometry

from floorplans.importers.centrelines.areas import box_sides, walls_of_area
from floorplans.importers.centrelines.rooms import walls_of_rooms
from floorplans.importers.draft import RawOpening, RawWall, walls_along
from floorplans.importers.geojson.features import FeatureClass, Kind, number_of
from floorplans.walls import OpeningKind

OPENING_WIDTH_M: Mapping[OpeningKind, float] = {"door": 0.9, "window": 1.2, "passage": 1.2}
"""Width of openings drawn as points [m]."""

_OPENING_KINDS: tuple[OpeningKind, ...] = ("door", "passage", "window")
_MAX_FILL_M = 0.7
"""A door or window drawn as an area up to this thick fills its gap in the wall [m]."""
_AT_WALL_M = 0.3
"""The border of a room lies at a wall that is no farther away [m]."""
_MOSTLY = 0.4
_BENT = 0.7
"""An area that fills less than this fraction of the box around it is bent."""


@dataclass(frozen=True)
class Placed:
    """A feature of the chosen level.

    Attributes
    ----------
    feature : mapping
        As in the file.
    what : FeatureClass
    geometry : shapely geometry
        In the plan's frame [m].
    """

    feature: Mapping[str, Any]
    what: FeatureClass
    geometry: BaseGeometry


def walls_of(placed: Sequence[Placed], tolerance_m: float) -> list[RawWall]:
    """Return the walls of all features: areas, lines, and those between rooms that have none."""
    areas = list(_areas(placed, "wall"))
    lines = [wall for p in _of_kind(placed, "wall") for wall in _line_walls(p)]
    rooms = list(_areas(placed, "room"))
    if rooms and _have_walls([polygon for _, polygon in rooms], [polygon for _, polygon in areas]):
        rooms = []
    walls = _area_walls(placed, areas, tolerance_m) + lines
    if rooms:
        open_ = [p.what.is_open for p, _ in rooms]
        walls += walls_of_rooms([polygon for _, polygon in rooms], open_, tolerance_m)
    elif not areas:
        walls += [w for p, outline in _areas(placed, "outline") for w in _ring(p, outline)]
    return walls


def _have_walls(rooms: Sequence[Polygon], areas: Sequence[Polygon]) -> bool:
    """Whether walls are drawn along most of the borders of rooms, and not only a pillar in them."""
    if not areas:
        return False
    borders = shapely.union_all([room.boundary for room in rooms])
    beside = borders.intersection(shapely.union_all(areas).buffer(_AT_WALL_M))
    return beside.length > _MOSTLY * borders.length


def openings_of(placed: Sequence[Placed], tolerance_m: float) -> list[RawOpening]:
    """Return all openings, doors first."""
    return [
        _with_heights(opening, p)
        for kind in _OPENING_KINDS
        for p in _of_kind(placed, kind)
        for part in _parts(p.geometry)
        for opening in _part_openings(part, kind, p, tolerance_m)
    ]


def _of_kind(placed: Sequence[Placed], kind: Kind) -> Iterator[Placed]:
    return (p for p in placed if p.what.kind == kind)


def _areas(placed: Sequence[Placed], kind: Kind) -> Iterator[tuple[Placed, Polygon]]:
    for p in _of_kind(placed, kind):
        for part in _parts(p.geometry):
            if isinstance(part, Polygon) and part.area > 0:
                yield p, part


def _parts(geometry: BaseGeometry) -> list[BaseGeometry]:
    """Points, lines and polygons of a geometry, collections flattened."""
    parts = list(shapely.get_parts(geometry))
    if isinstance(geometry, GeometryCollection):
        return [inner for part in parts for inner in _parts(part)]
    return parts


def _area_walls(
    placed: Sequence[Placed], areas: Sequence[tuple[Placed, Polygon]], tolerance_m: float
) -> list[RawWall]:
    if not areas:
        return []
    fillings = [
        polygon
        for kind in _OPENING_KINDS
        for _, polygon in _areas(placed, kind)
        if _fills_a_gap(polygon)
    ]
    polygons = [polygon for _, polygon in areas]
    walls = walls_of_area(shapely.union_all(polygons), tolerance_m, shapely.union_all(fillings))
    tree = shapely.STRtree(polygons)
    return [_like(wall, areas[int(tree.nearest(_middle(wall)))][0]) for wall in walls]


def _fills_a_gap(polygon: Polygon) -> bool:
    width_m, length_m = box_sides(polygon)
    return width_m <= min(_MAX_FILL_M, 0.7 * length_m) or polygon.area < _BENT * width_m * length_m


def _middle(wall: RawWall) -> Point:
    (x0, y0), (x1, y1) = wall.start, wall.end
    return Point((x0 + x1) / 2, (y0 + y1) / 2)


def _like(wall: RawWall, p: Placed) -> RawWall:
    """Give a wall the properties of its feature."""
    thickness_m = number_of(p.feature, "thickness_m", "thickness", "width")
    return replace(
        wall,
        thickness_m=wall.thickness_m or thickness_m,
        material=p.what.material,
        height_m=number_of(p.feature, "height_m", "height"),
    )


def _line_walls(p: Placed) -> list[RawWall]:
    lines = [part for part in _parts(p.geometry) if isinstance(part, LineString)]
    return [_like(wall, p) for line in lines for wall in walls_along(line)]


def _ring(p: Placed, outline: Polygon) -> list[RawWall]:
    rings = [LineString(ring) for ring in (outline.exterior, *outline.interiors)]
    return [replace(wall, material=p.what.material) for ring in rings for wall in walls_along(ring)]


def _part_openings(
    part: BaseGeometry, kind: OpeningKind, p: Placed, tolerance_m: float
) -> list[RawOpening]:
    if isinstance(part, Point):
        width_m = number_of(p.feature, "width_m", "width", "door:width") or OPENING_WIDTH_M[kind]
        return [RawOpening((part.x, part.y), width_m, kind)]
    if isinstance(part, LineString):
        return [RawOpening.between(wall.start, wall.end, kind) for wall in walls_along(part)]
    if not isinstance(part, Polygon) or part.area == 0:
        return []
    width_m, length_m = box_sides(part)
    if part.area < _BENT * width_m * length_m:
        walls = walls_of_area(part, tolerance_m)
        return [RawOpening.between(wall.start, wall.end, kind) for wall in walls]
    return [_boxed(part, kind, length_m, is_long=width_m < 0.7 * length_m)]


def _boxed(part: Polygon, kind: OpeningKind, length_m: float, *, is_long: bool) -> RawOpening:
    """Opening as long as the box around an area, along its long side if it has one."""
    corners = shapely.get_coordinates(shapely.oriented_envelope(part))
    first, second = corners[1] - corners[0], corners[2] - corners[1]
    x, y = max((first, second), key=lambda side: float(side @ side))
    middle = part.centroid
    direction = (float(x), float(y)) if is_long else None
    return RawOpening((middle.x, middle.y), length_m, kind, direction)


def _with_heights(opening: RawOpening, p: Placed) -> RawOpening:
    return replace(
        opening,
        sill_m=number_of(p.feature, "sill_m", "sill", "sill_height"),
        head_m=number_of(p.feature, "head_m", "head", "head_height"),
        material=p.what.material,
    )
