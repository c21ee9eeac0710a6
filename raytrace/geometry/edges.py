"""Diffracting edges: vertical ones at wall ends and corners, horizontal ones at openings.

An edge diffracts where the free space around it is more than half a turn. Vertical edges are
found for each height interval, so a door jamb ends at the lintel and a T-junction is no edge. A
horizontal edge bounds a wall over or under an opening (lintel, sill, wall top): a half plane.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from raytrace.arrays import Ints
from raytrace.geometry.cells import CellComplex
from raytrace.geometry.sheets import COINCIDENT_M, OPEN, Profile
from raytrace.kernels.plan_view import PARTIAL

TURN = 2.0 * np.pi


@dataclass(frozen=True, eq=False)
class VerticalEdge:
    """A wedge with a vertical edge.

    Attributes
    ----------
    vertex
        Vertex number in the plan view.
    x, y
        Its position [m].
    o_face_azimuth
        Direction of the o-face [rad]; the free space lies counter-clockwise of it.
    wedge_n
        Free angle over pi.
    o_slab, n_slab
        Slab of the o-face and of the n-face.
    z_low, z_high
        Heights of its ends [m].
    cells
        (n,) cells of the plan view in the free space at the edge.
    """

    vertex: int
    x: float
    y: float
    o_face_azimuth: float
    wedge_n: float
    o_slab: int
    n_slab: int
    z_low: float
    z_high: float
    cells: Ints


@dataclass(frozen=True)
class HorizontalEdge:
    """The lintel, sill or top edge of a wall: a half plane.

    Attributes
    ----------
    plan_edges
        The cell edges it runs along, one from each side.
    z
        Its height [m].
    wall_above
        Whether the wall is above it (a lintel) or below (a sill, a counter).
    material
        Slab of the wall.
    """

    plan_edges: tuple[int, int]
    z: float
    wall_above: bool
    material: int


class _Wall(NamedTuple):
    """A wall as seen from one of its ends: `bend_rad` is what a displaced vertex turns it by."""

    azimuth: float
    bend_rad: float
    profile: Profile


class _Wedge(NamedTuple):
    o_face: float
    angle: float
    o_slab: int
    n_slab: int


def find_vertical_edges(cells: CellComplex, height_m: float) -> tuple[VerticalEdge, ...]:
    """Return every vertical edge of a building that diffracts."""
    walls_at: dict[int, list[_Wall]] = {}
    for a, b, profile in cells.wall_segments:
        dx, dy = cells.vertices[b] - cells.vertices[a]
        bend = COINCIDENT_M / float(np.hypot(dx, dy))
        walls_at.setdefault(a, []).append(_Wall(float(np.arctan2(dy, dx)), bend, profile))
        walls_at.setdefault(b, []).append(_Wall(float(np.arctan2(-dy, -dx)), bend, profile))
    around = _cells_around(cells)
    return tuple(
        edge
        for vertex, walls in sorted(walls_at.items())
        for edge in _edges_at(vertex, walls, height_m, around.get(vertex, []), cells)
    )


def _cells_around(cells: CellComplex) -> dict[int, list[tuple[int, float]]]:
    """For each vertex, the cells that have it as a corner and the azimuth of their inside."""
    view = cells.view
    around: dict[int, list[tuple[int, float]]] = {}
    for cell, (first, last) in enumerate(pairwise(view.cell_edges.tolist())):
        middle = view.ends[first:last, :2].mean(axis=0)
        for vertex in view.vertex[first:last, 0].tolist():
            dx, dy = middle - cells.vertices[vertex]
            around.setdefault(vertex, []).append((cell, float(np.arctan2(dy, dx))))
    return around


def _edges_at(
    vertex: int,
    walls: list[_Wall],
    height_m: float,
    around: list[tuple[int, float]],
    cells: CellComplex,
) -> Iterator[VerticalEdge]:
    x, y = cells.vertices[vertex]
    levels = sorted({0.0, height_m} | {t for wall in walls for t in wall.profile.tops})
    standing: list[tuple[_Wedge, float, float]] = []
    for z_low, z_high in pairwise(levels):
        below = {wedge: low for wedge, low, high in standing if high == z_low}
        wedges = list(_wedges(walls, 0.5 * (z_low + z_high)))
        standing = [s for s in standing if s[2] < z_low or s[0] not in wedges]
        standing += [(wedge, below.get(wedge, z_low), z_high) for wedge in wedges]
    for wedge, z_low, z_high in standing:
        inside = [c for c, azimuth in around if (azimuth - wedge.o_face) % TURN < wedge.angle]
        if inside:
            yield VerticalEdge(
                vertex, float(x), float(y), wedge.o_face, wedge.angle / np.pi,
                wedge.o_slab, wedge.n_slab, z_low, z_high, np.array(inside, np.int64),
            )  # fmt: skip


def _wedges(walls: list[_Wall], z: float) -> Iterator[_Wedge]:
    """Free sectors of more than half a turn between the walls that stand at height z.

    A wall is straight where a corner is nearer to its line than `COINCIDENT_M`.
    """
    solid = sorted(
        (wall.azimuth, m, wall.bend_rad) for wall in walls if (m := wall.profile.at(z)) != OPEN
    )
    for one, two in zip(solid, solid[1:] + solid[:1], strict=True):
        (start, o_slab, o_bend), (end, n_slab, n_bend) = one, two
        angle = end - start if end > start else end - start + TURN
        if angle > np.pi + o_bend + n_bend:
            yield _Wedge(start, angle, o_slab, n_slab)


def find_horizontal_edges(cells: CellComplex) -> tuple[HorizontalEdge, ...]:
    """Return every horizontal edge of a wall over or under an opening."""
    view = cells.view
    edges: list[HorizontalEdge] = []
    for e in np.flatnonzero((view.kind == PARTIAL) & (view.twin > np.arange(len(view.twin)))):
        profile = view.profile[e]
        part = slice(view.profile_intervals[profile], view.profile_intervals[profile + 1])
        slabs = view.interval_slab[part].tolist()
        for z, (below, above) in zip(view.interval_top[part], pairwise(slabs), strict=False):
            if (below == OPEN) != (above == OPEN):
                sides = (int(e), int(view.twin[e]))
                edges.append(HorizontalEdge(sides, float(z), above != OPEN, max(below, above)))
    return tuple(edges)
