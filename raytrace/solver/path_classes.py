"""The three families of paths: reflected only, over an upright edge, over a level edge.

Each family is a job: it grows its own beams, adds its paths to sums, and can write them out
one by one.
"""

from collections.abc import Iterator
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from raytrace.geometry.edges import HorizontalEdge, VerticalEdge
from raytrace.kernels.beams import ORDER, Hits, Tree, grow_tree, hit_points
from raytrace.kernels.horizontal_edges import Rim, RimLegsIn, new_work, sum_level_edge
from raytrace.kernels.path_points import level_points, reflection_points, upright_points
from raytrace.kernels.plan_view import GRAZING_M
from raytrace.kernels.reflections import sum_reflections
from raytrace.kernels.strips import StripTree, edge_frame, grow_strips, hit_from_strip
from raytrace.kernels.tracing import Record, Sums, new_room, no_record
from raytrace.kernels.unfolding import most_items
from raytrace.kernels.utd import new_wedge
from raytrace.kernels.vertical_edges import Edge, LegsIn, legs_to_edge, sum_upright_edge
from raytrace.solver.setup import Tracing

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

HITS_AT_ONCE = 1 << 17
"""Receivers in beams are looked up so many at a time, which bounds the memory of large maps."""


class Family(Protocol):
    """Some of the paths of a trace."""

    def grow(self) -> int:
        """Grow the beams, which `add_to` does else; return how many there are."""
        ...

    def add_to(self, sums: Sums, beams: Ints | None = None) -> None:
        """Add the paths to sums, or only those of some of the beams."""
        ...

    def write_to(self, sums: Sums, record: Record) -> None:
        """Add the paths to sums, and to a record as far as it has room."""
        ...

    def receivers_of(self, record: Record) -> NDArray[np.int64]:
        """Receiver of each recorded path (n,)."""
        ...

    def write_points(self, record: Record, points: Floats, kinds: NDArray[np.int8]) -> None:
        """Write the points (n, most, 3) [m] and interactions (n, most - 2) of recorded paths."""
        ...


class Reflections:
    """Line of sight and every sequence of reflections."""

    def __init__(self, tracing: Tracing) -> None:
        self._tracing = tracing

    @cached_property
    def _hits(self) -> Hits:
        t = self._tracing
        return all_hits(t, t.tree)

    def grow(self) -> int:
        """See `Family`; the beams of the source are there."""
        return len(self._tracing.tree.link)

    def add_to(self, sums: Sums, beams: Ints | None = None) -> None:
        """See `Family`."""
        for hits in hits_in_lots(self._tracing, self._tracing.tree, beams):
            self._sum(hits, sums, no_record())

    def write_to(self, sums: Sums, record: Record) -> None:
        """See `Family`."""
        self._sum(self._hits, sums, record)

    def _sum(self, hits: Hits, sums: Sums, record: Record) -> None:
        trace, tree = self._tracing.trace, self._tracing.tree
        room = new_room(trace.max_order, most_items(tree.link))
        sum_reflections(trace, tree, hits, room, sums, record)

    def receivers_of(self, record: Record) -> NDArray[np.int64]:
        """See `Family`."""
        return _receivers(self._hits, record)

    def write_points(self, record: Record, points: Floats, kinds: NDArray[np.int8]) -> None:
        """See `Family`."""
        trace, tree = self._tracing.trace, self._tracing.tree
        reflection_points(trace, tree, self._hits, record, points, kinds)


class OverVerticalEdge:
    """Every path that one vertical edge diffracts."""

    def __init__(self, tracing: Tracing, edge: VerticalEdge) -> None:
        self._tracing = tracing
        self._cells = edge.cells
        self._vertex = edge.vertex
        self._edge = Edge(
            edge.x, edge.y, *self._heights(edge), edge.o_face_azimuth,
            new_wedge(edge.wedge_n, edge.o_material, edge.n_material),
        )  # fmt: skip

    def _heights(self, edge: VerticalEdge) -> tuple[float, float]:
        """Heights between which a path may cross; floor and ceiling are no ends of an edge."""
        low = edge.z_low if edge.z_low > GRAZING_M else -1.0
        height = self._tracing.scene.height_m
        return low, edge.z_high if edge.z_high < height - GRAZING_M else height + 1.0

    @cached_property
    def _legs_in(self) -> LegsIn:
        tree, corners = self._tracing.tree, self._tracing.corners
        mine = np.flatnonzero(corners.pair[:, 0] == self._vertex)
        mine = mine[np.argsort(tree.link[corners.pair[mine, 1], ORDER], kind="stable")]
        beams, share = corners.pair[mine, 1], corners.share[mine]
        return legs_to_edge(self._tracing.trace, tree, beams, share, self._edge)

    @cached_property
    def _tree(self) -> Tree:
        t, lowest = self._tracing, self._legs_in.order[:1].sum()
        most = t.config.max_reflections - int(lowest), t.config.max_transmissions
        return grow_tree(t.trace.plan, t.bounces, self._edge.x, self._edge.y, self._cells, most)

    @cached_property
    def _hits(self) -> Hits:
        return all_hits(self._tracing, self._tree)

    def grow(self) -> int:
        """See `Family`."""
        return len(self._tree.link) if len(self._legs_in.order) else 0

    def add_to(self, sums: Sums, beams: Ints | None = None) -> None:
        """See `Family`."""
        if len(self._legs_in.order):
            for hits in hits_in_lots(self._tracing, self._tree, beams):
                self._sum(hits, sums, no_record())

    def write_to(self, sums: Sums, record: Record) -> None:
        """See `Family`."""
        if len(self._legs_in.order):
            self._sum(self._hits, sums, record)

    def _sum(self, hits: Hits, sums: Sums, record: Record) -> None:
        trace, legs, tree = self._tracing.trace, self._legs_in, self._tree
        room = new_room(trace.max_order, most_items(tree.link))
        sum_upright_edge(trace, self._edge, legs, tree, hits, room, sums, record)

    def receivers_of(self, record: Record) -> NDArray[np.int64]:
        """See `Family`."""
        return _receivers(self._hits, record)

    def write_points(self, record: Record, points: Floats, kinds: NDArray[np.int8]) -> None:
        """See `Family`."""
        trace, legs, tree = self._tracing.trace, self._legs_in, self._tree
        upright_points(trace, self._edge, legs, tree, self._hits, record, points, kinds)


class OverHorizontalEdge:
    """Every path that leaves one side of a level edge (side 0 or 1 of its plan edges)."""

    def __init__(self, tracing: Tracing, edge: HorizontalEdge, side: int) -> None:
        self._tracing = tracing
        self._near, self._far = edge.plan_edges[side], edge.plan_edges[1 - side]
        self._rim = Rim(
            edge_frame(tracing.trace.plan, self._near), edge.z, 1.0 if edge.wall_above else -1.0,
            new_wedge(2.0, edge.material, edge.material),
        )  # fmt: skip

    @cached_property
    def _legs_in(self) -> RimLegsIn:
        t = self._tracing
        x1, y1, x2, y2 = t.trace.plan.ends[self._near]
        length = np.hypot(x2 - x1, y2 - y1)
        mine = np.flatnonzero(np.isin(t.rims[:, 0], (self._near, self._far)))
        beams = t.rims[mine, 1]
        order = np.argsort(t.tree.link[beams, ORDER], kind="stable")
        mine, beams = mine[order], beams[order]
        stretch = t.stretches[mine]
        turned = (t.rims[mine, 0] == self._far)[:, None]
        stretch = np.where(turned, 1.0 - stretch[:, ::-1], stretch) * length
        frame, image = self._rim.frame, t.tree.beam[beams]
        return RimLegsIn(
            order=t.tree.link[beams, ORDER].astype(np.int64),
            beam=beams.astype(np.int64),
            x=frame[0] * image[:, 0] + frame[1] * image[:, 1] + frame[2],
            h=frame[3] * image[:, 0] + frame[4] * image[:, 1] + frame[5],
            low=np.ascontiguousarray(stretch[:, 0]),
            high=np.ascontiguousarray(stretch[:, 1]),
        )

    @cached_property
    def _strips(self) -> StripTree:
        t, view = self._tracing, self._tracing.trace.plan
        cell = int(np.searchsorted(view.cell_edges, self._near, side="right")) - 1
        most = t.config.max_reflections - int(self._legs_in.order[0]), t.config.max_transmissions
        return grow_strips(view, t.bounces, self._near, cell, most)

    @cached_property
    def _lit(self) -> tuple[Hits, Floats]:
        beams = np.arange(len(self._strips.link))
        return hit_from_strip(self._strips, self._tracing.targets, beams, ALL_HITS)[:2]

    def grow(self) -> int:
        """See `Family`."""
        return len(self._strips.link)

    def add_to(self, sums: Sums, beams: Ints | None = None) -> None:
        """See `Family`."""
        strips, targets = self._strips, self._tracing.targets
        beams = np.arange(len(strips.link)) if beams is None else beams
        while len(beams):
            hits, seen, done = hit_from_strip(strips, targets, beams, HITS_AT_ONCE)
            self._sum((hits, seen), sums, no_record())
            beams = beams[done:]

    def write_to(self, sums: Sums, record: Record) -> None:
        """See `Family`."""
        self._sum(self._lit, sums, record)

    def _sum(self, lit: tuple[Hits, Floats], sums: Sums, record: Record) -> None:
        trace, strips, source = self._tracing.trace, self._strips, self._source
        work = new_work(trace.max_order, source[0], strips)
        sum_level_edge(trace, self._rim, source, strips, lit, work, sums, record)

    @property
    def _source(self) -> tuple[Tree, RimLegsIn]:
        return self._tracing.tree, self._legs_in

    def receivers_of(self, record: Record) -> NDArray[np.int64]:
        """See `Family`."""
        return _receivers(self._lit[0], record)

    def write_points(self, record: Record, points: Floats, kinds: NDArray[np.int8]) -> None:
        """See `Family`."""
        trace, strips, lit = self._tracing.trace, self._strips, self._lit
        level_points(trace, self._rim, self._source, strips, lit, record, points, kinds)


ALL_HITS = 1 << 62


def all_hits(tracing: Tracing, tree: Tree) -> Hits:
    """Receivers in the beams of a tree."""
    beams = np.arange(len(tree.link))
    return hit_points(tracing.trace.plan, tree, tracing.targets, beams, ALL_HITS)[0]


def hits_in_lots(tracing: Tracing, tree: Tree, beams: Ints | None) -> Iterator[Hits]:
    """Receivers in the beams of a tree, or in some of them, so many at a time."""
    beams = np.arange(len(tree.link)) if beams is None else beams
    while len(beams):
        hits, done = hit_points(tracing.trace.plan, tree, tracing.targets, beams, HITS_AT_ONCE)
        beams = beams[done:]
        yield hits


def _receivers(hits: Hits, record: Record) -> NDArray[np.int64]:
    return hits.pair[record.key[: record.used[0], 0], 0].astype(np.int64)


def all_families(tracing: Tracing) -> list[Family]:
    """Return the families that together hold every path of a trace, each path once.

    Edges that the source does not light are left out; the most lit ones come first, so that
    threads have about the same to do.
    """
    families: list[Family] = [Reflections(tracing)]
    if not tracing.config.max_diffractions:
        return families
    view = tracing.trace.plan
    lit = np.bincount(tracing.corners.pair[:, 0], minlength=int(view.vertex.max()) + 1)
    rims = np.bincount(tracing.rims[:, 0], minlength=len(view.line))
    upright = [(lit[e.vertex], OverVerticalEdge(tracing, e)) for e in tracing.scene.vertical_edges]
    level = [
        (rims[list(e.plan_edges)].sum(), OverHorizontalEdge(tracing, e, side))
        for e in tracing.scene.horizontal_edges
        for side in (0, 1)
    ]
    by_legs = sorted([*upright, *level], key=lambda counted: -counted[0])
    return families + [family for n_legs, family in by_legs if n_legs]
