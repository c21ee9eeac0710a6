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
) -> Sums:
    """Sum the paths of some classes at each receiver.

    Parameters
    ----------
    workers
        The threads; the result does not depend on how many there are.
    classes
        At least one; beams that were grown before are used again.
    evaluations
        Field tables and power threshold; of several, the powers are added.
    max_paths
        Raise the power threshold to where no more paths than that are left; no limit by default.
    progress
        Called as classes are done.
    """
    if max_paths is not None:
        unlimited = [replace(evaluations[0], min_power=math.inf)]
        least = _min_power(_sum(workers, classes, unlimited, None).bins, max_paths)
        evaluations = [replace(e, min_power=max(least, e.min_power)) for e in evaluations]
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
) -> Sums:
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
    return _added_powers(totals)


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


def _added_powers(parts: Sequence[Sums]) -> Sums:
    """Add the powers that antennas of several polarisations receive over the same paths.

    So that squared magnitudes of fields add up too, the field has the phase of the first one.
    """
    if len(parts) == 1:
        return parts[0]
    first = parts[0]
    size = np.sqrt(sum(np.abs(part.field) ** 2 for part in parts))
    return first._replace(
        field=size * np.exp(1j * np.angle(first.field)),
        power=np.sum([part.power for part in parts], axis=0),
        moments=np.sum([part.moments for part in parts], axis=0),
        left_out=np.sum([part.left_out for part in parts], axis=0),
    )
