"""DXF drawings -> drafts of plans.

The layer of a line, by its name or the user's mapping, determines what it is. Closed outlines of
wall bodies, fills, and the strips between parallel lines make up the wall area; gaps in it at doors
and windows are filled; its centre lines, with the measured thickness, are the walls. An unpaired
line is a wall of unknown thickness. Doors and windows come from blocks, from the swings of door
leaves, and from lines that lie in a gap; other lines of windows are walls of glass.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import LineString
from shapely.geometry.base import BaseGeometry

from floorplans.errors import PlanError
from floorplans.importers.centrelines.align import aligned_to_main_directions, along_walls
from floorplans.importers.centrelines.areas import MAX_HEAVY_M, walls_of_area
from floorplans.importers.centrelines.axes import point_of
from floorplans.importers.centrelines.double_doors import join_leaves
from floorplans.importers.centrelines.gaps import fill_gaps
from floorplans.importers.centrelines.parallel_lines import strips_of_lines
from floorplans.importers.centrelines.sections import sections_inside
from floorplans.importers.centrelines.split_by_material import by_material, without_openings
from floorplans.importers.centrelines.spurious import without_spurious_walls
from floorplans.importers.draft import Draft, ImportOptions, RawOpening, RawWall
from floorplans.importers.dxf.bodies import corners_of, thin_bodies, without_floors
from floorplans.importers.dxf.curved_glazing import PAIR_M
from floorplans.importers.dxf.curves import Curve, scaled_curve
from floorplans.importers.dxf.drawing import Content, Symbol, load_document, read_content
from floorplans.importers.dxf.glazing import (
    CLOSE_M,
    MIN_SINGLE_M,
    glass_walls,
    loose_openings,
)
from floorplans.importers.dxf.layers import Layers, damaged_objects, layers_of, missing_blocks
from floorplans.importers.dxf.loose_singles import without_loose_singles
from floorplans.importers.dxf.marks import marks_of, with_marks
from floorplans.importers.dxf.openings import (
    as_windows_outside,
    door_swings,
    opening_of_swing,
    openings_of_symbol,
)
from floorplans.importers.layer_names import unmatched
from floorplans.importers.progress import Report, Step, no_report
from floorplans.importers.tangle import check_crossings
from floorplans.importers.units import UNITS, check_size, guess_unit, unit_length
from floorplans.walls import complement

if TYPE_CHECKING:
    from ezdxf.document import Drawing as Document

CHORD_M = 0.02
"""Largest deviation of chords from an arc [m]."""
MAX_LINES = 20_000
"""Most lines on the layers of walls of a storey."""
_AT_FACE_M = 0.12
_INLIER_PERCENTILES = (0.5, 99.5)

_INSUNITS = {1: "in", 2: "ft", 4: "mm", 5: "cm", 6: "m", 7: "km", 10: "yd", 14: "dm"}

Material = str | None


@dataclass(frozen=True)
class _Bodies:
    """Contents of the layers of walls.

    Attributes
    ----------
    area : mapping of Material to shapely geometry
        Wall area of each material [m].
    singles : tuple of (LineString, Material)
        Unpaired lines [m].
    """

    area: Mapping[Material, BaseGeometry]
    singles: tuple[tuple[LineString, Material], ...]


def read_dxf(path: Path, options: ImportOptions, report: Report = no_report) -> Draft:
    """Read a DXF drawing of one storey.

    Parameters
    ----------
    path : Path
    options : ImportOptions
        `unit`, `layers` and `tolerance_m` (of chords) are used.
    report : callable
        Called with finished steps.

    Returns
    -------
    Draft

    Raises
    ------
    PlanError
        When the file is damaged or too large, holds no walls, or its unit is unknown.
    """
    document = load_document(path)
    report(Step.FILE_LOADED)
    unit, stated_by = _unit(document, options)
    tolerance = (options.tolerance_m or CHORD_M) / UNITS[unit]
    content = read_content(document, options.layers, tolerance)
    layers = layers_of(content, options.layers)
    check_size(_size(content, layers), unit, stated_by)
    metric = _with_doors_of_swings(_in_metres(content, UNITS[unit]), layers)
    metric, floors = without_floors(metric, layers)
    bodies = _bodies(metric, layers)
    loose = ""
    if any(map(layers.is_guess, layers.of("wall"))):
        singles, loose = without_loose_singles(bodies.singles, _merged([*bodies.area.values()]))
        bodies = replace(bodies, singles=singles)
    report(Step.FACES_PAIRED)
    walls, openings = _building(metric, layers, bodies)
    marks = marks_of(document, UNITS[unit])
    return Draft(
        name=path.stem,
        walls=tuple(walls),
        openings=tuple(openings),
        layers=with_marks(layers.uses(), marks),
        notes=(
            f"unit {unit}, as {stated_by}",
            *filter(None, (missing_blocks(content), damaged_objects(content, layers), loose)),
            *floors,
            *unmatched(options.layers, content.n_objects),
        ),
        original=layers.original(metric),
        marks=marks,
        unit_name=unit,
        unit_m=UNITS[unit],
    )


def _unit(document: Document, options: ImportOptions) -> tuple[str, str]:
    """Unit of the drawing, and who states it."""
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
    """Width and depth of the walls in the drawing's unit, without outliers."""
    curves = [curve for layer in layers.of("wall") for curve in content.curves[layer]]
    points = np.array([point for curve in curves for point in curve.points])
    width, depth = np.diff(np.percentile(points, _INLIER_PERCENTILES, axis=0), axis=0)[0]
    return float(width), float(depth)


def _in_metres(content: Content, unit_m: float) -> Content:
    def scaled(curve: Curve) -> Curve:
        return scaled_curve(curve, unit_m)

    metric = Content(n_objects=content.n_objects, hidden=content.hidden)
    for layer, curves in content.curves.items():
        metric.curves[layer] = [scaled(curve) for curve in curves]
    for layer, curves in content.left_out.items():
        metric.left_out[layer] = [scaled(curve) for curve in curves]
    metric.symbols = [
        replace(symbol, curves=tuple(scaled(curve) for curve in symbol.curves))
        for symbol in content.symbols
    ]
    return metric


def _with_doors_of_swings(content: Content, layers: Layers) -> Content:
    """Take arcs of door leaves for doors where walls and doors are on one layer."""
    for layer in filter(layers.is_guess, layers.of("wall")):
        curves = content.curves[layer]
        swings = door_swings(curves)
        content.symbols += [
            Symbol("door", True, layer, (1.0, 0.0), (c,)) for c in curves if c.swing in swings
        ]
        content.curves[layer] = [c for c in curves if c.swing is None or c.swing not in swings]
    return content


def _building(
    content: Content, layers: Layers, bodies: _Bodies
) -> tuple[list[RawWall], list[RawOpening]]:
    """Walls and openings of a drawing in metres."""
    area = _merged(list(bodies.area.values()))
    openings = _drawn_openings(content, layers, area, bodies.singles)
    openings = join_leaves(along_walls(openings, _faces(content, layers)))
    filled = list(fill_gaps(area, openings))
    area = _merged([area, *filled])
    loose, bent, glass = loose_openings(content, layers, area)
    more = fill_gaps(area, loose)
    area, filled = _merged([area, *more]), [*filled, *more]
    openings = as_windows_outside([*openings, *loose, *bent], area)
    solid = without_openings(bodies.area, openings)
    walls = walls_of_area(area, CLOSE_M, shapely.union_all(filled)) if not area.is_empty else []
    walls = aligned_to_main_directions(without_spurious_walls(walls, area))
    return [
        *(piece for wall in walls for piece in by_material(wall, solid)),
        *_single_walls(bodies, area),
        *glass_walls(glass, area),
    ], openings


def _merged(areas: Sequence[BaseGeometry]) -> BaseGeometry:
    """Union of areas, each of which is one already."""
    return areas[0] if len(areas) == 1 else shapely.union_all(areas)


def _drawn_openings(
    content: Content,
    layers: Layers,
    area: BaseGeometry,
    singles: Sequence[tuple[LineString, Material]],
) -> list[RawOpening]:
    """Openings of blocks and of swings of leaves, in wall areas, single lines and panes."""
    if not content.symbols and not layers.of("door"):
        return []
    ground = shapely.union_all([area, *(line for line, _ in singles), *_panes(content, layers)])
    openings = [o for symbol in content.symbols for o in openings_of_symbol(symbol, ground)]
    return openings + _swing_openings(content, layers, ground)


def _faces(content: Content, layers: Layers) -> NDArray[np.float64]:
    """All straight lines of walls and panes, (n, 2, 2) [m]."""
    return _segments(
        [c for k in ("wall", "window") for name in layers.of(k) for c in content.curves[name]]
    )


def _segments(curves: Sequence[Curve]) -> NDArray[np.float64]:
    """Straight pieces of curves, (n, 2, 2)."""
    chains = [corners_of(curve) for curve in curves]
    pieces = [np.stack([chain[:-1], chain[1:]], axis=1) for chain in chains]
    return np.concatenate([np.empty((0, 2, 2)), *pieces])


def _panes(content: Content, layers: Layers) -> list[LineString]:
    """Lines of windows, which may be walls of glass that doors stand in."""
    curves = [curve for layer in layers.of("window") for curve in content.curves[layer]]
    return [LineString(curve.points) for curve in curves]


def _bodies(content: Content, layers: Layers) -> _Bodies:
    """Wall area and single lines of each material."""
    curves: dict[Material, list[Curve]] = {}
    for layer in layers.of("wall"):
        curves.setdefault(layers.material(layer), []).extend(content.curves[layer])
    _check_number(curves)
    check_crossings(
        {f"layer {name}": _segments(content.curves[name]) for name in layers.of("wall")}
    )
    by_material_ = {material: thin_bodies(chains) for material, chains in curves.items()}
    faces = shapely.union_all([body for closed, _ in by_material_.values() for body in closed])
    beside = faces.buffer(_AT_FACE_M)
    area: dict[Material, BaseGeometry] = {}
    singles: list[tuple[LineString, Material]] = []
    for material, (closed, segments) in by_material_.items():
        walls = strips_of_lines(segments, PAIR_M, MAX_HEAVY_M)
        strips = [s for s in walls.area if s.difference(beside).area > s.area / 2]
        area[material] = shapely.union_all([*closed, *strips])
        singles += [(LineString(ends), material) for ends in walls.singles]
    return _Bodies(area, tuple(singles))


def _check_number(curves: Mapping[Material, Sequence[Curve]]) -> None:
    """Reject more lines than the walls of a storey have, before the slow work."""
    n_lines = sum(len(chain.points) for chains in curves.values() for chain in chains)
    if n_lines > MAX_LINES:
        raise PlanError(
            f"the layers of walls hold {n_lines} lines, more than the {MAX_LINES} of a single "
            "storey; leave layers out, such as NAME=ignore, or save one storey",
            remedy="layers",
        )


def _single_walls(bodies: _Bodies, area: BaseGeometry) -> Iterator[RawWall]:
    """Walls on unpaired lines, except beside a wall's face."""
    ends = np.array([line.coords for line, _ in bodies.singles]).reshape(-1, 2, 2)
    beside = sections_inside(ends, area.buffer(_AT_FACE_M)) if len(ends) else []
    for line, (single, material), sections in zip(ends, bodies.singles, beside, strict=True):
        along = (line[1] - line[0]) / single.length
        for low, high in complement(sections, single.length):
            if high - low > min(MIN_SINGLE_M, single.length / 2):
                start, end = line[0] + np.outer((low, high), along)
                yield RawWall(point_of(start), point_of(end), None, material)


def _swing_openings(content: Content, layers: Layers, ground: BaseGeometry) -> list[RawOpening]:
    """Openings of door leaves drawn without a block."""
    curves = [curve for layer in layers.of("door") for curve in content.curves[layer]]
    return [opening_of_swing(swing, curves, ground) for swing in door_swings(curves)]
