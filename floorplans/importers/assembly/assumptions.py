"""What neither the file nor the user states about a plan."""

from __future__ import annotations

from collections.abc import Iterator

from floorplans.importers.assembly.source_and_start import SourceAndStart
from floorplans.importers.defaults import (
    DOOR_HEAD_M,
    DOOR_MATERIAL,
    DOOR_THICKNESS_M,
    THICK_M,
    THICK_WALL_MATERIAL,
    WALL_MATERIAL,
    WALL_THICKNESS_M,
    WINDOW_HEAD_M,
    WINDOW_MATERIAL,
    WINDOW_SILL_M,
    WINDOW_THICKNESS_M,
)
from floorplans.importers.draft import Assumption, Draft, ImportOptions
from floorplans.importers.marks import Marks
from floorplans.unchecked import UncheckedPlan


def assumptions(
    draft: Draft,
    options: ImportOptions,
    marked: Marks,
    plan: UncheckedPlan,
    places: SourceAndStart,
) -> Iterator[Assumption]:
    """What neither the file nor the user states, in the order of the plan file."""
    if options.height_m is None and draft.height_m is None:
        yield Assumption("height_m", f"{plan.height_m:g}", "the file gives no height of the storey")
    for key in ("floor_material", "ceiling_material"):
        if getattr(options, key) is None and getattr(draft, key) is None:
            yield Assumption(key, getattr(plan, key), "the file names no material")
    if (options.source or marked.source) is None:
        yield Assumption(
            "source", f"{list(plan.source or ())}", "the file states no source; away from walls"
        )
    if (options.start or marked.start) is None:
        why = f"the cell with the longest walk from the source, {places.distance_m:.0f} m"
        yield Assumption("start", f"{list(plan.start or ())}", why)
    yield from draft.assumed
    yield from _wall_assumptions(draft, options)
    yield from _opening_assumptions(draft)


def _wall_assumptions(draft: Draft, options: ImportOptions) -> Iterator[Assumption]:
    n = len(draft.walls)
    bare = sum(raw.material is None for raw in draft.walls)
    thin = sum(raw.thickness_m is None for raw in draft.walls)
    if bare and options.wall_material is None:
        why = f"the file names no material for {bare} of {n} drawn walls"
        value = f"{WALL_MATERIAL}, {THICK_WALL_MATERIAL} if at least {THICK_M:g} m thick"
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
