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
from scipy.spatial import KDTree

from floorplans.repair.geometry import (
    Change,
    along_across,
    line_crossing,
    moved_wall,
    tidy_point,
)
from floorplans.walls import TOLERANCE_M, Point, Wall, centre_lines

_TINY_M = 0.01
_MIN_SINE = sin(radians(15.0))
"""Sine of the smallest angle at which centre lines are prolonged to where they cross."""
_WIDER = 1.01
"""So many times the distance is looked up, as distances are rounded."""


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
    """Ends (n, 2, 2), each moved along its wall to the centre line of the wall it stands in.

    An end that already meets another end moves no farther than the reach.
    """
    points = ends.reshape(-1, 2)
    thickness_m = np.array([wall.thickness_m for wall in walls])
    near = _near_walls(walls, points, reach_m, 1.0)
    touched = near.gap_m <= TOLERANCE_M
    is_settled = _any_of_each(near.end, touched & near.is_inner, len(points))
    in_corner = _any_of_each(near.end, touched, len(points))
    in_body = (near.across_m <= reach_m + thickness_m[near.wall] / 2) & (
        near.beside_m <= reach_m + thickness_m[near.end // 2] / 2
    )
    meets = np.where(in_corner[near.end], near.gap_m <= reach_m, in_body)
    used = meets & ~touched & ~is_settled[near.end]
    others: dict[int, list[int]] = {}
    for i, j in zip(near.end[used].tolist(), near.wall[used].tolist(), strict=True):
        others.setdefault(i, []).append(j)
    moved = ends.copy()
    for i, met in others.items():
        end = _End(i // 2, i % 2)
        moved[end.wall, end.side] = _meeting_point(walls, end, met, reach_m)
    return moved


@dataclass(frozen=True)
class _NearWalls:
    """Pairs of an end, counted over all walls, and another wall near it, each (n,).

    Attributes
    ----------
    end, wall : int64
    gap_m, across_m : float64
        Distance from the wall's centre line, and from the infinite line [m].
    beside_m : float64
        How far beyond the ends of the wall the end lies; 0 between them [m].
    is_inner : bool
        Whether it lies between them, not at one.
    """

    end: NDArray[np.int64]
    wall: NDArray[np.int64]
    gap_m: NDArray[np.float64]
    across_m: NDArray[np.float64]
    beside_m: NDArray[np.float64]
    is_inner: NDArray[np.bool_]


def _near_walls(
    walls: Sequence[Wall], points: NDArray[np.float64], reach_m: float, body: float
) -> _NearWalls:
    """Other walls near the ends, which lie at points (2 n, 2).

    The reach is counted from the walls' bodies if `body` is 1, from their centre lines if it is 0.
    """
    lines, ends = centre_lines(walls), _points(points)
    thickness_m = np.array([max(wall.thickness_m, 0.0) for wall in walls])  # as drawn, unchecked
    across_m = reach_m + body * thickness_m / 2
    pairs: list[NDArray[np.int64]] = []
    for among in _alike(across_m):
        distance_m = _WIDER * np.hypot(across_m[among].max(), across_m).repeat(2)
        end, near = shapely.STRtree(lines[among]).query(ends, "dwithin", distance=distance_m)
        pairs.append(np.stack([end, among[near]]))
    end, near = np.concatenate(pairs, axis=1)
    order = np.lexsort((near, end))
    end, near = end[order], near[order]
    end, near = (x[near != end // 2] for x in (end, near))
    start, stop = np.array([(wall.start, wall.end) for wall in walls]).transpose(1, 0, 2)
    step = (stop - start)[near]
    length_m = np.hypot(step[:, 0], step[:, 1])
    u_x, u_y = (step / np.where(length_m > 0, length_m, 1.0)[:, None]).T
    x, y = (points[end] - start[near]).T
    along_m = x * u_x + y * u_y
    return _NearWalls(
        end,
        near,
        gap_m=np.array(shapely.distance(ends[end], lines[near])),
        across_m=np.abs(u_x * y - u_y * x),
        beside_m=np.maximum(np.maximum(-along_m, along_m - length_m), 0.0),
        is_inner=(along_m > TOLERANCE_M) & (along_m < length_m - TOLERANCE_M),
    )


def _alike(sizes: NDArray[np.float64]) -> list[NDArray[np.int64]]:
    """Indices of sizes that differ by less than a factor of two."""
    octave = np.floor(np.log2(sizes))
    return [np.flatnonzero(octave == k) for k in np.unique(octave)]


def _any_of_each(which: NDArray[np.int64], flags: NDArray[np.bool_], n: int) -> NDArray[np.bool_]:
    """Whether any flag of each number below n is set, (n,)."""
    return np.bincount(which[flags], minlength=n) > 0


def _on_walls(walls: Sequence[Wall], ends: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Which ends (n, 2, 2) lie on another wall between its ends, (2 n,)."""
    points = ends.reshape(-1, 2)
    near = _near_walls(walls, points, TOLERANCE_M, 0.0)
    return _any_of_each(near.end, near.is_inner, len(points))


def _points(ends: NDArray[np.float64]) -> NDArray[np.object_]:
    return np.array(shapely.points(ends), dtype=np.object_)


def _meeting_point(
    walls: Sequence[Wall], end: _End, others: Iterable[int], reach_m: float
) -> Point:
    """Where an end should be: the nearest crossing of its line with that of a wall it meets."""
    wall = walls[end.wall]
    here = wall.end if end.side else wall.start
    best, best_m = here, np.inf
    for other in (walls[j] for j in others):
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


def _beside(wall: Wall, point: Point) -> float:
    """How far beyond the ends of a wall a point of its line lies; 0 between them [m]."""
    s, _ = along_across(wall, point)
    return max(-s, s - wall.length_m, 0.0)


def _moved_together(
    walls: Sequence[Wall], ends: NDArray[np.float64], fixed: NDArray[np.bool_], reach_m: float
) -> NDArray[np.float64]:
    """Ends (n, 2, 2); those closer together than the reach are moved to one, a fixed one if any."""
    flat = ends.reshape(-1, 2)
    first, second = KDTree(flat).query_pairs(reach_m, output_type="ndarray").T
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
            size = f"{wall.length_m:.2f}" if wall.length_m >= _TINY_M else f"under {_TINY_M:g}"
            changes.append(Change("dropped", f"piece of {size} m dropped", wall.start))
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
