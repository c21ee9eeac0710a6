"""Collinear walls: those that overlap or continue each other are merged.

This works on finished walls with materials, heights and openings. Imported centre lines, which have
none yet and lie less exactly, are joined before by `floorplans.importers.centrelines.axes`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from math import dist, radians, sin

import numpy as np
import shapely

from floorplans.repair.geometry import (
    Change,
    along_across,
    direction,
    moved_wall,
    tidy_point,
)
from floorplans.walls import TOLERANCE_M, Interval, Opening, Wall, centre_lines

_MAX_SINE = sin(radians(3.0))
"""Sine of the largest angle between collinear walls."""
THICKNESS_FRACTION = 0.25
"""Walls whose centre lines are nearer than this fraction of their thickness are collinear."""
_SAME_THICKNESS_M = 1e-3


@dataclass(frozen=True)
class _Piece:
    """A wall of a group, and the interval of the group's line it lies on [m]."""

    wall: Wall
    span: Interval


def merge_lines(
    walls: Sequence[Wall],
    reach_m: float,
    thickness_fraction: float,
    changes: list[Change],
    sideways_fraction: float = THICKNESS_FRACTION,
) -> tuple[Wall, ...]:
    """Merge collinear walls, so that no two walls run along each other.

    Parameters
    ----------
    walls : sequence of Wall
    reach_m : float
        Gaps in the line up to this width are closed, and walls moved sideways by up to it [m].
    thickness_fraction : float
        Walls are joined where their thicknesses differ by at most this fraction.
    changes : list of Change
        Changes are appended here.
    sideways_fraction : float
        Fraction of its thickness by which a wall may also be moved sideways.

    Returns
    -------
    tuple of Wall
    """
    merged: list[Wall] = []
    for group in sorted(_groups(walls, reach_m, sideways_fraction), key=min):
        if len(group) == 1:
            merged.append(walls[group[0]])
        else:
            merged += _one_line([walls[i] for i in group], reach_m, thickness_fraction, changes)
    return tuple(merged)


def _groups(walls: Sequence[Wall], reach_m: float, sideways_fraction: float) -> Iterator[list[int]]:
    """Indices of the walls of each line, the longest wall first."""
    thickest = max((wall.thickness_m for wall in walls), default=0.0)
    near = _nearly_parallel(walls, reach_m + sideways_fraction * thickest)
    free = set(range(len(walls)))
    for leader in sorted(free, key=lambda i: (-walls[i].length_m, i)):
        if leader not in free:
            continue
        free.remove(leader)
        group, todo = [leader], [leader]
        while todo:
            members = [i for i in near[todo.pop()] if i in free]
            for i in members:
                sideways_m = reach_m + sideways_fraction * min(
                    walls[leader].thickness_m, walls[i].thickness_m
                )
                members_here = [walls[k] for k in group]
                if _in_line(walls[leader], walls[i], members_here, reach_m, sideways_m):
                    free.remove(i)
                    group.append(i)
                    todo.append(i)
        yield group


def _nearly_parallel(walls: Sequence[Wall], distance_m: float) -> list[list[int]]:
    """Walls within a distance of each wall that two lines of one group may have, in order."""
    lines = centre_lines(walls)
    along = np.array([direction(wall) for wall in walls]).reshape(-1, 2)
    around = shapely.box(*(shapely.bounds(lines) + distance_m * np.array([-1, -1, 1, 1])).T)
    first, second = shapely.STRtree(lines).query(around)
    sines = along[first, 0] * along[second, 1] - along[first, 1] * along[second, 0]
    kept = (np.abs(sines) <= 2 * _MAX_SINE) & (first != second)
    first, second = first[kept], second[kept]
    kept = np.array(shapely.dwithin(lines[first], lines[second], distance_m), dtype=np.bool_)
    near: list[list[int]] = [[] for _ in walls]
    order = np.lexsort((second[kept], first[kept]))
    for i, j in zip(first[kept][order].tolist(), second[kept][order].tolist(), strict=True):
        near[i].append(j)
    return near


def _in_line(
    leader: Wall, wall: Wall, group: Sequence[Wall], reach_m: float, sideways_m: float
) -> bool:
    """Whether a wall lies on the leader's line and touches the group, up to the reach."""
    (ux, uy), (vx, vy) = direction(leader), direction(wall)
    if abs(ux * vy - uy * vx) > _MAX_SINE:
        return False
    offsets = [along_across(leader, end) for end in (wall.start, wall.end)]
    if max(abs(across) for _, across in offsets) > sideways_m:
        return False
    low, high = sorted(s for s, _ in offsets)
    spans = (_span(leader, member) for member in group)
    return any(low <= top + reach_m and high >= bottom - reach_m for bottom, top in spans)


def _span(leader: Wall, wall: Wall) -> Interval:
    low, high = sorted(along_across(leader, end)[0] for end in (wall.start, wall.end))
    return (low, high)


def _one_line(
    group: Sequence[Wall], reach_m: float, thickness_fraction: float, changes: list[Change]
) -> list[Wall]:
    """Walls of one line, moved onto it without overlap; equal neighbours merged."""
    leader = group[0]
    pieces = [_Piece(wall, _span(leader, wall)) for wall in group]
    runs = _joined(_owners(pieces, reach_m), thickness_fraction)
    walls = [_wall_on(leader, span, owners, pieces) for span, owners in runs]
    if _same(walls, group):
        return list(group)
    text = f"{len(group)} collinear walls merged into {len(walls)}"
    changes.append(Change("joined", text, walls[0].start, walls[-1].end))
    return walls


def _owners(pieces: Sequence[_Piece], reach_m: float) -> Iterator[tuple[Interval, _Piece]]:
    """Sections of the line with the thickest wall on each; those up to the reach join the last."""
    stops = sorted({stop for piece in pieces for stop in piece.span})
    last: tuple[Interval, _Piece] | None = None
    for low, high in pairwise(stops):
        middle = (low + high) / 2
        here = [piece for piece in pieces if piece.span[0] <= middle <= piece.span[1]]
        if not here and (last is None or high - low > reach_m):
            continue
        owner = max(here, key=_rank) if here else last[1] if last else pieces[0]
        short = high - low <= reach_m and last is not None and last[0][1] == low
        if last is not None and (short or owner is last[1]) and last[0][1] == low:
            last = ((last[0][0], high), last[1])
            continue
        if last is not None:
            yield last
        last = ((low, high), owner)
    if last is not None:
        yield last


def _rank(piece: _Piece) -> tuple[float, float, float]:
    return (piece.wall.height_m, piece.wall.thickness_m, piece.wall.length_m)


def _joined(
    sections: Iterator[tuple[Interval, _Piece]], thickness_fraction: float
) -> list[tuple[Interval, list[tuple[float, Wall]]]]:
    """Runs of sections whose walls are alike, with the length of each wall in them."""
    runs: list[tuple[Interval, list[tuple[float, Wall]]]] = []
    for (low, high), piece in sections:
        part = (high - low, piece.wall)
        if (
            runs
            and runs[-1][0][1] == low
            and _alike(runs[-1][1][-1][1], piece.wall, thickness_fraction)
        ):
            runs[-1] = ((runs[-1][0][0], high), [*runs[-1][1], part])
        else:
            runs.append(((low, high), [part]))
    return runs


def _alike(a: Wall, b: Wall, thickness_fraction: float) -> bool:
    allowed_m = max(_SAME_THICKNESS_M, thickness_fraction * max(a.thickness_m, b.thickness_m))
    return (
        (a.material, a.kind) == (b.material, b.kind)
        and abs(a.height_m - b.height_m) < TOLERANCE_M
        and abs(a.thickness_m - b.thickness_m) <= allowed_m
    )


def _wall_on(
    leader: Wall, span: Interval, owners: list[tuple[float, Wall]], pieces: Sequence[_Piece]
) -> Wall:
    """Create the wall of a run, with the openings whose middles lie on it."""
    start, end = (_point_on(leader, s) for s in span)
    first = owners[0][1]
    total_m = sum(length_m for length_m, _ in owners)
    mean_m = sum(length_m * wall.thickness_m for length_m, wall in owners) / total_m
    same = all(wall.thickness_m == first.thickness_m for _, wall in owners)
    model = replace(first, thickness_m=first.thickness_m if same else round(mean_m, 3))
    bare = replace(model, start=start, end=end, openings=())
    parts = [_with_openings_on(piece.wall, bare) for piece in pieces]
    return moved_wall([replace(model, openings=()), *parts], start, end)


def _with_openings_on(wall: Wall, bare: Wall) -> Wall:
    """Keep only the openings of a wall whose middles lie beside another wall."""
    if not wall.openings:
        return wall

    def beside(opening: Opening) -> bool:
        middle = wall.point_at(opening.offset_m + opening.width_m / 2)
        return 0 <= along_across(bare, middle)[0] <= bare.length_m

    return replace(wall, openings=tuple(filter(beside, wall.openings)))


def _point_on(leader: Wall, s: float) -> tuple[float, float]:
    if abs(s) < TOLERANCE_M:
        return leader.start
    if abs(s - leader.length_m) < TOLERANCE_M:
        return leader.end
    ux, uy = direction(leader)
    return tidy_point(leader.start[0] + s * ux, leader.start[1] + s * uy)


def _same(walls: Sequence[Wall], group: Sequence[Wall]) -> bool:
    """Whether each wall coincides with one of the group and has the same properties."""

    def near(a: Wall, b: Wall) -> bool:
        straight = max(dist(a.start, b.start), dist(a.end, b.end))
        turned = max(dist(a.start, b.end), dist(a.end, b.start))
        same_properties = (a.material, a.kind, a.thickness_m, a.height_m) == (
            b.material,
            b.kind,
            b.thickness_m,
            b.height_m,
        )
        return same_properties and min(straight, turned) <= 2 * TOLERANCE_M

    return len(walls) == len(group) and all(any(near(a, b) for b in group) for a in walls)
