"""Small buildings made of sheets, straight to a mesh: no floor plan between test and tracer."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
import shapely
import trimesh
from numpy.typing import NDArray

from raytrace import Scene

Floats = NDArray[np.float64]
Point = tuple[float, float]

HEIGHT_M = 3.0
CONCRETE, PLASTERBOARD, GLASS, CEILING_BOARD = range(4)
SLABS = (("concrete", 0.2), ("plasterboard", 0.1), ("glass", 0.01), ("ceiling_board", 0.02))


class Hole(NamedTuple):
    """An opening of a wall: interval along it and heights [m]; slab of its filling or None."""

    near: float
    far: float
    low: float
    high: float
    filling: int | None = None


class Sheet(NamedTuple):
    """A vertical rectangle over start - end [m], between two heights [m]."""

    start: Point
    end: Point
    low: float
    high: float
    slab: int


def wall(
    start: Point,
    end: Point,
    *holes: Hole,
    slab: int = PLASTERBOARD,
    low: float = 0.0,
    high: float = HEIGHT_M,
) -> tuple[Sheet, ...]:
    """Return the sheets that are left of a wall around holes that do not lie over each other."""
    return tuple(_columns(start, end, sorted(holes), slab, (low, high)))


def _columns(
    start: Point, end: Point, holes: Sequence[Hole], slab: int, heights: tuple[float, float]
) -> Iterator[Sheet]:
    a, b = np.array(start), np.array(end)
    length = float(np.hypot(*(b - a)))

    def at(s: float) -> Point:
        x, y = a + (b - a) * (s / length)
        return float(x), float(y)

    done = 0.0
    for hole in holes:
        yield Sheet(at(done), at(hole.near), *heights, slab)
        piece = at(hole.near), at(hole.far)
        yield Sheet(*piece, heights[0], hole.low, slab)
        yield Sheet(*piece, hole.high, heights[1], slab)
        if hole.filling is not None:
            yield Sheet(*piece, hole.low, hole.high, hole.filling)
        done = hole.far
    yield Sheet(at(done), end, *heights, slab)


def door(near: float, far: float, head: float = 2.25, filling: int | None = None) -> Hole:
    """Return an open door, or one shut by a leaf."""
    return Hole(near, far, 0.0, head, filling)


def window(near: float, far: float, filling: int | None = None) -> Hole:
    """Return a window with sill and head."""
    return Hole(near, far, 0.875, 2.125, filling)


def ring(corners: Sequence[Point], slab: int = CONCRETE) -> tuple[Sheet, ...]:
    """Return full walls around a polygon."""
    sides = zip(corners, [*corners[1:], corners[0]], strict=True)
    return tuple(s for a, b in sides for s in wall(a, b, slab=slab))


@dataclass(frozen=True)
class Building:
    """Sheets between a floor and a ceiling.

    Attributes
    ----------
    outline
        Corners of floor and ceiling [m].
    sheets
        All walls, the outer ones too.
    height_m
        Of the ceiling [m].
    slabs
        (material, thickness [m]) of the slab numbers.
    floor, ceiling
        Their slabs.
    ground_margin_m
        See `Scene.from_mesh`.
    """

    outline: tuple[Point, ...]
    sheets: tuple[Sheet, ...]
    height_m: float = HEIGHT_M
    slabs: tuple[tuple[str, float], ...] = SLABS
    floor: int = CONCRETE
    ceiling: int = CEILING_BOARD
    ground_margin_m: float | None = None

    @cached_property
    def triangles(self) -> Floats:
        """(n, 3, 3) [m] walls, then floor, then ceiling."""
        walls = [_rectangle(s) for s in self._solid]
        slabs = [_slab(shapely.Polygon(self.outline), z) for z in (0.0, self.height_m)]
        return np.concatenate([*walls, *slabs])

    @cached_property
    def triangle_slab(self) -> NDArray[np.int64]:
        """(n,) slab of each triangle."""
        walls = np.repeat([s.slab for s in self._solid], 2)
        n = (len(self.triangles) - len(walls)) // 2
        return np.concatenate([walls, [self.floor] * n, [self.ceiling] * n]).astype(np.int64)

    @property
    def _solid(self) -> list[Sheet]:
        return [s for s in self.sheets if s.high > s.low and s.start != s.end]

    @cached_property
    def scene(self) -> Scene:
        """The tracer's reading of it."""
        margin = self.ground_margin_m
        return Scene.from_mesh(
            mesh_of(self.triangles), self.triangle_slab, self.slabs, ground_margin_m=margin
        )

    @cached_property
    def ground(self) -> Floats:
        """(n, 3, 3) triangles of the ground around it [m]."""
        if self.ground_margin_m is None:
            return np.zeros((0, 3, 3))
        footprint = shapely.Polygon(self.outline)
        (x1, y1, x2, y2), margin = footprint.bounds, self.ground_margin_m
        whole = shapely.box(x1 - margin, y1 - margin, x2 + margin, y2 + margin)
        return _slab(whole.difference(footprint), 0.0)

    def moved(self, matrix: Floats, shift: Floats) -> "Building":
        """Return the building with every plan-view point p at matrix @ p + shift."""

        def move(p: Point) -> Point:
            x, y = matrix @ np.array(p) + shift
            return float(x), float(y)

        sheets = (s._replace(start=move(s.start), end=move(s.end)) for s in self.sheets)
        return replace(self, outline=tuple(map(move, self.outline)), sheets=tuple(sheets))

    def random_points(self, n: int, seed: int) -> Floats:
        """Return (n, 3) generic points between floor and ceiling [m]."""
        rng = np.random.default_rng(seed)
        ground = shapely.Polygon(self.outline)
        low, high = np.array(ground.bounds[:2]), np.array(ground.bounds[2:])
        points: list[Floats] = []
        while len(points) < n:
            x, y = rng.uniform(low, high)
            if ground.contains(shapely.Point(x, y)):
                points.append(np.array([x, y, rng.uniform(0.2, self.height_m - 0.2)]))
        return np.array(points)


def mesh_of(triangles: Floats) -> trimesh.Trimesh:
    """Return triangles (n, 3, 3) as a mesh, as they are."""
    faces = np.arange(3 * len(triangles)).reshape(-1, 3)
    return trimesh.Trimesh(vertices=triangles.reshape(-1, 3), faces=faces, process=False)


def _rectangle(sheet: Sheet) -> Floats:
    (x1, y1), (x2, y2) = sheet.start, sheet.end
    a, b = (x1, y1, sheet.low), (x2, y2, sheet.low)
    c, d = (x2, y2, sheet.high), (x1, y1, sheet.high)
    return np.array([[a, b, c], [a, c, d]])


def _slab(outline: shapely.Polygon, z: float) -> Floats:
    parts = shapely.get_parts(shapely.constrained_delaunay_triangles(outline))
    corners = np.array([shapely.get_coordinates(p)[:3] for p in parts])
    return np.concatenate([corners, np.full((*corners.shape[:2], 1), z)], axis=2)


def box(width: float, depth: float, *inside: Sheet, height: float = HEIGHT_M) -> Building:
    """Return a rectangular room with a corner at the origin and walls in it."""
    corners = ((0.0, 0.0), (width, 0.0), (width, depth), (0.0, depth))
    outside = tuple(s._replace(high=height) for s in ring(corners))
    return Building(corners, (*outside, *inside), height)
