"""Readings that are held out while a model is fitted: by place, and by transmitter."""

from typing import NamedTuple

import numpy as np

from raytrace.arrays import Bools, Ints
from rssnav.measurements.survey import Survey

SQUARE_M = 1.0
"""Side of the squares of the chequerboard whose halves are held out in turn [m]."""


class Fold(NamedTuple):
    """Readings to fit to, and readings to test with: (n,) bool each."""

    fit: Bools
    test: Bools


def by_space(survey: Survey, square_m: float = SQUARE_M) -> tuple[Fold, ...]:
    """Hold out the white and the black squares of a chequerboard over the plan in turn."""
    square = np.floor(survey.points[:, :2] / square_m).astype(np.int64)
    return _halves(survey, square.sum(axis=1) % 2)


def by_transmitter(survey: Survey) -> tuple[Fold, ...]:
    """Hold out each transmitter in turn; no fold where there is one transmitter."""
    read = ~survey.is_censored
    folds = (
        Fold(read & (survey.transmitter != k), read & (survey.transmitter == k))
        for k in range(len(survey.transmitters))
    )
    return tuple(fold for fold in folds if fold.fit.any() and fold.test.any())


def _halves(survey: Survey, side: Ints) -> tuple[Fold, ...]:
    read = ~survey.is_censored
    folds = (Fold(read & (side != k), read & (side == k)) for k in (0, 1))
    return tuple(fold for fold in folds if fold.fit.any() and fold.test.any())
