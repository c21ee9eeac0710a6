"""Draft -> plan: walls that meet, openings in their walls, an outline, defaults for the rest."""

from __future__ import annotations

import shapely
from shapely.geometry import LineString, Polygon

from floorplans.errors import PlanError
from floorplans.importers.draft import Draft, ImportOptions, Origin
from floorplans.importers.imported import Assumption, Imported
from floorplans.plan import FloorPlan
from floorplans.walls import Wall

HEIGHT_M = 3.0
WALL_THICKNESS_M = 0.1
WALL_MATERIAL = "plasterboard"
SLAB_MATERIAL = "concrete"


def assemble(draft: Draft, options: ImportOptions, source_file: str) -> Imported:
    """Make a plan of what a reader found.

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
        When no region is closed by the walls, or the plan would not pass its checks.
    """
    height_m = options.height_m or draft.height_m or HEIGHT_M
    walls = tuple(
        Wall(
            raw.start,
            raw.end,
            raw.material or options.wall_material or WALL_MATERIAL,
            raw.thickness_m or options.wall_thickness_m or WALL_THICKNESS_M,
            raw.height_m or height_m,
        )
        for raw in draft.walls
    )
    outline = draft.outline or _outline(walls)
    inside = outline.representative_point()
    x, y = options.start or (inside.x, inside.y)
    plan = FloorPlan(
        name=options.name or draft.name,
        outline=outline,
        walls=walls,
        height_m=height_m,
        floor_material=options.floor_material or draft.floor_material or SLAB_MATERIAL,
        ceiling_material=options.ceiling_material or draft.ceiling_material or SLAB_MATERIAL,
        source=options.source or (inside.x, inside.y, min(1.5, height_m / 2)),
        start=(x, y),
        origin=draft.georeference,
    )
    assumed = (Assumption("source", str(plan.source), "inside the outline"),)
    origin = draft.origin or Origin(0.0, 0.0, "the file, in metres")
    return Imported(plan, source_file, origin, assumed, draft.layers, (), draft.notes)


def _outline(walls: tuple[Wall, ...]) -> Polygon:
    lines = shapely.union_all([LineString([wall.start, wall.end]) for wall in walls])
    regions = shapely.get_parts(shapely.polygonize(shapely.get_parts(lines)))
    whole = shapely.get_parts(shapely.union_all(regions))
    if not len(whole):
        raise PlanError("the walls close no region", ("outline",))
    return max(whole, key=lambda region: region.area)
