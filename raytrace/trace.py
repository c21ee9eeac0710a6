"""The tracer: scene, transmitter and receivers in; paths, or a map of their sums, out."""

import math
import platform
import time
import warnings
from collections.abc import Mapping, Sequence
from functools import cache
from importlib.metadata import version
from typing import Any, NamedTuple

import numpy as np

from raytrace.arrays import Floats
from raytrace.compilation import watched_compilation
from raytrace.config import TraceConfig
from raytrace.errors import SceneError, SceneWarning
from raytrace.grid import Grid
from raytrace.kernels.sums import Sums
from raytrace.memory import memory_limit
from raytrace.radio.antennas import Antenna, HalfWaveDipole
from raytrace.radio.transmitter import Transmitter
from raytrace.results.layers import coherent_power, layers_of, received_dbm
from raytrace.results.paths import Paths
from raytrace.results.radio_map import RadioMap
from raytrace.results.transmitter_maps import TransmitterMaps
from raytrace.scene import Scene
from raytrace.solver.accumulate import Progress, sum_paths
from raytrace.solver.beam_class import COPIES_OF_PATHS
from raytrace.solver.dynamic_range import prepare_within_range
from raytrace.solver.evaluation import evaluation_of
from raytrace.solver.extruded_classes import Reflected, cells_bytes, path_classes
from raytrace.solver.limits import taking
from raytrace.solver.path_class import Evaluation
from raytrace.solver.setup import Tracing
from raytrace.solver.sharing import check_frequencies, part_of, sharing_paths
from raytrace.solver.workers import Stop, Workers

AT_ONCE = 16
"""Lists of the strongest paths that are kept before they are joined."""

TRACER_VERSION = 10
"""Grows whenever the same scene would give another map."""


def trace_paths(
    scene: Scene,
    transmitter: Transmitter,
    receivers: Floats,
    config: TraceConfig | None = None,
    *,
    receive_antenna: Antenna | None = None,
    strongest: int | None = None,
    stop: Stop | None = None,
    max_memory_bytes: int | None = None,
) -> Paths:
    """Find every path to the given receivers, or the strongest ones.

    Parameters
    ----------
    scene, transmitter
        The building and the transmitter.
    receivers
        (n, 3) positions [m]; no path reaches one outside the building.
    config
        How many reflections and diffractions; 6 and 1 by default.
    receive_antenna
        The receivers' antenna; a vertical half-wave dipole of 0 dB peak gain by default.
    strongest
        Return at most so many paths of each receiver. All are computed, but the others take 48
        bytes each for a moment instead of a kilobyte in the end.
    stop, max_memory_bytes
        As for `compute_radio_map`.

    Returns
    -------
    Paths
        Receiver by receiver, strongest first.

    Raises
    ------
    ValueError
        For receivers that are not finite numbers (n, 3), or fewer than one path.
    SceneError
        Where the transmitter is not inside the building.
    TraceStoppedError, MemoryLimitError
        As for `compute_radio_map`.
    """
    receivers = _positions(receivers, "receivers")
    if strongest is not None and strongest < 1:
        raise ValueError(f"strongest = {strongest}: expected at least 1, or None for all paths")
    config = config or TraceConfig()
    evaluation = evaluation_of(scene.slabs, transmitter, config, receive_antenna)
    with Workers(1, stop) as workers:
        guard = workers.guard(memory_limit(max_memory_bytes))
        position = transmitter.position
        tracing, _ = workers.run(
            prepare_within_range, scene, position, receivers, config, guard, [evaluation]
        )
        return workers.run(_list_paths, tracing, evaluation, strongest)


def _list_paths(tracing: Tracing, evaluation: Evaluation, strongest: int | None) -> Paths:
    found: list[Paths] = []
    for path_class in path_classes(tracing):
        found.append(path_class.list_paths(evaluation, strongest))
        if strongest is not None and len(found) == AT_ONCE:
            found = [_ordered(found).strongest(2 * strongest)]
        most_bytes = COPIES_OF_PATHS * sum(paths.vertices.nbytes for paths in found)
        taking(tracing.guard, most_bytes, "the paths")
    paths = _ordered(found)
    return paths if strongest is None else paths.strongest(strongest)


def _ordered(found: list[Paths]) -> Paths:
    """Join lists of paths: receiver by receiver, strongest first."""
    return Paths.joined(found).with_halves_joined().with_bounded_gain().strongest_first()


def compute_radio_map(
    scene: Scene,
    transmitter: Transmitter,
    grid: Grid,
    config: TraceConfig | None = None,
    *,
    receive_antenna: Antenna | None = None,
    threads: int | None = None,
    progress: Progress | None = None,
    stop: Stop | None = None,
    max_memory_bytes: int | None = None,
) -> RadioMap:
    """Sum every path at each cell of a grid.

    Parameters
    ----------
    scene, transmitter, grid
        The building, the transmitter, and where receivers are.
    config
        How many reflections and diffractions; 6 and 1 by default.
    receive_antenna
        The receivers' antenna; a vertical half-wave dipole of 0 dB peak gain by default.
    threads
        How many; all processors by default. The map does not depend on it.
    progress
        Called with the number of finished parts of the work and of all parts.
    stop
        Called many times a second, such as `threading.Event.is_set`; where it returns True, the
        trace ends, within a kernel too.
    max_memory_bytes
        Most memory for receivers, sums, beams and legs [bytes]; by default half of what is free.

    Raises
    ------
    SceneError
        Where the transmitter is not inside the building.
    TraceStoppedError
        Where `stop` has ended the trace.
    MemoryLimitError
        Where it needs more than `max_memory_bytes`.

    Warns
    -----
    SceneWarning
        Where cells are so near to the transmitter that their power is bounded by the transmit
        power.
    """
    run = _Run(threads, progress, stop, max_memory_bytes)
    ends = [transmitter], receive_antenna
    return _maps_at(scene, ends, grid, config or TraceConfig(), run)[0]


class _Run(NamedTuple):
    """How a map is computed, see `compute_radio_map`."""

    threads: int | None
    progress: Progress | None
    stop: Stop | None
    max_memory_bytes: int | None


def _maps_at(
    scene: Scene,
    ends: tuple[Sequence[Transmitter], Antenna | None],
    grid: Grid,
    config: TraceConfig,
    run: _Run,
) -> list[RadioMap]:
    """Return the maps of transmitters at one place, whose beams are grown once.

    `ends` holds the transmitters and the receivers' antenna.
    """
    started, (transmitters, receive_antenna) = time.perf_counter(), ends
    evaluations = [
        evaluation_of(scene.slabs, each, config, receive_antenna) for each in transmitters
    ]
    with watched_compilation() as compilation, Workers(run.threads, run.stop) as workers:
        guard = workers.guard(memory_limit(run.max_memory_bytes))
        n_cells = grid.x.size * grid.y.size
        needed_bytes = sum(
            cells_bytes(scene, n_cells, config, workers.n, each.n_pairs) for each in evaluations
        )
        guard = taking(guard, needed_bytes, f"{grid.x.size} x {grid.y.size} cells")
        points, position = grid.points(), transmitters[0].position
        traced = workers.run(
            prepare_within_range, scene, position, points, config, guard, evaluations, workers.n
        )
        found = _sum_paths(workers, traced, evaluations, run.progress)
    seconds = (time.perf_counter() - started - compilation.seconds) / len(found)
    straight_m = np.linalg.norm(points - np.array(position), axis=1)
    _warn_of_near_cells(found, points)
    maps: list[RadioMap] = []
    for transmitter, sums in zip(transmitters, found, strict=True):
        layers = layers_of(sums, straight_m, transmitter.power_dbm)
        on_grid: dict[str, Any] = {n: layer.reshape(grid.shape) for n, layer in layers.items()}
        made = _provenance(scene, seconds)
        antenna = receive_antenna or HalfWaveDipole()
        maps.append(RadioMap(
            **on_grid, grid=grid, transmitter=transmitter, config=config, provenance=made,
            receive_antenna=antenna,
        ))  # fmt: skip
    return maps


def compute_radio_maps(
    scene: Scene,
    transmitters: Mapping[str, Transmitter],
    grid: Grid,
    config: TraceConfig | None = None,
    *,
    receive_antenna: Antenna | None = None,
    threads: int | None = None,
    progress: Progress | None = None,
    stop: Stop | None = None,
    max_memory_bytes: int | None = None,
) -> TransmitterMaps:
    """Sum every path at each cell of a grid, for each of several transmitters.

    Transmitters at one place, such as those of an access point at several frequencies, share
    beams and paths. Where numbers limit these, the maps are those of `compute_radio_map` up to
    rounding. Where a dynamic range does, transmitters that differ in their frequencies alone share
    them: the paths are chosen at the lowest frequency, for which the map is that of
    `compute_radio_map`, and how much is left out at the others is not bounded
    (`RadioMap.left_out_db` is infinite). Otherwise a least power limits them, and each transmitter
    is traced alone.

    Parameters
    ----------
    scene, grid, config, receive_antenna, threads, stop, max_memory_bytes
        As for `compute_radio_map`; the scene is prepared once for all.
    transmitters
        At least one, by name.
    progress
        Called with finished parts and all parts, `sharing.PARTS` of them for each transmitter.

    Raises
    ------
    ValueError
        For no transmitters.
    SceneError
        Where a transmitter is not inside the building, or a material is not known at its
        frequency; the message names it.
    TraceStoppedError, MemoryLimitError
        As for `compute_radio_map`.
    """
    maps: dict[str, RadioMap] = {}
    config = config or TraceConfig()
    check_frequencies(scene.slabs, transmitters)
    for names in sharing_paths(transmitters, config):
        part = part_of(progress, len(maps), len(transmitters), len(names))
        run = _Run(threads, part, stop, max_memory_bytes)
        ends = [transmitters[name] for name in names], receive_antenna
        try:
            found = _maps_at(scene, ends, grid, config, run)
        except SceneError as error:
            raise SceneError(f"transmitter {names[0]!r}: {error}") from error
        maps.update(zip(names, found, strict=True))
    return TransmitterMaps({name: maps[name] for name in transmitters})


def received_power(
    scene: Scene,
    transmitter: Transmitter,
    points: Floats,
    config: TraceConfig | None = None,
    *,
    receive_antenna: Antenna | None = None,
    threads: int | None = None,
    progress: Progress | None = None,
    stop: Stop | None = None,
    max_memory_bytes: int | None = None,
) -> Floats:
    """Sum the powers of every path at any points, such as those of a walk or a survey.

    No path is stored: the cost and the values are those of cells of a map at the same points.

    Parameters
    ----------
    scene, transmitter
        The building and the transmitter.
    points
        (n, 3) positions of receivers [m].
    config, receive_antenna, threads, progress, stop, max_memory_bytes
        As for `compute_radio_map`.

    Returns
    -------
    (n,) float64
        Received power [dBm], at most the transmit power; -inf where no path arrives, and outside
        the building.

    Raises
    ------
    ValueError
        For points that are not finite numbers (n, 3).
    SceneError, TraceStoppedError, MemoryLimitError
        As for `compute_radio_map`.
    """
    points = _positions(points, "points")
    config = config or TraceConfig()
    if not len(points):
        return np.empty(0)
    evaluation = evaluation_of(scene.slabs, transmitter, config, receive_antenna)
    with Workers(threads, stop) as workers:
        guard = workers.guard(memory_limit(max_memory_bytes))
        needed_bytes = cells_bytes(scene, len(points), config, workers.n, evaluation.n_pairs)
        guard = taking(guard, needed_bytes, f"{len(points)} points")
        position = transmitter.position
        traced = workers.run(
            prepare_within_range, scene, position, points, config, guard, [evaluation], workers.n
        )
        (sums,) = _sum_paths(workers, traced, [evaluation], progress)
    return received_dbm(sums.power, transmitter.power_dbm)


def _positions(points: Floats, name: str) -> Floats:
    """Check positions (n, 3) [m]."""
    points = np.array(points, dtype=np.float64)
    if points.ndim != 2 or points.shape[1] != 3 or not np.isfinite(points).all():
        raise ValueError(f"{name} of shape {points.shape}: expected finite numbers (n, 3)")
    return points


def _sum_paths(
    workers: Workers,
    traced: tuple[Tracing, Reflected | None],
    evaluations: Sequence[Evaluation],
    progress: Progress | None,
) -> list[Sums]:
    """Sum all paths at each receiver of a tracing, with each of several evaluations.

    Where a dynamic range limits the paths, what is left out is bounded at the first frequency.
    """
    tracing, known = traced
    classes = path_classes(tracing.shared_by(workers.n), known)
    max_paths = tracing.config.max_paths
    found = sum_paths(workers, classes, evaluations, max_paths=max_paths, progress=progress)
    for sums in found:
        sums.left_out[tracing.reachable] += sums.not_grown[0]
    if len(tracing.least):
        first = evaluations[0].tables.wavelength
        for each, sums in zip(evaluations[1:], found[1:], strict=True):
            if each.tables.wavelength == first:
                sums.left_out[:] = found[0].left_out
            else:
                sums.left_out[tracing.reachable] = math.inf
    return found


def _warn_of_near_cells(found: Sequence[Sums], points: Floats) -> None:
    """Warn of cells in which the far field of some paths would exceed what is transmitted."""
    power = [np.maximum(sums.power, coherent_power(sums)) for sums in found]
    near = np.flatnonzero(np.max(power, axis=0) > 1.0)
    if len(near):
        x, y, z = points[near[0]]
        warnings.warn(
            f"{len(near)} of {len(points)} cells are too near to the transmitter for far-field "
            f"formulas, the first at ({x:g}, {y:g}, {z:g}): their power is set to the transmit "
            "power; move the transmitter off the cell centre, or receive at another height",
            SceneWarning,
            stacklevel=4,
        )


def _provenance(scene: Scene, wall_time_s: float) -> dict[str, str | float | int]:
    return {
        "tracer_version": TRACER_VERSION,
        "material_edition": scene.material_edition,
        "wall_time_s": wall_time_s,
        "python": platform.python_version(),
        **_versions(),
    }


@cache
def _versions() -> dict[str, str]:
    """Versions of the libraries; looked up once, which takes longer than a small map."""
    return {name: version(name) for name in ("rssnav", "numpy", "numba", "scipy", "trimesh")}
