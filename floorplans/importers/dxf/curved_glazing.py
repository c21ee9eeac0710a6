"""Lines of windows on curves, and several lines of one window."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise
from math import radians, sin

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import LineString
from shapely.geometry.base import BaseGeometry

from floorplans.importers.centrelines.areas import box_sides
from floorplans.importers.centrelines.sections import linestrings
from floorplans.importers.draft import CURVE_COSINE, RawOpening
from floorplans.walls import TOLERANCE_M

PAIR_M = 0.6
"""Largest distance between the two lines of a wall [m]."""
IN_WALL_M = 0.05
"""Lines as near to a wall lie in it [m]."""
_BENT_M = 0.15
"""A line that leaves its chord farther is no straight window [m]."""
_PARALLEL = sin(radians(6.0))
_APART_M = 0.005
"""Least distance between two lines of a window; nearer ones are the same line [m]."""
_TOUCH_M = 0.02
_MOSTLY = 0.9
"""Fraction of a curved window's lines within a wall from which on it lies in it."""
_JAMB_M = 0.3
"""Shorter lines of a curved window are jambs and caps [m]."""


def smooth_pieces(line: LineString) -> list[LineString]:
    """Divide a line at its corners; a curve of chords stays whole."""
    points = shapely.get_coordinates(shapely.remove_repeated_points(line))
    steps = np.diff(points, axis=0)
    along = steps / np.hypot(steps[:, 0], steps[:, 1])[:, None]
    corners = 1 + np.flatnonzero(np.sum(along[:-1] * along[1:], axis=1) < CURVE_COSINE)
    stops = [0, *corners.tolist(), len(points) - 1]
    return [LineString(points[low : high + 1]) for low, high in pairwise(stops)]


def is_bent(lines: Sequence[LineString]) -> bool:
    """Whether lines of windows, without corners, follow a curve together or one by one."""
    chords = [LineString([line.coords[0], line.coords[-1]]) for line in lines]
    if max(map(shapely.hausdorff_distance, lines, chords), default=0.0) > _BENT_M:
        return True
    depth_m, _ = box_sides(shapely.multilinestrings(_middle_lines(lines)))
    return depth_m > 2 * _BENT_M


def is_curve_in_wall(lines: Sequence[LineString], area: BaseGeometry) -> bool:
    """Whether lines of a window that form no straight opening lie within a wall nearly all along.

    The ends of a curve may reach into what it meets.
    """
    wide = area.buffer(IN_WALL_M)
    inside_m = sum(line.intersection(wide).length for line in lines)
    return inside_m > _MOSTLY * sum(line.length for line in lines)


def along_curve(lines: Sequence[LineString]) -> Iterator[RawOpening]:
    """Windows on the chords of curves: of several lines beside each other, the middle one.

    Lines of windows one after the other, with narrow mullions between them, are windows each.
    """
    for line in _middle_lines(lines):
        for (ax, ay), (bx, by) in pairwise(shapely.get_coordinates(line).tolist()):
            yield RawOpening.between((ax, ay), (bx, by), "window")


def _middle_lines(lines: Sequence[LineString]) -> list[LineString]:
    """One of each set of lines beside each other, of middle length, without jambs and caps."""
    left = sorted((line for line in lines if line.length > _JAMB_M), key=_length_m)
    middle: list[LineString] = []
    while left:
        longest = left[-1]
        band = longest.buffer(PAIR_M, cap_style="flat").buffer(IN_WALL_M)
        beside = [line for line in left if line.intersection(band).length > line.length / 2]
        long = [line for line in beside if line.length > longest.length / 2]
        middle.append(long[len(long) // 2])
        left = [line for line in left if line not in beside]
    return middle


def _length_m(line: LineString) -> float:
    return float(line.length)


def without_caps(lines: Sequence[LineString]) -> list[LineString]:
    """Lines of windows without the short ones across that end panes and frames."""
    tree = shapely.STRtree(lines)
    return [
        line
        for line in lines
        if line.length > PAIR_M
        or not _is_cap(line, [lines[i] for i in tree.query(line, "dwithin", distance=_TOUCH_M)])
    ]


def _is_cap(cap: LineString, near: Sequence[LineString]) -> bool:
    """Whether a longer line ends at the middle of a line, or two on one side at both its ends."""
    (x0, y0), (x1, y1) = cap.coords[0], cap.coords[-1]
    ux, uy = (x1 - x0) / cap.length, (y1 - y0) / cap.length
    met: set[tuple[bool, bool]] = set()
    for line in near:
        if line.length <= cap.length:
            continue
        s = cap.project(shapely.shortest_line(cap, line).interpolate(0.0))
        beside = line.interpolate(0.5, normalized=True)
        across = ux * (beside.y - y0) - uy * (beside.x - x0)
        if abs(across) < line.length / 4:
            continue
        if _TOUCH_M < s < cap.length - _TOUCH_M:
            return True
        met.add((s > cap.length / 2, across > 0))
    return any({(False, side), (True, side)} <= met for side in (False, True))


def between_others(segments: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Which segments (n, 2, 2) have nearly parallel ones on both sides, `PAIR_M` apart or less.

    A window drawn as three lines or more has its panes between those of its frame.
    """
    steps = segments[:, 1] - segments[:, 0]
    lengths = np.hypot(steps[:, 0], steps[:, 1])[:, None]
    along = steps / np.maximum(lengths, TOLERANCE_M)
    across = np.stack([-along[:, 1], along[:, 0]], axis=1) * PAIR_M
    middle = segments.mean(axis=1)
    probes = linestrings(np.stack([middle - across, middle + across], axis=1))
    lines = linestrings(segments)
    i, j = shapely.STRtree(lines).query(probes, predicate="intersects")
    sine = along[i, 0] * along[j, 1] - along[i, 1] * along[j, 0]
    i, j = (k[(np.abs(sine) < _PARALLEL) & (i != j)] for k in (i, j))
    hits = shapely.get_coordinates(shapely.centroid(shapely.intersection(probes[i], lines[j])))
    aside = np.sum((hits - middle[i]) * across[i], axis=1) / PAIR_M
    left, right = np.full(len(segments), np.inf), np.full(len(segments), np.inf)
    np.minimum.at(left, i[aside > _APART_M], aside[aside > _APART_M])
    np.minimum.at(right, i[aside < -_APART_M], -aside[aside < -_APART_M])
    return left + right <= PAIR_M
