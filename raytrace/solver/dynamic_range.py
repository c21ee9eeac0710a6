"""A limit relative to what arrives anyway: beams and paths far below it are left out.

Paths are compared with the power of reflections and transmissions alone at their receivers. A beam
is compared with the least one near the edge of the plan view from which it enters its cell.
"""

import math
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from itertools import repeat

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from raytrace.arrays import Floats, Ints
from raytrace.config import TraceConfig
from raytrace.kernels.beams import CELL
from raytrace.kernels.guard import Guard
from raytrace.kernels.sums import Sums, add_sums, sums_from
from raytrace.scene import Scene
from raytrace.solver.extruded_classes import Reflected, Reflections
from raytrace.solver.loss_limits import limits_from_transmitter
from raytrace.solver.path_class import Evaluation
from raytrace.solver.setup import Tracing, prepare, with_receivers

FROM_EDGES = 0.1
"""Points are this far from a cell's edges, as a fraction of the way to its middle."""


def prepare_within_range(
    scene: Scene,
    position: tuple[float, float, float],
    receivers: Floats,
    config: TraceConfig,
    guard: Guard,
    evaluations: Sequence[Evaluation],
    threads: int = 1,
) -> tuple[Tracing, Reflected | None]:
    """Grow the beams from a transmitter, see `setup.prepare`, within `config.dynamic_range_db`.

    Paths without a diffraction are compared with the straight one, diffracted ones with all that is
    reflected and transmitted, both by the first of the evaluations. The result does not depend on
    the number of threads.

    Returns
    -------
    tracing, known
        As `extruded_classes.path_classes` takes them.
    """
    evaluation = evaluations[0]
    limits = limits_from_transmitter(scene, config, evaluation)
    grown_for = evaluation.digest if limits.loss.is_active else None
    if math.isinf(config.dynamic_range_db):
        tracing = prepare(scene, position, receivers, config, guard, limits)
        return replace(tracing, grown_for=grown_for), None
    grown_for = evaluation.digest
    points = _points(scene, position[2])
    both = np.concatenate([points, receivers])
    straight = replace(config, max_reflections=0, max_diffractions=0)
    limits = limits_from_transmitter(scene, straight, evaluation)
    tracing = prepare(scene, position, both, straight, guard, limits)
    power = _least(Reflections(tracing).sum_paths(evaluation).power, config, evaluation)
    limits = limits_from_transmitter(scene, config, evaluation, _at_edges(scene, power))
    tracing = replace(prepare(scene, position, both, config, guard, limits), least=power)
    least = power[len(points) :]
    if not config.max_diffractions:
        return replace(with_receivers(tracing, receivers), least=least, grown_for=grown_for), None
    reflected = _reflected(tracing, evaluations, threads)
    power = _least(reflected[0].power, config, evaluation)
    loss = limits.loss._replace(least=_at_edges(scene, power))
    tracing = replace(
        with_receivers(tracing, receivers),
        limits=limits._replace(loss=loss),
        grown_for=grown_for,
        least=least,
        least_diffracted=power[len(points) :],
    )
    at_receivers = [sums_from(sums, len(points)) for sums in reflected]
    return tracing, Reflected(list(evaluations), at_receivers)


def _reflected(tracing: Tracing, evaluations: Sequence[Evaluation], threads: int) -> list[Sums]:
    """Sum the paths without a diffraction; each thread takes receivers of its own."""
    parts = beam_parts(tracing, threads)
    reflections = Reflections(tracing.shared_by(len(parts)))
    with ThreadPoolExecutor(len(parts)) as pool:
        totals, *others = pool.map(reflections.sum_each, repeat(evaluations), parts)
    for each, *rest in zip(totals, *others, strict=True):
        for part in rest:
            add_sums(each, part)
        each.not_grown[0] = tracing.left_out
    return totals


def beam_parts(tracing: Tracing, count: int) -> list[Ints]:
    """Divide the beams into parts that have no receiver in common, at most so many.

    Cells with a receiver on their common border are in one part.
    """
    targets, cells = tracing.targets, tracing.tree.link[:, CELL]
    n_cells, n_points = len(targets.cell_points) - 1, len(tracing.geometry.receivers.xy)
    sizes = np.diff(targets.cell_points)
    within = np.repeat(np.arange(n_cells), sizes), n_cells + targets.number
    shape = n_cells + n_points, n_cells + n_points
    groups = connected_components(coo_array((np.ones(len(within[0])), within), shape))[1][:n_cells]
    work = np.bincount(groups[cells], sizes[cells])
    part_of, taken = np.zeros(len(work), np.int64), np.zeros(count)
    for group in np.argsort(-work, kind="stable"):
        part_of[group] = np.argmin(taken)
        taken[part_of[group]] += work[group]
    part = part_of[groups[cells]]
    return [np.flatnonzero(part == k) for k in range(count) if k == 0 or taken[k]]


def _points(scene: Scene, z: float) -> Floats:
    """Points (2 n_edges, 3) [m] in the cells: near the start and near the middle of each edge."""
    view = scene.view
    sizes = np.diff(view.cell_edges)
    middle = np.add.reduceat(view.ends[:, :2], view.cell_edges[:-1]) / sizes[:, None]
    at = np.stack([view.ends[:, :2], 0.5 * (view.ends[:, :2] + view.ends[:, 2:])])
    xy = at + FROM_EDGES * (middle[view.cell_of] - at)
    return np.column_stack([xy.reshape(-1, 2), np.full(2 * len(view.ends), z)])


def _at_edges(scene: Scene, power: Floats) -> Floats:
    """Least power (n_edges,) at the points of each edge, its end included."""
    view = scene.view
    start, middle = power[: len(view.ends)], power[len(view.ends) : 2 * len(view.ends)]
    following = np.arange(1, len(view.ends) + 1)
    following[view.cell_edges[1:] - 1] = view.cell_edges[:-1]
    return np.minimum(np.minimum(start, start[following]), middle)


def _least(power: Floats, config: TraceConfig, evaluation: Evaluation) -> Floats:
    """Power below which paths are left out where that much arrives."""
    return np.maximum(power * 10.0 ** (-0.1 * config.dynamic_range_db), evaluation.min_power)
