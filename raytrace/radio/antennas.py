"""Antennas: amplitudes of two polarisations over the direction; dipoles and the isotropic one.

Towards a unit direction s = (u_x c, u_y c, sigma) with horizontal part u, cosine c and sine sigma
of the elevation, an antenna has the amplitudes `v` (vertical polarisation) along
tau = (z - (z . s) s) / c, which points up, and `h` (horizontal) along psi = z x s / c
(docs/theory.md, eq. 10). In spherical coordinates tau = -theta-hat and psi = phi-hat. Amplitudes
are relative to a 0 dBi radiator: the gain in a direction is |v|^2 + |h|^2, and a lossless antenna's
gain averages to 1 over the sphere.

The same pattern serves for receiving. A wave that arrives along s comes from the direction -s,
where tau is the same vector and psi the opposite one: the antenna receives
v(-s) E_tau - h(-s) E_psi (docs/theory.md, eq. 32).
"""

from dataclasses import dataclass
from math import log10
from typing import Literal, NamedTuple, Protocol, get_args

import numpy as np

from raytrace.arrays import Complexes, Floats
from raytrace.errors import SceneError
from raytrace.radio.antenna_checks import check_gain_db, unit_vector

DIPOLE_PEAK_GAIN_DBI = 2.150_88
"""Peak gain of a lossless half-wave dipole over an isotropic radiator [dB] (Balanis, 4-93)."""


class Amplitudes(NamedTuple):
    """V and H field amplitudes towards directions; two arrays of the directions' shape [1]."""

    v: Floats | Complexes
    h: Floats | Complexes


class Antenna(Protocol):
    """What the tracer asks of an antenna."""

    def amplitudes(self, sine: Floats, azimuth: Floats) -> Amplitudes:
        """Field amplitudes towards directions.

        Parameters
        ----------
        sine
            Sine of the elevation, the direction's z component; any shape.
        azimuth
            From +x towards +y [rad]; the same shape. At the zenith it defines tau.
        """
        ...

    def describe(self) -> str:
        """Name and parameters in one line, for messages."""
        ...


@dataclass(frozen=True)
class HalfWaveDipole:
    """Half-wave dipole, cos(pi/2 cos chi) / sin chi at the angle chi from its axis.

    Balanis, eq. 4-84; docs/theory.md, eqs. 9 and 31.

    Attributes
    ----------
    peak_gain_db
        Gain across the axis [dB]. The default normalises it to 0 dB, as the paper does;
        a lossless dipole has `DIPOLE_PEAK_GAIN_DBI`.
    axis
        (x, y, z) along the wire, of any length; vertical by default. The opposite axis is the
        same antenna with the opposite phase.

    Raises
    ------
    ValueError
        For a gain that is NaN or too large.
    """

    peak_gain_db: float = 0.0
    axis: tuple[float, float, float] = (0.0, 0.0, 1.0)

    def __post_init__(self) -> None:
        """Check gain and axis; raise ValueError for a wrong one."""
        check_gain_db("peak_gain_db", self.peak_gain_db)
        object.__setattr__(self, "axis", unit_vector("axis", self.axis))

    def amplitudes(self, sine: Floats, azimuth: Floats) -> Amplitudes:
        """Field amplitudes towards directions; see `Antenna.amplitudes`."""
        cosine = np.sqrt(np.maximum(1.0 - sine**2, 0.0))
        x, y, z = self.axis
        along_azimuth = x * np.cos(azimuth) + y * np.sin(azimuth)
        across_azimuth = y * np.cos(azimuth) - x * np.sin(azimuth)
        along_wire = along_azimuth * cosine + z * sine
        size = 10.0 ** (self.peak_gain_db / 20.0) * _dipole_shape(along_wire)
        return Amplitudes(size * (z * cosine - along_azimuth * sine), size * across_azimuth)

    def describe(self) -> str:
        """Name and parameters in one line."""
        x, y, z = self.axis
        direction = "vertical" if z == 1.0 else f"along ({x:g}, {y:g}, {z:g})"
        return f"half-wave dipole, {direction}, peak gain {self.peak_gain_db:g} dB"


def _dipole_shape(cos_chi: Floats) -> Floats:
    """cos(pi/2 cos chi) / sin^2 chi, which is smooth and pi/4 along the wire."""
    sin2 = 1.0 - cos_chi**2
    safe = np.maximum(sin2, 1e-9)
    return np.where(sin2 > 1e-9, np.cos(0.5 * np.pi * cos_chi) / safe, 0.25 * np.pi)


Polarisation = Literal["vertical", "horizontal", "mean"]
HALF_DB = 10.0 * log10(0.5)


@dataclass(frozen=True)
class Isotropic:
    """The same gain in every direction.

    Attributes
    ----------
    gain_db
        Gain over a 0 dBi radiator [dB].
    polarisation
        Along tau ("vertical") or psi ("horizontal"), or unknown: then powers are means over all
        polarisations ("mean"; docs/theory.md, eq. 48).

    Raises
    ------
    ValueError
        For a gain that is NaN or too large, and another polarisation.
    """

    gain_db: float = 0.0
    polarisation: Polarisation = "vertical"

    def __post_init__(self) -> None:
        """Check gain and polarisation; raise ValueError for those that cannot be."""
        check_gain_db("gain_db", self.gain_db)
        if self.polarisation not in get_args(Polarisation):
            known = ", ".join(map(repr, get_args(Polarisation)))
            raise ValueError(f"polarisation = {self.polarisation!r}: expected one of {known}")

    def amplitudes(self, sine: Floats, azimuth: Floats) -> Amplitudes:
        """Field amplitudes towards directions; see `Antenna.amplitudes`.

        Raises
        ------
        SceneError
            For an unknown polarisation, which has powers but no amplitudes.
        """
        if self.polarisation == "mean":
            raise SceneError(
                f"antenna {self.describe()!r} has no field amplitudes: expected a polarisation of "
                '"vertical" or "horizontal"'
            )
        everywhere = np.full(np.shape(sine), 10.0 ** (self.gain_db / 20.0))
        nowhere = np.zeros_like(everywhere)
        is_vertical = self.polarisation == "vertical"
        return Amplitudes(*(everywhere, nowhere) if is_vertical else (nowhere, everywhere))

    def describe(self) -> str:
        """Name and parameters in one line."""
        polarised = {"mean": "mean over polarisations"}
        how = polarised.get(self.polarisation, f"{self.polarisation}ly polarised")
        return f"isotropic, {how}, gain {self.gain_db:g} dB"


def polarisations(antenna: Antenna) -> tuple[Antenna, ...]:
    """Return antennas of known polarisation whose received powers add up to those of an antenna."""
    if isinstance(antenna, Isotropic) and antenna.polarisation == "mean":
        half_db = antenna.gain_db + HALF_DB
        return Isotropic(half_db), Isotropic(half_db, "horizontal")
    return (antenna,)


def is_vertical(antenna: Antenna) -> bool:
    """Whether an antenna is vertically polarised, real, and the same in all azimuths."""
    sine = np.linspace(-1.0, 1.0, 33)
    around = np.linspace(0.0, 2.0 * np.pi, 13)
    v, h = antenna.amplitudes(*np.meshgrid(sine, around, indexing="ij"))
    real = not np.iscomplexobj(v) and not np.any(h)
    return bool(real and np.allclose(v, v[:, :1]))


def vertical_amplitude(antenna: Antenna, sine: Floats) -> Floats:
    """V amplitude of an antenna for which `is_vertical` holds.

    Raises
    ------
    SceneError
        For an antenna that is not of that kind.
    """
    if not is_vertical(antenna):
        raise SceneError(
            f"antenna {antenna.describe()!r}: expected a vertically polarised one that is "
            "the same in all azimuths"
        )
    return np.asarray(antenna.amplitudes(sine, np.zeros_like(sine)).v, dtype=np.float64)
