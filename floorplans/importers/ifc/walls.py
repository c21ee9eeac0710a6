"""Walls, openings and slabs of an IFC storey -> raw walls and openings."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import dist, hypot

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import LineString
from shapely.geometry.base import BaseGeometry

from floorplans.importers.centrelines.areas import walls_of_area
from floorplans.importers.defaults import WINDOW_MATERIAL, WINDOW_THICKNESS_M
from floorplans.importers.draft import RawOpening, RawWall
from floorplans.importers.ifc.curves import Entity
from floorplans.importers.ifc.materials import Materials
from floorplans.importers.ifc.parts import parts_of
from floorplans.importers.ifc.shapes import Body, Scale, axis_points, bodies, placement_of
from floorplans.walls import OpeningKind

Floats = NDArray[np.float64]

MIN_TOP_M = 0.3
"""Least height of a wall's top above the floor [m]."""

MAX_FOOT_M = 1.0
"""Largest height of a wall's foot above the floor; higher ones stand on something else [m]."""

_RISES_M = 1.8
"""Least height over the floor of a wall of a lower storey that is a wall of this one too [m]."""
_MULLION_M = 0.3
"""Shorter pieces of a curtain wall are the depth of its mullions [m]."""
_CURTAIN_M = 0.5
"""Largest depth of the mullions of a straight curtain wall [m]."""
_STRAIGHT_FRACTION = 0.85
_PASSAGE_FOOT_M = 0.1
_BENT_M = 0.01


@dataclass(frozen=True)
class ReadWall:
    """A wall as read: pieces of one thickness and material, and the openings."""

    pieces: tuple[RawWall, ...]
    openings: tuple[RawOpening, ...]
    top_m: float


def read_wall(wall: Entity, floor_m: float, scale: Scale, materials: Materials) -> ReadWall | None:
    """Read a wall; None if it has neither body nor axis, or does not stand on this floor.

    Parameters
    ----------
    wall : entity
    floor_m : float
        Elevation of the storey [m].
    scale : Scale
    materials : Materials
        Those of the model.
    """
    parts = bodies_of_parts(wall, scale)
    top_m = top_on_floor(parts, floor_m) if parts else np.inf
    if top_m is None:
        return None
    axis = axis_points(wall, scale)
    footprint = shapely.union_all([body.footprint for body in parts])
    material, layers_m = materials.of_wall(wall)
    if wall.is_a("IfcCurtainWall"):
        material, layers_m = material or WINDOW_MATERIAL, layers_m or WINDOW_THICKNESS_M
        lines = list(_curtain_lines(axis, footprint, layers_m, scale.chord_m))
    else:
        lines = list(_centre_lines(axis, footprint, layers_m, scale.chord_m))
    if not lines or not np.isfinite([ends for *ends, _ in lines]).all():
        return None
    pieces = [
        RawWall(start, end, layers_m or thickness_m, material) for start, end, thickness_m in lines
    ]
    return ReadWall(tuple(pieces), tuple(_openings(wall, pieces, floor_m, scale)), float(top_m))


def read_filling(filling: Entity, floor_m: float, scale: Scale) -> RawOpening | None:
    """Read a door or window that fills no opening, from its placement and overall size."""
    width_m, height_m = (
        scale.metre * float(size or 0.0) for size in (filling.OverallWidth, filling.OverallHeight)
    )
    if not (width_m > 0 and height_m > 0):
        return None
    matrix = placement_of(filling)
    along = matrix[:2, 0] / max(np.hypot(*matrix[:2, 0]), 1e-12)
    x, y = scale.metre * matrix[:2, 3] + along * width_m / 2
    sill_m = max(scale.metre * float(matrix[2, 3]) - floor_m, 0.0)
    return RawOpening(
        (float(x), float(y)), width_m, _kind(filling), (float(along[0]), float(along[1])),
        sill_m, sill_m + height_m,
    )  # fmt: skip


def top_on_floor(parts: Sequence[Body], floor_m: float) -> float | None:
    """Height of the top of bodies, at least one, over a floor [m]; None if they do not stand on it.

    Parameters
    ----------
    parts : sequence of Body
    floor_m : float
        Elevation of the floor [m].
    """
    top_m = max(body.z_max for body in parts) - floor_m
    foot_m = min(body.z_min for body in parts) - floor_m
    return None if top_m < MIN_TOP_M or foot_m > MAX_FOOT_M else top_m


def rises_through(element: Entity, floor_m: float, scale: Scale) -> bool:
    """Whether an element of a lower storey goes on through the floor to more than a door's height.

    Parameters
    ----------
    element : entity
    floor_m : float
        Elevation of the floor [m].
    scale : Scale
    """
    parts = bodies_of_parts(element, scale)
    top_m = top_on_floor(parts, floor_m) if parts else None
    return top_m is not None and top_m > _RISES_M


def bodies_of_parts(element: Entity, scale: Scale) -> list[Body]:
    """Bodies of an element, or of its parts."""
    found = bodies(element, scale)
    if found or not element.IsDecomposedBy:
        return found
    return [body for part in parts_of(element) for body in bodies(part, scale)]


Line = tuple[tuple[float, float], tuple[float, float], float | None]


def _centre_lines(
    axis: Floats, footprint: BaseGeometry, layers_m: float | None, chord_m: float
) -> Iterator[Line]:
    """Straight centre lines (start, end, thickness) of a wall.

    A straight wall lies in the middle of its footprint. A curved wall becomes chords of its axis,
    moved to the middle. A footprint that is no strip is decomposed.
    """
    if len(axis) > 2 and _bend(axis) > _BENT_M:
        yield from _curved(axis, footprint, layers_m)
    elif footprint.is_empty or not footprint.area > 0:
        if len(axis) >= 2:
            yield _point(axis[0]), _point(axis[-1]), layers_m
    else:
        along = axis[-1] - axis[0] if len(axis) >= 2 else _long_side(footprint)
        line, filled = _middle_of(footprint, along)
        if filled >= _STRAIGHT_FRACTION:
            yield line
            return
        for raw in walls_of_area(footprint, chord_m):
            yield raw.start, raw.end, raw.thickness_m


def _curtain_lines(
    axis: Floats, footprint: BaseGeometry, layers_m: float, chord_m: float
) -> Iterator[Line]:
    """Centre lines of a curtain wall: panes are thinner than arcs are exact, and mullions deeper.

    A straight one lies in the middle of its mullions.
    """
    is_bent = len(axis) > 2 and _bend(axis) > _BENT_M
    if footprint.area > 0 and not is_bent:
        line, _ = _middle_of(footprint, _long_side(footprint))
        if (line[2] or 0.0) <= _CURTAIN_M:
            yield line
            return
        footprint = footprint.buffer(chord_m, join_style="mitre")
    lines = list(_centre_lines(axis, footprint, layers_m, chord_m))
    yield from [line for line in lines if dist(line[0], line[1]) > _MULLION_M] or lines


def _middle_of(footprint: BaseGeometry, along: Floats) -> tuple[Line, float]:
    """Centre line of the box around a footprint, and the fraction of the box that it fills."""
    u = along / np.hypot(*along)
    across = np.array([-u[1], u[0]])
    corners = shapely.get_coordinates(footprint)
    s, t = corners @ u, corners @ across
    middle = across * (t.min() + t.max()) / 2
    thickness_m = float(np.ptp(t))
    filled = float(footprint.area / max(np.ptp(s) * thickness_m, 1e-12))
    return (_point(u * s.min() + middle), _point(u * s.max() + middle), thickness_m), filled


def _curved(axis: Floats, footprint: BaseGeometry, layers_m: float | None) -> Iterator[Line]:
    """Chords of a curved wall, moved from its axis to the middle of its footprint."""
    line: BaseGeometry = LineString(axis)
    thickness_m = layers_m or (footprint.area / line.length if footprint.area > 0 else None)
    if thickness_m is not None and not footprint.is_empty:
        offsets = (0.0, thickness_m / 2, -thickness_m / 2)
        moved = [LineString(axis).offset_curve(offset) for offset in offsets]
        line = max(moved, key=lambda curve: _area_within(curve, footprint, thickness_m))
    for start, end in pairwise(shapely.get_coordinates(line)):
        yield _point(start), _point(end), thickness_m


def _area_within(curve: BaseGeometry, footprint: BaseGeometry, width_m: float) -> float:
    band = curve.buffer(width_m / 2, cap_style="flat")
    return band.intersection(footprint).area


def _openings(
    wall: Entity, pieces: Sequence[RawWall], floor_m: float, scale: Scale
) -> Iterator[RawOpening]:
    for rel in wall.HasOpenings:
        hole = rel.RelatedOpeningElement
        if getattr(hole, "PredefinedType", None) == "RECESS":
            continue
        fillings = [filled.RelatedBuildingElement for filled in hole.HasFillings]
        shapes = bodies(hole, scale)
        if shapes:
            yield _opening_of(shapes, pieces, fillings, floor_m)
        elif fillings and (opening := read_filling(fillings[0], floor_m, scale)) is not None:
            yield opening


def _opening_of(
    shapes: Sequence[Body], pieces: Sequence[RawWall], fillings: Sequence[Entity], floor_m: float
) -> RawOpening:
    """Measure an opening along the nearest piece of its wall, or from end to end of its chords."""
    footprint = shapely.union_all([shape.footprint for shape in shapes])
    middle = footprint.centroid
    piece = min(pieces, key=lambda p: shapely.linestrings([p.start, p.end]).distance(middle))
    (x0, y0), (x1, y1) = piece.start, piece.end
    u = np.array([x1 - x0, y1 - y0]) / max(hypot(x1 - x0, y1 - y0), 1e-12)
    s = shapely.get_coordinates(footprint) @ u
    across = np.array([-u[1], u[0]])
    centre = u * (s.min() + s.max()) / 2 + across * (np.array(piece.start) @ across)
    width_m = float(np.ptp(s))
    if (bent := _bent_section(footprint, pieces)) is not None:
        centre, u, width_m = bent
    sill_m = max(min(shape.z_min for shape in shapes) - floor_m, 0.0)
    head_m = max(shape.z_max for shape in shapes) - floor_m
    kind: OpeningKind = "passage" if sill_m < _PASSAGE_FOOT_M else "window"
    if fillings:
        kind = _kind(fillings[0])
    return RawOpening(
        _point(centre), width_m, kind, (float(u[0]), float(u[1])), float(sill_m),
        float(head_m),
    )  # fmt: skip


def _bent_section(
    footprint: BaseGeometry, pieces: Sequence[RawWall]
) -> tuple[Floats, Floats, float] | None:
    """Centre, direction and width of the section of a curved wall in a footprint.

    None if it lies on one straight piece.
    """
    if len(pieces) < 2 or any(a.end != b.start for a, b in pairwise(pieces)):
        return None
    curve = LineString([piece.start for piece in pieces] + [pieces[-1].end])
    section = shapely.get_coordinates(shapely.line_merge(curve.intersection(footprint)))
    if len(section) < 3:
        return None
    along = section[-1] - section[0]
    width_m = float(np.hypot(*along))
    u = along / max(width_m, 1e-12)
    s = section @ u
    if not (np.diff(s) > 0).all():
        return None
    middle = (s[0] + s[-1]) / 2
    return np.array([np.interp(middle, s, xy) for xy in section.T]), u, width_m


def _kind(filling: Entity) -> OpeningKind:
    return "door" if filling.is_a("IfcDoor") else "window"


def _bend(axis: Floats) -> float:
    """Largest distance of an axis from the straight line between its ends [m]."""
    chord = shapely.linestrings(axis[[0, -1]])
    return float(shapely.distance(chord, shapely.points(axis)).max())


def _long_side(footprint: BaseGeometry) -> Floats:
    corners = shapely.get_coordinates(shapely.oriented_envelope(footprint))
    sides = np.diff(corners[:3], axis=0)
    return sides[np.argmax(np.hypot(*sides.T))]


def _point(xy: Floats) -> tuple[float, float]:
    return float(xy[0]), float(xy[1])
