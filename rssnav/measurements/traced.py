"""RSS at the places of a survey, as the tracer predicts it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from raytrace import (
    Antenna,
    HalfWaveDipole,
    Scene,
    SceneError,
    TraceConfig,
    Transmitter,
    received_power,
)
from raytrace.arrays import Floats
from rssnav.cost_notice import points_announcement
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
    is_antenna_chosen
        Whether transmitters with an antenna of their own have `transmit_antenna` too.
    threads
        How many; all processors by default.
    max_memory_bytes
        Most memory of a trace [bytes]; half of what is free by default.
    """

    config: TraceConfig = field(default_factory=lambda: TraceConfig(3, 1, 3))
    frequency_hz: float = 2.4e9
    transmit_antenna: Antenna = field(default_factory=HalfWaveDipole)
    receive_antenna: Antenna = field(default_factory=HalfWaveDipole)
    is_antenna_chosen: bool = False
    threads: int | None = None
    max_memory_bytes: int | None = None

    def transmitter(self, survey: Survey, number: int) -> Transmitter:
        """Return a survey's transmitter as the tracer takes it."""
        known, antenna = survey.transmitters[number], self.transmit_antenna
        if known.antenna is not None and not self.is_antenna_chosen:
            antenna = known.antenna
        return Transmitter(known.position, known.power_dbm, self.frequency_hz, antenna)


def survey_announcement(scene: Scene, survey: Survey, settings: TraceSettings) -> str | None:
    """Return what tracing a survey will take, in words, if that is long; otherwise None.

    Estimated with the transmitter that was measured most often.

    Raises
    ------
    SceneError
        Where it is in no room; the message names it.
    """
    counts = np.bincount(survey.transmitter, minlength=len(survey.transmitters))
    most = int(np.argmax(counts))
    try:
        return points_announcement(
            scene,
            settings.transmitter(survey, most),
            survey.points[survey.transmitter == most],
            settings.config,
            settings.threads,
            settings.max_memory_bytes,
            n_transmitters=int(np.count_nonzero(counts)),
        )
    except SceneError as error:
        name = survey.transmitters[most].name
        raise SceneError(f"transmitter {name!r}: {error}") from error


def traced_dbm(
    scene: Scene,
    survey: Survey,
    settings: TraceSettings,
    progress: Progress | None = None,
    *,
    stop: Callable[[], bool] | None = None,
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
    stop
        Ends the trace where it returns True, see `raytrace.received_power`.

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
        try:
            power_dbm[mine] = received_power(
                scene,
                settings.transmitter(survey, k),
                survey.points[mine],
                settings.config,
                receive_antenna=settings.receive_antenna,
                threads=settings.threads,
                stop=stop,
                max_memory_bytes=settings.max_memory_bytes,
            )
        except SceneError as error:
            raise SceneError(f"transmitter {known.name!r}: {error}") from error
        if progress is not None:
            progress(k + 1, len(survey.transmitters))
    return power_dbm
