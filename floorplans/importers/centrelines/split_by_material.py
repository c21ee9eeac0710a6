"""Walls split where their material changes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from math import dist, hypot

import shapely
from shapely.geometry import LineString
from shapely.geometry.base import BaseGeometry

from floorplans.importers.draft import RawOpening, RawWall

MIN_RUN_M = 2.0
"""A shorter section of another material belongs to its neighbour [m]."""
_FRAME_M = 0.1
_DEPTH_M = 0.6


def by_material(wall: RawWall, areas: Mapping[str | None, BaseGeometry]) -> Iterator[RawWall]:
    """Split a wall into sections of one material each.

    Parameters
    ----------
    wall : RawWall
    areas : mapping of str or None to shapely geometry
        Area of each material [m]; where there is none, as behind a door, the neighbour's continues.

    Yields
    ------
    RawWall
        In order along the wall.
    """
    if len(areas) == 1:
        yield replace(wall, material=next(iter(areas)))
        return
    line = LineString([wall.start, wall.end])
    runs = _runs(line, areas)
    stops = [0.0, *((a[1] + b[0]) / 2 for a, b in pairwise(runs)), line.length]
    for (low, high), (*_, material) in zip(pairwise(stops), runs, strict=True):
        start = wall.start if low == 0 else _point(line, low)
        end = wall.end if high == line.length else _point(line, high)
        yield replace(wall, start=start, end=end, material=material)


def without_openings(
    areas: Mapping[str | None, BaseGeometry], openings: Sequence[RawOpening]
) -> dict[str | None, BaseGeometry]:
    """Areas of materials without doors and windows, where sills are drawn.

    Parameters
    ----------
    areas : mapping of str or None to shapely geometry
        [m].
    openings : sequence of RawOpening
        Those of unknown direction are ignored.
    """
    boxes = [
        _around(opening, opening.direction) for opening in openings if opening.direction is not None
    ]
    holes = shapely.union_all(boxes)
    return {material: area.difference(holes) for material, area in areas.items()}


def _around(opening: RawOpening, direction: tuple[float, float]) -> BaseGeometry:
    (x, y), (ux, uy) = opening.centre, direction
    half = (opening.width_m / 2 + _FRAME_M) / hypot(ux, uy)
    line = LineString([(x - ux * half, y - uy * half), (x + ux * half, y + uy * half)])
    return line.buffer(_DEPTH_M, cap_style="flat")


Run = tuple[float, float, str | None]


def _runs(line: LineString, areas: Mapping[str | None, BaseGeometry]) -> list[Run]:
    """Start, end and material of each run along a line [m]; at least one, none short."""
    runs: list[Run] = sorted(
        (
            (low, high, material)
            for material, area in areas.items()
            for low, high in _spans(line, area)
        ),
        key=lambda run: run[:2],
    )
    merged = _merged(runs)
    while len(merged) > 1:
        shortest = min(merged, key=lambda run: run[1] - run[0])
        if shortest[1] - shortest[0] >= MIN_RUN_M:
            break
        merged = _merged([run for run in merged if run is not shortest])
    return merged or [(0.0, line.length, next(iter(areas), None))]


def _merged(runs: list[Run]) -> list[Run]:
    """Merge neighbouring runs of one material."""
    merged = runs[:1]
    for low, high, material in runs[1:]:
        if material == merged[-1][2]:
            merged[-1] = (merged[-1][0], max(high, merged[-1][1]), material)
        elif high > merged[-1][1]:
            merged.append((max(low, merged[-1][1]), high, material))
    return merged


def _spans(line: LineString, area: BaseGeometry) -> Iterator[tuple[float, float]]:
    start = line.coords[0]
    for part in shapely.get_parts(line.intersection(area)):
        ends = sorted(dist(start, (x, y)) for x, y in shapely.get_coordinates(part))
        if ends and ends[-1] > ends[0]:
            yield ends[0], ends[-1]


def _point(line: LineString, s: float) -> tuple[float, float]:
    point = line.interpolate(s)
    return (point.x, point.y)
