"""Sums over all paths, on any number of threads with the same result."""

import math
from collections import deque
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from raytrace.kernels.tracing import STRONGEST, Sums, new_sums
from raytrace.solver.path_classes import Family, all_families
from raytrace.solver.setup import Tracing
from raytrace.threads import n_threads

Floats = NDArray[np.float64]

Progress = Callable[[int, int], None]
"""Called with the number of finished parts and of all parts."""


AHEAD = 4
"""Families in work, or waiting for their turn to be added, a thread."""


def sum_paths(
    tracing: Tracing, threads: int | None = None, progress: Progress | None = None
) -> Sums:
    """Sum every path of a trace at each receiver.

    Parameters
    ----------
    tracing
        What to trace.
    threads
        How many; all processors by default. The result does not depend on it.
    progress
        Called as families are done.
    """
    threads = n_threads(threads)
    if tracing.config.max_paths is not None:
        bounded = _sum(with_least_power(tracing, math.inf), threads, None)
        least = _least_power(bounded.bins, tracing.config.max_paths)
        tracing = with_least_power(tracing, max(least, tracing.trace.least_power))
    return _sum(tracing, threads, progress)


def with_least_power(tracing: Tracing, least_power: float) -> Tracing:
    """Return the same trace, which leaves out paths below another power."""
    return replace(tracing, trace=tracing.trace._replace(least_power=least_power))


def _least_power(bins: Floats, max_paths: int) -> float:
    """Lowest power, of whole decibels, above which there are no more paths than that."""
    kept = np.cumsum(bins)
    if kept[-1] <= max_paths:
        return 0.0
    return float(10.0 ** (-0.1 * np.flatnonzero(kept > max_paths)[0]))


def _sum(tracing: Tracing, threads: int, progress: Progress | None) -> Sums:
    """Sum families as they are done, in their order."""
    families = deque(all_families(tracing))
    n_families = len(families)
    total = new_sums(len(tracing.trace.receivers), tracing.config.max_reflections)
    for done, part in enumerate(_in_order(tracing, families, threads), 1):
        add_sums(total, part)
        if progress is not None:
            progress(done, n_families)
    return total


def add_sums(total: Sums, part: Sums) -> None:
    """Add the sums of some paths to those of others."""
    strongest = np.maximum(total.moments[:, STRONGEST], part.moments[:, STRONGEST])
    for whole, addend in zip(total, part, strict=True):
        whole += addend
    total.moments[:, STRONGEST] = strongest


def _in_order(tracing: Tracing, families: deque[Family], threads: int) -> Iterator[Sums]:
    """Sums of each family, in their order, computed a few ahead; a family is then let go."""

    def sums_of(family: Family) -> Sums:
        sums = new_sums(len(tracing.trace.receivers), tracing.config.max_reflections)
        family.add_to(sums)
        return sums

    pool = ThreadPoolExecutor(threads)
    try:
        ahead: deque[Future[Sums]] = deque()
        while families:
            ahead.append(pool.submit(sums_of, families.popleft()))
            if len(ahead) > AHEAD * threads:
                yield ahead.popleft().result()
        while ahead:
            yield ahead.popleft().result()
    finally:
        pool.shutdown(wait=True, cancel_futures=True)
