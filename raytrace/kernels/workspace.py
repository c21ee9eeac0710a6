"""Working arrays of the kernels, and the totals that they add to."""

import math
from typing import NamedTuple

import numpy as np

from raytrace.arrays import Floats, Ints
from raytrace.kernels.compiling import jit
from raytrace.kernels.guard import Guard
from raytrace.kernels.lanes import WIDTH, Lanes, any_of, lane, lanes_of, load, store, where
from raytrace.kernels.records import Record
from raytrace.kernels.sums import EXCESS, FIRST_MOMENT, N_MOMENTS, STRONGEST, Bundle, Sums


class Collector(NamedTuple):
    """What a kernel adds the paths to.

    Attributes
    ----------
    sums, record
        Sums over paths, and single paths.
    min_power
        Paths whose power is known to be below this are left out [fraction of the transmitted].
    least
        (n_cells,) the same for the receivers in a cell of the plan.
    guard
        May end the work.
    """

    sums: Sums
    record: Record
    min_power: float
    least: Floats
    guard: Guard


class Workspace(NamedTuple):
    """Working arrays for eight receivers.

    Attributes
    ----------
    receivers
        (8,) their numbers.
    levels, image_z
        (8,), (2 max_reflections + 1, 8) which of the receiver heights they are at, and its images
        in floor and ceiling [m].
    counts
        (max_reflections + 1, 8) paths to them by reflections.
    rows
        (FIRST_MOMENT + N_MOMENTS, 8) scratch.
    """

    receivers: Ints
    levels: Ints
    image_z: Floats
    counts: Floats
    rows: Floats


def new_workspace(max_reflections: int) -> Workspace:
    """Working arrays for paths of that many reflections."""
    return Workspace(
        np.zeros(WIDTH, np.int64),
        np.full(WIDTH, -1, np.int64),
        np.empty((2 * max_reflections + 1, WIDTH)),
        np.empty((max_reflections + 1, WIDTH)),
        np.empty((FIRST_MOMENT + N_MOMENTS, WIDTH)),
    )


@jit(inline=True)
def count_path(workspace: Workspace, order: int, weight: Lanes) -> None:
    """Count a path of that many reflections to each receiver."""
    store(workspace.counts[order], load(workspace.counts[order]) + weight)


@jit(inline=True)
def add_bundle(sums: Sums, workspace: Workspace, n: int, bundle: Bundle) -> None:
    """Add what arrives at the first n receivers of a block to the sums."""
    total = lanes_of(0.0)
    for k in range(len(workspace.counts)):
        total = total + load(workspace.counts[k])
    if not any_of(total > 0.0):
        return
    rows = workspace.rows
    for k, part in enumerate(bundle):
        store(rows[k], part)
    for j in range(n):
        r = workspace.receivers[j]
        sums.field[r] += complex(rows[0, j], rows[1, j])
        sums.power[r] += rows[2, j]
        moments = sums.moments[r]
        for k in range(EXCESS, STRONGEST):
            moments[k] += rows[FIRST_MOMENT + k, j]
        moments[STRONGEST] = max(moments[STRONGEST], rows[FIRST_MOMENT + STRONGEST, j])
        for k in range(len(workspace.counts)):
            sums.n_paths[r, k] += workspace.counts[k, j]


@jit(inline=True)
def least_power(collector: Collector, cell: int) -> float:
    """Power threshold of paths to the receivers in a cell."""
    return max(collector.min_power, collector.least[cell])


@jit(inline=True)
def apply_power_threshold(
    collector: Collector,
    workspace: Workspace,
    least: float,
    bound: Lanes,
    weight: Lanes,
    n_paths: float,
) -> Lanes:
    """Set the weights of paths below the power threshold to 0 and record their bounds.

    Parameters
    ----------
    collector, workspace
        The sums, and the receivers.
    least
        The threshold, see `least_power`.
    bound, weight, n_paths
        Bounds on the powers, the paths' weights, and how many there are at each receiver.
    """
    below = bound < least
    if any_of(below & (weight > 0.0)):
        left = where(below, weight, 0.0) * n_paths
        add_left_out(collector.sums, workspace.receivers, bound, left, collector.min_power)
    return where(below, 0.0, weight)


@jit(inner=True)
def add_left_out(sums: Sums, receivers: Ints, bound: Lanes, left: Lanes, min_power: float) -> None:
    """Record numbers of paths that are left out at eight receivers, by their bounds."""
    for j in range(WIDTH):
        power, n_paths = lane(bound, j), lane(left, j)
        if n_paths > 0.0:
            sums.left_out[receivers[j]] += n_paths * power
            if math.isinf(min_power):
                level = int(-10.0 * math.log10(max(power, 1e-39)))
                sums.bins[max(level, 0)] += n_paths
