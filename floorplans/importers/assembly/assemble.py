"""Draft -> plan that passes its checks, with defaults for what the file does not state."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
import shapely
from shapely.geometry import LineString

from floorplans.errors import PlanError, unknown_name
from floorplans.importers.assembly.assumptions import assumptions
from floorplans.importers.assembly.building import Building, buildings
from floorplans.importers.assembly.draft_plan import unusable
from floorplans.importers.assembly.map_fit import fit_of
from floorplans.importers.assembly.openings import NO_WALL
from floorplans.importers.assembly.source_and_start import (
    SOURCE_HEIGHT_M,
    SourceAndStart,
    choose_source_and_start,
)
from floorplans.importers.defaults import (
    HEIGHT_M,
    SLAB_MATERIAL,
    WALL_THICKNESS_M,
    wall_material_of,
)
from floorplans.importers.draft import Draft, ImportOptions
from floorplans.importers.imported import Imported, ImportRecord
from floorplans.importers.marks import Position
from floorplans.importers.progress import Report, Step, no_report
from floorplans.importers.tangle import check_crossings
from floorplans.materials import MATERIALS, PlanMaterial
from floorplans.plan import FloorPlan
from floorplans.repair.geometry import Change, tidy_point
from floorplans.repair.plan import repair_plan
from floorplans.transmitters import PlanTransmitter
from floorplans.unchecked import UncheckedPlan
from floorplans.values import LENGTH, MAX_SIDE_M, MAX_WALLS, check_number
from floorplans.walls import TOLERANCE_M, Wall
from floorplans.walls import Point as Point2

MUCH_OUTSIDE = 0.05
"""Fraction of the walls' length outside the outline from which on the user is warned."""

MANY_LOST = 0.25
"""Fraction of the openings without a wall from which on the user is warned."""

_NO_WALL = tuple(NO_WALL.format(kind=kind) for kind in ("door", "passage", "window"))
_GIVEN_BY_USER = ("name", "height_m", "floor_material", "ceiling_material", "source", "start")


def assemble(
    draft: Draft, options: ImportOptions, source_file: str, report: Report = no_report
) -> Imported:
    """Create a plan from a draft.

    Parameters
    ----------
    draft : Draft
    options : ImportOptions
    source_file : str
        Name of the file the draft is from.
    report : callable
        Called with finished steps.

    Returns
    -------
    Imported

    Raises
    ------
    UnusablePlanError
        When the building is open, or the plan fails its checks; the error holds a draft of the
        plan.
    PlanError
        When the file holds no walls, or an option is wrong.
    """
    _check(draft, options)
    height_m = options.height_m or draft.height_m or HEIGHT_M
    best: tuple[ImportRecord, Building] | None = None
    walls = _walls(draft, options, height_m)
    for building in buildings(draft, walls, options, height_m, report):
        record = _record(draft, options, building, height_m, source_file)
        report(Step.PLACES_CHOSEN)
        imported = _checked(record)
        if imported is not None:
            report(Step.PLAN_CHECKED)
            return imported
        best = best or (record, building)
    if best is None:
        raise PlanError("the walls enclose no region; check which layers hold the walls")
    record, building = best
    raise unusable(record, building.gaps)


def _checked(record: ImportRecord) -> Imported | None:
    """Return what was imported as a plan that passes its checks, after safe repairs if it must."""
    try:
        return _imported(record, record.plan, record.changes)
    except PlanError as fault:
        if fault.place and fault.place[0] in _GIVEN_BY_USER:
            raise
    repaired = repair_plan(record.plan)
    try:
        return _imported(record, repaired.plan, (*record.changes, *repaired.changes))
    except PlanError:
        return None


def _imported(record: ImportRecord, plan: UncheckedPlan, changes: tuple[Change, ...]) -> Imported:
    fields: dict[str, Any] = {**vars(record), "plan": FloorPlan.of(plan), "changes": changes}
    return Imported(**fields)


def _record(
    draft: Draft, options: ImportOptions, building: Building, height_m: float, source_file: str
) -> ImportRecord:
    marks = draft.marks
    if draft.origin is None:
        marks = marks.shifted(-building.origin.x, -building.origin.y)
    marked = marks.inside(building.outline, height_m)
    source, start = options.source or marked.source, options.start or marked.start
    places = _places(building, source, start, height_m)
    plan = UncheckedPlan(
        name=options.name or draft.name,
        outline=building.outline,
        walls=building.walls,
        height_m=height_m,
        floor_material=options.floor_material or draft.floor_material or SLAB_MATERIAL,
        ceiling_material=options.ceiling_material or draft.ceiling_material or SLAB_MATERIAL,
        source=source or (*places.source, min(SOURCE_HEIGHT_M, height_m / 2)),
        start=start or places.start,
        origin=draft.georeference,
        materials=_used(draft, building.walls),
        transmitters=tuple(
            PlanTransmitter(f"tx{k}", place) for k, place in enumerate(marked.transmitters, 1)
        ),
    )
    fit = fit_of(draft.known, building)
    original = draft.original
    if original is not None and draft.origin is None:
        original = original.moved(-building.origin.x, -building.origin.y)
    return ImportRecord(
        plan=plan,
        source_file=source_file,
        origin=building.origin,
        assumed=tuple(assumptions(draft, options, marked, plan, places)),
        layers=draft.layers,
        changes=building.changes,
        notes=(*draft.notes, *marks.missing_in(marked), *fit.notes),
        warnings=(*draft.warnings, *_losses(draft, building), *fit.warnings),
        original=original,
    )


def _losses(draft: Draft, building: Building) -> Iterator[str]:
    """Warn of much wall outside the outline, and of many openings without a wall."""
    outside = 1.0 - building.enclosed
    if outside >= MUCH_OUTSIDE:
        total_m = sum(LineString([wall.start, wall.end]).length for wall in draft.walls)
        yield (
            f"{100 * outside:.0f} % of the walls, about {outside * total_m:.3g} m, lie outside the "
            "outline and are left out: another building, a fence, or a part that is open"
        )
    n_lost = sum(change.text in _NO_WALL for change in building.changes)
    if n_lost > MANY_LOST * len(draft.openings):
        yield (
            f"{n_lost} of {len(draft.openings)} doors and windows lie in no wall and are left out: "
            "look whether their walls were read"
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
    check_crossings({"the file": np.array([(wall.start, wall.end) for wall in draft.walls])})
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


def _used(draft: Draft, walls: Sequence[Wall]) -> tuple[PlanMaterial, ...]:
    """Materials of a draft that the walls are made of."""
    names = {wall.material for wall in walls}
    return tuple(material for material in draft.materials if material.name in names)


def _places(
    building: Building, source: Position | None, start: Point2 | None, height_m: float
) -> SourceAndStart:
    if source is not None and start is not None:
        return SourceAndStart(source[:2], start, 0.0)
    place = None if source is None else source[:2]
    return choose_source_and_start(building.outline, building.walls, height_m, place)
