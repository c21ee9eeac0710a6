"""What a map will cost, told before it is traced.

The map is traced for some of its receivers and some of the building's edges, to the full order.
Receivers are taken on a lattice that is refined until enough of them are lit; edges are taken all
near the transmitter, where most paths go over them, and every k-th one further away. Which ones
does not depend on chance or on the clock, so the paths that are foretold do not either.
"""

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from raytrace.edges import LevelEdge, UprightEdge
from raytrace.grid import Grid, TraceConfig
from raytrace.radio_map import RadioMap
from raytrace.scene import Scene
from raytrace.summing import default_threads
from raytrace.trace import compute_radio_map
from raytrace.transmitter import Transmitter

NEAREST_EDGES = 48
"""Edges nearest to the transmitter are all traced, of each kind this many."""

FURTHER_EDGES = 48
"""Of the others about as many."""

LIT_RECEIVERS = 64
"""The lattice of receivers is refined until so many of them are lit."""

FIRST_RECEIVERS = 100
"""Receivers of the coarsest lattice, about."""

TELLING_PATHS = 50_000
"""It is also refined for so many paths, which take long enough to tell the time of one."""

SECONDS_A_PATH = 1.5e-7
"""Where a whole map has fewer, a path takes about this long on one thread [s]."""

BYTES_A_HIT = 8
"""Memory of a receiver in a beam."""

Edge = TypeVar("Edge", UprightEdge, LevelEdge)


@dataclass(frozen=True)
class CostEstimate:
    """What a map will cost.

    Attributes
    ----------
    paths
        Number of paths that will be summed.
    seconds
        Time to trace it on this machine, with compiled kernels [s].
    memory_bytes
        Memory for sums and for receivers in beams, over what the process uses already.
    """

    paths: int
    seconds: float
    memory_bytes: int


@dataclass(frozen=True, eq=False)
class _Sample:
    """Some of a map's receivers and edges; one of `edge_step` further edges is in it."""

    grid: Grid
    near: Scene
    near_and_far: Scene
    edge_step: int
    source: Transmitter
    config: TraceConfig
    threads: int | None

    def trace(self, scene: Scene, grid: Grid | None = None) -> tuple[RadioMap, float]:
        """Return a map of some edges, and how long it took [s]."""
        started = time.perf_counter()
        radio_map = compute_radio_map(
            scene, self.source, grid or self.grid, self.config, threads=self.threads
        )
        return radio_map, time.perf_counter() - started


def estimate_cost(
    scene: Scene,
    source: Transmitter,
    grid: Grid,
    config: TraceConfig | None = None,
    *,
    threads: int | None = None,
) -> CostEstimate:
    """Estimate what `compute_radio_map` will take, within a factor of two or so.

    Parameters
    ----------
    scene, source, grid, config
        As for `compute_radio_map`.
    threads
        With how many the map will be traced; all processors by default.

    Raises
    ------
    SceneError
        Where the transmitter is not inside the building.
    """
    config = config or TraceConfig()
    sample = _sample_of(scene, source, grid, config, threads)
    step = _coarsest_step(grid)
    while True:
        sample = replace(sample, grid=_lattice(grid, step))
        near, _ = sample.trace(sample.near)
        enough = near.path_count.sum() >= TELLING_PATHS
        if step == 1 or (enough and np.count_nonzero(near.path_count) >= LIT_RECEIVERS):
            break
        step = max(1, step // 2)
    everywhere = grid.x.size * grid.y.size / near.path_count.size
    traced, seconds = sample.trace(sample.near_and_far)
    near_paths, traced_paths = int(near.path_count.sum()), int(traced.path_count.sum())
    paths = everywhere * (near_paths + sample.edge_step * (traced_paths - near_paths))
    return CostEstimate(
        round(paths),
        _seconds(sample, grid, paths, (traced_paths, seconds)),
        _bytes(grid, config, paths, threads),
    )


def _sample_of(
    scene: Scene, source: Transmitter, grid: Grid, config: TraceConfig, threads: int | None
) -> _Sample:
    x, y, _ = source.position
    n_edges = max(len(scene.upright_edges), len(scene.level_edges))
    step = max(1, round((n_edges - NEAREST_EDGES) / FURTHER_EDGES))
    upright = sorted(scene.upright_edges, key=lambda e: (e.x - x) ** 2 + (e.y - y) ** 2)
    middles = scene.view.ends.reshape(-1, 2, 2).mean(axis=1)
    away = np.hypot(*(middles - (x, y)).T)
    level = sorted(scene.level_edges, key=lambda e: float(away[e.plan_edges[0]]))
    near, both = (
        replace(scene, upright_edges=_some(upright, k), level_edges=_some(level, k))
        for k in (0, step)
    )
    return _Sample(grid, near, both, step, source, config, threads)


def _some(edges: Sequence[Edge], step: int) -> tuple[Edge, ...]:
    """Return the nearest edges, and every step-th further one; none of those for step 0."""
    further = edges[NEAREST_EDGES:]
    return (*edges[:NEAREST_EDGES], *(further[step // 2 :: step] if step else ()))


def _coarsest_step(grid: Grid) -> int:
    """Return the largest power of two that leaves enough receivers."""
    step = 1
    while grid.x.size * grid.y.size >= 4 * step**2 * FIRST_RECEIVERS:
        step *= 2
    return step


def _lattice(grid: Grid, step: int) -> Grid:
    return replace(grid, x=grid.x[step // 2 :: step], y=grid.y[step // 2 :: step])


def _seconds(sample: _Sample, whole: Grid, paths: float, traced: tuple[int, float]) -> float:
    """Time for the beams, for adding up all families' sums, and for the paths [s]."""
    shallow = replace(sample, config=replace(sample.config, max_reflections=0), grid=whole)
    _, adding = shallow.trace(sample.near_and_far)
    one = replace(sample.grid, x=sample.grid.x[:1], y=sample.grid.y[:1])
    _, near = sample.trace(sample.near, one)
    _, both = sample.trace(sample.near_and_far, one)
    beams = near + sample.edge_step * max(0.0, both - near)
    n, seconds = traced
    a_path = SECONDS_A_PATH / (sample.threads or default_threads())
    if n >= TELLING_PATHS:
        a_path = min(max((seconds - both) / n, 0.2 * a_path), 20.0 * a_path)
    return beams + sample.edge_step * adding + paths * a_path


def _bytes(grid: Grid, config: TraceConfig, paths: float, threads: int | None) -> int:
    """Memory for the sums of all families in work, and for receivers in beams."""
    receivers = grid.x.size * grid.y.size
    a_sum = 24 + 8 * (config.max_reflections + 1)
    in_work = 9 * (threads or default_threads()) + 1
    hits = paths / (config.max_reflections + 1)
    return round(in_work * a_sum * receivers + BYTES_A_HIT * hits)
