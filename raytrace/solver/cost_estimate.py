"""What a map will cost, estimated before it is traced.

Some of the path classes are traced to the full order, for some of the receivers: the classes whose
edges most beams meet, which hold most paths, and every k-th of the others; of large trees the first
beams and every k-th run of the others; receivers in tiles, as a beam that holds one holds its
neighbours too, which share a block then. The choice depends neither on chance nor on the clock, so
the estimated number of paths does not either.

Where even that takes too much time or memory, lower orders are traced, as many as there is time
for, and the estimate is extrapolated from the last two.
"""

import math
import time
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from raytrace.arrays import Floats, Ints
from raytrace.config import TraceConfig
from raytrace.errors import MemoryLimitError, TraceStoppedError
from raytrace.grid import Grid
from raytrace.kernels.guard import Guard
from raytrace.kernels.sums import PAIRS, add_sums, new_sums, sums_bytes
from raytrace.memory import memory_limit
from raytrace.radio.antennas import polarisations
from raytrace.radio.transmitter import Transmitter
from raytrace.scene import Scene
from raytrace.solver.accumulate import sums_in_work
from raytrace.solver.dynamic_range import prepare_within_range
from raytrace.solver.evaluation import evaluation_of
from raytrace.solver.extruded_classes import path_classes
from raytrace.solver.path_class import PathClass
from raytrace.solver.setup import prepare
from raytrace.solver.workers import Stop, Workers
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

LONGEST_S = 0.4
"""Processor time for the full order, and again for lower ones [s]."""

MAX_BYTES = 200 << 20
"""Memory for the beams of a class, while costs are estimated [bytes]."""

LEAST_POWER = 3.0
"""Numbers of paths are taken to grow at least with this power of the order."""

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
    is_extrapolated
        Whether the numbers follow from those of fewer reflections; then only their order of
        magnitude is known.
    seconds_for_beams
        The part of `seconds` that does not depend on the number of cells [s].
    seconds_of_lower_orders
        Time with 0, 1, ... reflections [s]; only where some of them were traced.
    """

    paths: int
    seconds: float
    memory_bytes: int
    is_extrapolated: bool = False
    seconds_for_beams: float = 0.0
    seconds_of_lower_orders: tuple[float, ...] = ()


@dataclass(frozen=True)
class _Sample:
    """Cost and paths of some path classes for some receivers, scaled to all classes.

    Attributes
    ----------
    n_classes, n_receivers, n_reached
        Number of all path classes, of receivers, and of those with a path.
    paths
        Number of paths.
    preparing_s, growing_s, summing_s
        Time for the receivers, for the beams, and for finding receivers in them and summing the
        paths [s].
    most_beams
        Beams of the largest tree.
    """

    n_classes: int
    n_receivers: int
    n_reached: int
    paths: float
    preparing_s: float
    growing_s: float
    summing_s: float
    most_beams: float

    def seconds(self, n_receivers: int, threads: int, adding_s: float) -> float:
        """Time for so many receivers, where a class's sum of one is added in `adding_s` [s]."""
        everywhere = n_receivers / self.n_receivers
        working = (self.growing_s + everywhere * self.summing_s) / threads
        return everywhere * self.preparing_s + working + self.n_classes * n_receivers * adding_s


def estimate_cost(
    scene: Scene,
    transmitter: Transmitter,
    grid: Grid,
    config: TraceConfig | None = None,
    *,
    threads: int | None = None,
    stop: Stop | None = None,
    max_memory_bytes: int | None = None,
) -> CostEstimate:
    """Estimate what `compute_radio_map` will take, with about a second of processor time.

    Within a factor of two or so; where the numbers are extrapolated from fewer reflections, their
    order of magnitude.

    Parameters
    ----------
    scene, transmitter, grid, config
        As for `compute_radio_map`.
    threads
        Number of threads that the map will be traced with; all processors by default.
    stop, max_memory_bytes
        As for `compute_radio_map`; they apply to the estimate itself, which takes some 200 MB at
        most.

    Raises
    ------
    SceneError
        Where the transmitter is not inside the building.
    TraceStoppedError
        Where `stop` has ended the estimate.
    MemoryLimitError
        Where even line of sight needs more memory than `max_memory_bytes`.
    """
    config, threads = config or TraceConfig(), n_threads(threads)
    n_receivers = grid.x.size * grid.y.size
    max_bytes = min(MAX_BYTES, memory_limit(max_memory_bytes))
    sampler = _Sampler(scene, transmitter, grid, stop or _never, max_bytes)
    sampler.compile(config)
    sample, lower = sampler.sample(config, LONGEST_S), list[_Sample]()
    is_extrapolated = sample is None
    if sample is None:
        lower = sampler.lower_orders(config)
        known = lower or [sampler.least(config)]
        sample = _extrapolated(known, config.max_reflections)
    if lower:
        lower += [_extrapolated(lower, n) for n in range(len(lower), config.max_reflections)]
    adding_s = _seconds_to_add(sample.n_receivers, config) / sample.n_receivers
    in_work = sums_in_work(sample.n_classes, threads)
    n_pairs = PAIRS if len(polarisations(transmitter.antenna)) > 1 else 1
    sums = in_work * sums_bytes(n_receivers, config.max_reflections, n_pairs)
    return CostEstimate(
        round(sample.paths * n_receivers / sample.n_receivers),
        sample.seconds(n_receivers, threads, adding_s),
        sums + round(threads * BYTES_A_BEAM * sample.most_beams),
        is_extrapolated,
        sample.growing_s / threads,
        tuple(order.seconds(n_receivers, threads, adding_s) for order in lower),
    )


@dataclass(frozen=True)
class _Sampler:
    """Traces some of the path classes of a map for some of its cells."""

    scene: Scene
    transmitter: Transmitter
    grid: Grid
    stop: Stop
    max_bytes: int

    def compile(self, config: TraceConfig) -> None:
        """Compile the kernels, whose time does not count."""
        transmissions = 0 if config.max_transmissions == 0 else 1
        small = replace(config, max_reflections=1, max_transmissions=transmissions)
        point = np.array([[self.grid.x[0], self.grid.y[0], self.grid.height_m]])
        with Workers(1, self.stop) as workers, suppress(MemoryLimitError):
            workers.run(self._traced, point, small, workers.guard(self.max_bytes))

    def lower_orders(self, config: TraceConfig) -> list[_Sample]:
        """Return samples of 0, 1, ... reflections, as many as there is time for."""
        samples: list[_Sample] = []
        ends_s = time.process_time() + LONGEST_S
        for order in range(config.max_reflections):
            left_s = ends_s - time.process_time()
            found = self.sample(replace(config, max_reflections=order), left_s)
            if found is None:
                break
            samples.append(found)
        return samples

    def least(self, config: TraceConfig) -> _Sample:
        """Return the sample of line of sight alone."""
        return self._sampled(TraceConfig(0, 0, min_power_dbm=config.min_power_dbm), math.inf)

    def sample(self, config: TraceConfig, longest_s: float) -> _Sample | None:
        """Return a sample; None where it takes too much time or memory."""
        try:
            return self._sampled(config, longest_s)
        except (TraceStoppedError, MemoryLimitError):
            if self.stop():
                raise
            return None

    def _sampled(self, config: TraceConfig, longest_s: float) -> _Sample:
        """Return a sample of more and more receivers, until enough of them have a path."""
        ends_s = time.process_time() + longest_s
        every = max(1, self.grid.x.size * self.grid.y.size // RECEIVERS)
        with Workers(1, lambda: self.stop() or time.process_time() > ends_s) as workers:
            guard = workers.guard(self.max_bytes)
            while True:
                points = _in_tiles(self.grid, every)
                found = workers.run(self._traced, points, config, guard)
                enough = found.n_reached >= REACHED_RECEIVERS or len(points) > 8 * RECEIVERS
                if every == 1 or enough:
                    return found
                every //= 2

    def _traced(self, points: Floats, config: TraceConfig, guard: Guard) -> _Sample:
        started = time.perf_counter()
        none = replace(config, max_reflections=0, max_transmissions=0)
        prepare(self.scene, self.transmitter.position, points, none, guard)
        preparing = time.perf_counter() - started
        started = time.perf_counter()
        evaluation = evaluation_of(self.scene.slabs, self.transmitter, config)
        position = self.transmitter.position
        tracing, _ = prepare_within_range(self.scene, position, points, config, guard, [evaluation])
        classes = path_classes(tracing)
        n_classes, chosen = len(classes), _some(classes)
        del classes  # the beams of each are dropped with it
        growing, reached = time.perf_counter() - started, np.zeros(len(points), np.bool_)
        summing = paths = 0.0
        most_beams = len(tracing.tree.link)
        while chosen:
            path_class, weight = chosen.pop(0)
            started = time.perf_counter()
            n_beams = path_class.grow()
            growing += weight * (time.perf_counter() - started)
            most_beams = max(most_beams, n_beams)
            for beams, each in _some_beams(n_beams):
                started = time.perf_counter()
                sums = path_class.sum_paths(evaluation, beams)
                taken = time.perf_counter() - started
                summing += weight * each * taken
                paths += weight * each * float(sums.n_paths.sum())
                reached |= sums.power > 0.0
        n_reached = int(np.count_nonzero(reached))
        return _Sample(
            n_classes, len(points), n_reached, paths, preparing, growing, summing, most_beams
        )


def _never() -> bool:
    """Stop no estimate."""
    return False


def _extrapolated(samples: list[_Sample], max_reflections: int) -> _Sample:
    """Let numbers grow with the power of the order by which the last two samples differ."""
    last, n = samples[-1], len(samples)

    def grown(name: str) -> float:
        power, now = LEAST_POWER, float(getattr(last, name))
        then = float(getattr(samples[-2], name)) if n > 1 else 0.0
        if then > 0.0 and now > 0.0:
            power = max(power, math.log(now / then) / math.log(n / (n - 1)))
        return now * ((max_reflections + 1) / n) ** power

    names = ("paths", "growing_s", "summing_s", "most_beams")
    return replace(last, **{name: grown(name) for name in names})


def _in_tiles(grid: Grid, every: int) -> Floats:
    """Return the cells (n, 3) [m] of one in so many tiles, some in each row and column of tiles."""
    n_x, n_y = grid.x.size, grid.y.size
    x, y = np.arange(math.ceil(n_x / TILE)), np.arange(math.ceil(n_y / TILE))
    turn = x[None, :] + max(1, round(GOLDEN * every)) * y[:, None]
    tile_y, tile_x = np.nonzero(turn % every == 0)
    within = np.arange(TILE)
    i_y = (tile_y[:, None, None] * TILE + within[:, None]) + 0 * within
    i_x = (tile_x[:, None, None] * TILE + within) + 0 * within[:, None]
    inside = (i_y < n_y) & (i_x < n_x)
    number = np.sort(i_y[inside] * n_x + i_x[inside])
    i_y, i_x = number // n_x, number % n_x
    return np.column_stack([grid.x[i_x], grid.y[i_y], np.full(len(number), grid.height_m)])


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


def _seconds_to_add(n_receivers: int, config: TraceConfig) -> float:
    """Return the time to add the sums of a path class to those of the others [s]."""
    total, part = (new_sums(n_receivers, config.max_reflections) for _ in range(2))
    part.touched[:] = True
    add_sums(total, part)  # compiled or loaded, whose time does not count
    started = time.perf_counter()
    add_sums(total, part)
    return time.perf_counter() - started
