"""DXF entities -> chains of points in the plan view."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from math import ceil, cos, degrees, dist, floor, isfinite, radians
from typing import TYPE_CHECKING, Any

import shapely
from shapely.geometry import LinearRing, Polygon
from shapely.geometry.base import BaseGeometry

from floorplans.walls import Point

if TYPE_CHECKING:
    from ezdxf.entities.dxfgfx import DXFGraphic
    from ezdxf.math import Matrix44

CHORD_STEPS = (90.0, 45.0, 22.5, 11.25, 5.625, 2.8125)
"""Angles of chords [degrees]: concentric arcs are divided at the same angles."""

_MIN_SWEEP_DEG, _MAX_SWEEP_DEG = 30.0, 120.0
_MIN_RATIO = 0.7
"""Ellipses down to this ratio of axes can be the swing of a door in a scaled block."""
_SAME = 1e-6
"""A chain whose ends are nearer than this fraction of its length is closed."""
_EXTERNAL = 1
_NOT_CLOSED = 32
"""Flags of an outer boundary of a hatch, and of one that encloses nothing."""
_FAR = 1e12
"""Larger coordinates are invalid in any unit."""


@dataclass(frozen=True)
class Swing:
    """The circular arc of a door's leaf: hinge, and the two ends of the arc."""

    hinge: Point
    ends: tuple[Point, Point]

    @property
    def radius(self) -> float:
        """Length of the leaf, in the drawing's unit."""
        return dist(self.hinge, self.ends[0])


@dataclass(frozen=True)
class Curve:
    """A chain of points.

    Attributes
    ----------
    points : tuple of (float, float)
        The first is not repeated at the end of a closed chain.
    closed : bool
    filled : bool
        Whether it is filled, as by a hatch or a solid.
    swing : Swing or None
        For an arc that may be a door's.
    holes : tuple of tuple of (float, float)
        Rings in a filled chain that are not filled.
    width : float
        Of a polyline that is drawn wide, in the drawing's unit; otherwise 0.
    """

    points: tuple[Point, ...]
    closed: bool = False
    filled: bool = False
    swing: Swing | None = None
    holes: tuple[tuple[Point, ...], ...] = ()
    width: float = 0.0


def curves_of(entity: DXFGraphic, tolerance: float) -> list[Curve]:
    """Chains of points of an entity; none if it is no curve or not finite.

    Parameters
    ----------
    entity : DXFGraphic
    tolerance : float
        Largest deviation of chords from a curve, in the drawing's unit.
    """
    try:
        curves = list(_READERS[entity.dxftype()](entity, tolerance))
    except (ArithmeticError, AttributeError, IndexError, TypeError, ValueError):
        return []  # a damaged entity; it still counts as an object of its layer
    return [curve for curve in curves if len(curve.points) > 1 and is_finite(curve)]


def moved_curve(curve: Curve, matrix: Matrix44) -> Curve:
    """Move a curve by the transformation of an insert."""

    def moved(points: Iterable[Point]) -> tuple[Point, ...]:
        return tuple(map(_flat, matrix.transform_vertices([(x, y, 0.0) for x, y in points])))

    return _mapped(curve, moved)


def scaled_curve(curve: Curve, factor: float) -> Curve:
    """Scale a curve about (0, 0), also its width."""

    def scaled(points: Iterable[Point]) -> tuple[Point, ...]:
        return tuple((x * factor, y * factor) for x, y in points)

    return replace(_mapped(curve, scaled), width=curve.width * factor)


def _mapped(curve: Curve, mapping: Callable[[Iterable[Point]], tuple[Point, ...]]) -> Curve:
    """Map all points of a curve."""
    swing = curve.swing
    if swing is not None:
        hinge, start, end = mapping((swing.hinge, *swing.ends))
        swing = Swing(hinge, (start, end))
    holes = tuple(mapping(hole) for hole in curve.holes)
    return replace(curve, points=mapping(curve.points), swing=swing, holes=holes)


def chord_step_deg(radius: float, tolerance: float) -> float:
    """Largest angle of chords that stay within a tolerance of a circle."""
    for step in CHORD_STEPS:
        if radius * (1 - cos(radians(step / 2))) <= tolerance:
            return step
    return CHORD_STEPS[-1]


def is_finite(curve: Curve) -> bool:
    """Whether all points of a curve, also those of its swing, are where a drawing can be."""
    swing = curve.swing
    points = [*curve.points, *(point for hole in curve.holes for point in hole)]
    points += [] if swing is None else [swing.hinge, *swing.ends]
    return all(isfinite(x) and isfinite(y) and max(abs(x), abs(y)) < _FAR for x, y in points)


def _flat(point: Any) -> Point:
    return (float(point.x), float(point.y))


def _line(line: Any, _: float) -> Iterator[Curve]:
    yield Curve((_flat(line.dxf.start), _flat(line.dxf.end)))


def _arc(arc: Any, tolerance: float) -> Iterator[Curve]:
    start, end = float(arc.dxf.start_angle), float(arc.dxf.end_angle)
    sweep = (end - start) % 360 or 360.0
    step = chord_step_deg(float(arc.dxf.radius), tolerance)
    marks = range(floor(start / step) + 1, ceil((start + sweep) / step))
    angles = [start, *(step * mark for mark in marks), start + sweep]
    points = tuple(_flat(vertex) for vertex in arc.vertices(angles))
    yield Curve(points, swing=_swing(_centre(arc), points[0], points[-1], sweep))


def _centre(arc: Any) -> Point:
    return _flat(arc.ocs().to_wcs(arc.dxf.center))


def _swing(hinge: Point, start: Point, end: Point, sweep_deg: float) -> Swing | None:
    turns = _MIN_SWEEP_DEG <= sweep_deg <= _MAX_SWEEP_DEG
    return Swing(hinge, (start, end)) if turns else None


def _circle(circle: Any, tolerance: float) -> Iterator[Curve]:
    step = chord_step_deg(float(circle.dxf.radius), tolerance)
    angles = [step * mark for mark in range(round(360 / step))]
    yield Curve(tuple(_flat(vertex) for vertex in circle.vertices(angles)), closed=True)


def _ellipse(ellipse: Any, tolerance: float) -> Iterator[Curve]:
    points = tuple(_flat(vertex) for vertex in ellipse.flattening(tolerance))
    sweep_deg = degrees(ellipse.dxf.end_param - ellipse.dxf.start_param) % 360
    nearly_circle = float(ellipse.dxf.ratio) >= _MIN_RATIO
    hinge = _flat(ellipse.dxf.center)
    swing = _swing(hinge, points[0], points[-1], sweep_deg) if nearly_circle else None
    yield Curve(points, swing=swing)


def _spline(spline: Any, tolerance: float) -> Iterator[Curve]:
    yield Curve(tuple(_flat(vertex) for vertex in spline.flattening(tolerance)))


def _polyline(polyline: Any, tolerance: float) -> Iterator[Curve]:
    """Read a polyline as one chain, with bulges as chords and a swing for each bulge."""
    if polyline.dxftype() == "POLYLINE" and not (
        polyline.is_2d_polyline or polyline.is_3d_polyline
    ):
        return
    points: list[Point] = []
    for part in polyline.virtual_entities():
        for curve in curves_of(part, tolerance):
            chain = curve.points
            if points and dist(points[-1], chain[-1]) < dist(points[-1], chain[0]):
                chain = chain[::-1]
            points += chain[1:] if points else chain
            if curve.swing is not None:
                yield Curve(chain, swing=curve.swing)
    if len(points) > 1:
        length = sum(dist(a, b) for a, b in pairwise(points))
        closed = dist(points[0], points[-1]) <= _SAME * length
        yield Curve(tuple(points[:-1] if closed else points), closed=closed, width=_width(polyline))


def _width(polyline: Any) -> float:
    """Width of a polyline that has one all along, otherwise 0."""
    if polyline.dxftype() == "POLYLINE":
        widths = {float(polyline.dxf.get(f"default_{end}_width", 0.0)) for end in ("start", "end")}
    else:
        widths = {float(width) for ends in polyline.get_points("se") for width in ends}
        if polyline.dxf.get("const_width", 0.0):
            widths = {float(polyline.dxf.const_width)}
    return widths.pop() if len(widths) == 1 else 0.0


def _mline(mline: Any, tolerance: float) -> Iterator[Curve]:
    for part in mline.virtual_entities():
        yield from curves_of(part, tolerance)


def _hatch(hatch: Any, tolerance: float) -> Iterator[Curve]:
    """Read a hatch as what it fills: its boundaries, without the holes in them.

    A boundary within another is a hole, unless it is marked as an outer one beside marked holes.
    """
    rings = [
        ([_flat(v) for v in path.flattening(tolerance)], is_outer)
        for path, is_outer in _boundaries(hatch)
    ]
    rings = [(points, is_outer) for points, is_outer in rings if len(points) > 2]
    if all(is_outer for _, is_outer in rings):
        rings = [(points, False) for points, _ in rings]
    for part in _filled(rings):
        if isinstance(part, Polygon):
            ring, *holes = (_ring(ring) for ring in (part.exterior, *part.interiors))
            yield Curve(ring, closed=True, filled=True, holes=tuple(holes))


def _boundaries(hatch: Any) -> Iterator[tuple[Any, bool]]:
    """Yield the closed boundaries of a hatch as paths, and whether each is marked as outer."""
    from ezdxf.path import from_hatch_boundary_path

    for boundary in hatch.paths:
        if not _is_open(boundary):
            path = from_hatch_boundary_path(boundary, hatch.ocs(), hatch.dxf.elevation.z)
            for part in path.sub_paths() if path.has_sub_paths else (path,):
                yield part, bool(boundary.path_type_flags & _EXTERNAL)


def _is_open(boundary: Any) -> bool:
    """Whether a boundary encloses nothing: it is marked so, or its edges mostly do not meet."""
    if boundary.path_type_flags & _NOT_CLOSED:
        return True
    ends = [(edge.start_point, edge.end_point) for edge in getattr(boundary, "edges", ())]
    jumps = sum(
        min(a.distance(b) for a in one for b in other)
        for one, other in zip(ends, [*ends[1:], *ends[:1]], strict=True)
    )
    return jumps > sum(start.distance(end) for start, end in ends)


def _filled(rings: Sequence[tuple[list[Point], bool]]) -> Iterator[BaseGeometry]:
    """Yield the area in each ring that is no hole of another, without its holes.

    Rings that are marked as outer ones are no holes.
    """
    found: list[BaseGeometry] = []
    depths: list[int] = []
    areas = [(_area(ring), is_outer) for ring, is_outer in rings]
    for area, is_outer in sorted(areas, key=lambda item: -item[0].area):
        around = [depth for other, depth in zip(found, depths, strict=True) if other.covers(area)]
        found.append(area)
        depths.append(0 if is_outer or not around else max(around) + 1)
    for area, depth in zip(found, depths, strict=True):
        if depth % 2 == 0:
            below = [
                other for other, k in zip(found, depths, strict=True)
                if k == depth + 1 and area.covers(other)
            ]  # fmt: skip
            yield from shapely.get_parts(area.difference(shapely.union_all(below)))


def _area(ring: list[Point]) -> BaseGeometry:
    return shapely.make_valid(Polygon(ring))


def _ring(ring: LinearRing) -> tuple[Point, ...]:
    return tuple((float(x), float(y)) for x, y in ring.coords[:-1])


def _solid(solid: Any, _: float) -> Iterator[Curve]:
    yield Curve(tuple(_flat(vertex) for vertex in solid.wcs_vertices()), closed=True, filled=True)


_READERS: dict[str, Callable[[Any, float], Iterator[Curve]]] = {
    "LINE": _line,
    "ARC": _arc,
    "CIRCLE": _circle,
    "ELLIPSE": _ellipse,
    "SPLINE": _spline,
    "LWPOLYLINE": _polyline,
    "POLYLINE": _polyline,
    "MLINE": _mline,
    "HATCH": _hatch,
    "SOLID": _solid,
    "TRACE": _solid,
}
CURVE_TYPES = tuple(_READERS)
"""Entity types that are read."""
