"""Which steps of a flight its length counts.

The paper does not say how it measures the length of a trajectory. Its printed lengths exist as
flights, all twelve, only if one step is left out of each: see ``docs/reproduction.md``.
"""

from __future__ import annotations

from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from rssnav.results import TrainingResult


class Count(StrEnum):
    """Which steps a length counts."""

    ALL = "all steps"
    WITHOUT_LAST = "last step left out"
    WITHOUT_FIRST = "first step left out"


SUPPORTED_COUNT = Count.WITHOUT_LAST
"""The count under which flights of all printed lengths exist."""

COMPARED_COUNTS = (SUPPORTED_COUNT, Count.ALL)
"""Counts that lengths are compared with the paper's under."""


def counted_lengths_m(result: TrainingResult, count: Count) -> NDArray[np.float64]:
    """Length of each final flight that reaches the source.

    Parameters
    ----------
    result : TrainingResult
        A finished training.
    count : Count
        The steps that are counted.

    Returns
    -------
    ndarray of float64, shape (A,)
        [m], for the A flights that arrive.
    """
    length_m = result.path_length_m[result.reached]
    if count is Count.ALL:
        return length_m
    cells = result.trajectories[result.reached]
    last = (
        (cells >= 0).sum(axis=1) - 1 if count is Count.WITHOUT_LAST else np.ones_like(cells[:, 0])
    )
    run = np.arange(last.size)
    step = result.world.position[cells[run, last]] - result.world.position[cells[run, last - 1]]
    return length_m - np.hypot(*step.T)
