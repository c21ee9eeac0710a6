"""What a map will cost, told before it is traced.

Some of the families of paths are traced to the full order, for some of the receivers: the most
lit edges, where most paths go over, and every k-th of the others; of large trees the first beams
and every k-th run of the others; receivers in tiles, as a beam that lights one lights its
neighbours too, which are then done at once. Which ones does not depend on chance or on the clock,
so the paths that are foretold do not either.
"""

import time
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from raytrace.config import TraceConfig
from raytrace.grid import Grid
from raytrace.kernels.tracing import Sums, new_sums
from raytrace.radio.transmitter import Transmitter
from raytrace.scene import Scene
from raytrace.solver.accumulate import AHEAD, add_sums
from raytrace.solver.path_classes import Family, all_families
from raytrace.solver.setup import prepare
from raytrace.threads import n_threads

Floats = NDArray[np.float64]

MOST_LIT = 16
"""So many of the most lit families are all traced."""

OTHERS = 24
"""Of the others about as many."""

BEAMS = 2048
"""Of a larger tree the first beams are looked at, which light most, and about as many others."""

RUN = 32
"""Beams of a run: neighbours in a tree, of about as many reflections."""

TILE = 4
"""Cells along the side of a tile."""

RECEIVERS = 8192
"""Receivers in tiles, about."""

GOLDEN = 0.618
"""By so much of their distance tiles are shifted from row to row."""

LIT_RECEIVERS = 64
"""More tiles are taken until so many of their receivers are lit."""

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
        Memory for sums and for beams, over what the process uses already.
    """

    paths: int
    seconds: float
    memory_bytes: int


@dataclass(frozen=True)
class _Sample:
    """What some families took and found for some receivers, scaled to all families.

    Attributes
    ----------
    n_families, lit
        Number of all families, and of receivers with a path.
    paths
        Number of paths.
    growing_s, summing_s
        Time for the beams, and for finding receivers in them and summing the paths [s].
    most_beams
        Beams of the largest tree.
    """

    n_families: int
    lit: int
    paths: float
    growing_s: float
    summing_s: float
    most_beams: int


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
    config, threads = config or TraceConfig(), n_threads(threads)
    n_receivers = grid.x.size * grid.y.size
    every = max(1, n_receivers // RECEIVERS)
    # once for the compiler, which is not to be timed
    _sampled(scene, source, grid.points()[:1], replace(config, max_reflections=1))
    while True:
        points = _in_tiles(grid, every)
        sample = _sampled(scene, source, points, config)
        if every == 1 or sample.lit >= LIT_RECEIVERS:
            break
        every //= 2
    everywhere = n_receivers / len(points)
    started = time.perf_counter()
    prepare(scene, source, grid.points(), replace(config, max_reflections=0))
    preparing = time.perf_counter() - started
    working = (sample.growing_s + everywhere * sample.summing_s) / threads
    a_sum = new_sums(n_receivers, config.max_reflections)
    in_work = min(sample.n_families, AHEAD * threads + 1) + 1
    return CostEstimate(
        round(sample.paths * everywhere),
        preparing + working + sample.n_families * _seconds_to_add(a_sum),
        in_work * sum(part.nbytes for part in a_sum) + threads * BYTES_A_BEAM * sample.most_beams,
    )


def _in_tiles(grid: Grid, every: int) -> Floats:
    """Return the cells (n, 3) [m] of one in so many tiles, some in each row and column of tiles."""
    x, y = np.arange(grid.x.size) // TILE, np.arange(grid.y.size) // TILE
    turn = x[None, :] + max(1, round(GOLDEN * every)) * y[:, None]
    return grid.points()[(turn % every == 0).ravel()]


def _sampled(scene: Scene, source: Transmitter, points: Floats, config: TraceConfig) -> _Sample:
    """Trace some of the families for some receivers."""
    started = time.perf_counter()
    tracing = prepare(scene, source, points, config)
    families = all_families(tracing)
    growing, total = time.perf_counter() - started, new_sums(len(points), 0)
    summing = paths = 0.0
    most_beams = len(tracing.tree.link)
    for family, weight in _some(families):
        started = time.perf_counter()
        n_beams = family.grow()
        growing += weight * (time.perf_counter() - started)
        most_beams = max(most_beams, n_beams)
        for beams, each in _some_beams(n_beams):
            sums = new_sums(len(total.power), config.max_reflections)
            started = time.perf_counter()
            family.add_to(sums, beams)
            summing += weight * each * (time.perf_counter() - started)
            paths += weight * each * float(sums.n_paths.sum())
            total.power[:] += sums.power
    lit = int(np.count_nonzero(total.power))
    return _Sample(len(families), lit, paths, growing, summing, most_beams)


def _some(families: list[Family]) -> list[tuple[Family, int]]:
    """Return some families, the most lit ones come first, and for how many each of them stands."""
    others = families[MOST_LIT:]
    step = max(1, round(len(others) / OTHERS))
    return [(f, 1) for f in families[:MOST_LIT]] + [(f, step) for f in others[step // 2 :: step]]


def _some_beams(n: int) -> list[tuple[NDArray[np.int64], float]]:
    """Return the first of n beams, and some of the others with how many each stands for."""
    first, others = np.arange(min(n, BEAMS)), np.arange(min(n, BEAMS), n)
    every = max(1, len(others) // BEAMS)
    some = others[others // RUN % every == every // 2]
    return [(first, 1.0), (some, len(others) / max(len(some), 1))]


def _seconds_to_add(sums: Sums) -> float:
    """Return the time to add the sums of a family to those of the others [s]."""
    started = time.perf_counter()
    add_sums(sums, new_sums(len(sums.power), sums.n_paths.shape[1] - 1))
    return time.perf_counter() - started
