"""What a map will cost, estimated before it is traced.

Some of the path classes are traced to the full order, for some of the receivers: the classes whose
edges most beams meet, which hold most paths, and every k-th of the others; of large trees the first
beams and every k-th run of the others; receivers in tiles, as a beam that holds one holds its
neighbours too, which share a block then. The choice depends neither on chance nor on the clock, so
the estimated number of paths does not either.
"""

import time
from dataclasses import dataclass, replace

import numpy as np

from raytrace.arrays import Floats, Ints
from raytrace.config import TraceConfig
from raytrace.grid import Grid
from raytrace.kernels.sums import Sums, add_sums, new_sums
from raytrace.radio.transmitter import Transmitter
from raytrace.scene import Scene
from raytrace.solver.accumulate import AHEAD
from raytrace.solver.evaluation import evaluation_of
from raytrace.solver.extruded_classes import path_classes
from raytrace.solver.path_class import PathClass
from raytrace.solver.setup import prepare
from raytrace.threads import n_threads

LARGEST = 16
"""The classes whose edges most beams meet are all traced, this many."""

OTHERS = 24
"""About this many of the other classes are traced."""

BEAMS = 2048
"""Of a larger tree the first beams, which hold most receivers, and about as many others."""

RUN = 32
"""Beams of a run: neighbours in a tree, of about as many reflections."""

TILE = 4
"""Cells along the side of a tile."""

RECEIVERS = 8192
"""Receivers in tiles, about."""

GOLDEN = 0.618
"""Shift of the tiles from row to row, as a fraction of their distance."""

REACHED_RECEIVERS = 64
"""More tiles are taken until this many of their receivers have a path."""

BYTES_A_BEAM = 320
"""Memory of a beam while its tree grows, about."""


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
        Memory for sums and for beams, beyond what the process uses already.
    """

    paths: int
    seconds: float
    memory_bytes: int


@dataclass(frozen=True)
class _Sample:
    """Cost and paths of some path classes for some receivers, scaled to all classes.

    Attributes
    ----------
    n_classes, n_reached
        Number of all path classes, and of receivers with a path.
    paths
        Number of paths.
    growing_s, summing_s
        Time for the beams, and for finding receivers in them and summing the paths [s].
    most_beams
        Beams of the largest tree.
    """

    n_classes: int
    n_reached: int
    paths: float
    growing_s: float
    summing_s: float
    most_beams: int


def estimate_cost(
    scene: Scene,
    transmitter: Transmitter,
    grid: Grid,
    config: TraceConfig | None = None,
    *,
    threads: int | None = None,
) -> CostEstimate:
    """Estimate what `compute_radio_map` will take, within a factor of two or so.

    Parameters
    ----------
    scene, transmitter, grid, config
        As for `compute_radio_map`.
    threads
        Number of threads that the map will be traced with; all processors by default.

    Raises
    ------
    SceneError
        Where the transmitter is not inside the building.
    """
    config, threads = config or TraceConfig(), n_threads(threads)
    n_receivers = grid.x.size * grid.y.size
    every = max(1, n_receivers // RECEIVERS)
    # once for the compiler, whose time does not count
    _sampled(scene, transmitter, grid.points()[:1], replace(config, max_reflections=1))
    while True:
        points = _in_tiles(grid, every)
        sample = _sampled(scene, transmitter, points, config)
        if every == 1 or sample.n_reached >= REACHED_RECEIVERS:
            break
        every //= 2
    everywhere = n_receivers / len(points)
    started = time.perf_counter()
    prepare(scene, transmitter.position, grid.points(), replace(config, max_reflections=0))
    preparing = time.perf_counter() - started
    working = (sample.growing_s + everywhere * sample.summing_s) / threads
    a_sum = new_sums(n_receivers, config.max_reflections)
    in_work = min(sample.n_classes, AHEAD * threads + 1) + 1
    return CostEstimate(
        round(sample.paths * everywhere),
        preparing + working + sample.n_classes * _seconds_to_add(a_sum),
        in_work * sum(part.nbytes for part in a_sum) + threads * BYTES_A_BEAM * sample.most_beams,
    )


def _in_tiles(grid: Grid, every: int) -> Floats:
    """Return the cells (n, 3) [m] of one in so many tiles, some in each row and column of tiles."""
    x, y = np.arange(grid.x.size) // TILE, np.arange(grid.y.size) // TILE
    turn = x[None, :] + max(1, round(GOLDEN * every)) * y[:, None]
    return grid.points()[(turn % every == 0).ravel()]


def _sampled(
    scene: Scene, transmitter: Transmitter, points: Floats, config: TraceConfig
) -> _Sample:
    """Trace some of the path classes for some receivers."""
    started = time.perf_counter()
    tracing = prepare(scene, transmitter.position, points, config)
    evaluation = evaluation_of(scene.slabs, transmitter, config)
    classes = path_classes(tracing)
    growing, reached = time.perf_counter() - started, np.zeros(len(points), np.bool_)
    summing = paths = 0.0
    most_beams = len(tracing.tree.link)
    for path_class, weight in _some(classes):
        started = time.perf_counter()
        n_beams = path_class.grow()
        growing += weight * (time.perf_counter() - started)
        most_beams = max(most_beams, n_beams)
        for beams, each in _some_beams(n_beams):
            started = time.perf_counter()
            sums = path_class.sum_paths(evaluation, beams)
            summing += weight * each * (time.perf_counter() - started)
            paths += weight * each * float(sums.n_paths.sum())
            reached |= sums.power > 0.0
    n_reached = int(np.count_nonzero(reached))
    return _Sample(len(classes), n_reached, paths, growing, summing, most_beams)


def _some(classes: list[PathClass]) -> list[tuple[PathClass, int]]:
    """Return some classes, the largest ones first, and how many each of them stands for."""
    others = classes[LARGEST:]
    step = max(1, round(len(others) / OTHERS))
    return [(c, 1) for c in classes[:LARGEST]] + [(c, step) for c in others[step // 2 :: step]]


def _some_beams(n: int) -> list[tuple[Ints, float]]:
    """Return the first of n beams, and some of the others with how many each stands for."""
    first, others = np.arange(min(n, BEAMS)), np.arange(min(n, BEAMS), n)
    every = max(1, len(others) // BEAMS)
    some = others[others // RUN % every == every // 2]
    return [(first, 1.0), (some, len(others) / max(len(some), 1))]


def _seconds_to_add(sums: Sums) -> float:
    """Return the time to add the sums of a path class to those of the others [s]."""
    started = time.perf_counter()
    add_sums(sums, new_sums(len(sums.power), sums.n_paths.shape[1] - 1))
    return time.perf_counter() - started
