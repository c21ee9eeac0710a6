"""IFC models -> drafts of plans, one storey at a time.

Walls are read from their bodies (the middle of the footprint) and, where they are curved, from
their axes; their thickness and materials from their layers, otherwise from the body. What voids a
wall is an opening: a door or window if one fills it, otherwise a passage. Slabs and ceilings above
give the height. Needs ifcopenshell.
"""

from __future__ import annotations

import warnings
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from math import atan2, degrees
from pathlib import Path

import numpy as np
from shapely.errors import ShapelyError
from shapely.geometry import GeometryCollection
from shapely.geometry.base import BaseGeometry

from floorplans.errors import PlanError
from floorplans.georeference import GeoOrigin
from floorplans.importers.draft import Draft, ImportOptions, LayerUse, RawOpening
from floorplans.importers.ifc.columns import is_in_wall, read_column
from floorplans.importers.ifc.curves import Entity
from floorplans.importers.ifc.file import Model, Storey, open_model, scale_of, storey_of, storeys_of
from floorplans.importers.ifc.materials import Materials
from floorplans.importers.ifc.parts import parts_of
from floorplans.importers.ifc.shapes import Body, Scale, bodies
from floorplans.importers.ifc.walls import ReadWall, read_filling, read_wall, rises_through
from floorplans.importers.layer_names import unmatched
from floorplans.importers.original import DrawnLayer, Original
from floorplans.importers.progress import Report, Step, no_report
from floorplans.values import MAX_WALLS

_DAMAGED = (
    ArithmeticError, AssertionError, AttributeError, LookupError, RuntimeError, ShapelyError,
    TypeError, ValueError,
)  # fmt: skip
"""Errors of models whose entities lack parts or refer to a wrong class."""

_SLABS = ("IfcSlab", "IfcRoof", "IfcCovering")
_MOST_SHOWN = 2000
_CEILING_M = (1.8, 30.0)
_SAME_CEILING_M = 0.3
_TO_CEILING_M = 0.35
"""A wall that ends at most this below the ceiling reaches it: slabs have a thickness [m]."""


def read_ifc(path: Path, options: ImportOptions, report: Report = no_report) -> Draft:
    """Read one storey of an IFC model.

    Parameters
    ----------
    path : Path
    options : ImportOptions
        `level` is the storey's name, its number from below, or its elevation [m] with a point;
        `layers` maps names of materials.
    report : callable
        Called with finished steps.

    Returns
    -------
    Draft

    Raises
    ------
    PlanError
        When the file cannot be read, or the choice of the storey is ambiguous.
    """
    model = open_model(path)
    report(Step.FILE_LOADED)
    try:
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore", DeprecationWarning)  # the library's own
            return _read_storey(model, path, options)
    except PlanError:
        raise
    except _DAMAGED as error:
        raise PlanError(f"the model is damaged: {type(error).__name__}: {error}") from error


def _read_storey(model: Model, path: Path, options: ImportOptions) -> Draft:
    scale = scale_of(model, options)
    storey, n_rising = _with_rising_walls(
        model, storey_of(model, options.level, scale.metre), scale
    )
    if len(storey.walls) > MAX_WALLS:
        raise PlanError(f"{len(storey.walls)} walls, more than the {MAX_WALLS} of one storey")
    floor_m = storey.elevation_m
    materials = Materials(scale.metre, options.layers, options.wall_material)
    read = [read_wall(wall, floor_m, scale, materials) for wall in storey.walls]
    walls = [wall for wall in read if wall is not None]
    columns, remarks = _columns(storey, walls, scale, materials)
    slabs = _slabs(model, storey, scale)
    height_m = options.height_m or _ceiling(slabs, floor_m) or _highest(walls)
    floor = next((e for e, body in slabs if abs(body.z_max - floor_m) < _SAME_CEILING_M), None)
    ceiling = next((e for e, body in slabs if _is_ceiling(body, floor_m)), None)
    loose = [
        opening
        for filling in storey.elements
        if _fills_nothing(filling)
        and (opening := read_filling(filling, floor_m, scale)) is not None
    ]
    return Draft(
        name=" ".join(f"{path.stem} {storey.name}".split()),
        walls=tuple(
            replace(piece, height_m=_height(wall.top_m, height_m))
            for wall in (*walls, *columns)
            for piece in wall.pieces
        ),
        openings=tuple(_within(loose, walls, height_m)),
        height_m=height_m,
        floor_material=None if floor is None else materials.of_slab(floor),
        ceiling_material=None if ceiling is None else materials.of_slab(ceiling),
        georeference=_georeference(model),
        notes=(*_rising_note(n_rising), *unmatched(options.layers, materials.names)),
        layers=tuple(_uses(storey, read, remarks)),
        materials=materials.own,
        assumed=tuple(materials.assumed()),
        original=_original(storey, scale),
    )


def _with_rising_walls(model: Model, storey: Storey, scale: Scale) -> tuple[Storey, int]:
    """Add walls and columns of lower storeys that rise through a storey; also their number."""
    own = {element.id() for element in storey.elements}
    rising = tuple(
        element
        for lower in storeys_of(model, scale.metre)
        if lower.elevation_m < storey.elevation_m
        for element in (*lower.walls, *(e for e in lower.elements if e.is_a("IfcColumn")))
        if element.id() not in own and rises_through(element, storey.elevation_m, scale)
    )
    return replace(storey, elements=(*storey.elements, *rising)), len(rising)


def _rising_note(n_rising: int) -> Iterator[str]:
    if n_rising:
        yield (
            f"{n_rising} walls and columns of lower storeys rise through "
            "this storey, and are part of it"
        )


def _columns(
    storey: Storey, walls: Sequence[ReadWall], scale: Scale, materials: Materials
) -> tuple[list[ReadWall], Counter[str]]:
    """Columns, and what is to be said about how many of them."""
    pieces = [piece for wall in walls for piece in wall.pieces]
    columns: list[ReadWall] = []
    remarks: Counter[str] = Counter()
    for element in storey.elements:
        if not element.is_a("IfcColumn"):
            continue
        column = read_column(element, storey.elevation_m, scale, materials)
        if column is None:
            remarks["thin, or without a readable shape on this floor, left out"] += 1
        elif pieces and is_in_wall(column, pieces):
            remarks["part of walls, left out"] += 1
        else:
            columns.append(column)
            if any(side.material is None for side in column.pieces):
                remarks["of unknown material, as walls of their thickness"] += 1
    return columns, remarks


def _original(storey: Storey, scale: Scale) -> Original:
    """Footprints of the storey's elements by class, except of slabs, which cover everything."""
    shapes: dict[str, list[BaseGeometry]] = {}
    in_curtains = _parts_of_curtain_walls(storey)
    for element in storey.elements[:_MOST_SHOWN]:
        kind = element.is_a()
        if kind in (*_SLABS, "IfcOpeningElement"):
            continue
        with suppress(*_DAMAGED):  # what is left out need not be readable
            shapes.setdefault(kind, []).extend(body.footprint for body in bodies(element, scale))
    return Original(
        tuple(
            DrawnLayer(
                kind,
                _BECAME.get(kind, "left out"),
                kind in _BECAME or kind in in_curtains,
                GeometryCollection(own),
            )
            for kind, own in sorted(shapes.items())
        )
    )


def _slabs(model: Model, storey: Storey, scale: Scale) -> list[tuple[Entity, Body]]:
    """Slabs, roofs and ceilings above or below the storey's walls, with their bodies."""
    inside = {element.id() for element in storey.elements}
    found: list[tuple[Entity, Body]] = []
    for kind in _SLABS:
        for element in model.by_type(kind):
            is_ceiling = getattr(element, "PredefinedType", None) == "CEILING"
            if kind == "IfcCovering" and not (is_ceiling and element.id() in inside):
                continue
            found += [(element, body) for body in bodies(element, scale)]
    return found


def _is_ceiling(body: Body, floor_m: float) -> bool:
    low, high = _CEILING_M
    return low <= body.z_min - floor_m <= high


def _ceiling(slabs: Sequence[tuple[Entity, Body]], floor_m: float) -> float | None:
    """Height of the ceiling: of suspended ceilings, otherwise of the lowest slab above.

    Raises
    ------
    PlanError
        When rooms have suspended ceilings at different heights.
    """
    above = [(e, body.z_min - floor_m) for e, body in slabs if _is_ceiling(body, floor_m)]
    if not above:
        return None
    suspended = sorted(height for e, height in above if e.is_a("IfcCovering"))
    if suspended and suspended[-1] - suspended[0] > _SAME_CEILING_M:
        raise PlanError(
            f"rooms have ceilings at {suspended[0]:.2f} m to {suspended[-1]:.2f} m, and a plan has "
            "one flat ceiling; give the height that matters",
            ("height_m",),
            remedy="height_m",
        )
    return suspended[0] if suspended else min(height for _, height in above)


def _highest(walls: Sequence[ReadWall]) -> float | None:
    """Height at which most of the walls end, rounded to 1 cm."""
    tops = Counter(round(wall.top_m, 2) for wall in walls if wall.top_m < _CEILING_M[1])
    return max(tops, key=lambda top: (tops[top], top)) if tops else None


def _height(top_m: float, ceiling_m: float | None) -> float | None:
    """Height of a wall; None if it reaches the ceiling."""
    if ceiling_m is None or top_m >= ceiling_m - _TO_CEILING_M:
        return None
    return top_m


def _within(
    loose: Sequence[RawOpening], walls: Sequence[ReadWall], ceiling_m: float | None
) -> Iterator[RawOpening]:
    """Yield openings between floor and ceiling, clipped to there."""
    for opening in (*loose, *(o for wall in walls for o in wall.openings)):
        head_m = opening.head_m or 0.0
        if ceiling_m is not None:
            head_m = min(head_m, ceiling_m)
        if 0 < opening.width_m < np.inf and head_m > (opening.sill_m or 0.0):
            yield replace(opening, head_m=head_m)


def _fills_nothing(element: Entity) -> bool:
    return (element.is_a("IfcDoor") or element.is_a("IfcWindow")) and not element.FillsVoids


def _georeference(model: Model) -> GeoOrigin | None:
    """Place of the model's origin, if its site states one."""
    sites = [s for s in model.by_type("IfcSite") if s.RefLatitude and s.RefLongitude]
    if not sites:
        return None
    contexts = [c for c in model.by_type("IfcGeometricRepresentationContext", False) if c.TrueNorth]
    x, y = contexts[0].TrueNorth.DirectionRatios[:2] if contexts else (0.0, 1.0)
    latitude, longitude = _angle_deg(sites[0].RefLatitude), _angle_deg(sites[0].RefLongitude)
    return GeoOrigin(longitude, latitude, degrees(atan2(x, y)))


def _angle_deg(parts: Sequence[int]) -> float:
    """Degrees of an angle in degrees, minutes, seconds and millionths of seconds."""
    units = (1.0, 60.0, 3600.0, 3600e6)
    return sum(part / unit for part, unit in zip(parts, units, strict=False))


def _uses(
    storey: Storey, read: Sequence[ReadWall | None], columns: Mapping[str, int]
) -> Iterator[LayerUse]:
    """Yield what became of each class of elements."""
    unread = Counter(wall.is_a() for wall, got in zip(storey.walls, read, strict=True) if not got)
    in_curtains = _parts_of_curtain_walls(storey)
    for kind, count in sorted(Counter(element.is_a() for element in storey.elements).items()):
        became = _BECAME.get(kind, "left out")
        if kind not in _BECAME and in_curtains[kind] == count:
            became = "parts of curtain walls"
        if unread[kind]:
            became += f"; {unread[kind]} without a readable shape, or not on this floor, left out"
        if kind.startswith("IfcColumn"):
            became += "".join(f"; {n} {remark}" for remark, n in columns.items())
        yield LayerUse(kind, count, became)


def _parts_of_curtain_walls(storey: Storey) -> Counter[str]:
    """Number of plates, mullions and so on of each class in a storey's curtain walls."""
    curtains = [wall for wall in storey.walls if wall.is_a("IfcCurtainWall")]
    return Counter(
        kind for kind, _ in {(part.is_a(), part.id()) for w in curtains for part in parts_of(w)}
    )


_BECAME = {
    "IfcWall": "walls",
    "IfcWallStandardCase": "walls",
    "IfcWallElementedCase": "walls",
    "IfcCurtainWall": "walls of glass",
    "IfcColumn": "columns",
    "IfcColumnStandardCase": "columns",
    "IfcOpeningElement": "openings",
    "IfcDoor": "doors",
    "IfcWindow": "windows",
    "IfcSlab": "the heights of floor and ceiling",
    "IfcCovering": "the height of the ceiling",
}
