"""The plan view's arrays, and look-ups in them that every kernel needs."""

import math
from typing import NamedTuple

import numpy as np

from raytrace.arrays import Bools, Floats, Ints
from raytrace.kernels.compiling import jit
from raytrace.kernels.lanes import (
    Lanes,
    Mask,
    Number,
    absolute,
    all_false,
    floor,
    lanes_of,
    where,
)

WALL, PARTIAL, PORTAL = 0, 1, 2
"""Kinds of cell edges: one slab at every height; several slabs, or open at some heights; open at
every height."""

GRAZING_M = 1e-7
"""A ray within this distance of a corner or of a horizontal edge grazes it [m]. What differs on
the two sides of such a ray counts half on either (docs/conventions.md, "Grazing rays")."""


class PlanView(NamedTuple):
    """Convex cells of the plan view and their edges, counter-clockwise.

    Attributes
    ----------
    cell_edges
        (n_cells + 1,) edges of cell c are cell_edges[c]:cell_edges[c + 1].
    ends
        (n_edges, 4) start x, y and end x, y [m].
    vertex
        (n_edges, 2) numbers of the end points.
    plane
        (n_edges, 3) unit normal and offset of the edge's line, n . p = d [m].
    line
        (n_edges,) number that collinear edges share.
    kind
        (n_edges,) WALL, PARTIAL or PORTAL.
    profile
        (n_edges,) height profile of the wall on the edge, -1 for a portal.
    twin, beyond
        (n_edges,) the same edge seen from the other cell, and that cell, where a ray can pass
        at some height; -1 where there is none.
    behind_first, behind
        Edges of other cells at the back of edge e, where it is solid at every height, are
        behind[behind_first[e]:behind_first[e + 1]].
    cell_of
        (n_edges,) the cell of each edge.
    is_outdoors
        (n_cells,) whether a cell has no ceiling.
    profile_intervals
        (n_profiles + 1,) height intervals of profile p are
        profile_intervals[p]:profile_intervals[p + 1].
    interval_top, interval_slab
        Upper height [m] and slab of each interval; slab -1 is open.
    """

    cell_edges: Ints
    ends: Floats
    vertex: Ints
    plane: Floats
    line: Ints
    kind: Ints
    profile: Ints
    twin: Ints
    beyond: Ints
    behind_first: Ints
    behind: Ints
    cell_of: Ints
    is_outdoors: Bools
    profile_intervals: Ints
    interval_top: Floats
    interval_slab: Ints


@jit(inline=True)
def cross(ax: Number, ay: Number, bx: Number, by: Number) -> Number:
    """Third component of a x b; positive where b lies to the left of a."""
    return ax * by - ay * bx


@jit(inline=True)
def mirrored(x: float, y: float, line: Floats) -> tuple[float, float]:
    """Image of a point in a line (n_x, n_y, d)."""
    t = 2.0 * (line[0] * x + line[1] * y - line[2])
    return x - t * line[0], y - t * line[1]


@jit(inner=True)
def to_segment(x: float, y: float, one: Floats, other: Floats) -> float:
    """Squared distance of a point from a segment between two others [m^2]."""
    ax, ay, dx, dy = one[0], one[1], other[0] - one[0], other[1] - one[1]
    t = ((x - ax) * dx + (y - ay) * dy) / max(dx * dx + dy * dy, 1e-30)
    t = min(max(t, 0.0), 1.0)
    across, along = x - ax - t * dx, y - ay - t * dy
    return across * across + along * along


@jit()
def distances_to_cells(view: PlanView, one: Floats, other: Floats) -> Floats:
    """Shortest distances (n_cells,) [m] of the edges of cells from a segment that crosses none.

    `one` and `other` are its ends [m], equal for a point.
    """
    found = np.empty(len(view.cell_edges) - 1)
    for cell in range(len(found)):
        least = math.inf
        for e in range(view.cell_edges[cell], view.cell_edges[cell + 1]):
            start, end = view.ends[e, :2], view.ends[e, 2:]
            least = min(least, to_segment(one[0], one[1], start, end))
            least = min(least, to_segment(other[0], other[1], start, end))
            least = min(least, to_segment(start[0], start[1], one, other))
        found[cell] = math.sqrt(least)
    return found


@jit(inline=True)
def folded(z: float, height: float) -> float:
    """Height in the building of an unfolded height: reflections at floor and ceiling undone."""
    storeys = math.floor(z / height)
    rest = z - storeys * height
    if int(storeys) & 1:
        return height - rest
    return rest


@jit(inline=True)
def slab_at(view: PlanView, profile: int, z: float) -> int:
    """Slab of a profile at height z, -1 where it is open."""
    k = int(view.profile_intervals[profile])
    last = view.profile_intervals[profile + 1] - 1
    while k < last and z > view.interval_top[k]:
        k += 1
    return int(view.interval_slab[k])


@jit(inline=True)
def in_building(z: Lanes, height: float) -> Lanes:
    """`folded` for eight heights."""
    storeys = floor(z / height)
    rest = z - storeys * height
    odd = storeys - 2.0 * floor(0.5 * storeys)
    return where(odd > 0.5, height - rest, rest)


@jit(inline=True)
def slabs_at(view: PlanView, profile: int, z: Lanes) -> Lanes:
    """`slab_at` for eight heights."""
    k = int(view.profile_intervals[profile + 1]) - 1
    slab = lanes_of(float(view.interval_slab[k]))
    while k > view.profile_intervals[profile]:
        k -= 1
        slab = where(z <= view.interval_top[k], float(view.interval_slab[k]), slab)
    return slab


@jit(inline=True)
def at_horizontal_edge(view: PlanView, profile: int, z: Lanes) -> Mask:
    """Which heights are within `GRAZING_M` of a horizontal edge of a profile."""
    near = all_false()
    for k in range(view.profile_intervals[profile], view.profile_intervals[profile + 1] - 1):
        near = near | (absolute(z - view.interval_top[k]) < GRAZING_M)
    return near
