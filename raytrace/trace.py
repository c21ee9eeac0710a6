"""The tracer: scene, source and receivers in; paths, or a map of their sums, out."""

import platform
import time
from importlib.metadata import version
from typing import Any

import numpy as np
from numpy.typing import NDArray

from raytrace.config import TraceConfig
from raytrace.grid import Grid
from raytrace.kernels.tracing import new_record, new_sums
from raytrace.radio.antennas import Antenna
from raytrace.radio.transmitter import Transmitter
from raytrace.results.layers import layers_of
from raytrace.results.paths import Paths
from raytrace.results.radio_map import RadioMap
from raytrace.scene import Scene
from raytrace.solver.accumulate import Progress, sum_paths
from raytrace.solver.path_classes import Family, all_families
from raytrace.solver.setup import Tracing, prepare

Floats = NDArray[np.float64]

TRACER_VERSION = 3
"""Grows whenever the same scene would give another map."""


def trace_paths(
    scene: Scene,
    source: Transmitter,
    receivers: Floats,
    config: TraceConfig | None = None,
    *,
    receive_antenna: Antenna | None = None,
) -> Paths:
    """Find every path to the given receivers.

    Parameters
    ----------
    scene, source
        The building and the transmitter.
    receivers
        (n, 3) positions [m]; one outside the building is reached by no path.
    config
        How many reflections and diffractions; 6 and 1 by default.
    receive_antenna
        The receivers' antenna; a vertical half-wave dipole of 0 dB peak gain by default.

    Returns
    -------
    Paths
        Receiver by receiver, strongest first.

    Raises
    ------
    SceneError
        Where the transmitter is not inside the building.
    """
    receivers = np.array(receivers, dtype=np.float64)
    if receivers.ndim != 2 or receivers.shape[1] != 3 or not np.isfinite(receivers).all():
        raise ValueError(f"receivers of shape {receivers.shape}: expected finite numbers (n, 3)")
    tracing = prepare(scene, source, receivers, config or TraceConfig(), receive_antenna)
    found = [_write_out(tracing, family) for family in all_families(tracing)]
    return (
        Paths(
            np.concatenate([p.receiver for p in found]),
            np.concatenate([p.interactions for p in found]),
            np.concatenate([p.vertices for p in found]),
            np.concatenate([p.length_m for p in found]),
            np.concatenate([p.gain for p in found]),
            np.concatenate([p.weight for p in found]),
        )
        .with_halves_joined()
        .strongest_first()
    )


def _write_out(tracing: Tracing, family: Family) -> Paths:
    """Every path of a family: counted first, then written."""
    config = tracing.config
    sums = new_sums(len(tracing.trace.receivers), config.max_reflections)
    count = new_record(0)
    family.write_to(sums, count)
    n = int(count.used[0])
    record = new_record(n)
    most = config.max_reflections + config.max_diffractions + config.max_transmissions
    points = np.zeros((n, most + 2, 3))
    kinds = np.zeros((n, most), np.int8)
    if n:
        family.write_to(new_sums(len(tracing.trace.receivers), config.max_reflections), record)
        family.write_points(record, points, kinds)
    length = np.linalg.norm(np.diff(points, axis=1), axis=2).sum(axis=1)
    receiver = family.receivers_of(record) if n else np.empty(0, np.int64)
    return Paths(receiver, kinds, points, length, record.gain, record.share)


def compute_radio_map(
    scene: Scene,
    source: Transmitter,
    grid: Grid,
    config: TraceConfig | None = None,
    *,
    receive_antenna: Antenna | None = None,
    threads: int | None = None,
    progress: Progress | None = None,
) -> RadioMap:
    """Sum every path at each cell of a grid.

    Parameters
    ----------
    scene, source, grid
        The building, the transmitter, and where receivers are.
    config
        How many reflections and diffractions; 6 and 1 by default.
    receive_antenna
        The receivers' antenna; a vertical half-wave dipole of 0 dB peak gain by default.
    threads
        How many; all processors by default. The map does not depend on it.
    progress
        Called with the number of finished parts of the work and of all parts.

    Raises
    ------
    SceneError
        Where the transmitter is not inside the building.
    """
    started = time.perf_counter()
    config = config or TraceConfig()
    tracing = prepare(scene, source, grid.points(), config, receive_antenna)
    sums = sum_paths(tracing, threads, progress)
    straight_m = np.linalg.norm(grid.points() - np.array(source.position), axis=1)
    layers = layers_of(sums, straight_m, source.power_dbm)
    on_grid: dict[str, Any] = {n: layer.reshape(grid.shape) for n, layer in layers.items()}
    return RadioMap(
        **on_grid,
        grid=grid,
        transmitter=source,
        config=config,
        provenance=_provenance(scene, time.perf_counter() - started),
    )


def _provenance(scene: Scene, wall_time_s: float) -> dict[str, str | float | int]:
    return {
        "tracer_version": TRACER_VERSION,
        "material_edition": scene.material_edition,
        "wall_time_s": wall_time_s,
        "python": platform.python_version(),
        **{name: version(name) for name in ("rssnav", "numpy", "numba", "scipy", "trimesh")},
    }
