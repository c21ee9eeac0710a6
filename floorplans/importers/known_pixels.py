"""Pixels that a robot's map knows, to measure a plan against."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, eq=False)
class KnownPixels:
    """Centres of the pixels of a map, a regular selection of large maps.

    Attributes
    ----------
    free, occupied : (n, 2) float64
        (x, y) in the draft's coordinates [m].
    pixel_m : float
        Side of a pixel [m].
    area_m2 : float
        Of all free pixels [m²].
    """

    free: NDArray[np.float64]
    occupied: NDArray[np.float64]
    pixel_m: float
    area_m2: float

    def moved(self, to: Callable[[NDArray[np.float64]], NDArray[np.float64]]) -> KnownPixels:
        """Transform the points."""
        return replace(self, free=to(self.free), occupied=to(self.occupied))
