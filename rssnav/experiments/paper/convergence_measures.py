"""Which runs converged, and the paper's "convergence time" in three interpretations."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rssnav.results import TrainingResult

STEP_S = 1.0
"""Duration of a step [s]."""


@dataclass(frozen=True)
class Measure:
    """An interpretation of "convergence time".

    Attributes
    ----------
    name, heading, title : str
        Names for files, axes (with the unit) and panels.
    digits : int
        Digits after the decimal point that tables show.
    scale : str
        Scale of its axis, "linear" from zero or "log".
    of : callable
        From a training to the time of each run that converged, shape (C,).
    """

    name: str
    heading: str
    title: str
    digits: int
    scale: str
    of: Callable[[TrainingResult], NDArray[np.float64]]


def converged(result: TrainingResult) -> NDArray[np.bool_]:
    """Mask of the realisations (R,) that converged."""
    return result.converged_episode >= 0


def _episodes(result: TrainingResult) -> NDArray[np.float64]:
    return result.converged_episode[converged(result)].astype(np.float64)


def _flight_time_h(result: TrainingResult) -> NDArray[np.float64]:
    return result.converged_steps[converged(result)].astype(np.float64) * (STEP_S / 3600.0)


def _cpu_time_ms(result: TrainingResult) -> NDArray[np.float64]:
    return 1000.0 * result.converged_cpu_s[converged(result)]


MEASURES = (
    Measure("episodes_to_convergence", "episodes", "episodes", 0, "linear", _episodes),
    Measure("flight_time_h", "flight time [h]", "simulated flight time", 1, "log", _flight_time_h),
    Measure("cpu_time_ms", "CPU time [ms]", "CPU time", 1, "log", _cpu_time_ms),
)
