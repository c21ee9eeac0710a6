"""Repair of walls as drawings leave them: ends that almost meet, duplicate walls.

Two walls should meet where an end of one lies in the body of the other, or within a small reach of
it: the end is moved along its wall to where the centre lines cross. Walls that run along each other
within that reach are merged.

    merge walls that run along each other        collinear
    move ends to where centre lines cross        ends
    repeat until nothing changes

Openings stay where they are in the plan.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from scipy.spatial import KDTree

from floorplans.repair.collinear import THICKNESS_FRACTION, merge_lines
from floorplans.repair.ends import snap_ends
from floorplans.repair.geometry import Change, moved_wall, points_on_walls
from floorplans.walls import TOLERANCE_M, Opening, Wall

__all__ = ["Change", "RepairedWalls", "repair_walls", "split_at_junctions"]

REACH_M = 0.05
"""By default, gaps up to this width are closed [m]."""

_MAX_PASSES = 8


class RepairedWalls(NamedTuple):
    """Repaired walls, and the changes in order."""

    walls: tuple[Wall, ...]
    changes: tuple[Change, ...]


def repair_walls(
    walls: Sequence[Wall],
    reach_m: float = REACH_M,
    thickness_fraction: float = 0.0,
    sideways_fraction: float = THICKNESS_FRACTION,
) -> RepairedWalls:
    """Make walls meet that almost meet, and merge walls that run along each other.

    Parameters
    ----------
    walls : sequence of Wall
    reach_m : float
        Gaps up to this width are closed, and shorter pieces dropped [m].
    thickness_fraction : float
        Collinear walls are joined where their thicknesses differ by at most this fraction; the
        joined wall has their mean thickness, weighted by length.
    sideways_fraction : float
        Fraction of its thickness by which a wall may be moved sideways, besides the reach.

    Returns
    -------
    RepairedWalls
        The walls are those given, unchanged, where there is nothing to repair.

    Examples
    --------
    >>> wall = Wall((0, 0), (4, 0), "brick", 0.2, 3)
    >>> repair_walls([wall, Wall((2, 0.03), (2, 5), "brick", 0.2, 3)]).changes[0]
    Change(kind='moved', text='end of a wall moved 0.03 m', at=(2.0, 0.03), to=(2.0, 0.0))
    """
    repaired = tuple(walls)
    changes: list[Change] = []
    for _ in range(_MAX_PASSES):
        before = len(changes)
        repaired = merge_lines(repaired, reach_m, thickness_fraction, changes, sideways_fraction)
        repaired = snap_ends(repaired, reach_m, changes)
        if len(changes) == before:
            break
    return RepairedWalls(repaired, tuple(changes))


def split_at_junctions(walls: Sequence[Wall]) -> tuple[Wall, ...]:
    """Split walls where others end on them or cross them, but not within an opening.

    Parameters
    ----------
    walls : sequence of Wall

    Returns
    -------
    tuple of Wall
        The same sheets, in pieces that touch only at their ends (except at openings).
    """
    pieces: list[Wall] = []
    for wall, cuts in zip(walls, points_on_walls(walls), strict=True):
        stops = _stops(wall, cuts)
        if len(stops) == 2:
            pieces.append(wall)
            continue
        for low, high in pairwise(stops):
            pieces.append(moved_wall([wall], wall.point_at(low), wall.point_at(high)))
    return _meeting_exactly(pieces)


def _meeting_exactly(walls: Sequence[Wall]) -> tuple[Wall, ...]:
    """Give ends that differ only by rounding identical coordinates."""
    ends = np.array([end for wall in walls for end in (wall.start, wall.end)]).reshape(-1, 2)
    same = np.arange(len(ends))
    for i, j in sorted(KDTree(ends).query_pairs(TOLERANCE_M)) if len(ends) else ():
        same[j] = min(same[j], same[i])
    points = [(float(x), float(y)) for x, y in ends[same]]
    pairs = zip(walls, points[::2], points[1::2], strict=True)
    return tuple(
        wall if (start, end) == (wall.start, wall.end) else replace(wall, start=start, end=end)
        for wall, start, end in pairs
    )


def _stops(wall: Wall, cuts: Iterable[float]) -> list[float]:
    """Where to split a wall, with its ends: each place once, and none within an opening."""
    stops = [0.0]
    for s in sorted(cuts):
        apart = min(s - stops[-1], wall.length_m - s) > TOLERANCE_M
        if apart and not any(_spans(opening, s) for opening in wall.openings):
            stops.append(s)
    return [*stops, wall.length_m]


def _spans(opening: Opening, s: float) -> bool:
    return opening.offset_m + TOLERANCE_M < s < opening.end_m - TOLERANCE_M
