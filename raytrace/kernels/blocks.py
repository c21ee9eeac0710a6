"""Blocks of up to eight receivers that are visible from one beam."""

from typing import NamedTuple

from raytrace.kernels.beam_hits import Hits
from raytrace.kernels.building import TraceGeometry
from raytrace.kernels.compiling import jit
from raytrace.kernels.lanes import WIDTH, Lanes, lanes_of, load, sqrt, store
from raytrace.kernels.workspace import Workspace


class Block(NamedTuple):
    """Up to eight receivers that are visible from one beam.

    Attributes
    ----------
    first, n
        Their hits are first to first + n.
    beam
        The beam.
    x, y
        Where they are [m].
    weight
        Visible fraction of their surroundings; 0 for those beyond n.
    straight
        Their distances from the transmitter [m].
    """

    first: int
    n: int
    beam: int
    x: Lanes
    y: Lanes
    weight: Lanes
    straight: Lanes


@jit(inline=True)
def next_block(geometry: TraceGeometry, hits: Hits, first: int, workspace: Workspace) -> Block:
    """Take the receivers of the next hits of one beam; the last one fills the block up."""
    receivers, rows = geometry.receivers, workspace.rows
    beam, n = int(hits.pair[first, 1]), 0
    for j in range(WIDTH):
        hit = first + j
        if j == n and hit < len(hits.pair) and hits.pair[hit, 1] == beam:
            n += 1
        hit = first + min(j, n - 1)
        r = hits.pair[hit, 0]
        workspace.receivers[j] = r
        rows[0, j], rows[1, j] = receivers.xy[r, 0], receivers.xy[r, 1]
        rows[2, j] = hits.weight[hit] if j < n else 0.0
        if workspace.levels[j] != receivers.level[r]:
            workspace.levels[j] = receivers.level[r]
            for k in range(receivers.image_z.shape[1]):
                workspace.image_z[k, j] = receivers.image_z[receivers.level[r], k]
    for k in range(len(workspace.counts)):
        store(workspace.counts[k], lanes_of(0.0))
    x, y, weight = load(rows[0]), load(rows[1]), load(rows[2])
    return Block(first, n, beam, x, y, weight, straight_line(geometry, x, y, workspace))


@jit(inline=True)
def straight_line(geometry: TraceGeometry, x: Lanes, y: Lanes, workspace: Workspace) -> Lanes:
    """Distances from the transmitter to receivers [m]."""
    origin = geometry.transmitter
    dx, dy, dz = x - origin[0], y - origin[1], load(workspace.image_z[0]) - origin[2]
    return sqrt(dx * dx + dy * dy + dz * dz)
