"""Working arrays of the kernels, and the totals that they add to."""

import math
from typing import NamedTuple

import numpy as np

from raytrace.arrays import Floats, Ints
from raytrace.kernels.compiling import jit
from raytrace.kernels.guard import Guard
from raytrace.kernels.lanes import (
    WIDTH,
    Lanes,
    any_of,
    lane,
    lanes_of,
    load,
    store,
    where,
)
from raytrace.kernels.records import Record
from raytrace.kernels.sums import (
    BUNDLE_ROWS,
    EXCESS,
    FIELDS,
    STRONGEST,
    Bundle,
    Sums,
    store_bundle,
    sums_at,
)


class Collector(NamedTuple):
    """What a kernel adds the paths to.

    Attributes
    ----------
    sums, others, record
        Sums over paths with the first tables; with the others, along an axis in front of that of
        the receivers; and single paths.
    min_power
        Paths whose power is known to be below this are left out [fraction of the transmitted].
    least
        (n_receivers,) the same for the paths to each receiver; empty where it is `min_power` for
        all.
    heights
        (max_reflections + 1, LENGTHS + 1) see `bounds.height_sums`; not read without a threshold.
    guard
        May end the work.
    """

    sums: Sums
    others: Sums
    record: Record
    min_power: float
    least: Floats
    heights: Floats
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
    ways
        (8,) ways to an edge, by number.
    counts
        (max_reflections + 1, 8) paths to them by reflections.
    left
        (8,) bound on the power of paths to them that are left out.
    bundles
        (n_others, BUNDLE_ROWS, 8) what arrives there with the other tables, see `sums.Bundle`.
    rows, coefficients
        (BUNDLE_ROWS, 8) and (n_interactions, 4, 8) scratch.
    """

    receivers: Ints
    levels: Ints
    image_z: Floats
    ways: Ints
    counts: Floats
    left: Floats
    bundles: Floats
    rows: Floats
    coefficients: Floats


def new_workspace(max_reflections: int, n_interactions: int, n_others: int = 0) -> Workspace:
    """Working arrays for paths of that many reflections, whose legs meet no more walls."""
    return Workspace(
        np.zeros(WIDTH, np.int64),
        np.full(WIDTH, -1, np.int64),
        np.empty((2 * max_reflections + 1, WIDTH)),
        np.zeros(WIDTH, np.int64),
        np.empty((max_reflections + 1, WIDTH)),
        np.zeros(WIDTH),
        np.zeros((n_others, BUNDLE_ROWS, WIDTH)),
        np.empty((BUNDLE_ROWS, WIDTH)),
        np.empty((n_interactions, 4, WIDTH)),
    )


@jit(inline=True)
def count_path(workspace: Workspace, order: int, weight: Lanes) -> None:
    """Count a path of that many reflections to each receiver."""
    store(workspace.counts[order], load(workspace.counts[order]) + weight)


@jit(inline=True)
def add_bundle(collector: Collector, workspace: Workspace, n: int, bundle: Bundle) -> None:
    """Add what arrives at the first n receivers of a block to the sums."""
    total = lanes_of(0.0)
    for k in range(len(workspace.counts)):
        total = total + load(workspace.counts[k])
    if not any_of(total > 0.0):
        return
    store_bundle(workspace.rows, bundle)
    add_rows(collector.sums, workspace, n, workspace.rows)
    for f in range(len(workspace.bundles)):
        rows = workspace.bundles[f]
        add_rows(sums_at(collector.others, f), workspace, n, rows)
        for k in range(len(rows)):
            store(rows[k], lanes_of(0.0))


@jit(inline=True)
def add_rows(sums: Sums, workspace: Workspace, n: int, rows: Floats) -> None:
    """Add a bundle in memory to the sums."""
    fields = rows[FIELDS:]
    for j in range(n):
        r = workspace.receivers[j]
        for k in range(sums.field.shape[1]):
            sums.field[r, k] += complex(fields[2 * k, j], fields[2 * k + 1, j])
        sums.touched[r] = True
        sums.power[r] += rows[0, j]
        moments = sums.moments[r]
        for k in range(EXCESS, STRONGEST):
            moments[k] += rows[1 + k, j]
        moments[STRONGEST] = max(moments[STRONGEST], rows[1 + STRONGEST, j])
        for k in range(len(workspace.counts)):
            sums.n_paths[r, k] += workspace.counts[k, j]


@jit(inline=True)
def has_threshold(collector: Collector) -> bool:
    """Whether there is a power threshold."""
    return collector.min_power > 0.0 or len(collector.least) > 0


@jit(inline=True)
def least_powers(collector: Collector, workspace: Workspace) -> Lanes:
    """Power thresholds of paths to the receivers of a block, whose `left` is set to 0."""
    store(workspace.left, lanes_of(0.0))
    if len(collector.least) == 0:
        return lanes_of(collector.min_power)
    row = workspace.rows[0]
    for j in range(WIDTH):
        row[j] = max(collector.least[workspace.receivers[j]], collector.min_power)
    return load(row)


@jit(inline=True)
def leave_out(workspace: Workspace, power: Lanes) -> None:
    """Record a bound on the power of paths that are left out."""
    store(workspace.left, load(workspace.left) + power)


@jit(inline=True)
def apply_power_threshold(
    collector: Collector,
    workspace: Workspace,
    least: Lanes,
    bound: Lanes,
    weight: Lanes,
    several: tuple[float, Lanes],
) -> Lanes:
    """Set the weights of paths below the power threshold to 0 and record their bounds.

    Parameters
    ----------
    collector, workspace
        The sums, and the receivers.
    least
        The thresholds, see `least_powers`.
    bound, weight
        Bound on the power of each path, and the paths' weights.
    several
        How many there are at each receiver, and a bound on all of them together over that on each.
    """
    below = bound < least
    if any_of(below & (weight > 0.0)):
        left = where(below, weight, 0.0)
        leave_out(workspace, left * bound * several[1])
        if math.isinf(collector.min_power):
            count_left_out(collector.sums, bound, left * several[0])
    return where(below, 0.0, weight)


@jit(inner=True)
def count_left_out(sums: Sums, bound: Lanes, left: Lanes) -> None:
    """Count paths that are left out at eight receivers, by their bounds."""
    for j in range(WIDTH):
        power, n_paths = lane(bound, j), lane(left, j)
        if n_paths > 0.0:
            level = int(-10.0 * math.log10(max(power, 1e-39)))
            sums.bins[max(level, 0)] += n_paths


@jit(inner=True)
def add_left_out(sums: Sums, workspace: Workspace, n: int) -> None:
    """Add what is left out at the first n receivers of a block to the sums."""
    for j in range(n):
        sums.touched[workspace.receivers[j]] = True
        sums.left_out[workspace.receivers[j]] += workspace.left[j]
