"""Trace once, evaluate often: gains of known paths for other materials, antennas, frequencies.

The paths depend on the geometry alone. What their gains depend on besides is evaluated from the
surface, angle and polarisation frame of each interaction, exactly as a new trace would.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from raytrace.arrays import Floats, Ints
from raytrace.config import TraceConfig
from raytrace.memory import memory_limit
from raytrace.radio.antennas import Antenna
from raytrace.radio.materials import Slab
from raytrace.radio.table_slopes import SlabsAt, table_slopes
from raytrace.radio.tables import both_tables, step_tables, tables_of_polarisations
from raytrace.radio.transmitter import Transmitter
from raytrace.results.paths import Paths
from raytrace.results.step_lanes import gains_of
from raytrace.scene import Scene
from raytrace.solver.dynamic_range import prepare_within_range
from raytrace.solver.evaluation import evaluation_of
from raytrace.solver.extruded_classes import path_classes
from raytrace.solver.kept_paths import KeptPaths, keep_paths
from raytrace.solver.workers import Stop, Workers


def evaluate_paths(
    paths: Paths,
    slabs: Sequence[Slab],
    transmitter: Transmitter,
    *,
    receive_antenna: Antenna | None = None,
) -> Paths:
    """Compute the gains of known paths for other materials, antennas or another frequency.

    Parameters
    ----------
    paths
        What `trace_paths` found.
    slabs
        Materials and thicknesses, in the order of `Scene.slabs`.
    transmitter
        Its frequency and antenna; the position is that of the paths.
    receive_antenna
        The receivers' antenna; a vertical half-wave dipole of 0 dB peak gain by default.

    Returns
    -------
    Paths
        The same paths in the same order, with other gains. A trace with a limit by power or loss
        has left out what was weak with its own materials, antennas and frequency.

    Raises
    ------
    ValueError
        For paths without steps.
    """
    if paths.steps is None:
        raise ValueError("these paths have no steps: expected paths that trace_paths found")
    tables = tables_of_polarisations(transmitter, slabs, receive_antenna=receive_antenna)
    gain, pairs = gains_of(tables, paths.steps)
    return replace(paths, gain=gain, pair_gains=pairs).with_bounded_gain()


@dataclass(frozen=True, eq=False)
class TracedPoints:
    """The paths from one transmitter to n points, kept to be evaluated again.

    Attributes
    ----------
    slabs
        What the building was traced with.
    transmitter, receive_antenna
        The transmitter, and the receivers' antenna.
    kept
        The paths.
    is_limited
        Whether a power or a loss limits them, so that paths that are weak may be missing.
    """

    slabs: tuple[Slab, ...]
    transmitter: Transmitter
    receive_antenna: Antenna | None
    kept: KeptPaths
    is_limited: bool = False

    def __repr__(self) -> str:
        """Numbers of points and paths in one line."""
        return f"<TracedPoints: {len(self.left_out)} points, {self.n_paths} paths>"

    @property
    def n_paths(self) -> int:
        """Number of paths."""
        return len(self.kept)

    @property
    def left_out(self) -> Floats:
        """(n,) fraction of each point's power that is left out, for the materials traced with."""
        return self.kept.left_out

    def at(self, points: Ints) -> TracedPoints:
        """Return the same for some of the points, numbered in their order."""
        return replace(self, kept=self.kept.at(points))

    def powers(
        self,
        slabs: Sequence[Slab] | None = None,
        transmitter: Transmitter | None = None,
        receive_antenna: Antenna | None = None,
    ) -> Floats:
        """Sum the powers of the paths at each point (n,) [fraction of the transmitted].

        Parameters
        ----------
        slabs, transmitter, receive_antenna
            Other ones than it was traced with.

        Raises
        ------
        ValueError
            For other ones where a power or a loss limits the paths: those that are weak with the
            ones of the trace are missing.
        """
        if slabs is not None or transmitter is not None or receive_antenna is not None:
            self._check_limits()
        tables = step_tables(
            transmitter or self.transmitter,
            slabs or self.slabs,
            receive_antenna=receive_antenna or self.receive_antenna,
        )
        return self.kept.powers(tables)

    def derivatives(self, slabs_at: SlabsAt, values: Floats) -> tuple[Floats, Floats]:
        """Sum the powers of the paths at each point, and differentiate them.

        Parameters
        ----------
        slabs_at
            Returns the slabs for values of some properties, such as log(permittivity - 1).
        values
            (n_values,) where to differentiate.

        Returns
        -------
        powers
            (n,) [fraction of the transmitted].
        derivatives
            (n, n_values) of the powers with respect to the values.

        Raises
        ------
        ValueError
            As for `powers`.
        """
        self._check_limits()
        frequency_hz = self.transmitter.frequency_hz
        of_slabs = both_tables(slabs_at(values), frequency_hz)
        slopes, value_of = table_slopes(slabs_at, values, frequency_hz, of_slabs)
        tables = step_tables(
            self.transmitter, slabs_at(values), receive_antenna=self.receive_antenna
        )
        powers, by_slab = self.kept.powers_and_slopes(tables, slopes)
        return powers, sum_by_value(by_slab, value_of, len(values))

    def _check_limits(self) -> None:
        if self.is_limited:
            raise ValueError(
                "paths that a power or a loss limits are those of the materials, antennas and "
                "frequency of their trace: expected the same ones, or min_power_dbm = -inf and "
                "a number of transmissions"
            )


def sum_by_value(by_slab: Floats, value_of: Ints, n_values: int) -> Floats:
    """Sum derivatives (n, n_slabs, n_slots) over the slabs that depend on each value."""
    is_used = value_of >= 0
    found = np.zeros((n_values, len(by_slab)))
    np.add.at(found, value_of[is_used], by_slab[:, is_used].T)
    return found.T


def trace_points(
    scene: Scene,
    transmitter: Transmitter,
    points: Floats,
    config: TraceConfig | None = None,
    *,
    receive_antenna: Antenna | None = None,
    max_left_out: float = 0.0,
    threads: int | None = None,
    stop: Stop | None = None,
    max_memory_bytes: int | None = None,
) -> TracedPoints:
    """Find every path to some points and keep the paths.

    Parameters
    ----------
    scene, transmitter, config, receive_antenna
        As for `trace_paths`.
    points
        (n, 3) positions [m].
    max_left_out
        Largest fraction of a point's power that may be left out with its weakest paths; 0 keeps
        all of them. A tenth of the paths of a flat holds 99.9 % of the power.
    threads
        How many; all processors by default. The result does not depend on it.
    stop, max_memory_bytes
        As for `compute_radio_map`; a kept path takes about 0.7 kB.

    Raises
    ------
    SceneError
        Where the transmitter is not inside the building.
    TraceStoppedError, MemoryLimitError
        As for `compute_radio_map`.
    ValueError
        For points of another shape, and a fraction that is not from 0 to below 1.
    """
    points = np.array(points, dtype=np.float64)
    if points.ndim != 2 or points.shape[1] != 3 or not np.isfinite(points).all():
        raise ValueError(f"points of shape {points.shape}: expected finite numbers (n, 3)")
    if not 0.0 <= max_left_out < 1.0:
        raise ValueError(f"max_left_out = {max_left_out}: expected a fraction from 0 to below 1")
    config = config or TraceConfig()
    evaluation = evaluation_of(scene.slabs, transmitter, config, receive_antenna)
    with Workers(threads, stop) as workers:
        guard = workers.guard(memory_limit(max_memory_bytes))
        position = transmitter.position
        tracing, _ = workers.run(
            prepare_within_range, scene, position, points, config, guard, [evaluation], workers.n
        )
        classes = path_classes(tracing.shared_by(workers.n))
        kept = keep_paths(workers, classes, evaluation, len(points), max_left_out, tracing.guard)
    return TracedPoints(scene.slabs, transmitter, receive_antenna, kept, config.is_limited)
