"""Walls drawn as two parallel lines -> the strips between them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import Polygon

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

    start: NDArray[np.float64]
    along: NDArray[np.float64]
    length: float
    used: list[Interval] = field(default_factory=list[Interval])

    def free(self, low: float, high: float) -> Iterator[Interval]:
        """Unused sections of [low, high]."""
        position = low
        for used_low, used_high in [*sorted(self.used), (high, high)]:
            if min(used_low, high) - position > _MIN_OVERLAP_M:
                yield position, min(used_low, high)
            position = max(position, used_high)


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
    segments, steps, lengths = (x[lengths > 1e-6] for x in (segments, steps, lengths))
    if not len(segments):
        return StripWalls((), segments)
    faces = [
        _Face(segment[0], step / length, float(length))
        for segment, step, length in zip(segments, steps, lengths, strict=True)
    ]
    strips = list(_strips(faces, segments, max_thickness_m))
    if heavy_m > max_thickness_m:
        strips += _heavy_strips(faces, heavy_m)
    areas = _areas(strips, 0.0)
    return StripWalls((*areas, *_corners(strips, areas)), _singles(faces, strips))


def _strips(faces: list[_Face], segments: Segments, max_thickness_m: float) -> Iterator[Strip]:
    """Strips between pairs of faces, thin ones first."""
    for thickness_m, i, j in _pairs(faces, segments, max_thickness_m):
        if thickness_m >= MIN_THICKNESS_M:
            yield from _between(faces[i], faces[j], _MIN_OVERLAP_M)


def _pairs(
    faces: list[_Face], segments: Segments, distance_m: float
) -> list[tuple[float, int, int]]:
    """Pairs of nearly parallel faces up to a distance, each after its distance, the least first."""
    lines = np.array(shapely.linestrings(segments), dtype=np.object_)
    along = np.array([face.along for face in faces]).reshape(-1, 2)
    near = _near_in_direction(lines, along, distance_m)
    a, b = along[near[:, 0]], along[near[:, 1]]
    near = near[np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]) <= _MAX_SINE]
    apart = ((_apart(faces[i], faces[j]), i, j) for i, j in near.tolist())
    return sorted(pair for pair in apart if pair[0] <= distance_m)


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
    segments = np.array([_ends_of(faces[k]) for k in whole]).reshape(-1, 2, 2)
    trial = [replace(faces[k], used=[*faces[k].used]) for k in whole]
    strips = [
        strip
        for apart_m, i, j in _pairs(trial, segments, heavy_m)
        for strip in _between(trial[i], trial[j], _least_length_m(apart_m))
    ]
    free = [high - low for face in trial for low, high in face.free(0.0, face.length)]
    single_m = sum(length for length in free if length > _JAMB_M)
    if not strips or single_m > _FEW_SINGLE * sum(face.length for face in trial):
        return []
    for k, face in zip(whole, trial, strict=True):
        faces[k].used[:] = face.used
    return strips


def _ends_of(face: _Face) -> list[NDArray[np.float64]]:
    return [face.start, face.start + face.along * face.length]


def _least_length_m(thickness_m: float) -> float:
    """Length from which on two faces are those of a wall: the more, the thicker it is [m]."""
    return (_LONG if thickness_m <= _JAMB_M else _VERY_LONG) * thickness_m


def _facing(face: _Face, other: _Face) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Coordinates of the other face's ends along and across a face, in order along it."""
    ends = np.array([other.start, other.start + other.along * other.length]) - face.start
    s = ends @ face.along
    t = face.along[0] * ends[:, 1] - face.along[1] * ends[:, 0]
    order = np.argsort(s)
    return s[order], t[order]


def _apart(face: _Face, other: _Face) -> float:
    """Distance of two faces where they face each other; inf if they do not [m]."""
    s, t = _facing(face, other)
    low, high = max(s[0], 0.0), min(s[1], face.length)
    if high - low < _MIN_OVERLAP_M:
        return np.inf
    sides = np.interp([low, high], s, t)
    return float(np.abs(sides).mean()) if sides[0] * sides[1] > 0 else np.inf


def _between(face: _Face, other: _Face, least_m: float) -> Iterator[Strip]:
    """Strips longer than the least where both faces are free; marks them as used."""
    s, t = _facing(face, other)
    low, high = max(s[0], 0.0), min(s[1], face.length)
    for begin, end in list(face.free(low, high)):
        back, _ = _facing(other, _part(face, begin, end))
        for back_low, back_high in list(other.free(max(back[0], 0.0), min(back[1], other.length))):
            ahead, _ = _facing(face, _part(other, back_low, back_high))
            section = (max(float(ahead[0]), begin), min(float(ahead[1]), end))
            if section[1] - section[0] <= least_m:
                continue
            face.used.append(section)
            other.used.append((back_low, back_high))
            yield _strip(face, section, np.interp(section, s, t))


def _part(face: _Face, low: float, high: float) -> _Face:
    return _Face(face.start + face.along * low, face.along, high - low)


def _strip(face: _Face, section: Interval, sides: NDArray[np.float64]) -> Strip:
    across = np.array([-face.along[1], face.along[0]])
    ends = [
        face.start + face.along * s + across * side / 2
        for s, side in zip(section, sides, strict=True)
    ]
    (x0, y0), (x1, y1) = ends
    start, end = (float(x0), float(y0)), (float(x1), float(y1))
    return Strip(start, end, float(np.abs(sides).mean()))


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
        (_part(face, low, high), face.length)
        for face in faces
        for low, high in face.free(0.0, face.length)
    ]
    found: list[list[NDArray[np.float64]]] = []
    for (part, whole_m), covered in zip(parts, _covered([p for p, _ in parts], walls), strict=True):
        for low, high in complement(covered, part.length):
            if high - low >= min(_MIN_SINGLE_M, whole_m - _CAP_M) and high - low > _CAP_M:
                found.append([part.start + part.along * s for s in (low, high)])
    return np.array(found, dtype=np.float64).reshape(-1, 2, 2)


def _covered(faces: list[_Face], walls: Areas) -> list[list[Interval]]:
    """Sections of each face inside convex walls."""
    sections: list[list[Interval]] = [[] for _ in faces]
    if not len(walls):
        return sections
    start, along = (
        np.array([getattr(f, x) for f in faces]).reshape(-1, 2) for x in ("start", "along")
    )
    ends = start + along * np.array([face.length for face in faces])[:, None]
    lines = np.array(shapely.linestrings(np.stack([start, ends], axis=1)), dtype=np.object_)
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
