"""Columns of an IFC storey -> rings of walls, which are solid."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import shapely
from shapely.geometry import Polygon

from floorplans.importers.centrelines.areas import block_walls, box_sides
from floorplans.importers.draft import RawWall
from floorplans.importers.ifc.curves import Entity
from floorplans.importers.ifc.materials import Materials
from floorplans.importers.ifc.shapes import Scale
from floorplans.importers.ifc.walls import ReadWall, bodies_of_parts, top_on_floor

MIN_SIDE_M = 0.15
"""Thinner columns, such as posts of steel, are left out [m]."""


def read_column(
    column: Entity, floor_m: float, scale: Scale, materials: Materials
) -> ReadWall | None:
    """Read a column; None if it is thin, has no body, or does not stand on this floor.

    Parameters
    ----------
    column : entity
    floor_m : float
        Elevation of the storey [m].
    scale : Scale
    materials : Materials
        Those of the model.
    """
    parts = bodies_of_parts(column, scale)
    top_m = top_on_floor(parts, floor_m) if parts else None
    if top_m is None:
        return None
    around = shapely.union_all([body.footprint for body in parts]).convex_hull
    around = around.simplify(scale.chord_m)
    if not isinstance(around, Polygon) or box_sides(around)[0] < MIN_SIDE_M:
        return None
    material, _ = materials.of_wall(column)
    ring = block_walls(around)
    return ReadWall(tuple(replace(side, material=material) for side in ring), (), top_m)


def is_in_wall(column: ReadWall, walls: Sequence[RawWall]) -> bool:
    """Whether a column stands in a wall, as part of it."""
    around = Polygon([side.start for side in column.pieces])
    lines = shapely.linestrings([(wall.start, wall.end) for wall in walls])
    half_m = np.array([(wall.thickness_m or 0.0) / 2 for wall in walls])
    return bool((shapely.distance(lines, around) < half_m).any())
