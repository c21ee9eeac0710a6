"""IFC curves and profiles -> points, arcs as chords of bounded error."""

from __future__ import annotations

from collections.abc import Iterator
from math import acos, atan2, ceil, cos, hypot, pi, sin
from typing import Any

import numpy as np
from numpy.typing import NDArray
from shapely.geometry import Polygon

Entity = Any
"""An instance of IFC; ifcopenshell gives no types."""

Points = list[tuple[float, float]]

MAX_DEPTH = 16
"""Deepest nesting of curves, solids and mapped items that is followed."""


class UnreadableError(ValueError):
    """A shape that is not supported; the message names its class."""


def curve_points(curve: Entity, chord: float, angle_unit: float, depth: int = 0) -> Points:
    """Points of a plane curve.

    Parameters
    ----------
    curve : entity
    chord : float
        Largest deviation of chords from an arc, in the file's unit.
    angle_unit : float
        The file's unit of angles [rad].
    depth : int
        Of the nesting so far.

    Raises
    ------
    UnreadableError
    """
    if depth > MAX_DEPTH:
        raise UnreadableError(f"{curve.is_a()} nested too deep")
    if curve.is_a("IfcPolyline"):
        return [_xy(point.Coordinates) for point in curve.Points]
    if curve.is_a("IfcIndexedPolyCurve"):
        return _indexed(curve, chord)
    if curve.is_a("IfcTrimmedCurve"):
        return _trimmed(curve, chord, angle_unit)
    if curve.is_a("IfcCompositeCurve"):
        return _composite(curve, chord, angle_unit, depth)
    if curve.is_a("IfcCircle"):
        centre, turn = _axes_2d(curve.Position)
        return _arc(centre, curve.Radius, turn, turn + 2 * pi, chord)
    raise UnreadableError(curve.is_a())


def profile_polygon(profile: Entity, chord: float, angle_unit: float) -> Polygon:
    """Area of a profile in the file's unit; raise `UnreadableError` if not supported."""
    if profile.is_a("IfcRectangleProfileDef"):
        x, y = profile.XDim / 2, profile.YDim / 2
        return _placed(Polygon([(-x, -y), (x, -y), (x, y), (-x, y)]), profile.Position)
    if profile.is_a("IfcCircleProfileDef"):
        ring = _arc((0.0, 0.0), profile.Radius, 0.0, 2 * pi, chord)
        return _placed(Polygon(ring), profile.Position)
    if profile.is_a("IfcArbitraryClosedProfileDef"):
        ring = curve_points(profile.OuterCurve, chord, angle_unit)
        if len(ring) >= 3:
            return Polygon(ring).buffer(0)
    raise UnreadableError(profile.is_a())


def _xy(coordinates: tuple[float, ...]) -> tuple[float, float]:
    return float(coordinates[0]), float(coordinates[1])


def _indexed(curve: Entity, chord: float) -> Points:
    points = [_xy(point) for point in curve.Points.CoordList]
    if not curve.Segments:
        return points
    found: Points = []
    for segment in curve.Segments:
        corners = [points[index - 1] for index in segment[0]]
        if segment.is_a("IfcArcIndex"):
            first, middle, last = corners
            corners = _arc_through(first, middle, last, chord)
        found += corners if not found else corners[1:]
    return found


def _composite(curve: Entity, chord: float, angle_unit: float, depth: int) -> Points:
    found: Points = []
    for segment in curve.Segments:
        points = curve_points(segment.ParentCurve, chord, angle_unit, depth + 1)
        if not segment.SameSense:
            points = points[::-1]
        found += points if not found else points[1:]
    return found


def _trimmed(curve: Entity, chord: float, angle_unit: float) -> Points:
    basis = curve.BasisCurve
    if basis.is_a("IfcLine"):
        ends = [_on_line(basis, trim) for trim in (curve.Trim1, curve.Trim2)]
        return ends if curve.SenseAgreement else ends[::-1]
    if not basis.is_a("IfcCircle"):
        raise UnreadableError(f"IfcTrimmedCurve of {basis.is_a()}")
    centre, turn = _axes_2d(basis.Position)
    first, last = (
        _angle_on_circle(trim, centre, turn, angle_unit) for trim in (curve.Trim1, curve.Trim2)
    )
    if curve.SenseAgreement:
        last += 2 * pi * ceil((first - last) / (2 * pi) + 1e-12)
    else:
        last -= 2 * pi * ceil((last - first) / (2 * pi) + 1e-12)
    return _arc(centre, basis.Radius, first, last, chord)


def _on_line(line: Entity, trim: tuple[Entity, ...]) -> tuple[float, float]:
    for value in trim:
        if value.is_a("IfcCartesianPoint"):
            return _xy(value.Coordinates)
    x, y = _xy(line.Pnt.Coordinates)
    u, v = _xy(line.Dir.Orientation.DirectionRatios)
    s = trim[0].wrappedValue * line.Dir.Magnitude / hypot(u, v)
    return x + s * u, y + s * v


def _angle_on_circle(
    trim: tuple[Entity, ...], centre: tuple[float, float], turn: float, angle_unit: float
) -> float:
    for value in trim:
        if value.is_a("IfcCartesianPoint"):
            x, y = _xy(value.Coordinates)
            return atan2(y - centre[1], x - centre[0])
    return turn + float(trim[0].wrappedValue) * angle_unit


def _arc(
    centre: tuple[float, float], radius: float, first: float, last: float, chord: float
) -> Points:
    """Points of an arc from one angle to another [rad]."""
    if not radius > 0:
        raise UnreadableError(f"circle of radius {radius:g}")
    step = 2 * acos(1 - min(chord / radius, 0.5))
    angles = np.linspace(first, last, max(2, ceil(abs(last - first) / step) + 1))
    return [(centre[0] + radius * cos(a), centre[1] + radius * sin(a)) for a in angles]


def _arc_through(
    a: tuple[float, float], b: tuple[float, float], c: tuple[float, float], chord: float
) -> Points:
    """Points of the arc from a via b to c; a straight line if they are collinear."""
    (ax, ay), (bx, by), (cx, cy) = a, b, c
    d = 2 * (ax * (by - cy) + bx * (cy - ay) + cx * (ay - by))
    if abs(d) < 1e-12:
        return [a, b, c]
    aa, bb, cc = ax * ax + ay * ay, bx * bx + by * by, cx * cx + cy * cy
    x = (aa * (by - cy) + bb * (cy - ay) + cc * (ay - by)) / d
    y = (aa * (cx - bx) + bb * (ax - cx) + cc * (bx - ax)) / d
    first, last = atan2(ay - y, ax - x), atan2(cy - y, cx - x)
    if d > 0:  # counter-clockwise
        last += 2 * pi if last < first else 0.0
    else:
        last -= 2 * pi if last > first else 0.0
    return [a, *_arc((x, y), hypot(ax - x, ay - y), first, last, chord)[1:-1], c]


def _axes_2d(position: Entity) -> tuple[tuple[float, float], float]:
    """Origin of a placement, and the angle of its x axis [rad]."""
    if position is None:
        return (0.0, 0.0), 0.0
    x, y = _xy(position.Location.Coordinates)
    if not position.RefDirection:
        return (x, y), 0.0
    u, v = _xy(position.RefDirection.DirectionRatios)
    return (x, y), atan2(v, u)


def _placed(polygon: Polygon, position: Entity) -> Polygon:
    (x, y), turn = _axes_2d(position)
    matrix = np.array([[cos(turn), -sin(turn)], [sin(turn), cos(turn)]])
    return Polygon(_corners(polygon) @ matrix.T + [x, y])


def _corners(polygon: Polygon) -> NDArray[np.float64]:
    return np.array(polygon.exterior.coords, dtype=np.float64)


def rings(polygon: Polygon) -> Iterator[NDArray[np.float64]]:
    """Yield the exterior ring and the holes, each (n, 2)."""
    for ring in (polygon.exterior, *polygon.interiors):
        yield np.array(ring.coords, dtype=np.float64)
