"""A draft's walls and openings -> a storey: walls that meet, an outline, openings in walls."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from math import dist

import numpy as np
import shapely
from shapely.geometry import Polygon

from floorplans.importers.assembly.openings import attach_openings, close_gaps
from floorplans.importers.assembly.outline import Link, Storey, find_outline, settled
from floorplans.importers.draft import Draft, ImportOptions, Origin, RawOpening
from floorplans.importers.progress import Report, Step
from floorplans.repair.geometry import DECIMALS, Change, tidy_point
from floorplans.repair.walls import REACH_M, repair_walls
from floorplans.walls import TOLERANCE_M, Point, Wall

THICKNESS_FRACTION = 0.3
"""Collinear walls are joined where their thicknesses differ by at most this fraction."""

_SETTLING_M = (10 * TOLERANCE_M, 1e-3, 1e-2)
"""How far walls are moved to meet once the gaps in the outline are closed; tried in order [m]."""
_DETOUR = 1.3
"""Ratio of length to distance up to which a section of the outline is an opening."""
_ORDER = {"door": 0, "passage": 1, "window": 2}


@dataclass(frozen=True)
class Building:
    """The storey in the plan's coordinates.

    Attributes
    ----------
    outline : shapely.geometry.Polygon
    walls : tuple of Wall
        With their openings.
    changes : tuple of Change
    origin : Origin
    gaps : tuple of Link
        Where the outline has no wall [m].
    closed_m : float
        Length of the outline where the file has no wall [m].
    enclosed : float
        Fraction of the drawn walls' length that is in or on the outline.
    """

    outline: Polygon
    walls: tuple[Wall, ...]
    changes: tuple[Change, ...]
    origin: Origin
    gaps: tuple[Link, ...]
    closed_m: float
    enclosed: float


def buildings(
    draft: Draft,
    walls: Sequence[Wall],
    options: ImportOptions,
    height_m: float,
    report: Report,
) -> Iterator[Building]:
    """Yield what a draft may be, the most faithful first.

    The outline is derived from the walls in their final positions. Where walls miss each other by
    less than a drawing shows, the next storey moves them a little farther.

    Parameters
    ----------
    draft : Draft
    walls : sequence of Wall
        The draft's walls, complete.
    options : ImportOptions
    height_m : float
        Of the ceiling [m].
    report : callable
        Called with finished steps.
    """
    openings = sorted(draft.openings, key=lambda opening: _ORDER[opening.kind])
    reach_m = options.tolerance_m or REACH_M
    repaired = repair_walls(close_gaps(walls, openings), reach_m, THICKNESS_FRACTION)
    report(Step.WALLS_REPAIRED)
    found = find_outline(repaired.walls, draft.outline, height_m, options.close_gaps_m, report)
    report(Step.OUTLINE_FOUND)
    for settling_m in _SETTLING_M:
        storey = settled(found, draft.outline, height_m, settling_m)
        report(Step.WALLS_SETTLED)
        if storey is not None:
            changes = (*repaired.changes, *storey.changes, *_closed_by_reader(draft))
            closed_m = sum(line.length for line in draft.closed) + sum(
                dist(c.at, c.to) for c in storey.changes if c.kind == "closed" and c.to
            )
            storey = replace(storey, changes=changes)
            building = _with_openings(storey, openings, draft.origin, closed_m)
            report(Step.OPENINGS_ATTACHED)
            yield building


def _closed_by_reader(draft: Draft) -> Iterator[Change]:
    """Yield a change for each section of the outline that the reader has closed."""
    for line in draft.closed:
        start, end = _point(line.coords[0]), _point(line.coords[-1])
        if line.length <= _DETOUR * dist(start, end):
            text = f"opening of {line.length:.2f} m where known space ends, closed with walls"
            yield Change("closed", text, start, end)
        else:
            text = f"border of known space without a wall, {line.length:.2f} m, closed with walls"
            yield Change("closed", text, start)


def _point(xy: Sequence[float]) -> Point:
    return (float(xy[0]), float(xy[1]))


def _with_openings(
    storey: Storey, openings: Sequence[RawOpening], origin: Origin | None, closed_m: float
) -> Building:
    """Attach openings, in the plan's coordinates."""
    if origin is None:
        x, y, *_ = storey.outline.bounds
        origin = Origin(x, y, "the file, in metres")
        storey, openings = _moved(storey, openings, -x, -y)
    walls, dropped = attach_openings(storey.walls, openings, storey.outline)
    changes = (*storey.changes, *dropped)
    return Building(storey.outline, walls, changes, origin, storey.gaps, closed_m, storey.enclosed)


def _moved(
    storey: Storey, openings: Sequence[RawOpening], d_x: float, d_y: float
) -> tuple[Storey, list[RawOpening]]:
    """Translate a storey and openings by (d_x, d_y) [m]."""

    def to(point: Point) -> Point:
        return tidy_point(point[0] + d_x, point[1] + d_y)

    shift = np.array([d_x, d_y])
    moved = replace(
        storey,
        outline=shapely.transform(storey.outline, lambda xy: (xy + shift).round(DECIMALS)),
        walls=tuple(replace(w, start=to(w.start), end=to(w.end)) for w in storey.walls),
        changes=tuple(
            replace(change, at=to(change.at), to=to(change.to) if change.to else None)
            for change in storey.changes
        ),
        gaps=tuple((to(a), to(b)) for a, b in storey.gaps),
    )
    return moved, [replace(opening, centre=to(opening.centre)) for opening in openings]
