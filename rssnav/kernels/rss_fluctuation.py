"""RSS readings: the map's value and a Gaussian fluctuation that is correlated in time."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from rssnav.kernels.compiling import jit
from rssnav.kernels.xoshiro import draw, gaussian


@jit()
def fluctuating(
    mean_dbm: float,
    sigma_db: float,
    correlation: float,
    fluctuation_db: NDArray[np.float64],
    generator: NDArray[np.uint64],
) -> float:
    """Reading [dBm] with a first-order autoregressive fluctuation (1,), which is updated."""
    if sigma_db == 0.0:
        return mean_dbm
    innovation = sigma_db * gaussian(draw(generator), draw(generator))
    kept = correlation * fluctuation_db[0]
    fluctuation_db[0] = kept + math.sqrt(1.0 - correlation * correlation) * innovation
    return mean_dbm + fluctuation_db[0]
