"""Nearly collinear centre lines, put on one line and joined, before they become walls."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
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
_SHORT = 2.0  # times its thickness: a shorter section takes the thickness of its neighbour


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
    return _without_duplicates([a for group in _groups(axes) for a in _on_one_line(group, solid)])


def _groups(axes: list[Axis]) -> list[list[Axis]]:
    """Group axes that are nearly collinear with the longest of them."""
    groups: list[list[Axis]] = []
    for axis in sorted(axes, key=lambda axis: -axis.length_m):
        for group in groups:
            if _on_line_of(group[0], axis):
                group.append(axis)
                break
        else:
            groups.append([axis])
    return groups


def _on_line_of(first: Axis, other: Axis) -> bool:
    along = first.vector / first.length_m
    if abs(other.vector @ along) < _SAME_DIRECTION * other.length_m:
        return False
    apart = max(first.thickness_m, other.thickness_m) * _OFFSET_FRACTION
    across = np.array([-along[1], along[0]])
    ends = np.array([other.start, other.end]) - np.array(first.start)
    return bool(np.abs(ends @ across).max() <= apart)


def _on_one_line(group: list[Axis], solid: BaseGeometry) -> list[Axis]:
    """Put a group on its mean line, in the direction of its longest axis."""
    built = [axis for axis in group if not axis.is_filling] or group
    areas = np.array([axis.length_m * axis.thickness_m * (axis in built) for axis in group])
    towards = np.array([axis.vector * np.sign(axis.vector @ group[0].vector) for axis in group])
    along = towards.sum(axis=0) / np.hypot(*towards.sum(axis=0))
    across = np.array([-along[1], along[0]])
    ends = np.array([[axis.start, axis.end] for axis in group])
    offset = float(np.average((ends @ across).mean(axis=1), weights=areas))

    def point(s: float) -> Point:
        x, y = along * s + across * offset
        return float(x), float(y)

    def is_solid(low: float, high: float) -> bool:
        return high <= low or LineString([point(low), point(high)]).within(solid)

    s = np.sort(ends @ along, axis=1)
    sections = [
        _Section(float(low), float(high), axis.thickness_m, axis.is_filling)
        for (low, high), axis in sorted(
            zip(s.tolist(), group, strict=True), key=lambda pair: pair[0]
        )
    ]
    return [
        Axis(point(section.low), point(section.high), section.thickness_m)
        for section in _merged(sections, is_solid)
    ]


def _without_duplicates(axes: list[Axis]) -> list[Axis]:
    """Remove axes that run within the wall of a longer one."""
    kept: list[Axis] = []
    for axis in sorted(axes, key=lambda axis: -axis.length_m):
        if not any(_covers(longer, axis) for longer in kept):
            kept.append(axis)
    return kept


def _covers(longer: Axis, axis: Axis) -> bool:
    along = longer.vector / longer.length_m
    if abs(axis.vector @ along) < _DUPLICATE_DIRECTION * axis.length_m:
        return False
    ends = np.array([axis.start, axis.end]) - np.array(longer.start)
    s = np.sort(ends @ along)
    beside = np.abs(ends @ np.array([-along[1], along[0]])).max()
    shared = min(s[1], longer.length_m) - max(s[0], 0.0)
    near = beside <= max(longer.thickness_m, axis.thickness_m) / 2
    return bool(near and shared > _DUPLICATE_FRACTION * axis.length_m)


def _merged(sections: list[_Section], is_solid: Callable[[float, float], bool]) -> list[_Section]:
    """Join neighbours of similar thickness, then short ones and fillings with any.

    In this order, because a long wall often consists of short pieces.
    """
    same = _joined(sections, is_solid, _same_thickness, np.inf)
    return _touching(_joined(same, is_solid, _alike, _ACROSS_M), is_solid)


def _joined(
    sections: list[_Section],
    is_solid: Callable[[float, float], bool],
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
        if near and alike(last, following) and is_solid(last.high, following.low):
            like = max(last, following, key=lambda part: (not part.is_filling, part.length_m))
            done[-1] = replace(like, low=last.low, high=following.high)
        else:
            done.append(following)
    return done


def _touching(sections: list[_Section], is_solid: Callable[[float, float], bool]) -> list[_Section]:
    """Make neighbours touch midway, where there is solid between them."""
    done = sections[:1]
    for following in sections[1:]:
        last = done[-1]
        near = following.low - last.high <= _ACROSS_M
        if near and is_solid(last.high, following.low):
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
