"""Ends of walls, moved to where they meet other walls."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import dist, hypot, radians, sin

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from floorplans.repair.geometry import (
    Change,
    along_across,
    line_crossing,
    moved_wall,
    tidy_point,
)
from floorplans.walls import TOLERANCE_M, Point, Wall, centre_lines

_MIN_SINE = sin(radians(15.0))
"""Sine of the smallest angle at which centre lines are prolonged to where they cross."""


@dataclass(frozen=True)
class _End:
    """An end of a wall: the wall's index, and 0 for its start or 1 for its end."""

    wall: int
    side: int


def snap_ends(walls: Sequence[Wall], reach_m: float, changes: list[Change]) -> tuple[Wall, ...]:
    """Move ends to the walls and ends they almost meet; drop walls this leaves without length.

    Parameters
    ----------
    walls : sequence of Wall
    reach_m : float
        Ends up to this far beyond a wall's body are moved to it [m].
    changes : list of Change
        Changes are appended here.

    Returns
    -------
    tuple of Wall
    """
    if not walls:
        return ()
    ends = np.array([(wall.start, wall.end) for wall in walls], dtype=np.float64)
    moved = _moved_to_walls(walls, ends, reach_m)
    moved = _moved_together(walls, moved, _on_walls(walls, moved), reach_m)
    return tuple(_walls_between(walls, ends, moved, reach_m, changes))


def _moved_to_walls(
    walls: Sequence[Wall], ends: NDArray[np.float64], reach_m: float
) -> NDArray[np.float64]:
    """Ends (n, 2, 2), each moved along its wall to the centre line of the wall it stands in."""
    lines = centre_lines(walls)
    points = _points(ends.reshape(-1, 2))
    far_m = 1.5 * (reach_m + max(wall.thickness_m for wall in walls) / 2)
    which, near = shapely.STRtree(lines).query(points, predicate="dwithin", distance=far_m)
    gaps = shapely.distance(points[which], lines[near])
    candidates: list[list[tuple[int, float]]] = [[] for _ in points]
    for i, j, gap in zip(which.tolist(), near.tolist(), gaps.tolist(), strict=True):
        if j != i // 2:
            candidates[i].append((j, gap))
    moved = ends.copy()
    for i, others in enumerate(candidates):
        end = _End(i // 2, i % 2)
        touched = [j for j, gap_m in others if gap_m <= TOLERANCE_M]
        if any(_inner(walls[j], ends[end.wall, end.side]) for j in touched):
            continue
        apart = [(j, gap_m) for j, gap_m in others if gap_m > TOLERANCE_M]
        moved[end.wall, end.side] = _meeting_point(walls, end, apart, reach_m, bool(touched))
    return moved


def _on_walls(walls: Sequence[Wall], ends: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Which ends (n, 2, 2) lie on another wall between its ends, (2 n,)."""
    points = _points(ends.reshape(-1, 2))
    which, near = shapely.STRtree(centre_lines(walls)).query(
        points, predicate="dwithin", distance=TOLERANCE_M
    )
    on = np.zeros(points.size, dtype=np.bool_)
    for i, j in zip(which.tolist(), near.tolist(), strict=True):
        on[i] |= j != i // 2 and _inner(walls[j], ends[i // 2, i % 2])
    return on


def _inner(wall: Wall, point: NDArray[np.float64]) -> bool:
    """Whether a point of a wall lies between its ends."""
    s, _ = along_across(wall, (float(point[0]), float(point[1])))
    return TOLERANCE_M < s < wall.length_m - TOLERANCE_M


def _points(ends: NDArray[np.float64]) -> NDArray[np.object_]:
    return np.array(shapely.points(ends), dtype=np.object_)


def _meeting_point(
    walls: Sequence[Wall],
    end: _End,
    others: Iterable[tuple[int, float]],
    reach_m: float,
    in_corner: bool,
) -> Point:
    """Where an end should be: the nearest crossing of its line with that of a nearby wall.

    An end that already meets another end moves no farther than the reach.
    """
    wall = walls[end.wall]
    here = wall.end if end.side else wall.start
    best, best_m = here, np.inf
    for j, gap_m in others:
        other = walls[j]
        meets = gap_m <= reach_m if in_corner else _in_body(wall, here, other, reach_m)
        if not meets:
            continue
        crossing = line_crossing(wall, other, _MIN_SINE)
        if crossing is None:
            continue
        move_m = dist(here, crossing)
        limit_m = reach_m + max(wall.thickness_m, other.thickness_m)
        if (
            move_m < min(best_m, limit_m)
            and _beside(other, crossing) <= reach_m + wall.thickness_m / 2
        ):
            best, best_m = tidy_point(*crossing), move_m
    return best


def _in_body(wall: Wall, end: Point, other: Wall, reach_m: float) -> bool:
    """Whether an end lies in another wall's body, or in the corner the two would form."""
    _, across = along_across(other, end)
    in_depth = abs(across) <= reach_m + other.thickness_m / 2
    return in_depth and _beside(other, end) <= reach_m + wall.thickness_m / 2


def _beside(wall: Wall, point: Point) -> float:
    """How far beyond the ends of a wall a point of its line lies; 0 between them [m]."""
    s, _ = along_across(wall, point)
    return max(-s, s - wall.length_m, 0.0)


def _moved_together(
    walls: Sequence[Wall], ends: NDArray[np.float64], fixed: NDArray[np.bool_], reach_m: float
) -> NDArray[np.float64]:
    """Ends (n, 2, 2); those closer together than the reach are moved to one, a fixed one if any."""
    flat = ends.reshape(-1, 2)
    points = _points(flat)
    first, second = shapely.STRtree(points).query(points, predicate="dwithin", distance=reach_m)
    graph = coo_array((np.ones(first.size), (first, second)), shape=(flat.shape[0],) * 2)
    _, labels = connected_components(graph, directed=False)
    order = np.argsort(labels, kind="stable")
    starts = np.flatnonzero(np.diff(labels[order])) + 1
    together = flat.copy()
    for members in np.split(order, starts):
        if members.size > 1 and np.ptp(flat[members], axis=0).max() > 0:
            anchors = members[fixed[members]]
            together[members] = (
                flat[anchors[0]] if anchors.size else _corner(walls, flat, members, reach_m)
            )
    return together.reshape(ends.shape)


def _corner(
    walls: Sequence[Wall], flat: NDArray[np.float64], members: NDArray[np.int64], reach_m: float
) -> Point:
    """Common point of ends: where the two longest walls cross, if that is near."""
    indices: list[int] = members.tolist()
    by_length = sorted(indices, key=lambda i: (-walls[i // 2].length_m, i))
    longest = by_length[0]
    here = (float(flat[longest][0]), float(flat[longest][1]))
    if np.ptp(flat[members], axis=0).max() <= TOLERANCE_M:
        return here
    for other in by_length[1:]:
        crossing = line_crossing(walls[longest // 2], walls[other // 2], _MIN_SINE)
        if crossing is not None and dist(crossing, here) <= 2 * reach_m:
            return tidy_point(*crossing)
    return here


def _walls_between(
    walls: Sequence[Wall],
    ends: NDArray[np.float64],
    moved: NDArray[np.float64],
    reach_m: float,
    changes: list[Change],
) -> Iterable[Wall]:
    """Walls between the moved ends; each change is recorded."""
    for wall, old, new in zip(walls, ends, moved, strict=True):
        start, end = (float(new[0][0]), float(new[0][1])), (float(new[1][0]), float(new[1][1]))
        if dist(start, end) <= max(min(reach_m, wall.length_m / 2), TOLERANCE_M):
            changes.append(Change("dropped", f"piece of {wall.length_m:.3g} m dropped", wall.start))
            continue
        if (start, end) == (wall.start, wall.end):
            yield wall
            continue
        for before, after in zip(old.tolist(), (start, end), strict=True):
            shift_m = hypot(after[0] - before[0], after[1] - before[1])
            if shift_m > TOLERANCE_M:
                text = f"end of a wall moved {shift_m:.2g} m"
                changes.append(Change("moved", text, (before[0], before[1]), after))
        yield moved_wall([wall], start, end)
