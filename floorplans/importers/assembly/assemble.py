"""Draft -> plan: walls that meet, attached openings, an outline, defaults for the rest."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely
from shapely.geometry import Polygon

from floorplans.errors import PlanError, unknown_name
from floorplans.importers.assembly.openings import attach_openings, close_gaps
from floorplans.importers.assembly.outline import Storey, find_outline
from floorplans.importers.assembly.source_and_start import (
    SOURCE_HEIGHT_M,
    SourceAndStart,
    choose_source_and_start,
)
from floorplans.importers.defaults import (
    DOOR_HEAD_M,
    DOOR_MATERIAL,
    DOOR_THICKNESS_M,
    HEIGHT_M,
    SLAB_MATERIAL,
    THICK_M,
    THICK_WALL_MATERIAL,
    WALL_MATERIAL,
    WALL_THICKNESS_M,
    WINDOW_HEAD_M,
    WINDOW_MATERIAL,
    WINDOW_SILL_M,
    WINDOW_THICKNESS_M,
    wall_material_of,
)
from floorplans.importers.draft import Assumption, Draft, ImportOptions, Origin, RawOpening
from floorplans.importers.imported import Imported
from floorplans.materials import MATERIALS, PlanMaterial
from floorplans.plan import FloorPlan
from floorplans.repair.collinear import merge_lines
from floorplans.repair.geometry import DECIMALS, Change, tidy_point
from floorplans.repair.walls import REACH_M, repair_walls
from floorplans.values import LENGTH, MAX_SIDE_M, MAX_WALLS, check_number
from floorplans.walls import TOLERANCE_M, Wall

THICKNESS_FRACTION = 0.3
"""Collinear walls are joined where their thicknesses differ by at most this fraction."""


@dataclass(frozen=True)
class _Building:
    """The storey in the plan's coordinates."""

    outline: Polygon
    walls: tuple[Wall, ...]
    changes: tuple[Change, ...]
    origin: Origin


def assemble(draft: Draft, options: ImportOptions, source_file: str) -> Imported:
    """Create a plan from a draft.

    Parameters
    ----------
    draft : Draft
    options : ImportOptions
    source_file : str
        Name of the file the draft is from.

    Returns
    -------
    Imported

    Raises
    ------
    PlanError
        When the walls enclose no region, or the plan fails its checks.
    """
    _check(draft, options)
    height_m = options.height_m or draft.height_m or HEIGHT_M
    building = _building(draft, _walls(draft, options, height_m), options, height_m)
    places = _places(building, options, height_m)
    plan = FloorPlan(
        name=options.name or draft.name,
        outline=building.outline,
        walls=building.walls,
        height_m=height_m,
        floor_material=options.floor_material or draft.floor_material or SLAB_MATERIAL,
        ceiling_material=options.ceiling_material or draft.ceiling_material or SLAB_MATERIAL,
        source=options.source or (*places.source, min(SOURCE_HEIGHT_M, height_m / 2)),
        start=options.start or places.start,
        origin=draft.georeference,
        materials=_used(draft, building.walls),
    )
    return Imported(
        plan=plan,
        source_file=source_file,
        origin=building.origin,
        assumed=tuple(_assumptions(draft, options, plan, places)),
        layers=draft.layers,
        changes=building.changes,
        notes=draft.notes,
    )


def _check(draft: Draft, options: ImportOptions) -> None:
    """Reject input that is too large or invalid."""
    if not draft.walls:
        raise PlanError("no walls were found in the file")
    if len(draft.walls) > MAX_WALLS:
        raise PlanError(
            f"{len(draft.walls)} pieces of wall, more than the {MAX_WALLS} of a single storey; "
            "import one storey, and only the layers of its walls"
        )
    x_min, y_min, x_max, y_max = shapely.total_bounds(
        shapely.multipoints([end for wall in draft.walls for end in (wall.start, wall.end)])
    )
    side_m = max(x_max - x_min, y_max - y_min)
    if side_m > MAX_SIDE_M:
        raise PlanError(
            f"the walls extend over {side_m / 1000:.3g} km, more than any building; "
            "give the unit or scale of the file"
        )
    for key in ("height_m", "wall_thickness_m", "tolerance_m"):
        value = getattr(options, key)
        if value is not None:
            check_number(value, LENGTH, (key,))
    for key in ("wall_material", "floor_material", "ceiling_material"):
        name = getattr(options, key)
        if name is not None and name not in MATERIALS:
            raise PlanError(unknown_name("material", name, MATERIALS), (key,), name)


def _walls(draft: Draft, options: ImportOptions, height_m: float) -> tuple[Wall, ...]:
    """Walls with defaults for what the file does not state, without those of zero length."""
    walls = (
        Wall(
            start=tidy_point(*raw.start),
            end=tidy_point(*raw.end),
            material=raw.material or options.wall_material or wall_material_of(raw.thickness_m),
            thickness_m=round(raw.thickness_m or options.wall_thickness_m or WALL_THICKNESS_M, 4),
            height_m=min(raw.height_m or height_m, height_m),
        )
        for raw in draft.walls
    )
    return tuple(wall for wall in walls if wall.length_m > TOLERANCE_M)


def _building(
    draft: Draft, walls: Sequence[Wall], options: ImportOptions, height_m: float
) -> _Building:
    """Make walls meet, find the outline, and attach the openings."""
    order = {"door": 0, "passage": 1, "window": 2}
    openings = sorted(draft.openings, key=lambda opening: order[opening.kind])
    reach_m = options.tolerance_m or REACH_M
    repaired = repair_walls(close_gaps(walls, openings), reach_m, THICKNESS_FRACTION)
    storey = find_outline(repaired.walls, draft.outline, height_m)
    joined = merge_lines(storey.walls, 10 * TOLERANCE_M, 0.0, [], sideways_fraction=0.0)
    storey = Storey(storey.outline, joined, (*repaired.changes, *storey.changes))
    origin = draft.origin
    if origin is None:
        x, y, *_ = storey.outline.bounds
        origin = Origin(x, y, "the file, in metres")
        storey, openings = _moved(storey, openings, -x, -y)
    walls, dropped = attach_openings(storey.walls, openings, storey.outline)
    return _Building(storey.outline, walls, (*storey.changes, *dropped), origin)


def _moved(
    storey: Storey, openings: Sequence[RawOpening], d_x: float, d_y: float
) -> tuple[Storey, list[RawOpening]]:
    """Translate a storey and openings by (d_x, d_y) [m]."""

    def to(point: tuple[float, float]) -> tuple[float, float]:
        return tidy_point(point[0] + d_x, point[1] + d_y)

    shift = np.array([d_x, d_y])
    outline = shapely.transform(storey.outline, lambda xy: (xy + shift).round(DECIMALS))
    walls = tuple(replace(wall, start=to(wall.start), end=to(wall.end)) for wall in storey.walls)
    changes = tuple(
        replace(change, at=to(change.at), to=to(change.to) if change.to else None)
        for change in storey.changes
    )
    return (
        Storey(outline, walls, changes),
        [replace(opening, centre=to(opening.centre)) for opening in openings],
    )


def _used(draft: Draft, walls: Sequence[Wall]) -> tuple[PlanMaterial, ...]:
    """Materials of a draft that the walls are made of."""
    names = {wall.material for wall in walls}
    return tuple(material for material in draft.materials if material.name in names)


def _places(building: _Building, options: ImportOptions, height_m: float) -> SourceAndStart:
    source = options.source[:2] if options.source is not None else None
    if options.source is not None and options.start is not None:
        return SourceAndStart(options.source[:2], options.start, 0.0)
    return choose_source_and_start(building.outline, building.walls, height_m, source)


def _assumptions(
    draft: Draft, options: ImportOptions, plan: FloorPlan, places: SourceAndStart
) -> Iterator[Assumption]:
    """What neither the file nor the user states, in the order of the plan file."""
    if options.height_m is None and draft.height_m is None:
        yield Assumption("height_m", f"{plan.height_m:g}", "the file gives no height of the storey")
    for key in ("floor_material", "ceiling_material"):
        if getattr(options, key) is None and getattr(draft, key) is None:
            yield Assumption(key, getattr(plan, key), "the file names no material")
    if options.source is None:
        yield Assumption(
            "source", f"{list(plan.require_source())}", "the file states no source; away from walls"
        )
    if options.start is None:
        why = f"the cell with the longest walk from the source, {places.distance_m:.0f} m"
        yield Assumption("start", f"{list(plan.require_start())}", why)
    yield from draft.assumed
    yield from _wall_assumptions(draft, options)
    yield from _opening_assumptions(draft)


def _wall_assumptions(draft: Draft, options: ImportOptions) -> Iterator[Assumption]:
    n = len(draft.walls)
    bare = sum(raw.material is None for raw in draft.walls)
    thin = sum(raw.thickness_m is None for raw in draft.walls)
    if bare and options.wall_material is None:
        why = f"the file gives {bare} of {n} drawn walls no material"
        value = f"{WALL_MATERIAL}, {THICK_WALL_MATERIAL} from {THICK_M:g} m thickness on"
        yield Assumption("wall material", value, why)
    if thin and options.wall_thickness_m is None:
        why = f"the file gives {thin} of {n} drawn walls no thickness"
        yield Assumption("wall thickness_m", f"{WALL_THICKNESS_M:g}", why)


def _opening_assumptions(draft: Draft) -> Iterator[Assumption]:
    doors = [raw for raw in draft.openings if raw.kind != "window"]
    windows = [raw for raw in draft.openings if raw.kind == "window"]
    if any(raw.head_m is None for raw in doors):
        yield Assumption("door head_m", f"{DOOR_HEAD_M:g}", "the file gives doors no height")
    if any(raw.material is None for raw in doors):
        value = f"open inside, {DOOR_MATERIAL} of {DOOR_THICKNESS_M:g} m in the outline"
        yield Assumption("door material", value, "the file names none")
    if any(raw.head_m is None for raw in windows):
        value = f"{WINDOW_SILL_M:g} to {WINDOW_HEAD_M:g}"
        yield Assumption("window sill_m to head_m", value, "the file gives windows no height")
    if any(raw.material is None for raw in windows):
        value = f"{WINDOW_MATERIAL} of {WINDOW_THICKNESS_M:g} m"
        yield Assumption("window material", value, "the file names none")
