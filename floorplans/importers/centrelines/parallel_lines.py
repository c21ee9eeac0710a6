"""Walls drawn as two parallel lines -> the strips between them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import Polygon

from floorplans.importers.centrelines.joined_pieces import joined_pieces
from floorplans.importers.centrelines.sections import linestrings
from floorplans.walls import Interval, Point, complement

MIN_THICKNESS_M = 0.02
_MAX_SINE = np.sin(np.radians(6.0))
_N_DIRECTIONS = 29
"""Bins of directions, each wider than the angle up to which lines are nearly parallel."""
_MIN_OVERLAP_M = 0.05
_MIN_SINGLE_M = 0.3
"""Unpaired lines shorter than this are jambs and caps, not walls [m]."""
_CAP_M = 0.03
_JAMB_M = 1.0
"""Shorter lines may be jambs; a wall that is thicker is heavy only if it is very long [m]."""
_LONG, _VERY_LONG = 1.5, 4.0
"""Length of the faces of a heavy wall, as a multiple of its thickness."""
_FEW_SINGLE = 0.2
"""Fraction of the lines that are single in a drawing that shows walls by both faces."""

Segments = NDArray[np.float64]
Areas = NDArray[np.object_]


@dataclass(frozen=True)
class Strip:
    """The wall area between two lines, where they face each other [m]."""

    start: Point
    end: Point
    thickness_m: float


def _areas(strips: Sequence[Strip], extension_m: NDArray[np.float64] | float) -> Areas:
    """Rectangles of strips, each extended at both ends, (n,)."""
    ends = np.array([(strip.start, strip.end) for strip in strips]).reshape(-1, 2, 2)
    along = ends[:, 1] - ends[:, 0]
    along /= np.hypot(along[:, 0], along[:, 1])[:, None]
    half_m = np.array([strip.thickness_m for strip in strips])[:, None] / 2
    across = np.stack([-along[:, 1], along[:, 0]], axis=1) * half_m
    ahead = along * np.broadcast_to(extension_m, len(strips))[:, None]
    a, b = ends[:, 0] - ahead, ends[:, 1] + ahead
    corners = np.stack([a + across, b + across, b - across, a - across], axis=1)
    return np.array(shapely.polygons(corners), dtype=np.object_)


@dataclass
class _Face:
    """A line: start, unit direction and length, and the sections already used as a wall's side."""

    start: Point
    along: Point
    length: float
    used: list[Interval] = field(default_factory=list[Interval])

    def free(self, low: float, high: float) -> Iterator[Interval]:
        """Unused sections of [low, high]."""
        position = low
        for used_low, used_high in [*sorted(self.used), (high, high)]:
            if min(used_low, high) - position > _MIN_OVERLAP_M:
                yield position, min(used_low, high)
            position = max(position, used_high)

    def at(self, s: float, t: float = 0.0) -> Point:
        """Place at a length along the line and a distance to its left [m]."""
        (x, y), (ux, uy) = self.start, self.along
        return (x + ux * s - uy * t, y + uy * s + ux * t)

    def part(self, low: float, high: float) -> _Face:
        """Section of the line, of which nothing is used."""
        return _Face(self.at(low), self.along, high - low)


@dataclass(frozen=True)
class StripWalls:
    """Walls found in lines.

    Attributes
    ----------
    area : tuple of shapely.geometry.Polygon
        Strips between pairs of lines, and the corners where strips meet [m].
    singles : (n, 2, 2) float64
        Unpaired lines, which are walls of unknown thickness [m].
    """

    area: tuple[Polygon, ...]
    singles: Segments


def strips_of_lines(segments: Segments, max_thickness_m: float, heavy_m: float = 0.0) -> StripWalls:
    """Pair lines that face each other, the nearest first; each section has one partner.

    Collinear pieces that touch are one line.

    Lines farther apart are the faces of heavy walls in a drawing that shows walls by both faces:
    where hardly any line is left single if they are. In a drawing of single lines they are the
    sides of a narrow room; in one of thin double walls such sides have their partners already.

    Parameters
    ----------
    segments : (n, 2, 2) float64
        Open lines of walls, not closed outlines of wall bodies [m].
    max_thickness_m : float
        Lines farther apart are not the sides of one wall, unless it is heavy [m].
    heavy_m : float
        Largest thickness of heavy walls [m].

    Returns
    -------
    StripWalls
    """
    steps = segments[:, 1] - segments[:, 0]
    lengths = np.hypot(steps[:, 0], steps[:, 1])
    segments = joined_pieces(segments[lengths > 1e-6])
    if not len(segments):
        return StripWalls((), segments)
    steps = segments[:, 1] - segments[:, 0]
    lengths = np.hypot(steps[:, 0], steps[:, 1])
    starts, along = segments[:, 0].tolist(), (steps / lengths[:, None]).tolist()
    faces = [
        _Face((x, y), (ux, uy), length)
        for (x, y), (ux, uy), length in zip(starts, along, lengths.tolist(), strict=True)
    ]
    strips = list(_strips(faces, max_thickness_m))
    if heavy_m > max_thickness_m:
        strips += _heavy_strips(faces, heavy_m)
    areas = _areas(strips, 0.0)
    return StripWalls((*areas, *_corners(strips, areas)), _singles(faces, strips))


def _strips(faces: list[_Face], max_thickness_m: float) -> Iterator[Strip]:
    """Strips between pairs of faces, thin ones first."""
    for thickness_m, i, j in _pairs(faces, max_thickness_m):
        if thickness_m >= MIN_THICKNESS_M:
            yield from _between(faces[i], faces[j], _MIN_OVERLAP_M)


def _pairs(faces: list[_Face], distance_m: float) -> list[tuple[float, int, int]]:
    """Pairs of nearly parallel faces up to a distance, each after its distance, the least first."""
    start, along = (_vectors(faces, name) for name in ("start", "along"))
    length = np.array([face.length for face in faces])
    ends = np.stack([start, start + along * length[:, None]], axis=1)
    i, j = _near_in_direction(linestrings(ends), along, distance_m).T
    sine = along[i, 0] * along[j, 1] - along[i, 1] * along[j, 0]
    parallel = np.abs(sine) <= _MAX_SINE
    i, j = i[parallel], j[parallel]
    apart_m = _apart(ends[j] - start[i, None], along[i], length[i])
    near = apart_m <= distance_m
    return sorted(zip(apart_m[near].tolist(), i[near].tolist(), j[near].tolist(), strict=True))


def _vectors(faces: Sequence[_Face], name: str) -> NDArray[np.float64]:
    return np.array([getattr(face, name) for face in faces]).reshape(-1, 2)


def _apart(
    ends: Segments, along: NDArray[np.float64], length: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Distances (n,) of faces from others where they face each other; inf if they do not [m].

    Parameters
    ----------
    ends : (n, 2, 2) float64
        Of the other faces, from each face's start [m].
    along : (n, 2) float64
        Unit directions of the faces.
    length : (n,) float64
        Of the faces [m].
    """
    s = np.sum(ends * along[:, None], axis=2)
    t = along[:, None, 0] * ends[..., 1] - along[:, None, 1] * ends[..., 0]
    run = s[:, 1] - s[:, 0]
    slope = np.divide(t[:, 1] - t[:, 0], run, out=np.zeros_like(run), where=run != 0)
    low, high = np.maximum(s.min(axis=1), 0.0), np.minimum(s.max(axis=1), length)
    sides = t[:, :1] + slope[:, None] * (np.stack([low, high], axis=1) - s[:, :1])
    facing = (high - low >= _MIN_OVERLAP_M) & (sides[:, 0] * sides[:, 1] > 0)
    return np.where(facing, np.abs(sides).mean(axis=1), np.inf)


def _near_in_direction(
    lines: Areas, along: NDArray[np.float64], distance_m: float
) -> NDArray[np.int64]:
    """Pairs (i, j), i < j, of lines up to a distance, all of them that are nearly parallel, (n, 2).

    Lines are looked up among those of their own bin of directions and of the next one: in a tangle
    most neighbours have other directions.
    """
    angle = np.arctan2(along[:, 1], along[:, 0]) % np.pi
    bins = np.minimum((angle / np.pi * _N_DIRECTIONS).astype(np.int64), _N_DIRECTIONS - 1)
    members = [np.flatnonzero(bins == k) for k in range(_N_DIRECTIONS)]
    found = [np.empty((0, 2), dtype=np.int64)]
    for k, own in enumerate(members):
        if not len(own):
            continue
        others = np.concatenate([own, members[(k + 1) % _N_DIRECTIONS]])
        i, j = shapely.STRtree(lines[others]).query(
            lines[own], predicate="dwithin", distance=distance_m
        )
        pairs = np.stack([own[i], others[j]], axis=1)
        is_once = (j >= len(own)) | (pairs[:, 0] < pairs[:, 1])
        found.append(np.sort(pairs[is_once], axis=1))
    return np.concatenate(found)


def _heavy_strips(faces: list[_Face], heavy_m: float) -> list[Strip]:
    """Heavy walls between faces that have no partner; none where many lines are left single.

    Marks the faces as used where there are any.
    """
    whole = [k for k, face in enumerate(faces) if face.length > _JAMB_M]
    trial = [replace(faces[k], used=[*faces[k].used]) for k in whole]
    strips = [
        strip
        for apart_m, i, j in _pairs(trial, heavy_m)
        for strip in _between(trial[i], trial[j], _least_length_m(apart_m))
    ]
    free = [high - low for face in trial for low, high in face.free(0.0, face.length)]
    single_m = sum(length for length in free if length > _JAMB_M)
    if not strips or single_m > _FEW_SINGLE * sum(face.length for face in trial):
        return []
    for k, face in zip(whole, trial, strict=True):
        faces[k].used[:] = face.used
    return strips


def _least_length_m(thickness_m: float) -> float:
    """Length from which on two faces are those of a wall: the more, the thicker it is [m]."""
    return (_LONG if thickness_m <= _JAMB_M else _VERY_LONG) * thickness_m


def _facing(face: _Face, other: _Face) -> tuple[Point, Point]:
    """Ends of another face, each along and to the left of a face, in order along it."""
    (x, y), (ux, uy) = face.start, face.along
    ends = ((px - x, py - y) for px, py in (other.start, other.at(other.length)))
    first, last = sorted((dx * ux + dy * uy, ux * dy - uy * dx) for dx, dy in ends)
    return first, last


def _between(face: _Face, other: _Face, least_m: float) -> Iterator[Strip]:
    """Strips longer than the least where both faces are free; marks them as used."""
    first, last = _facing(face, other)
    for begin, end in list(face.free(max(first[0], 0.0), min(last[0], face.length))):
        (back_low, _), (back_high, _) = _facing(other, face.part(begin, end))
        for low, high in list(other.free(max(back_low, 0.0), min(back_high, other.length))):
            (ahead_low, _), (ahead_high, _) = _facing(face, other.part(low, high))
            section = (max(ahead_low, begin), min(ahead_high, end))
            if section[1] - section[0] <= least_m:
                continue
            face.used.append(section)
            other.used.append((low, high))
            yield _strip(face, section, first, last)


def _strip(face: _Face, section: Interval, first: Point, last: Point) -> Strip:
    """Strip beside a section of a face, up to the line from `first` to `last` of its frame."""
    slope = (last[1] - first[1]) / (last[0] - first[0])
    begin, end = ((s, first[1] + slope * (s - first[0])) for s in section)
    thickness_m = (abs(begin[1]) + abs(end[1])) / 2
    return Strip(face.at(begin[0], begin[1] / 2), face.at(end[0], end[1] / 2), thickness_m)


def _corners(strips: list[Strip], areas: Areas) -> Iterator[Polygon]:
    """Areas missing between strips that meet: corners, Ts and crossings."""
    if not strips:
        return
    thickness_m = np.array([strip.thickness_m for strip in strips])
    pairs = shapely.STRtree(areas).query(areas, predicate="dwithin", distance=thickness_m.max())
    i, j = pairs[:, pairs[0] < pairs[1]]
    bent = _bent(strips, i, j)
    i, j = i[bent], j[bent]
    reach_m = 1.05 * np.maximum(thickness_m[i], thickness_m[j]) + _CAP_M
    first, second = (_areas([strips[k] for k in ks.tolist()], reach_m) for ks in (i, j))
    common = np.array(shapely.intersection(first, second), dtype=np.object_)
    apart_m = np.maximum(*(shapely.distance(common, areas[ks]) for ks in (i, j)))
    for area in common[(shapely.area(common) > 0) & (apart_m < 2 * _CAP_M)].tolist():
        if isinstance(area, Polygon):
            yield area


def _bent(
    strips: list[Strip], first: NDArray[np.int64], second: NDArray[np.int64]
) -> NDArray[np.bool_]:
    """Which pairs of strips are not nearly parallel."""
    along = np.array([np.subtract(strip.end, strip.start) for strip in strips])
    along /= np.hypot(along[:, 0], along[:, 1])[:, None]
    (ux, uy), (vx, vy) = along[first].T, along[second].T
    return np.abs(ux * vy - uy * vx) > _MAX_SINE


def _singles(faces: list[_Face], strips: list[Strip]) -> Segments:
    """Unpaired sections that are not part of a wall already, (n, 2, 2)."""
    thickness_m = np.array([strip.thickness_m for strip in strips])
    walls = shapely.buffer(_areas(strips, thickness_m + _CAP_M), _CAP_M, quad_segs=16)
    parts = [
        (face.part(low, high), face.length)
        for face in faces
        for low, high in face.free(0.0, face.length)
    ]
    found: list[list[Point]] = []
    for (part, whole_m), covered in zip(parts, _covered([p for p, _ in parts], walls), strict=True):
        for low, high in complement(covered, part.length):
            if high - low >= min(_MIN_SINGLE_M, whole_m - _CAP_M) and high - low > _CAP_M:
                found.append([part.at(low), part.at(high)])
    return np.array(found, dtype=np.float64).reshape(-1, 2, 2)


def _covered(faces: list[_Face], walls: Areas) -> list[list[Interval]]:
    """Sections of each face inside convex walls."""
    sections: list[list[Interval]] = [[] for _ in faces]
    if not len(walls):
        return sections
    start, along = (_vectors(faces, name) for name in ("start", "along"))
    ends = start + along * np.array([face.length for face in faces])[:, None]
    lines = linestrings(np.stack([start, ends], axis=1))
    which, wall = shapely.STRtree(walls).query(lines, "intersects")
    common = np.array(shapely.intersection(lines[which], walls[wall]), dtype=np.object_)
    points, pair = shapely.get_coordinates(common, return_index=True)
    s = np.sum((points - start[which[pair]]) * along[which[pair]], axis=1)
    pairs, first = np.unique(pair, return_index=True)
    low, high = np.minimum.reduceat(s, first), np.maximum.reduceat(s, first)
    for i, section in zip(
        which[pairs].tolist(), zip(low.tolist(), high.tolist(), strict=True), strict=True
    ):
        sections[i].append(section)
    return sections
