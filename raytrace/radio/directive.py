"""Antennas with a front: monopole on a ground plane, patch, and the sector antenna of 3GPP.

Each is lossless, or has the gain that its source states; `raytrace.radio.rotated.Rotated.towards`
points one in another direction.
"""

from dataclasses import dataclass
from functools import cached_property
from math import isfinite, pi, sqrt

import numpy as np

from raytrace.arrays import Floats
from raytrace.radio.antenna_checks import check_gain_db
from raytrace.radio.antennas import DIPOLE_PEAK_GAIN_DBI, Amplitudes, HalfWaveDipole
from raytrace.radio.rotated import components, unit_vectors

GROUND_PLANE_GAIN_DB = 10.0 * np.log10(2.0)
"""Gain of radiating into one half space over both [dB]."""

LEAST_BEAMWIDTH_DEG = 0.01
"""Smallest width of a sector's beam [deg]."""
N_NORMALISATION = 181
"""Elevations and azimuths of the front half space over which a patch's gain is averaged."""


@dataclass(frozen=True)
class Monopole:
    """Quarter-wave monopole on an infinite ground plane, a half-wave dipole's upper half.

    It stands along +z and radiates nothing below the horizon (Balanis, section 4.7.2).

    Attributes
    ----------
    peak_gain_db
        Gain at the horizon [dB]; by default that of a lossless one, 5.16 dBi.

    Raises
    ------
    ValueError
        For a gain that is NaN or too large.
    """

    peak_gain_db: float = DIPOLE_PEAK_GAIN_DBI + GROUND_PLANE_GAIN_DB

    def __post_init__(self) -> None:
        """Check the gain; raise ValueError for one out of range."""
        check_gain_db("peak_gain_db", self.peak_gain_db)

    def amplitudes(self, sine: Floats, azimuth: Floats) -> Amplitudes:
        """Field amplitudes towards directions; see `raytrace.antennas.Antenna.amplitudes`."""
        v, h = HalfWaveDipole(self.peak_gain_db).amplitudes(sine, azimuth)
        return Amplitudes(np.where(np.asarray(sine) >= 0.0, v, 0.0), h)

    def describe(self) -> str:
        """Name and parameters in one line."""
        return f"quarter-wave monopole on a ground plane, peak gain {self.peak_gain_db:.4g} dB"


@dataclass(frozen=True)
class Patch:
    """Half-wave rectangular patch on a thin substrate over an infinite ground plane.

    It lies in the yz plane, radiates towards +x, and is resonant and polarised along z. Two slots
    of magnetic current along y, at both ends of the patch, radiate; the substrate's thickness is
    neglected (cavity model: Balanis, eqs. 14-6, 14-44). Lossless: the gain averages to 1.

    Attributes
    ----------
    permittivity
        Of the substrate, relative, at least 1. It sets length and width, and so the gain:
        9.3 dBi on air, 7.1 dBi at 2.2, 6.0 dBi at 4.4.

    Raises
    ------
    ValueError
        For a permittivity below 1, or one that is not finite.
    """

    permittivity: float = 2.2

    def __post_init__(self) -> None:
        """Check the permittivity; raise ValueError below 1."""
        if not (isfinite(self.permittivity) and self.permittivity >= 1.0):
            raise ValueError(f"permittivity = {self.permittivity}: expected a number of at least 1")

    @property
    def size(self) -> tuple[float, float]:
        """Resonant length along z and width along y [wavelengths]."""
        return 0.5 / sqrt(self.permittivity), 0.5 * sqrt(2.0 / (self.permittivity + 1.0))

    @cached_property
    def peak_gain_db(self) -> float:
        """Gain towards +x [dBi]."""
        return float(-10.0 * np.log10(self._mean))

    @cached_property
    def _mean(self) -> float:
        """Mean of the squared shape over the sphere; the rule is Gauss-Legendre in both angles."""
        nodes, weights = np.polynomial.legendre.leggauss(N_NORMALISATION)
        sine, azimuth = np.meshgrid(nodes, 0.5 * pi * nodes, indexing="ij")
        v, h = self._shape(sine, azimuth)
        return float(weights @ (v**2 + h**2) @ weights) / 8.0

    def amplitudes(self, sine: Floats, azimuth: Floats) -> Amplitudes:
        """Field amplitudes towards directions; see `raytrace.antennas.Antenna.amplitudes`."""
        v, h = self._shape(np.asarray(sine), np.asarray(azimuth))
        size = 1.0 / sqrt(self._mean)
        return Amplitudes(size * v, size * h)

    def _shape(self, sine: Floats, azimuth: Floats) -> Amplitudes:
        """Amplitudes relative to those towards +x."""
        towards = unit_vectors(sine, azimuth)[2]
        x, y, z = np.moveaxis(towards, -1, 0)
        length, width = self.size
        size = np.sinc(width * y) * np.cos(pi * length * z)
        field = np.stack([-z, np.zeros_like(x), x], axis=-1)  # towards x (unit vector along y)
        in_front = np.where(x > 0.0, size, 0.0)
        return components(in_front[..., None] * field, sine, azimuth)

    def describe(self) -> str:
        """Name and parameters in one line."""
        return f"patch, permittivity {self.permittivity:g}, peak gain {self.peak_gain_db:.3g} dB"


@dataclass(frozen=True)
class Sector:
    """Element of a base station's antenna, after 3GPP TR 38.901, table 7.3-1.

    It radiates towards +x. Its gain falls with the square of the angles to the front and has a
    floor; it is a model of an enclosed element, so its gain does not average to 1.

    Attributes
    ----------
    peak_gain_db
        Gain towards +x [dB].
    beamwidth_deg
        Width between the directions of -3 dB, in elevation and in azimuth [deg].
    front_to_back_db
        Peak gain over that of the back, and over side lobes in elevation [dB].
    slant_deg
        Angle of the polarisation to the vertical, positive towards azimuth (polarisation model 2,
        eqs. 7.3-4 and 7.3-5) [deg].

    Raises
    ------
    ValueError
        For a number out of range.
    """

    peak_gain_db: float = 8.0
    beamwidth_deg: float = 65.0
    front_to_back_db: float = 30.0
    slant_deg: float = 0.0

    def __post_init__(self) -> None:
        """Check the numbers; raise ValueError for one out of range."""
        check_gain_db("peak_gain_db", self.peak_gain_db)
        if not LEAST_BEAMWIDTH_DEG <= self.beamwidth_deg <= 360.0:
            raise ValueError(
                f"beamwidth_deg = {self.beamwidth_deg}: expected {LEAST_BEAMWIDTH_DEG:g} to 360"
            )
        if not 0.0 <= self.front_to_back_db < float("inf"):
            raise ValueError(f"front_to_back_db = {self.front_to_back_db}: expected at least 0")
        if not isfinite(self.slant_deg):
            raise ValueError(f"slant_deg = {self.slant_deg}: expected a finite number")

    def amplitudes(self, sine: Floats, azimuth: Floats) -> Amplitudes:
        """Field amplitudes towards directions; see `raytrace.antennas.Antenna.amplitudes`."""
        elevation = np.degrees(np.arcsin(np.clip(sine, -1.0, 1.0)))
        turned = (np.degrees(azimuth) + 180.0) % 360.0 - 180.0
        down = self._attenuation_db(elevation) + self._attenuation_db(turned)
        gain_db = self.peak_gain_db - np.minimum(down, self.front_to_back_db)
        size, slant = 10.0 ** (gain_db / 20.0), np.radians(self.slant_deg)
        return Amplitudes(np.cos(slant) * size, np.sin(slant) * size)

    def _attenuation_db(self, angle_deg: Floats) -> Floats:
        parabola = 12.0 * (np.asarray(angle_deg) / self.beamwidth_deg) ** 2
        return np.minimum(parabola, self.front_to_back_db)

    def describe(self) -> str:
        """Name and parameters in one line."""
        return (
            f"3GPP sector, {self.beamwidth_deg:g} deg wide, peak gain {self.peak_gain_db:g} dB, "
            f"slant {self.slant_deg:g} deg"
        )
