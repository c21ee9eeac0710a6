"""Separate drawings on one sheet: storeys or buildings side by side."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TypeVar

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from shapely.geometry import Polygon, box
from shapely.geometry.base import BaseGeometry

from floorplans.errors import PlanError
from floorplans.frame import PlanFrame
from floorplans.importers.draft import Box, Draft, RawWall
from floorplans.importers.imported import DrawingPart, ImportRecord

CONNECTED_M = 1.0
"""Walls nearer to each other than this belong to one drawing [m]."""
LIKE_SIZE = 0.2
"""Fraction of the area and of the walls of the largest drawing from which on another is listed."""
_MARGIN_M = 0.25

Made = TypeVar("Made", bound=ImportRecord)
"""An `Imported` or a `DraftPlan`."""


def within(draft: Draft, region: Box) -> Draft:
    """Return what lies in a region of a drawing.

    Parameters
    ----------
    draft : Draft
    region : (float, float, float, float)
        (x_min, y_min, x_max, y_max) [unit of the file].

    Raises
    ------
    PlanError
        When no wall lies there.
    """
    x_min, y_min, x_max, y_max = (draft.unit_m * value for value in region)
    area = box(min(x_min, x_max), min(y_min, y_max), max(x_min, x_max), max(y_min, y_max))

    def is_in(x: float, y: float) -> bool:
        return bool(shapely.intersects_xy(area, x, y))

    walls = tuple(wall for wall in draft.walls if is_in(*_middle(wall)))
    if not walls:
        x_min, y_min, x_max, y_max = _rounded(_bounds(draft.walls), draft.unit_m)
        raise PlanError(
            f"no wall lies in the region; the walls reach from ({x_min:g}, {y_min:g}) to "
            f"({x_max:g}, {y_max:g})",
            ("region",),
            region,
        )
    return replace(
        draft,
        walls=walls,
        openings=tuple(o for o in draft.openings if is_in(*o.centre)),
        closed=tuple(line for line in draft.closed if is_in(*line.centroid.coords[0])),
        outline=None if draft.outline is None else _largest(draft.outline.intersection(area)),
    )


def with_parts(imported: Made, draft: Draft, frame: PlanFrame) -> Made:
    """Add the drawings of a sheet to an import of one of them, and a warning that names them.

    Parameters
    ----------
    imported : Imported or DraftPlan
    draft : Draft
        As it was read.
    frame : PlanFrame
        Of the plan in the draft's coordinates.
    """
    outline = shapely.transform(imported.plan.outline, frame.to_drawing)
    parts = tuple(_parts(draft, outline))
    if len(parts) < 2:
        return imported
    listed = "; ".join(
        f"{part.corners}, {part.n_walls} pieces of wall{', taken' * part.is_taken}"
        for part in parts
    )
    unit = draft.unit_name
    warning = f"the file holds {len(parts)} separate drawings (corners in {unit}): {listed}"
    return replace(imported, parts=parts, warnings=(warning, *imported.warnings))


def _parts(draft: Draft, outline: Polygon) -> Iterator[DrawingPart]:
    """Yield the drawing in the outline and others of like size, from left to right."""
    lines = np.array(
        shapely.linestrings([(wall.start, wall.end) for wall in draft.walls]), dtype=np.object_
    )
    taken = shapely.dwithin(lines, outline, CONNECTED_M)
    sheets: list[tuple[NDArray[np.int64], bool]] = [(np.flatnonzero(taken), True)]
    left = np.flatnonzero(~taken)
    sheets += [(left[group], False) for group in _groups(lines[left])]
    lengths_m, areas_m2 = shapely.length(lines), [_extent(lines[sheet]).area for sheet, _ in sheets]
    walls_m = [float(lengths_m[sheet].sum()) for sheet, _ in sheets]
    large = [
        area > LIKE_SIZE * max(areas_m2) and wall_m > LIKE_SIZE * max(walls_m)
        for area, wall_m in zip(areas_m2, walls_m, strict=True)
    ]
    found = [sheet for sheet, is_large in zip(sheets, large, strict=True) if is_large]
    for sheet, is_taken in sorted(found, key=lambda each: _extent(lines[each[0]]).bounds):
        bounds = _extent(lines[sheet]).buffer(_MARGIN_M).bounds
        yield DrawingPart(_rounded(bounds, draft.unit_m), len(sheet), is_taken)


def _groups(lines: NDArray[np.object_]) -> Iterator[NDArray[np.int64]]:
    """Groups of lines that are near each other, or whose extents overlap."""
    pairs = shapely.STRtree(lines).query(lines, "dwithin", distance=CONNECTED_M)
    labels = _connected(pairs, len(lines))
    while len(labels):
        extents = np.array([_extent(lines[labels == k]) for k in range(labels.max() + 1)])
        merged = _connected(shapely.STRtree(extents).query(extents, "intersects"), len(extents))
        if merged.max() + 1 == len(extents):
            break
        labels = merged[labels]
    yield from (np.flatnonzero(labels == k) for k in range(labels.max(initial=-1) + 1))


def _connected(pairs: NDArray[np.int64], n: int) -> NDArray[np.int64]:
    graph = coo_array((np.ones(pairs.shape[1]), tuple(pairs)), shape=(n, n))
    return connected_components(graph, directed=False)[1].astype(np.int64)


def _extent(lines: NDArray[np.object_]) -> BaseGeometry:
    return box(*shapely.total_bounds(lines)) if len(lines) else Polygon()


def _largest(geometry: BaseGeometry) -> Polygon | None:
    parts = [part for part in shapely.get_parts(geometry) if isinstance(part, Polygon)]
    return max(parts, key=lambda part: part.area, default=None)


def _middle(wall: RawWall) -> tuple[float, float]:
    return (wall.start[0] + wall.end[0]) / 2, (wall.start[1] + wall.end[1]) / 2


def _bounds(walls: Sequence[RawWall]) -> Box:
    x_min, y_min, x_max, y_max = shapely.total_bounds(
        shapely.linestrings([(wall.start, wall.end) for wall in walls])
    ).tolist()
    return x_min, y_min, x_max, y_max


def _rounded(bounds: Box, unit_m: float) -> Box:
    """Bounds in the file's unit, to about a centimetre."""
    step = 10.0 ** np.floor(np.log10(0.05 / unit_m))
    x_min, y_min, x_max, y_max = (float(round(value / unit_m / step) * step) for value in bounds)
    return x_min, y_min, x_max, y_max
