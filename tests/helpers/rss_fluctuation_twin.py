"""The fluctuation of RSS readings in NumPy: the readable twin of `stepping.fluctuating`.

With independent standard normal z_k (Box-Muller), standard deviation s and correlation c, the
fluctuation is the stationary first-order autoregressive process

    x_k = c x_(k-1) + sqrt(1 - c^2) s z_k,    x_0 = sqrt(1 - c^2) s z_0.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from q_learning_twin import Xoshiro
from scipy.signal import lfilter


def standard_normal(generator: Xoshiro, count: int) -> NDArray[np.float64]:
    """Normal numbers (count,), each from the upper 53 bits of two draws (Box-Muller)."""
    bits = np.array([generator.bits() for _ in range(2 * count)], dtype=np.uint64)
    upper = (bits >> np.uint64(11)).astype(float).reshape(-1, 2) * 2.0**-53
    radius = np.sqrt(-2.0 * np.log(upper[:, 0] + 2.0**-53))
    return radius * np.cos(2.0 * np.pi * upper[:, 1])


def fluctuation_db(
    generator: Xoshiro, count: int, sigma_db: float, correlation: float
) -> NDArray[np.float64]:
    """Fluctuations (count,) of successive readings [dB]."""
    innovation = np.sqrt(1.0 - correlation**2) * sigma_db
    return lfilter([innovation], [1.0, -correlation], standard_normal(generator, count))
