"""RSS at the places of a survey, as the tracer predicts it."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from raytrace import Antenna, HalfWaveDipole, Scene, SceneError, TraceConfig, Transmitter
from raytrace.arrays import Floats
from raytrace.memory import memory_limit
from raytrace.solver.accumulate import sum_paths
from raytrace.solver.evaluation import evaluation_of
from raytrace.solver.extruded_classes import path_classes
from raytrace.solver.setup import prepare
from raytrace.solver.workers import Workers
from rssnav.measurements.survey import Survey
from rssnav.progress import Progress


@dataclass(frozen=True)
class TraceSettings:
    """How a survey is traced.

    Attributes
    ----------
    config
        Limits of the trace.
    frequency_hz
        Carrier frequency [Hz].
    transmit_antenna, receive_antenna
        The antennas; vertical half-wave dipoles of 0 dB peak gain by default.
    threads
        How many; all processors by default.
    max_memory_bytes
        Most memory of a trace [bytes]; half of what is free by default.
    """

    config: TraceConfig = field(default_factory=lambda: TraceConfig(3, 1, 3))
    frequency_hz: float = 2.4e9
    transmit_antenna: Antenna = field(default_factory=HalfWaveDipole)
    receive_antenna: Antenna = field(default_factory=HalfWaveDipole)
    threads: int | None = None
    max_memory_bytes: int | None = None

    def transmitter(self, survey: Survey, number: int) -> Transmitter:
        """Return a survey's transmitter as the tracer takes it."""
        known = survey.transmitters[number]
        return Transmitter(
            known.position, known.power_dbm, self.frequency_hz, self.transmit_antenna
        )


def traced_dbm(
    scene: Scene, survey: Survey, settings: TraceSettings, progress: Progress | None = None
) -> Floats:
    """Predict each reading (n,) [dBm] as the sum of the powers of its paths; -inf without a path.

    Parameters
    ----------
    scene, survey
        The building and the readings.
    settings
        How it is traced.
    progress
        Called with the number of finished transmitters and of all.

    Raises
    ------
    SceneError
        Where a transmitter is in no room; the message names it.
    MemoryLimitError
        Where a trace needs more memory than it may take.
    """
    power_dbm = np.full(len(survey), -np.inf)
    for k, known in enumerate(survey.transmitters):
        mine = survey.transmitter == k
        transmitter = settings.transmitter(survey, k)
        try:
            gain = _power_gain(scene, transmitter, survey.points[mine], settings)
        except SceneError as error:
            raise SceneError(f"transmitter {known.name!r}: {error}") from error
        with np.errstate(divide="ignore"):
            power_dbm[mine] = transmitter.power_dbm + 10.0 * np.log10(gain)
        if progress is not None:
            progress(k + 1, len(survey.transmitters))
    return power_dbm


def _power_gain(
    scene: Scene, transmitter: Transmitter, points: Floats, settings: TraceSettings
) -> Floats:
    """Received over transmitted power (n,)."""
    config = settings.config
    evaluation = evaluation_of(scene.slabs, transmitter, config, settings.receive_antenna)
    with Workers(settings.threads) as workers:
        guard = workers.guard(memory_limit(settings.max_memory_bytes))
        tracing = workers.run(prepare, scene, transmitter.position, points, config, guard)
        classes = path_classes(tracing.shared_by(workers.n))
        return sum_paths(workers, classes, evaluation).power
