"""Doors and windows attached to their walls."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import shapely
from shapely.geometry import LineString, Point, Polygon
from shapely.geometry.base import BaseGeometry

from floorplans.importers.assembly.chords import glazed_chords, parts_on_chords
from floorplans.importers.centrelines.double_doors import LEAF_GAP_M, same_kind
from floorplans.importers.defaults import (
    DOOR_HEAD_M,
    DOOR_MATERIAL,
    DOOR_THICKNESS_M,
    WINDOW_HEAD_M,
    WINDOW_MATERIAL,
    WINDOW_SILL_M,
    WINDOW_THICKNESS_M,
)
from floorplans.importers.draft import RawOpening
from floorplans.repair.geometry import (
    DECIMALS,
    Change,
    along_across,
    direction,
    tidy_point,
)
from floorplans.walls import TOLERANCE_M, Opening, Wall, centre_lines
from floorplans.walls import Point as Point2

NO_WALL = "{kind} that lies in no wall dropped"
"""Text of the change that drops an opening."""

_BESIDE_M = 0.3
"""Largest distance from a wall's body to the middle of its opening [m]."""
_FRAME_M = 0.4
"""How far a gap may extend beyond an opening on each side [m]."""
_TOUCH_M = 0.05
_ON_EDGE_M = 1e-5
_MIN_FRACTION = 0.5
"""Fraction of an opening's width that must lie in its wall."""


class WallsWithOpenings(NamedTuple):
    """Walls with their openings, and the openings dropped for want of a wall."""

    walls: tuple[Wall, ...]
    changes: tuple[Change, ...]


def close_gaps(walls: Sequence[Wall], openings: Sequence[RawOpening]) -> tuple[Wall, ...]:
    """Close the gaps of walls that are interrupted at doors and windows.

    A gap is closed where an opening reaches from the end of a wall to the next collinear wall or to
    one across. The new wall has the properties of the longest collinear one. Chords of a curved
    wall that are glazed from end to end are closed as well (`glazed_chords`).

    Parameters
    ----------
    walls : sequence of Wall
    openings : sequence of RawOpening

    Returns
    -------
    tuple of Wall
        Those given, then the new ones.
    """
    if not walls:
        return ()
    tree = shapely.STRtree(centre_lines(walls))
    thickest_m = max(wall.thickness_m for wall in walls)
    new: list[Wall] = []
    for opening in openings:
        far_m = opening.width_m / 2 + thickest_m + _BESIDE_M
        near = sorted(tree.query(Point(opening.centre), "dwithin", distance=far_m).tolist())
        wall = _wall_in_gap(opening, [walls[i] for i in near])
        if wall is not None:
            new.append(wall)
    closed = (*walls, *new)
    return (*closed, *glazed_chords(closed, openings))


def _wall_in_gap(opening: RawOpening, near: Sequence[Wall]) -> Wall | None:
    """Wall in the gap that an opening spans; None where it lies in a wall or in no gap."""
    if any(_parts_on(opening, i, near, range(len(near))) for i in range(len(near))):
        return None
    in_line = [wall for wall in near if _is_in_line(opening, wall)]
    for wall in sorted(in_line, key=lambda wall: -wall.length_m):
        s, _ = along_across(wall, opening.centre)
        spans = [span for other in near if (span := _contact(wall, other)) is not None]
        left = max((span for span in spans if span.high <= s), key=lambda c: c.high, default=None)
        right = min((span for span in spans if span.low >= s), key=lambda c: c.low, default=None)
        slack_m = opening.width_m / 2 + _FRAME_M
        if left and right and s - left.high <= slack_m and right.low - s <= slack_m:
            start, end = _at(wall, left.gap_after), _at(wall, right.gap_before)
            filling = replace(wall, start=start, end=end, openings=())
            return filling if filling.length_m > TOLERANCE_M else None
    return None


@dataclass(frozen=True)
class _Contact:
    """Interval of a line that another wall occupies, and where gaps before and after it end."""

    low: float
    high: float
    gap_before: float
    gap_after: float


def _contact(line: Wall, other: Wall) -> _Contact | None:
    """Where a wall along or across another one meets its line; None if it does not."""
    ends = [along_across(line, end) for end in (other.start, other.end)]
    (s0, t0), (s1, t1) = ends
    if max(abs(t0), abs(t1)) < (line.thickness_m + other.thickness_m) / 2:
        low, high = min(s0, s1), max(s0, s1)
        return _Contact(low, high, gap_before=low, gap_after=high)
    slack_m = other.thickness_m / 2 + _TOUCH_M
    if min(t0, t1) > slack_m or max(t0, t1) < -slack_m or abs(t1 - t0) < TOLERANCE_M:
        return None
    s = s0 + (s1 - s0) * min(max(-t0 / (t1 - t0), 0.0), 1.0)
    half_m = other.thickness_m / 2
    return _Contact(s - half_m, s + half_m, gap_before=s, gap_after=s)


def _at(wall: Wall, s: float) -> Point2:
    """Point at a distance along a wall's line, also before its start or beyond its end."""
    ux, uy = direction(wall)
    return tidy_point(wall.start[0] + s * ux, wall.start[1] + s * uy)


def _is_in_line(opening: RawOpening, wall: Wall) -> bool:
    """Whether an opening runs along a wall, with its middle beside the wall's line."""
    _, across = along_across(wall, opening.centre)
    beside = abs(across) <= wall.thickness_m / 2 + _BESIDE_M
    return beside and opening.is_along(direction(wall))


def _parts_on(
    opening: RawOpening, host: int, walls: Sequence[Wall], near: Sequence[int]
) -> list[tuple[int, RawOpening]]:
    """Parts of an opening on a wall and the chords that continue it.

    Empty unless the opening is in line with the wall, with its middle on it and half its width on
    all of them.
    """
    s, _ = along_across(walls[host], opening.centre)
    if not (0 <= s <= walls[host].length_m and _is_in_line(opening, walls[host])):
        return []
    parts = parts_on_chords(opening, host, walls, near)
    covered_m = sum(_overlap_m(part, walls[i]) for i, part in parts)
    return parts if covered_m > _MIN_FRACTION * opening.width_m else []


def _overlap_m(opening: RawOpening, wall: Wall) -> float:
    """Width of an opening that lies on a wall."""
    s, _ = along_across(wall, opening.centre)
    return min(s + opening.width_m / 2, wall.length_m) - max(s - opening.width_m / 2, 0.0)


def attach_openings(
    walls: Sequence[Wall], openings: Sequence[RawOpening], outline: Polygon
) -> WallsWithOpenings:
    """Attach openings to the walls they lie in.

    Parameters
    ----------
    walls : sequence of Wall
    openings : sequence of RawOpening
        Doors before windows: of two that overlap, the earlier one stays.
    outline : shapely.geometry.Polygon
        Doors on its edge are filled.

    Returns
    -------
    WallsWithOpenings
    """
    tree = shapely.STRtree(centre_lines(walls))
    thickest_m = max(wall.thickness_m for wall in walls)
    changes: list[Change] = []
    by_wall: list[list[Opening]] = [list(wall.openings) for wall in walls]
    edge = outline.boundary.buffer(_ON_EDGE_M)
    for raw in openings:
        far_m = raw.width_m / 2 + thickest_m / 2 + _BESIDE_M
        near = tree.query(Point(raw.centre), "dwithin", distance=far_m).tolist()
        hosts = {i: parts for i in near if (parts := _parts_on(raw, i, walls, near))}
        if not hosts:
            changes.append(Change("dropped", NO_WALL.format(kind=raw.kind), raw.centre))
            continue
        i = min(hosts, key=lambda i: (abs(along_across(walls[i], raw.centre)[1]), i))
        for k, part in hosts[i]:
            _add(by_wall[k], _opening(part, walls[k], edge))
    attached = tuple(
        replace(wall, openings=tuple(sorted(own, key=lambda o: (o.offset_m, o.sill_m))))
        for wall, own in zip(walls, by_wall, strict=True)
    )
    return WallsWithOpenings(attached, tuple(changes))


def _opening(raw: RawOpening, wall: Wall, edge: BaseGeometry) -> Opening:
    """Opening of a wall, with defaults for what the file does not state."""
    s, _ = along_across(wall, raw.centre)
    low, high = max(s - raw.width_m / 2, 0.0), min(s + raw.width_m / 2, wall.length_m)
    low, high = tidy_point(low, high)
    window = raw.kind == "window"
    head_m = raw.head_m or (WINDOW_HEAD_M if window else DOOR_HEAD_M)
    head_m = min(head_m, wall.height_m)
    sill_m = (WINDOW_SILL_M if window else 0.0) if raw.sill_m is None else max(raw.sill_m, 0.0)
    material, thickness_m = raw.material, raw.thickness_m
    if material is None and window:
        material, thickness_m = WINDOW_MATERIAL, thickness_m or WINDOW_THICKNESS_M
    elif material is None and _on_edge(wall, low, high, edge):
        material, thickness_m = DOOR_MATERIAL, thickness_m or DOOR_THICKNESS_M
    return Opening(
        offset_m=low,
        width_m=round(high - low, DECIMALS),
        sill_m=sill_m if sill_m < head_m else 0.0,
        head_m=head_m,
        kind=raw.kind,
        material=material,
        thickness_m=thickness_m if material is not None else None,
    )


def _on_edge(wall: Wall, low: float, high: float, edge: BaseGeometry) -> bool:
    """Whether a section of a wall lies on the edge of the outline."""
    section = LineString([wall.point_at(low), wall.point_at(high)])
    return edge.intersection(section).length > 3 * _ON_EDGE_M


def _add(openings: list[Opening], new: Opening) -> None:
    """Add an opening to those of a wall: joined with one of its kind, dropped where it overlaps."""
    for i, old in enumerate(openings):
        apart_m = max(old.offset_m, new.offset_m) - min(old.end_m, new.end_m)
        if apart_m <= LEAF_GAP_M and same_kind(old, new):
            low, high = min(old.offset_m, new.offset_m), max(old.end_m, new.end_m)
            openings.pop(i)
            _add(openings, replace(old, offset_m=low, width_m=high - low))
            return
    if not any(new.overlaps(old) for old in openings):
        openings.append(new)
