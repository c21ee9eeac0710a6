"""Sums over all paths, on any number of threads with the same result."""

import os
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor

import numpy as np

from raytrace.families import Family, all_families
from raytrace.kernels.tracing import STRONGEST, Sums, new_record, new_sums
from raytrace.preparing import Tracing

Progress = Callable[[int, int], None]
"""Called with the number of finished parts and of all parts."""


def default_threads() -> int:
    """Threads to use where the caller does not say: one a processor that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


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
    families = all_families(tracing)
    total = new_sums(len(tracing.trace.receivers), tracing.config.max_reflections)
    for done, part in enumerate(_in_order(tracing, families, threads or default_threads()), 1):
        strongest = np.maximum(total.moments[:, STRONGEST], part.moments[:, STRONGEST])
        for whole, addend in zip(total, part, strict=True):
            whole += addend
        total.moments[:, STRONGEST] = strongest
        if progress is not None:
            progress(done, len(families))
    return total


def _in_order(tracing: Tracing, families: Sequence[Family], threads: int) -> Iterator[Sums]:
    """Sums of each family, in their order, computed a few ahead."""

    def sums_of(family: Family) -> Sums:
        sums = new_sums(len(tracing.trace.receivers), tracing.config.max_reflections)
        family.add_to(sums, new_record(0))
        return sums

    pool = ThreadPoolExecutor(threads)
    try:
        ahead: deque[Future[Sums]] = deque()
        for family in families:
            ahead.append(pool.submit(sums_of, family))
            if len(ahead) > 8 * threads:
                yield ahead.popleft().result()
        while ahead:
            yield ahead.popleft().result()
    finally:
        pool.shutdown(wait=True, cancel_futures=True)
