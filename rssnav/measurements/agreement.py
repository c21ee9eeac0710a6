"""How well predictions agree with readings."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import KDTree

from raytrace.arrays import Bools, Floats
from rssnav.measurements.survey import Survey

LEAST_PAIRS = 8
"""Fewest pairs of neighbours from which a floor is computed."""


@dataclass(frozen=True)
class Agreement:
    """Measured minus predicted RSS, over n readings.

    Attributes
    ----------
    n
        Readings that are compared.
    n_without
        Readings, beside them, for which there is no prediction: no path arrives.
    sigma_db
        Root mean square of the residuals [dB].
    mean_db, median_db
        Mean, and median of the magnitude [dB].
    """

    n: int
    n_without: int
    sigma_db: float
    mean_db: float
    median_db: float

    @classmethod
    def of(cls, measured: Floats, predicted: Floats, which: Bools) -> Agreement | None:
        """Compare readings with predictions [dBm], n each; None where nothing can be compared."""
        both = which & np.isfinite(predicted)
        if not both.any():
            return None
        residual = measured[both] - predicted[both]
        return cls(
            n=int(both.sum()),
            n_without=int(which.sum() - both.sum()),
            sigma_db=float(np.sqrt(np.mean(residual**2))),
            mean_db=float(residual.mean()),
            median_db=float(np.median(np.abs(residual))),
        )


def slope_of(measured: Floats, predicted: Floats, which: Bools) -> float:
    """Slope of measured on predicted RSS: 1 for the right contrast, 0 for equal predictions."""
    both = which & np.isfinite(predicted)
    if not both.any():
        return 0.0
    centred = predicted[both] - predicted[both].mean()
    spread = float(centred @ centred)
    return float(centred @ measured[both]) / spread if spread > 1e-9 else 0.0


@dataclass(frozen=True)
class Floor:
    """How much neighbouring readings differ, which no model that is smooth in between predicts.

    Attributes
    ----------
    sigma_db
        Root mean square of the differences of neighbours over sqrt(2) [dB].
    n_pairs, distance_m
        How many pairs there are, and the median of their distances [m].
    """

    sigma_db: float
    n_pairs: int
    distance_m: float


def floor_of(survey: Survey) -> Floor | None:
    """Compare each reading with its nearest one of the same transmitter and device."""
    differences: list[Floats] = []
    distances: list[Floats] = []
    key = survey.transmitter * len(survey.devices) + survey.device
    for k in np.unique(key):
        mine = np.flatnonzero((key == k) & ~survey.is_censored)
        if len(mine) < 2:
            continue
        places, rss_dbm = survey.points[mine], survey.rss_dbm[mine]
        of_two, of_neighbours = KDTree(places).query(places, k=2)
        distance, other = np.asarray(of_two)[:, 1], np.asarray(of_neighbours)[:, 1]
        pair = np.sort(np.column_stack([np.arange(len(mine)), other]), axis=1)
        pair, first = np.unique(pair, axis=0, return_index=True)
        differences.append(rss_dbm[pair[:, 0]] - rss_dbm[pair[:, 1]])
        distances.append(distance[first])
    n_pairs = sum(map(len, differences))
    if n_pairs < LEAST_PAIRS:
        return None
    difference = np.concatenate(differences)
    sigma_db = float(np.sqrt(np.mean(difference**2) / 2.0))
    return Floor(sigma_db, n_pairs, float(np.median(np.concatenate(distances))))
