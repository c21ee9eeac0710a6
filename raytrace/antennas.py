"""Antenna patterns: field amplitude over the polar angle, vertical polarisation.

A pattern here is rotationally symmetric about the vertical axis and polarised along the
polar unit vector, as a vertical wire antenna is. The tracer reads it as a function of the
direction's z component, cos(theta), where theta is the angle from the zenith.
"""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

DIPOLE_PEAK_GAIN_DBI = 2.150_88
"""Peak gain of a lossless half-wave dipole over an isotropic radiator [dB] (Balanis, 4-93)."""


class Antenna(Protocol):
    """What the tracer asks of an antenna."""

    def amplitude(self, cos_theta: NDArray[np.float64]) -> NDArray[np.float64]:
        """Field amplitude relative to a 0 dBi radiator, at directions with that z component."""
        ...

    def describe(self) -> str:
        """Name and parameters in one line, as stored with a map."""
        ...


@dataclass(frozen=True)
class HalfWaveDipole:
    """Vertical half-wave dipole, cos(pi/2 cos theta) / sin theta (Balanis, eq. 4-84).

    Attributes
    ----------
    peak_gain_db
        Gain at the horizon [dB]. The default normalises it to 0 dB, as the paper does;
        a lossless dipole has `DIPOLE_PEAK_GAIN_DBI`.
    """

    peak_gain_db: float = 0.0

    def amplitude(self, cos_theta: NDArray[np.float64]) -> NDArray[np.float64]:
        """Field amplitude over the direction's z component, any shape [1]."""
        sin_theta = np.sqrt(np.maximum(1.0 - cos_theta**2, 1e-12))
        return 10.0 ** (self.peak_gain_db / 20.0) * np.cos(0.5 * np.pi * cos_theta) / sin_theta

    def describe(self) -> str:
        """Name and parameters in one line."""
        return f"vertical half-wave dipole, peak gain {self.peak_gain_db:g} dB"


@dataclass(frozen=True)
class Isotropic:
    """The same amplitude in every direction, polarised along theta.

    Attributes
    ----------
    gain_db
        Gain over a 0 dBi radiator [dB].
    """

    gain_db: float = 0.0

    def amplitude(self, cos_theta: NDArray[np.float64]) -> NDArray[np.float64]:
        """Field amplitude, any shape [1]."""
        return np.full_like(cos_theta, 10.0 ** (self.gain_db / 20.0))

    def describe(self) -> str:
        """Name and parameters in one line."""
        return f"isotropic, theta-polarised, gain {self.gain_db:g} dB"
