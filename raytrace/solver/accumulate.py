"""Sums over all paths, on any number of threads with the same result."""

import math
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future
from dataclasses import replace

import numpy as np

from raytrace.arrays import Floats
from raytrace.kernels.sums import Sums, add_sums
from raytrace.solver.path_class import Evaluation, PathClass
from raytrace.solver.workers import Workers

Progress = Callable[[int, int], None]
"""Called with the number of finished parts and of all parts."""


AHEAD = 4
"""Path classes in work, or waiting for their turn to be added, per thread."""


def sums_in_work(n_classes: int, threads: int) -> int:
    """Most `Sums` that exist at a time while the paths of some classes are summed."""
    return min(n_classes, AHEAD * threads + 1) + 1


def sum_paths(
    workers: Workers,
    classes: Sequence[PathClass],
    evaluations: Sequence[Evaluation],
    *,
    max_paths: int | None = None,
    progress: Progress | None = None,
) -> list[Sums]:
    """Sum the paths of some classes at each receiver, with each of several evaluations.

    Parameters
    ----------
    workers
        The threads; the result does not depend on how many there are.
    classes
        At least one; beams that were grown before are used again.
    evaluations
        Field tables and power thresholds.
    max_paths
        Raise the power thresholds to where no more paths than that are left; no limit by default.
    progress
        Called as classes are done.
    """
    if max_paths is not None:
        unlimited = [replace(each, min_power=math.inf) for each in evaluations]
        evaluations = [
            replace(each, min_power=max(_min_power(sums.bins, max_paths), each.min_power))
            for each, sums in zip(evaluations, _sum(workers, classes, unlimited, None), strict=True)
        ]
    return _sum(workers, classes, evaluations, progress)


def _min_power(bins: Floats, max_paths: int) -> float:
    """Lowest power, of whole decibels, above which there are no more paths than that."""
    kept = np.cumsum(bins)
    if kept[-1] <= max_paths:
        return 0.0
    return float(10.0 ** (-0.1 * np.flatnonzero(kept > max_paths)[0]))


def _sum(
    workers: Workers,
    classes: Sequence[PathClass],
    evaluations: Sequence[Evaluation],
    progress: Progress | None,
) -> list[Sums]:
    """Sum classes as they are done, in their order."""
    parts = _in_order(workers, classes, evaluations)
    totals = next(parts)
    if progress is not None:
        progress(1, len(classes))
    for done, part in enumerate(parts, 2):
        for total, addend in zip(totals, part, strict=True):
            add_sums(total, addend)
        if progress is not None:
            progress(done, len(classes))
    return totals


def _in_order(
    workers: Workers, classes: Sequence[PathClass], evaluations: Sequence[Evaluation]
) -> Iterator[list[Sums]]:
    """Sum each class with each evaluation, in their order, computed a few ahead."""
    ahead: deque[Future[list[Sums]]] = deque()
    for path_class in classes:
        ahead.append(workers.submit(path_class.sum_each, evaluations))
        if len(ahead) > AHEAD * workers.n:
            yield workers.result(ahead.popleft())
    while ahead:
        yield workers.result(ahead.popleft())
