"""Paths that are kept after a trace, to be evaluated for other materials, antennas, frequencies.

Their geometry is traced once. An evaluation then goes through the steps of the paths alone
(`raytrace.kernels.step_gains`), for gains that a new trace would give too.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from raytrace.arrays import Bools, Floats, Ints
from raytrace.kernels.field_tables import FieldTables
from raytrace.kernels.guard import Guard, no_guard
from raytrace.kernels.lanes import WIDTH
from raytrace.kernels.step_derivatives import (
    PowerSums,
    Scratch,
    TableSlopes,
    add_power_slopes,
)
from raytrace.kernels.step_gains import StepLanes, add_powers
from raytrace.kernels.steps import PATH_BYTES, STEP_BYTES, joined
from raytrace.results.step_lanes import blocks_of, step_lanes
from raytrace.solver.limits import check_whole, taking
from raytrace.solver.path_class import Evaluation, KeptRecord, PathClass
from raytrace.solver.workers import Workers

KEPT = "the kept paths"


@dataclass(frozen=True, eq=False)
class KeptPaths:
    """Paths from a transmitter to n points.

    Attributes
    ----------
    n_points
        How many points there are.
    lanes
        The steps of the paths.
    receiver, weight
        (n_blocks, 8) which point each path reaches, and its weight; 0 for what fills up a block.
    left_out
        (n,) fraction of each point's power that the paths which were not kept had.
    """

    n_points: int
    lanes: StepLanes
    receiver: Ints
    weight: Floats
    left_out: Floats

    def __len__(self) -> int:
        """Number of paths."""
        return int(np.count_nonzero(self.weight))

    def at(self, points: Ints) -> KeptPaths:
        """Return the paths of some of the points, numbered in their order."""
        number = np.full(self.n_points, -1, dtype=np.int64)
        number[points] = np.arange(len(points))
        receiver = number[self.receiver]
        is_kept = (receiver >= 0) & (self.weight > 0.0)
        first = len(self.lanes.code) - len(self.lanes.wedge)
        plain, diffracted = (
            _filled_up(np.flatnonzero(part) + begin)
            for part, begin in ((is_kept[:first], 0), (is_kept[first:], first * WIDTH))
        )
        path = np.concatenate([plain, diffracted])
        lanes = StepLanes(
            *(_of_paths(array, path) for array in self.lanes[:3]),
            *(_of_paths(array, diffracted - first * WIDTH) for array in self.lanes[3:]),
        )
        weight = np.where(_is_first(path), self.weight.ravel()[path], 0.0).reshape(-1, WIDTH)
        receiver = receiver.ravel()[path].reshape(-1, WIDTH)
        return KeptPaths(len(points), lanes, receiver, weight, self.left_out[points])

    def powers(self, tables: FieldTables) -> Floats:
        """Sum the powers of the paths at each point (n,) [fraction of the transmitted]."""
        power = np.zeros(self.n_points)
        scratch = np.empty((0, 4, WIDTH)), np.empty(WIDTH)
        add_powers(tables, self.lanes, self.receiver, self.weight, scratch, power)
        return power

    def powers_and_slopes(
        self, tables: FieldTables, slopes: TableSlopes, guard: Guard | None = None
    ) -> tuple[Floats, Floats]:
        """Sum the powers of the paths at each point, and their derivatives.

        Parameters
        ----------
        tables, slopes
            Materials and antennas, and the derivatives of the materials' tables.
        guard
            What may end the work; nothing by default.

        Returns
        -------
        powers, derivatives
            (n,) and (n, n_slabs, n_slots).
        """
        n_slots, n_rows = slopes.reflection.shape[:2]
        sums = PowerSums(
            np.zeros(self.n_points),
            np.zeros((self.n_points, n_rows // tables.slab_rows, n_slots)),
        )
        scratch = Scratch(np.empty((self.lanes.code.shape[1], 4, WIDTH)), np.empty(WIDTH))
        guard = guard or no_guard()
        work = self.lanes, self.receiver, self.weight
        add_power_slopes(tables, slopes, *work, sums, scratch, guard)
        check_whole(guard, True, KEPT)
        return sums.power, sums.slopes


def keep_paths(
    workers: Workers,
    classes: list[PathClass],
    evaluation: Evaluation,
    n_points: int,
    max_left_out: float,
    guard: Guard,
) -> KeptPaths:
    """Find paths and keep the strongest of each point.

    Parameters
    ----------
    workers
        The threads; the result does not depend on how many there are.
    classes
        What to find them with.
    evaluation
        What their powers are computed with.
    n_points
        How many points there are.
    max_left_out
        Largest fraction of a point's power that is left out; 0 keeps all paths.
    guard
        What may end the work, with the memory that is left.
    """
    running = [workers.submit(path_class.keep_paths, evaluation) for path_class in classes]
    records = [workers.result(future) for future in running]
    rows, left_out = _chosen(records, n_points, max_left_out)
    n_max = max((len(r) for r in rows), default=0)
    _check_memory(guard, sum(map(len, rows)))
    running = [workers.submit(r.steps_of, chosen) for r, chosen in zip(records, rows, strict=True)]
    steps = joined([workers.result(future) for future in running])
    lanes, path = workers.run(step_lanes, steps)
    receiver = np.concatenate([r.receiver[k] for r, k in zip(records, rows, strict=True)])
    weight = np.concatenate([r.weight[k] for r, k in zip(records, rows, strict=True)])
    is_real = path >= 0
    of_path = np.maximum(path, 0)
    return KeptPaths(
        n_points,
        lanes,
        np.where(is_real, receiver[of_path] if n_max else 0, 0),
        np.where(is_real, weight[of_path] if n_max else 0.0, 0.0),
        left_out,
    )


def _filled_up(path: Ints) -> Ints:
    """Repeat the last number of a list until there are a multiple of eight."""
    return np.concatenate([path, np.repeat(path[-1:], -len(path) % WIDTH)])


def _of_paths(blocks: Floats, path: Ints) -> Floats:
    """Return blocks (n, ..., 8) of some of the paths of other blocks, by number in their order."""
    return blocks_of(blocks[path // WIDTH, ..., path % WIDTH])


def _is_first(path: Ints) -> Bools:
    """Say of a list that rises but for its end which numbers are not repeated (n,)."""
    return np.diff(path, prepend=-1) != 0


MOST_STEPS = 12
"""Interactions of a path for which memory is set aside; few paths have more."""


def _check_memory(guard: Guard, n_paths: int) -> None:
    """Check that so many paths may be kept: their steps, and a copy of them in lanes."""
    taking(guard, 2 * n_paths * (PATH_BYTES + MOST_STEPS * STEP_BYTES), KEPT)


def _chosen(
    records: list[KeptRecord], n_points: int, max_left_out: float
) -> tuple[list[Ints], Floats]:
    """Choose the strongest paths of each point; return rows of each record, and what is left.

    All paths below the mean of what may be left out are left out; only the others are sorted.
    """
    receiver = np.concatenate([record.receiver for record in records])
    power = np.concatenate([record.power for record in records])
    total, count = np.bincount(receiver, power, n_points), np.bincount(receiver, None, n_points)
    least = max_left_out * total / np.maximum(count, 1)
    is_kept = power >= least[receiver]
    lost = np.bincount(receiver[~is_kept], power[~is_kept], n_points)
    if max_left_out > 0.0:
        strong = np.flatnonzero(is_kept)
        order = strong[np.lexsort([power[strong], receiver[strong]])]
        of = receiver[order]
        running = np.cumsum(power[order])
        before = np.concatenate([[0.0], running])[np.searchsorted(of, np.arange(n_points))]
        weaker = running - before[of] + lost[of]
        is_kept[order] = weaker > max_left_out * total[of]
        lost = np.bincount(receiver[~is_kept], power[~is_kept], n_points)
    ends = np.cumsum([len(record.receiver) for record in records])[:-1]
    rows = [np.flatnonzero(part) for part in np.split(is_kept, ends)]
    return rows, lost / np.where(total > 0.0, total, 1.0)
