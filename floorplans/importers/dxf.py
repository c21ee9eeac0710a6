"""DXF drawings -> drafts of plans.

Layers tell what lines are, by their names or by the user's word. Closed outlines of wall bodies,
fills, and the strips between two parallel lines make up the area of wall; gaps in it at doors and
windows are filled; its centre lines, with the measured thickness, are the walls. A line without a
partner is a wall of unknown thickness. Doors and windows come from blocks, from the swings of door
leaves, and from lines that lie in a gap; other lines of windows are walls of glass.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import LineString, Point, Polygon
from shapely.geometry.base import BaseGeometry

from floorplans.importers.draft import Draft, ImportOptions, RawOpening, RawWall
from floorplans.importers.dxf_curves import Curve, Swing
from floorplans.importers.dxf_drawing import Content, load_document, read_content
from floorplans.importers.dxf_layers import Layers, layers_of
from floorplans.importers.dxf_openings import (
    loose_lines,
    opening_of_swing,
    openings_of_symbol,
)
from floorplans.importers.gap_filling import fill_gaps
from floorplans.importers.hanging import WINDOW_MATERIAL, WINDOW_THICKNESS_M
from floorplans.importers.units import UNITS, check_size, guess_unit, unit_length
from floorplans.importers.wall_areas import MAX_THICKNESS_M, walls_of_area
from floorplans.importers.wall_strips import strips_of_lines

if TYPE_CHECKING:
    from ezdxf.document import Drawing as Document

CHORD_M = 0.02
"""Chords leave an arc by at most this [m]."""
_PAIR_M = 0.6
"""Two lines farther apart than this are not the sides of one wall [m]."""
_CLOSE_M = 0.02
_IN_WALL_M = 0.05

_INSUNITS = {1: "in", 2: "ft", 4: "mm", 5: "cm", 6: "m", 7: "km", 10: "yd", 14: "dm"}

Material = str | None


@dataclass
class _Bodies:
    """Walls of one material: their area, and single lines (n, 2, 2) [m]."""

    area: list[Polygon] = field(default_factory=list[Polygon])
    singles: list[NDArray[np.float64]] = field(default_factory=list[NDArray[np.float64]])


def read_dxf(path: Path, options: ImportOptions) -> Draft:
    """Read a DXF drawing of one storey.

    Parameters
    ----------
    path : Path
    options : ImportOptions
        `unit`, `layers` and `tolerance_m` (of chords) are used here.

    Returns
    -------
    Draft

    Raises
    ------
    PlanError
        When the file is damaged or too large, holds no walls, or its unit cannot be told.
    """
    document = load_document(path)
    unit, told = _unit(document, options)
    tolerance = (options.tolerance_m or CHORD_M) / UNITS[unit]
    content = read_content(document, options.layers, tolerance)
    layers = layers_of(content, options.layers)
    check_size(_size(content, layers), unit, told)
    metric = _in_metres(content, UNITS[unit])
    walls, openings = _building(metric, layers)
    return Draft(
        name=path.stem,
        walls=tuple(walls),
        openings=tuple(openings),
        layers=layers.uses(),
        notes=(f"unit {unit}, as {told}",),
    )


def _unit(document: Document, options: ImportOptions) -> tuple[str, str]:
    """Unit of the drawing, and who says so."""
    if options.unit is not None:
        unit_length(options.unit)
        return options.unit, "you say"
    code = document.header.get("$INSUNITS", 0)
    if code in _INSUNITS:
        return _INSUNITS[code], "the file says"
    content = read_content(document, options.layers, tolerance=np.inf)
    layers = layers_of(content, options.layers)
    curves = [c for layer in layers.of("door") for c in content.curves[layer]]
    curves += [c for symbol in content.symbols if symbol.kind == "door" for c in symbol.curves]
    radii = [curve.swing.radius for curve in curves if curve.swing is not None]
    unit = guess_unit(_size(content, layers), radii)
    return unit, "the sizes of building and doors say (the file does not)"


def _size(content: Content, layers: Layers) -> tuple[float, float]:
    """Width and depth of all walls, in the drawing's unit."""
    curves = [curve for layer in layers.of("wall") for curve in content.curves[layer]]
    points = np.array([point for curve in curves for point in curve.points])
    width, depth = np.ptp(points, axis=0)
    return float(width), float(depth)


def _in_metres(content: Content, unit_m: float) -> Content:
    def scaled(curve: Curve) -> Curve:
        points = tuple((x * unit_m, y * unit_m) for x, y in curve.points)
        swing = curve.swing
        if swing is not None:
            hinge, *ends = ((x * unit_m, y * unit_m) for x, y in (swing.hinge, *swing.ends))
            swing = Swing(hinge, (ends[0], ends[1]))
        return replace(curve, points=points, swing=swing)

    metric = Content(n_objects=content.n_objects, hidden=content.hidden)
    for layer, curves in content.curves.items():
        metric.curves[layer] = [scaled(curve) for curve in curves]
    metric.symbols = [
        replace(symbol, curves=tuple(scaled(curve) for curve in symbol.curves))
        for symbol in content.symbols
    ]
    return metric


def _building(content: Content, layers: Layers) -> tuple[list[RawWall], list[RawOpening]]:
    """Walls and openings of a drawing in metres."""
    bodies = _bodies(content, layers)
    area, singles = _area(bodies), _singles(bodies)
    ground = shapely.union_all([area, singles])
    openings = [o for symbol in content.symbols for o in openings_of_symbol(symbol, ground)]
    openings += _swing_openings(content, layers, ground)
    fillings = list(fill_gaps(area, openings))
    loose, glass = _loose_openings(content, layers, shapely.union_all([area, *fillings]))
    fillings += fill_gaps(area, loose)
    for filling in fillings:
        _share_of(bodies, filling).area.append(filling)
    walls = [wall for material, body in bodies.items() for wall in _walls(body, material)]
    return walls + _glass_walls(glass), openings + loose


def _bodies(content: Content, layers: Layers) -> dict[Material, _Bodies]:
    """Area of wall and single lines of each material."""
    curves: dict[Material, list[Curve]] = {}
    for layer in layers.of("wall"):
        curves.setdefault(layers.material(layer), []).extend(content.curves[layer])
    bodies: dict[Material, _Bodies] = {}
    for material, chains in curves.items():
        area, segments = _thin_bodies(chains)
        walls = strips_of_lines(segments, _PAIR_M)
        bodies[material] = _Bodies([*area, *walls.area], [walls.singles])
    return bodies


def _thin_bodies(chains: Sequence[Curve]) -> tuple[list[Polygon], NDArray[np.float64]]:
    """Closed chains around what is thin enough to be a wall, and the segments of the others."""
    area: list[Polygon] = []
    segments: list[NDArray[np.float64]] = []
    for chain in chains:
        points = np.array([*chain.points, *chain.points[: chain.closed]])
        body = shapely.make_valid(Polygon(points)) if chain.closed and len(points) > 3 else None
        if body is not None and body.area > 0 and body.buffer(-MAX_THICKNESS_M / 2).is_empty:
            area += [part for part in shapely.get_parts(body) if isinstance(part, Polygon)]
        elif not chain.filled:
            segments.append(np.stack([points[:-1], points[1:]], axis=1))
    return area, np.concatenate(segments) if segments else np.empty((0, 2, 2))


def _area(bodies: Mapping[Material, _Bodies]) -> BaseGeometry:
    return shapely.union_all([polygon for body in bodies.values() for polygon in body.area])


def _singles(bodies: Mapping[Material, _Bodies]) -> BaseGeometry:
    lines = [line for body in bodies.values() for line in np.concatenate(body.singles)]
    return shapely.union_all([LineString(line) for line in lines])


def _swing_openings(content: Content, layers: Layers, ground: BaseGeometry) -> list[RawOpening]:
    """Openings of door leaves that are drawn as they are, without a block."""
    curves = [curve for layer in layers.of("door") for curve in content.curves[layer]]
    return [
        opening_of_swing(curve.swing, curves, ground)
        for curve in curves
        if curve.swing is not None and _LEAF_M[0] <= curve.swing.radius <= _LEAF_M[1]
    ]


_LEAF_M = (0.35, 2.0)


def _loose_openings(
    content: Content, layers: Layers, area: BaseGeometry
) -> tuple[list[RawOpening], list[LineString]]:
    """Lines of windows and doors that lie in a wall or in a gap of one, and those that do not."""
    openings: list[RawOpening] = []
    glass: list[LineString] = []
    for layer in (*layers.of("window"), *layers.of("door")):
        curves = content.curves[layer]
        leaves = [curve.swing for curve in curves if curve.swing is not None]
        straight = [curve for curve in curves if curve.swing is None]
        for heap in loose_lines(straight, "window"):
            if _has_leaf(heap.lines, leaves):
                continue
            if heap.opening is not None and _stands(heap.opening, area):
                openings.append(heap.opening)
            else:
                glass += heap.lines
    return openings, glass


def _has_leaf(lines: Sequence[LineString], leaves: Sequence[Swing]) -> bool:
    """Whether lines belong to a door's leaf."""
    heap = shapely.union_all(list(lines))
    return any(Point(p).distance(heap) < _IN_WALL_M for s in leaves for p in (s.hinge, *s.ends))


def _stands(opening: RawOpening, area: BaseGeometry) -> bool:
    """Whether an opening lies in a wall, or in a gap of one."""
    in_wall = Point(opening.centre).distance(area) < _IN_WALL_M
    return in_wall or bool(fill_gaps(area, [opening]))


def _share_of(bodies: Mapping[Material, _Bodies], filling: Polygon) -> _Bodies:
    """Walls that a filling goes on from: those it overlaps most."""
    return max(
        bodies.values(),
        key=lambda body: sum(filling.intersection(polygon).area for polygon in body.area),
    )


def _walls(body: _Bodies, material: Material) -> Iterator[RawWall]:
    area = shapely.union_all(body.area)
    for wall in walls_of_area(area, _CLOSE_M) if not area.is_empty else ():
        yield replace(wall, material=material)
    for (x0, y0), (x1, y1) in np.concatenate(body.singles).tolist():
        yield RawWall((x0, y0), (x1, y1), None, material)


def _glass_walls(lines: Sequence[LineString]) -> list[RawWall]:
    """Walls of glass on single lines, and between two lines that face each other."""
    segments = [np.stack([c[:-1], c[1:]], axis=1) for c in map(shapely.get_coordinates, lines)]
    if not segments:
        return []
    walls = strips_of_lines(np.concatenate(segments), _PAIR_M)
    found = walls_of_area(shapely.union_all(list(walls.area)), _CLOSE_M) if walls.area else []
    ends = [(wall.start, wall.end) for wall in found]
    ends += [((x0, y0), (x1, y1)) for (x0, y0), (x1, y1) in walls.singles.tolist()]
    return [RawWall(a, b, WINDOW_THICKNESS_M, WINDOW_MATERIAL) for a, b in ends]
