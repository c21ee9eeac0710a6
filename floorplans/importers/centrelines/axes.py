"""Nearly collinear centre lines, put on one line and joined, before they become walls."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import LineString
from shapely.geometry.base import BaseGeometry

from floorplans.walls import Point

_SAME_DIRECTION = np.cos(np.radians(4.0))
_DUPLICATE_DIRECTION = np.cos(np.radians(12.0))
_DUPLICATE_FRACTION = (
    0.5  # of an axis beside a longer one, within the wall, that makes it a duplicate
)
_OFFSET_FRACTION = 0.4  # of the thicker wall's thickness between collinear axes
_LIKE = 1.4  # ratio of thicknesses up to which two sections of a line are one wall
_ACROSS_M = 1.0  # gap up to which a short section is joined: the thickness of a wall across
_EDGE_M = 0.01  # beside the ends of a gap, which are edges of the solid
_SHORT = 2.0  # times its thickness: a shorter section takes the thickness of its neighbour


def point_of(xy: NDArray[np.float64]) -> Point:
    """Coordinates (2,) as a point."""
    return (float(xy[0]), float(xy[1]))


_IsWall = Callable[[float, float, float], bool]


@dataclass(frozen=True)
class Axis:
    """A straight centre line [m] with the thickness of its wall [m].

    `is_filling` marks that of a door or window, which may be thinner than its wall.
    """

    start: Point
    end: Point
    thickness_m: float
    is_filling: bool = False

    @property
    def vector(self) -> NDArray[np.float64]:
        """From start to end, (2,) [m]."""
        return np.array(self.end) - np.array(self.start)

    @property
    def length_m(self) -> float:
        """Length [m]."""
        return float(np.hypot(*self.vector))


@dataclass(frozen=True)
class _Section:
    """Part of a line from `low` to `high` along it [m]."""

    low: float
    high: float
    thickness_m: float
    is_filling: bool

    @property
    def length_m(self) -> float:
        return self.high - self.low


def on_common_lines(axes: list[Axis], solid: BaseGeometry) -> list[Axis]:
    """Put axes on common lines, and join those of similar thickness with only solid between them.

    Parameters
    ----------
    axes : list of Axis
    solid : shapely geometry
        All walls [m].

    Returns
    -------
    list of Axis
    """
    shapely.prepare(solid)
    return _without_duplicates([a for group in _groups(axes) for a in _on_one_line(group, solid)])


def _groups(axes: list[Axis]) -> list[list[Axis]]:
    """Group axes that are nearly collinear with the longest of them."""
    groups: list[list[Axis]] = []
    leaders = _Lines(len(axes))
    for axis in sorted(axes, key=lambda axis: -axis.length_m):
        parallel = np.abs(leaders.along @ axis.vector) >= _SAME_DIRECTION * axis.length_m
        apart = _OFFSET_FRACTION * np.maximum(leaders.thickness_m, axis.thickness_m)
        near = np.flatnonzero(parallel & (leaders.beside(axis) <= apart))
        if near.size:
            groups[int(near[0])].append(axis)
        else:
            groups.append([axis])
            leaders.add(axis)
    return groups


class _Lines:
    """Growing arrays of the lines of axes.

    Attributes
    ----------
    start, along : (n, 2) float64
        One end [m], and the unit vector.
    length_m, thickness_m : (n,) float64
    """

    def __init__(self, capacity: int) -> None:
        self._n = 0
        self._start, self._along = np.empty((capacity, 2)), np.empty((capacity, 2))
        self._offset_m = np.empty(capacity)
        self._length_m, self._thickness_m = np.empty(capacity), np.empty(capacity)

    @property
    def start(self) -> NDArray[np.float64]:
        return self._start[: self._n]

    @property
    def along(self) -> NDArray[np.float64]:
        return self._along[: self._n]

    @property
    def length_m(self) -> NDArray[np.float64]:
        return self._length_m[: self._n]

    @property
    def thickness_m(self) -> NDArray[np.float64]:
        return self._thickness_m[: self._n]

    def add(self, axis: Axis) -> None:
        """Add an axis."""
        k = self._n
        self._start[k], self._along[k] = axis.start, axis.vector / axis.length_m
        (x, y), (u_x, u_y) = self._start[k], self._along[k]
        self._offset_m[k] = u_x * y - u_y * x
        self._length_m[k], self._thickness_m[k] = axis.length_m, axis.thickness_m
        self._n += 1

    def beside(self, axis: Axis) -> NDArray[np.float64]:
        """Distance of an axis's farther end from each line, (n,) [m]."""
        (x_0, y_0), (x_1, y_1) = axis.start, axis.end
        turned = np.array([[y_0, y_1], [-x_0, -x_1]])
        across = np.abs(self.along @ turned - self._offset_m[: self._n, None])
        return np.maximum(across[:, 0], across[:, 1])

    def covers(self, axis: Axis) -> bool:
        """Whether an axis runs within the wall of one of the lines, which are longer."""
        parallel = np.abs(self.along @ axis.vector) >= _DUPLICATE_DIRECTION * axis.length_m
        near = self.beside(axis) <= np.maximum(self.thickness_m, axis.thickness_m) / 2
        k = np.flatnonzero(parallel & near)
        ends = np.array([axis.start, axis.end])[None] - self.start[k, None]
        s = np.sort(np.einsum("kec,kc->ke", ends, self.along[k]), axis=1)
        shared = np.minimum(s[:, 1], self.length_m[k]) - np.maximum(s[:, 0], 0.0)
        return bool((shared > _DUPLICATE_FRACTION * axis.length_m).any())


def _on_one_line(group: list[Axis], solid: BaseGeometry) -> list[Axis]:
    """Put a group on its mean line, in the direction of its longest axis."""
    built = [axis for axis in group if not axis.is_filling] or group
    areas = np.array([axis.length_m * axis.thickness_m * (axis in built) for axis in group])
    towards = np.array([axis.vector * np.sign(axis.vector @ group[0].vector) for axis in group])
    along = towards.sum(axis=0) / np.hypot(*towards.sum(axis=0))
    across = np.array([-along[1], along[0]])
    ends = np.array([[axis.start, axis.end] for axis in group])
    offset = float(np.average((ends @ across).mean(axis=1), weights=areas))

    def point(s: float, beside_m: float = 0.0) -> Point:
        return point_of(along * s + across * (offset + beside_m))

    def is_solid(low: float, high: float, beside_m: float = 0.0) -> bool:
        ends = [point(low, beside_m), point(high, beside_m)]
        return high <= low or solid.contains(LineString(ends))

    def is_wall(low: float, high: float, thickness_m: float) -> bool:
        """Whether only solid lies between, and over a longer gap no wall twice as thick."""
        sides = (-thickness_m, thickness_m) if high - low > _ACROSS_M else ()
        thicker = (is_solid(low + _EDGE_M, high - _EDGE_M, side) for side in sides)
        return is_solid(low, high) and not any(thicker)

    s = np.sort(ends @ along, axis=1)
    sections = [
        _Section(float(low), float(high), axis.thickness_m, axis.is_filling)
        for (low, high), axis in sorted(
            zip(s.tolist(), group, strict=True), key=lambda pair: pair[0]
        )
    ]
    return [
        Axis(point(section.low), point(section.high), section.thickness_m)
        for section in _merged(sections, is_wall)
    ]


def _without_duplicates(axes: list[Axis]) -> list[Axis]:
    """Remove axes that run within the wall of a longer one."""
    kept: list[Axis] = []
    longer = _Lines(len(axes))
    for axis in sorted(axes, key=lambda axis: -axis.length_m):
        if not longer.covers(axis):
            kept.append(axis)
            longer.add(axis)
    return kept


def _merged(sections: list[_Section], is_wall: _IsWall) -> list[_Section]:
    """Join neighbours of similar thickness, then short ones and fillings with any.

    In this order, because a long wall often consists of short pieces.
    """
    same = _joined(sections, is_wall, _same_thickness, np.inf)
    return _touching(_joined(same, is_wall, _alike, _ACROSS_M), is_wall)


def _joined(
    sections: list[_Section],
    is_wall: _IsWall,
    alike: Callable[[_Section, _Section], bool],
    max_gap_m: float,
) -> list[_Section]:
    """Join neighbours that are alike and have only solid between them."""
    done = sections[:1]
    for following in sections[1:]:
        last = done[-1]
        if following.high <= last.high:
            continue
        near = following.low - last.high <= max_gap_m
        if near and alike(last, following) and _meet(last, following, is_wall):
            like = max(last, following, key=lambda part: (not part.is_filling, part.length_m))
            done[-1] = replace(like, low=last.low, high=following.high)
        else:
            done.append(following)
    return done


def _meet(last: _Section, following: _Section, is_wall: _IsWall) -> bool:
    """Whether there is wall between two sections."""
    return is_wall(last.high, following.low, max(last.thickness_m, following.thickness_m))


def _touching(sections: list[_Section], is_wall: _IsWall) -> list[_Section]:
    """Make neighbours touch midway, where there is solid between them."""
    done = sections[:1]
    for following in sections[1:]:
        last = done[-1]
        near = following.low - last.high <= _ACROSS_M
        if near and _meet(last, following, is_wall):
            between = (last.high + following.low) / 2
            done[-1] = replace(last, high=between)
            following = replace(following, low=between)
        done.append(following)
    return done


def _same_thickness(a: _Section, b: _Section) -> bool:
    low, high = sorted((a.thickness_m, b.thickness_m))
    return a.is_filling == b.is_filling and high <= _LIKE * low


def _alike(a: _Section, b: _Section) -> bool:
    short = any(section.length_m < _SHORT * section.thickness_m for section in (a, b))
    return short or a.is_filling or b.is_filling or _same_thickness(a, b)
