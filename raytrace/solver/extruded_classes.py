"""The path classes of an extruded building: reflected only, over a vertical, a horizontal edge."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from raytrace.arrays import Floats, Ints
from raytrace.config import TraceConfig
from raytrace.geometry import edges
from raytrace.kernels.beam_hits import Hits, hit_points, no_hits
from raytrace.kernels.beams import FRACTION, ORDER, Tree, grow_tree, no_tree
from raytrace.kernels.edge_rays import edge_frame
from raytrace.kernels.guard import Guard
from raytrace.kernels.horizontal_edge_legs import (
    HorizontalEdgeArrays,
    HorizontalEdgeBeams,
    ImagesIn,
    new_edge_workspace,
)
from raytrace.kernels.horizontal_edges import sum_horizontal_edge
from raytrace.kernels.lanes import WIDTH
from raytrace.kernels.path_points import (
    horizontal_edge_points,
    reflection_points,
    vertical_edge_points,
)
from raytrace.kernels.plan_view import GRAZING_M
from raytrace.kernels.records import Record
from raytrace.kernels.reflections import ReflectionBeams, sum_reflections
from raytrace.kernels.steps import Steps
from raytrace.kernels.strip_hits import hit_from_strip
from raytrace.kernels.strips import grow_strips, no_strips
from raytrace.kernels.sums import Sums, sums_bytes, sums_from
from raytrace.kernels.unfolding import max_interactions, new_leg
from raytrace.kernels.vertical_edge_bounds import edge_bounds, no_bounds
from raytrace.kernels.vertical_edge_legs import (
    LegsIn,
    VerticalEdgeArrays,
    VerticalEdgeBeams,
    leg_bytes,
    legs_to_edge,
)
from raytrace.kernels.vertical_edges import sum_vertical_edge
from raytrace.kernels.wedge import new_wedge
from raytrace.kernels.workspace import Collector, new_workspace
from raytrace.scene import Scene
from raytrace.solver.accumulate import sums_in_work
from raytrace.solver.beam_class import BeamClass, HeightSums
from raytrace.solver.limits import check_whole, nbytes, taking
from raytrace.solver.loss_limits import (
    Arrivals,
    AtHorizontalEdge,
    continuations,
    edge_heights,
    edge_power,
    limits_from_horizontal_edge,
    limits_from_vertical_edge,
    shadow_of,
    strong_arrivals,
)
from raytrace.solver.path_class import Evaluation, Evaluations, PathClass
from raytrace.solver.setup import BEAMS, Tracing

RECEIVER_BYTES = 240
"""Memory of a receiver and of its results, without sums."""

LEGS = "the legs to an edge"


class Reflected(NamedTuple):
    """Sums over the paths without a diffraction, and what they were computed with."""

    evaluations: list[Evaluation]
    sums: list[Sums]


class Reflections(BeamClass[ReflectionBeams]):
    """Line of sight and every sequence of reflections.

    Parameters
    ----------
    tracing, heights
        See `BeamClass`.
    known
        Sums that were made before, to limit the other classes.
    """

    def __init__(
        self,
        tracing: Tracing,
        heights: HeightSums | None = None,
        known: Reflected | None = None,
    ) -> None:
        super().__init__(tracing, heights)
        self._known = known

    def _grow(self) -> tuple[ReflectionBeams, float]:
        return ReflectionBeams(self._tracing.tree, no_hits()), self._tracing.left_out

    def _least(self) -> Floats:
        return self._tracing.least

    def sum_each(self, evaluations: Sequence[Evaluation], beams: Ints | None = None) -> list[Sums]:
        """See `PathClass`."""
        known = self._known
        if beams is None and known is not None and list(evaluations) == known.evaluations:
            return [sums_from(sums, 0) for sums in known.sums]
        return super().sum_each(evaluations, beams)

    def _n_beams(self, beams: ReflectionBeams) -> int:
        return len(beams.tree.link)

    def _most_walls(self, beams: ReflectionBeams) -> int:
        return max_interactions(beams.tree.link)

    def _hit(
        self, beams: ReflectionBeams, numbers: Ints, max_hits: int, guard: Guard
    ) -> tuple[ReflectionBeams, int]:
        hits, done = _hits_of_tree(self._tracing, beams.tree, numbers, max_hits, guard)
        return beams._replace(hits=hits), done

    def _evaluate(self, beams: ReflectionBeams, group: Evaluations, collector: Collector) -> None:
        geometry, leg = self._tracing.geometry, new_leg(beams.tree.link)
        workspace = new_workspace(geometry.max_reflections, len(leg.types), len(group.numbers) - 1)
        sum_reflections(geometry, group.every, beams, leg, workspace, collector)

    def _write_points(
        self, beams: ReflectionBeams, record: Record, points: Floats, steps: Steps
    ) -> None:
        leg = new_leg(beams.tree.link)
        t = self._tracing
        reflection_points(t.geometry, beams, leg, record, points, steps, t.guard)


class OverVerticalEdge(BeamClass[VerticalEdgeBeams]):
    """Every path that one vertical edge diffracts."""

    def __init__(
        self,
        tracing: Tracing,
        edge: edges.VerticalEdge,
        counts: Floats,
        heights: HeightSums | None = None,
    ) -> None:
        super().__init__(tracing, heights)
        self._cells, self._vertex = edge.cells, edge.vertex
        self._edge = VerticalEdgeArrays(
            edge.x, edge.y, *_heights(edge, tracing.scene.height_m), edge.o_face_azimuth,
            new_wedge(edge.wedge_n, edge.o_slab, edge.n_slab),
        )  # fmt: skip
        self._power_behind = edge_power(tracing.config, self._edge.wedge.is_sheet)
        self._counts = counts

    def _legs_in(self) -> tuple[LegsIn, float]:
        """Return the legs to the edge, and a bound on the power of paths over those left out."""
        t, tree, corners = self._tracing, self._tracing.tree, self._tracing.corners
        mine = np.flatnonzero(corners.pair[:, 0] == self._vertex)
        mine = mine[np.argsort(tree.link[corners.pair[mine, 1], ORDER], kind="stable")]
        beams, weight = corners.pair[mine, 1], corners.weight[mine]
        to_edge = tree.beam[beams, :2] - (self._edge.x, self._edge.y)
        order, length = tree.link[beams, ORDER].astype(np.int64), np.hypot(*to_edge.T)
        arrivals = Arrivals(order, length, self._power_behind * tree.beam[beams, FRACTION])
        view, at = t.scene.view, np.array([self._edge.x, self._edge.y])
        kept, left_out = strong_arrivals(arrivals, t.limits, self._counts, view, (at, at))
        guard = taking(t.guard, len(kept) * leg_bytes(tree.link[beams[kept]]), LEGS)
        legs = legs_to_edge(view, tree, beams[kept], weight[kept], self._edge, guard)
        check_whole(guard, True, LEGS)
        return legs, left_out

    def _grow(self) -> tuple[VerticalEdgeBeams, float]:
        t, (legs, left_out) = self._tracing, self._legs_in()
        tree, ranks = no_tree(), np.empty((0, 4))
        if len(legs.order):
            limits = limits_from_vertical_edge(self._edge, legs, t.limits, self._counts)
            ranks = limits.loss.ranks
            root = (self._edge.x, self._edge.y)
            guard = taking(t.guard, nbytes(legs), LEGS)
            tree, behind, is_whole = grow_tree(
                t.scene.view, t.heights, root, self._cells, limits, guard
            )
            check_whole(guard, is_whole, BEAMS)
            left_out += behind
        return VerticalEdgeBeams(self._edge, legs, tree, no_hits(), ranks), left_out

    def _most_walls(self, beams: VerticalEdgeBeams) -> int:
        return max_interactions(self._tracing.tree.link) + max_interactions(beams.tree.link)

    def _n_beams(self, beams: VerticalEdgeBeams) -> int:
        return len(beams.tree.link)

    def _hit(
        self, beams: VerticalEdgeBeams, numbers: Ints, max_hits: int, guard: Guard
    ) -> tuple[VerticalEdgeBeams, int]:
        hits, done = _hits_of_tree(self._tracing, beams.tree, numbers, max_hits, guard)
        return beams._replace(hits=hits), done

    def _evaluate(self, beams: VerticalEdgeBeams, group: Evaluations, collector: Collector) -> None:
        geometry, tables = self._tracing.geometry, group.first.tables
        leg = new_leg(beams.tree.link)
        bounds = no_bounds()
        if collector.min_power > 0.0 or len(collector.least):
            shadow = shadow_of(self._tracing.limits, group.first, self._edge.wedge.o_slab)
            bounds = edge_bounds(geometry, tables, beams.legs, shadow, self._power_behind)
        most = max(len(leg.types), beams.legs.types.shape[1])
        workspace = new_workspace(geometry.max_reflections, most, len(group.numbers) - 1)
        sum_vertical_edge(geometry, group.every, beams, bounds, leg, workspace, collector)

    def _write_points(
        self, beams: VerticalEdgeBeams, record: Record, points: Floats, steps: Steps
    ) -> None:
        leg = new_leg(beams.tree.link)
        t = self._tracing
        rows = np.empty((3, WIDTH))
        vertical_edge_points(t.geometry, beams, leg, record, points, steps, rows, t.guard)


def _heights(edge: edges.VerticalEdge, height_m: float) -> tuple[float, float]:
    """Heights between which a path may cross; floor and ceiling do not end an edge."""
    low = edge.z_low if edge.z_low > GRAZING_M else -1.0
    return low, edge.z_high if edge.z_high < height_m - GRAZING_M else height_m + 1.0


class OverHorizontalEdge(BeamClass[HorizontalEdgeBeams]):
    """Every path that leaves one side of a horizontal edge (side 0 or 1 of its plan edges)."""

    def __init__(
        self,
        tracing: Tracing,
        edge: edges.HorizontalEdge,
        side: int,
        counts: Floats,
        heights: HeightSums | None = None,
    ) -> None:
        super().__init__(tracing, heights)
        self._near, self._far = edge.plan_edges[side], edge.plan_edges[1 - side]
        self._edge = HorizontalEdgeArrays(
            edge_frame(tracing.scene.view, self._near), edge.z, 1.0 if edge.wall_above else -1.0,
            new_wedge(2.0, edge.material, edge.material),
        )  # fmt: skip
        self._power_behind = edge_power(tracing.config, True)
        self._counts = counts

    def _images_in(self) -> tuple[ImagesIn, float]:
        """Return the beams to the edge, and a bound on the power of paths over those left out."""
        t = self._tracing
        x1, y1, x2, y2 = t.scene.view.ends[self._near]
        length = np.hypot(x2 - x1, y2 - y1)
        walls = t.partial_walls[:, 0]
        mine = np.flatnonzero((walls == self._near) | (walls == self._far))
        beams = t.partial_walls[mine, 1]
        order = np.argsort(t.tree.link[beams, ORDER], kind="stable")
        mine, beams = mine[order], beams[order]
        interval = t.intervals[mine]
        turned = (t.partial_walls[mine, 0] == self._far)[:, None]
        interval = np.where(turned, 1.0 - interval[:, ::-1], interval) * length
        frame, image = self._edge.frame, t.tree.beam[beams]
        h = frame[3] * image[:, 0] + frame[4] * image[:, 1] + frame[5]
        nearest, farthest = self._distances(h)
        images = ImagesIn(
            order=t.tree.link[beams, ORDER].astype(np.int64),
            beam=beams.astype(np.int64),
            x=frame[0] * image[:, 0] + frame[1] * image[:, 1] + frame[2],
            h=h,
            low=np.ascontiguousarray(interval[:, 0]),
            high=np.ascontiguousarray(interval[:, 1]),
            fraction=np.ascontiguousarray(image[:, FRACTION]),
            nearest=nearest,
            farthest=farthest,
        )
        ends = t.scene.view.ends[self._near]
        place, arrivals = (ends[:2], ends[2:]), self._arrivals(images)
        kept, left_out = strong_arrivals(arrivals, t.limits, self._counts, t.scene.view, place)
        columns: Any = images
        return ImagesIn(*(column[kept] for column in columns)), left_out

    def _distances(self, h: Floats) -> tuple[Floats, Floats]:
        """See `ImagesIn.nearest` and `farthest`, for images (n,) that far off in the plan view."""
        across = np.hypot(h[:, None], self._tracing.geometry.transmitter_z - self._edge.z)
        columns = [across[:, :1], *(across[:, k : k + 2] for k in range(1, across.shape[1], 2))]
        near = np.column_stack([c.min(axis=1) for c in columns])
        far = np.column_stack([c.max(axis=1) for c in columns])
        return np.minimum.accumulate(near, axis=1), np.maximum.accumulate(far, axis=1)

    def _arrivals(self, images: ImagesIn) -> Arrivals:
        aside = np.maximum(np.maximum(images.low - images.x, images.x - images.high), 0.0)
        fraction = self._power_behind * images.fraction
        along = np.column_stack([images.low - images.x, images.high - images.x])
        sines = along / np.maximum(np.hypot(along, images.h[:, None]), 1e-12)
        meets = np.column_stack([images.x, images.low, images.high])
        across = np.ascontiguousarray(np.stack([images.nearest, images.farthest], axis=-1))
        length = np.hypot(aside, images.h)
        at = AtHorizontalEdge(sines, images.h, meets, across)
        return Arrivals(images.order, length, fraction, at)

    def _grow(self) -> tuple[HorizontalEdgeBeams, float]:
        t, view, (images, left_out) = self._tracing, self._tracing.scene.view, self._images_in()
        strips, loss = no_strips(), t.limits.loss
        if len(images.order):
            cell = int(np.searchsorted(view.cell_edges, self._near, side="right")) - 1
            ends = edge_heights(t.scene, t.heights, self._edge, t.limits, self._power_behind)
            limits = limits_from_horizontal_edge(
                self._arrivals(images), t.limits, self._counts, ends
            )
            loss = limits.loss
            guard = taking(t.guard, nbytes((images, loss.over_edge)), LEGS)
            heights = t.heights._replace(start=self._edge.z)
            strips, behind, is_whole = grow_strips(view, heights, self._near, cell, limits, guard)
            check_whole(guard, is_whole, BEAMS)
            left_out += behind
        no_points = no_hits(), np.empty((0, 4))
        ways = loss.ranks, loss.over_edge * self._power_behind
        return HorizontalEdgeBeams(self._edge, t.tree, images, strips, *no_points, *ways), left_out

    def _most_walls(self, beams: HorizontalEdgeBeams) -> int:
        return max_interactions(beams.tree.link) + max_interactions(beams.strips.link)

    def _n_beams(self, beams: HorizontalEdgeBeams) -> int:
        return len(beams.strips.link)

    def _hit(
        self, beams: HorizontalEdgeBeams, numbers: Ints, max_hits: int, guard: Guard
    ) -> tuple[HorizontalEdgeBeams, int]:
        targets = self._tracing.targets
        hits, seen, done = hit_from_strip(beams.strips, targets, numbers, max_hits, guard)
        return beams._replace(hits=hits, seen=seen), done

    def _evaluate(
        self, beams: HorizontalEdgeBeams, group: Evaluations, collector: Collector
    ) -> None:
        geometry, n_others = self._tracing.geometry, len(group.numbers) - 1
        work, shadow = new_edge_workspace(geometry.max_reflections, beams, n_others), np.empty(0)
        if collector.min_power > 0.0 or len(collector.least):
            shadow = shadow_of(self._tracing.limits, group.first, self._edge.wedge.o_slab)
        sum_horizontal_edge(geometry, group.every, beams, shadow, work, collector)

    def _write_points(
        self, beams: HorizontalEdgeBeams, record: Record, points: Floats, steps: Steps
    ) -> None:
        geometry = self._tracing.geometry
        work = new_edge_workspace(geometry.max_reflections, beams)
        horizontal_edge_points(geometry, beams, work, record, points, steps, self._tracing.guard)


def _hits_of_tree(
    tracing: Tracing, tree: Tree, numbers: Ints, max_hits: int, guard: Guard
) -> tuple[Hits, int]:
    return hit_points(tracing.scene.view, tree, tracing.targets, numbers, max_hits, guard)


def cells_bytes(
    scene: Scene, n_cells: int, config: TraceConfig, threads: int, n_pairs: int = 1
) -> int:
    """Memory that the cells of a map take as receivers, with all sums over their paths [bytes]."""
    edges = len(scene.vertical_edges) + 2 * len(scene.horizontal_edges)
    in_work = sums_in_work(1 + config.max_diffractions * edges, threads)
    return n_cells * RECEIVER_BYTES + in_work * sums_bytes(n_cells, config.max_reflections, n_pairs)


def path_classes(tracing: Tracing, known: Reflected | None = None) -> list[PathClass]:
    """Return the classes that together hold every path of a trace, each path once.

    Edges that the transmitter's beams do not meet are left out; those that most beams meet come
    first, which balances the work of the threads. `known` is of this trace.
    """
    heights = HeightSums(tracing.geometry)
    classes: list[PathClass] = [Reflections(tracing, heights, known)]
    if not tracing.config.max_diffractions:
        return classes
    scene = tracing.scene
    at_vertex = np.bincount(tracing.corners.pair[:, 0], minlength=int(scene.view.vertex.max()) + 1)
    at_wall = np.bincount(tracing.partial_walls[:, 0], minlength=len(scene.view.line))
    counts = continuations(scene, tracing.config)
    vertical = [
        (at_vertex[e.vertex], OverVerticalEdge(tracing, e, counts.plain, heights))
        for e in scene.vertical_edges
    ]
    over = counts.from_horizontal
    horizontal = [
        (at_wall[list(e.plan_edges)].sum(), OverHorizontalEdge(tracing, e, side, over, heights))
        for e in scene.horizontal_edges
        for side in (0, 1)
    ]
    by_beams = sorted([*vertical, *horizontal], key=lambda counted: -counted[0])
    return classes + [path_class for n_beams, path_class in by_beams if n_beams]
