"""The plan view's walls, split where they meet, and the cuts that connect free wall ends.

The faces between walls and cuts must be simply bounded: no wall ends within a face, and no chain of
walls reaches into one. A cut extends a free wall end to the next wall; another cut connects what a
single chain of walls (a bridge of the graph) holds to the rest.
"""

from collections import defaultdict
from collections.abc import Iterable, Sequence
from itertools import pairwise

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry.base import BaseGeometry

from raytrace.arrays import Floats
from raytrace.errors import SceneError
from raytrace.geometry.junctions import TOUCHING_M, join_near_walls
from raytrace.geometry.sheets import Panel

Vertex = tuple[float, float]
Segment = tuple[Vertex, Vertex]

FINEST_SNAP_M = 2.0**-40
"""Vertices are snapped to this grid, or a coarser one where coordinates are large [m]."""


class _Lines:
    """Walls and cuts as chains of vertices, all of which become vertices of the plan view."""

    def __init__(self, panels: Sequence[Panel]) -> None:
        self._chains = [[_vertex(p.start), _vertex(p.end)] for p in panels]
        self._drawn: dict[int, shapely.LineString] = {}
        self._share_vertices()
        far = max((abs(c) for chain in self._chains for v in chain for c in v), default=1.0)
        self.snap_m = max(FINEST_SNAP_M, 2.0 ** (np.ceil(np.log2(max(far, 1.0))) - 46.0))

    def geometries(self) -> NDArray[np.object_]:
        """(n,) line strings."""
        for number, chain in enumerate(self._chains):
            if number not in self._drawn:
                self._drawn[number] = shapely.LineString(chain)
        return np.array([self._drawn[number] for number in range(len(self._chains))], dtype=object)

    def add_cut(self, tip: Vertex, ahead: Floats) -> bool:
        """Add a cut straight on from a vertex to the nearest line; return whether there is one."""
        ray = shapely.LineString([np.array(tip) + ahead * 1e-6, np.array(tip) + ahead * 1e5])
        lines = self.geometries()
        hits, chain = shapely.get_coordinates(shapely.intersection(ray, lines), return_index=True)
        if len(hits) == 0:
            return False
        nearest = int(np.argmin(np.hypot(*(hits - tip).T)))
        place = self._insert(int(chain[nearest]), _vertex(hits[nearest]))
        self._chains.append([tip, place])
        return True

    def _share_vertices(self) -> None:
        """Give walls that meet one common vertex, however their ends are rounded."""
        ends = [v for chain in self._chains for v in chain]
        tree = shapely.STRtree(shapely.points(ends))
        first, second = tree.query(shapely.points(ends), "dwithin", TOUCHING_M)
        shared = list(range(len(ends)))
        for a, b in sorted(zip(first.tolist(), second.tolist(), strict=True)):
            shared[a] = min(shared[a], shared[b])
        for k, chain in enumerate(self._chains):
            chain[:] = [ends[shared[2 * k]], ends[shared[2 * k + 1]]]
        self._drawn.clear()
        own = list(dict.fromkeys(ends[k] for k in shared))
        near = shapely.STRtree(self.geometries()).query(shapely.points(own), "dwithin", TOUCHING_M)
        for vertex, chain in near.T.tolist():
            self._insert(chain, own[vertex])

    def _insert(self, number: int, vertex: Vertex) -> Vertex:
        """Insert a point on a chain as a vertex; return it, or the vertex already there."""
        chain = self._chains[number]
        away = [float(np.hypot(v[0] - vertex[0], v[1] - vertex[1])) for v in chain]
        if min(away) <= TOUCHING_M:
            return chain[away.index(min(away))]
        chain.append(vertex)
        start, end = np.array(chain[0]), np.array(chain[-2])
        chain.sort(key=lambda v: float((np.array(v) - start) @ (end - start)))
        self._drawn.pop(number, None)
        return vertex


def node(
    panels: Iterable[Panel], footprint: BaseGeometry
) -> tuple[dict[Segment, Panel], set[Segment]]:
    """Split panels where they meet, and cut the footprint so that every face is simply bounded.

    Parameters
    ----------
    panels
        The walls.
    footprint
        What the floor covers; chains outside it are left as they are.

    Returns
    -------
    walls, cuts
        Straight pieces between vertices, each wall's with its panel.

    Raises
    ------
    SceneError
        Where a wall points out of the building.
    """
    panels = join_near_walls(list(panels))
    lines = _Lines(panels)
    walls = lines.geometries()
    pieces = _pieces(lines)
    while _cut_at_free_ends(lines, pieces) or _cut_at_bridge(lines, pieces, footprint):
        pieces = _pieces(lines)
    middles = shapely.points([((a[0] + b[0]) / 2, (a[1] + b[1]) / 2) for a, b in pieces])
    tree = shapely.STRtree(walls)
    near, distance = tree.query_nearest(middles, all_matches=False, return_distance=True)
    on_wall = distance < 4 * lines.snap_m
    of_wall = {s: panels[k] for s, k, on in zip(pieces, near[1], on_wall, strict=True) if on}
    return of_wall, {s for s, on in zip(pieces, on_wall, strict=True) if not on}


def _pieces(lines: _Lines) -> list[Segment]:
    """Straight pieces of the noded lines, snapped."""
    noded = shapely.get_parts(shapely.union_all(lines.geometries(), grid_size=lines.snap_m))
    found: dict[Segment, None] = {}
    for line in noded:
        points = [_vertex(p) for p in shapely.get_coordinates(line)]
        for a, b in pairwise(points):
            found[(a, b) if a < b else (b, a)] = None
    return list(found)


def _cut_at_free_ends(lines: _Lines, pieces: Sequence[Segment]) -> bool:
    """Add cuts at free ends; return whether there were any."""
    neighbours: defaultdict[Vertex, list[Vertex]] = defaultdict(list)
    for a, b in pieces:
        neighbours[a].append(b)
        neighbours[b].append(a)
    free = [(v, others[0]) for v, others in neighbours.items() if len(others) == 1]
    for end, before in free:
        if not lines.add_cut(end, _direction(before, end)):
            raise SceneError(
                f"the wall that ends at ({end[0]:g}, {end[1]:g}) points out of the building: "
                "the walls do not enclose the footprint"
            )
    return bool(free)


def _cut_at_bridge(lines: _Lines, pieces: Sequence[Segment], footprint: BaseGeometry) -> bool:
    """Add a cut from the far side of a bridge; return whether there was one.

    A pillar with a spur is such a case: the face around it would have the chain on both sides.
    """
    bridges = shapely.get_parts(shapely.polygonize_full([shapely.LineString(p) for p in pieces])[1])
    inside = [b for b in bridges if footprint.covers(b.interpolate(0.5, normalized=True))]
    if not inside:
        return False
    a, b = (_vertex(v) for v in shapely.get_coordinates(inside[0]))
    held, ahead = _held_by((a, b), pieces)
    far = max(held, key=lambda v: v[0] * ahead[0] + v[1] * ahead[1])
    if not lines.add_cut(far, ahead):
        raise SceneError(
            f"the walls around ({far[0]:g}, {far[1]:g}) reach out of the building: "
            "the walls do not enclose the footprint"
        )
    return True


def _held_by(bridge: Segment, pieces: Sequence[Segment]) -> tuple[set[Vertex], Floats]:
    """Vertices on a bridge's far side, seen from the outside walls, and the direction to them."""
    neighbours: defaultdict[Vertex, list[Vertex]] = defaultdict(list)
    for a, b in pieces:
        if {a, b} != set(bridge):
            neighbours[a].append(b)
            neighbours[b].append(a)
    outermost = min(v for piece in pieces for v in piece)
    for near, far in (bridge, bridge[::-1]):
        held, waiting = {far}, [far]
        while waiting:
            fresh = [v for v in neighbours[waiting.pop()] if v not in held]
            held.update(fresh)
            waiting += fresh
        if outermost not in held:
            return held, _direction(near, far)
    raise AssertionError(f"{bridge} lies on a ring, so it is no bridge")


def _direction(start: Vertex, end: Vertex) -> Floats:
    ahead = np.array(end) - np.array(start)
    return ahead / np.hypot(ahead[0], ahead[1])


def _vertex(point: Sequence[float] | Floats) -> Vertex:
    return float(point[0]), float(point[1])
