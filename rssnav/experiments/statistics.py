"""Bootstrap intervals over realisations.

An interval is the central 95 % of a statistic over resamples of the realisations with
replacement (percentile bootstrap; Efron and Tibshirani, An Introduction to the Bootstrap, 1993,
ch. 13). Trainings of different configurations are independent, so each is resampled separately.
The seed of the resampling is fixed: the same data gives the same interval.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

RESAMPLES = 10_000
LEVEL = 0.95
_SEED = 20_190_905


@dataclass(frozen=True)
class Estimate:
    """A statistic with its 95 % interval.

    Attributes
    ----------
    value : float
        The statistic of the data itself.
    low, high : float
        Limits of the interval.
    """

    value: float
    low: float
    high: float

    def __neg__(self) -> Estimate:
        return Estimate(-self.value, -self.high, -self.low)


def mean(values: ArrayLike) -> Estimate:
    """Mean over realisations (R,)."""
    data = _realisations(values)
    return _estimate(float(data.mean()), _resampled_means(data, 0))


def difference(first: ArrayLike, second: ArrayLike) -> Estimate:
    """Mean over the realisations (R1,) of one training minus that of another (R2,)."""
    a, b = _realisations(first), _realisations(second)
    resampled = _resampled_means(a, 0) - _resampled_means(b, 1)
    return _estimate(float(a.mean() - b.mean()), resampled)


def ratio(first: ArrayLike, second: ArrayLike) -> Estimate:
    """Mean over the realisations (R1,) of one training over that of another (R2,), positive."""
    a, b = _realisations(first), _realisations(second)
    if b.min() <= 0.0:
        raise ValueError("ratio: expected positive second values")
    resampled = _resampled_means(a, 0) / _resampled_means(b, 1)
    return _estimate(float(a.mean() / b.mean()), resampled)


def _realisations(values: ArrayLike) -> NDArray[np.float64]:
    data = np.asarray(values, dtype=np.float64)
    if data.ndim != 1 or data.size == 0:
        raise ValueError(f"values: shape {data.shape}; one value per realisation is needed")
    return data


def _resampled_means(data: NDArray[np.float64], stream: int) -> NDArray[np.float64]:
    """Means of the resamples, shape (RESAMPLES,)."""
    rng = np.random.default_rng((_SEED, stream))
    drawn = rng.integers(data.size, size=(RESAMPLES, data.size))
    return data[drawn].mean(axis=1)


def _estimate(value: float, resampled: NDArray[np.float64]) -> Estimate:
    tail = (1.0 - LEVEL) / 2.0
    low, high = np.quantile(resampled, (tail, 1.0 - tail))
    return Estimate(value, float(low), float(high))
