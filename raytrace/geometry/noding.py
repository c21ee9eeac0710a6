"""The plan view's walls, split where they meet, and the cuts that connect free wall ends.

The faces between walls and cuts must be simply bounded: no wall ends within a face, and no chain of
walls reaches into one. A cut extends a free wall end to the next wall; another cut connects what a
single chain of walls (a bridge of the graph) holds to the rest.
"""

from collections import defaultdict
from collections.abc import Iterable, Sequence

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from raytrace.arrays import Floats
from raytrace.errors import SceneError
from raytrace.geometry.chains import Chains, Segment, Vertex, vertex_at
from raytrace.geometry.junctions import join_near_walls
from raytrace.geometry.sheets import Panel


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
    chains = Chains((vertex_at(p.start), vertex_at(p.end)) for p in panels)
    pieces = chains.pieces()
    while _cut_at_free_ends(chains, pieces) or _cut_at_bridge(chains, pieces, footprint):
        pieces = chains.pieces()
    middles = shapely.points([((a[0] + b[0]) / 2, (a[1] + b[1]) / 2) for a, b in pieces])
    tree = shapely.STRtree(chains.geometries()[: len(panels)])
    near, distance = tree.query_nearest(middles, all_matches=False, return_distance=True)
    on_wall = distance < 4 * chains.snap_m
    of_wall = {s: panels[k] for s, k, on in zip(pieces, near[1], on_wall, strict=True) if on}
    return of_wall, {s for s, on in zip(pieces, on_wall, strict=True) if not on}


def _cut_at_free_ends(chains: Chains, pieces: Sequence[Segment]) -> bool:
    """Add cuts at free ends; return whether there were any."""
    neighbours: defaultdict[Vertex, list[Vertex]] = defaultdict(list)
    for a, b in pieces:
        neighbours[a].append(b)
        neighbours[b].append(a)
    free = [(v, others[0]) for v, others in neighbours.items() if len(others) == 1]
    lost = chains.add_cuts([(end, _direction(before, end)) for end, before in free])
    if lost is not None:
        raise SceneError(
            f"the wall that ends at ({lost[0]:g}, {lost[1]:g}) points out of the building: "
            "the walls do not enclose the footprint"
        )
    return bool(free)


def _cut_at_bridge(chains: Chains, pieces: Sequence[Segment], footprint: BaseGeometry) -> bool:
    """Add a cut from the far side of a bridge; return whether there was one.

    A pillar with a spur is such a case: the face around it would have the chain on both sides.
    """
    bridges = shapely.get_parts(shapely.polygonize_full([shapely.LineString(p) for p in pieces])[1])
    inside = [b for b in bridges if footprint.covers(b.interpolate(0.5, normalized=True))]
    if not inside:
        return False
    a, b = (vertex_at(v) for v in shapely.get_coordinates(inside[0]))
    held, ahead = _held_by((a, b), pieces)
    far = max(held, key=lambda v: v[0] * ahead[0] + v[1] * ahead[1])
    if chains.add_cuts([(far, ahead)]) is not None:
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
    (x1, y1), (x2, y2) = bridge
    raise SceneError(
        f"the walls at both ends of ({x1:g}, {y1:g}) to ({x2:g}, {y2:g}) reach the outside: "
        "the walls do not enclose the footprint"
    )


def _direction(start: Vertex, end: Vertex) -> Floats:
    ahead = np.array(end) - np.array(start)
    return ahead / np.hypot(ahead[0], ahead[1])
