"""A limit relative to what arrives anyway: beams far below it are not grown.

The power that arrives in a cell of the plan is that of reflections and transmissions alone, where
it is least: at the corners of the cell and in its middle.
"""

import math
from dataclasses import replace

import numpy as np

from raytrace.arrays import Floats, Ints
from raytrace.config import TraceConfig
from raytrace.kernels.guard import Guard
from raytrace.scene import Scene
from raytrace.solver.extruded_classes import Reflections
from raytrace.solver.loss_limits import limits_from_transmitter
from raytrace.solver.path_class import Evaluation
from raytrace.solver.setup import Tracing, prepare, with_receivers

FROM_CORNERS = 0.1
"""Points are this far from a cell's corners, as a fraction of the way to its middle."""


def prepare_within_range(
    scene: Scene,
    position: tuple[float, float, float],
    receivers: Floats,
    config: TraceConfig,
    guard: Guard,
    evaluation: Evaluation,
) -> Tracing:
    """Grow the beams from a transmitter, see `setup.prepare`, within `config.dynamic_range_db`.

    Beams from the transmitter are compared with the straight paths to a cell, beams from edges with
    all that is reflected into it.
    """
    limits = limits_from_transmitter(scene, config, evaluation)
    if math.isinf(config.dynamic_range_db):
        return prepare(scene, position, receivers, config, guard, limits)
    points, first = _points(scene, position[2])
    both = np.concatenate([points, receivers])
    straight = replace(config, max_reflections=0, max_diffractions=0)
    limits = limits_from_transmitter(scene, straight, evaluation)
    tracing = prepare(scene, position, both, straight, guard, limits)
    power = _least(Reflections(tracing).sum_paths(evaluation).power, config, evaluation)
    least = np.minimum.reduceat(power[: len(points)], first)
    limits = limits_from_transmitter(scene, config, evaluation, least)
    tracing = prepare(scene, position, both, config, guard, limits)
    least = np.concatenate([power[: len(points)], power[len(points) :]])
    tracing = replace(tracing, least=least)
    if not config.max_diffractions:
        return replace(with_receivers(tracing, receivers), least=least[len(points) :])
    power = _least(Reflections(tracing).sum_paths(evaluation).power, config, evaluation)
    loss = limits.loss._replace(least=np.minimum.reduceat(power[: len(points)], first))
    return replace(
        with_receivers(tracing, receivers),
        limits=limits._replace(loss=loss),
        least=least[len(points) :],
        least_diffracted=power[len(points) :],
    )


def _points(scene: Scene, z: float) -> tuple[Floats, Ints]:
    """Points (n, 3) [m] in the cells of the plan, and the number of the first one of each."""
    view = scene.view
    found: list[Floats] = []
    for first, last in zip(view.cell_edges[:-1], view.cell_edges[1:], strict=True):
        corners = view.ends[first:last, :2]
        middle = corners.mean(axis=0)
        found += [middle[None], corners + FROM_CORNERS * (middle - corners)]
    xy = np.concatenate(found)
    first_of_cell = view.cell_edges[:-1] + np.arange(len(view.cell_edges) - 1)
    return np.column_stack([xy, np.full(len(xy), z)]), first_of_cell


def _least(power: Floats, config: TraceConfig, evaluation: Evaluation) -> Floats:
    """Power below which paths are left out where that much arrives."""
    return np.maximum(power * 10.0 ** (-0.1 * config.dynamic_range_db), evaluation.min_power)
