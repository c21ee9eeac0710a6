"""The antenna at one end, as it is chosen on the page: a kind and a direction."""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, radians, sin

from floorplans.transmitters import ANTENNAS, WITHOUT_DIRECTION
from raytrace import Antenna
from rssnav.explorer.ranges import Range
from rssnav.transmitters import antenna_of

AZIMUTH = Range("Azimuth [\u00b0]", -180.0, 360.0, 15.0)
ELEVATION = Range("Elevation [\u00b0]", -90.0, 90.0, 15.0)
UPRIGHT_DEG = 90.0
_DIGITS = 12
"""Digits of a direction, so that an upright dipole is exactly upright."""


@dataclass(frozen=True)
class AntennaChoice:
    """A kind of antenna, and its direction.

    Attributes
    ----------
    name : str
        One of `floorplans.transmitters.ANTENNAS`; never a file.
    azimuth_deg, elevation_deg : float
        From +x towards +y, and above the horizontal: the axis of a dipole, or where the front of
        another antenna points to.
    """

    name: str
    azimuth_deg: float = 0.0
    elevation_deg: float = 0.0

    def __post_init__(self) -> None:
        """Check the values; raise ValueError for a wrong one."""
        if self.name not in ANTENNAS:
            raise ValueError(f"antenna: expected {', '.join(ANTENNAS)}")
        AZIMUTH.check(self.azimuth_deg)
        ELEVATION.check(self.elevation_deg)

    @classmethod
    def of(cls, name: str) -> AntennaChoice:
        """Return a kind in its usual direction: a dipole upright, others along +x."""
        return cls(name, elevation_deg=UPRIGHT_DEG if name == "dipole" else 0.0)

    @property
    def has_direction(self) -> bool:
        """Whether its direction matters."""
        return self.name not in WITHOUT_DIRECTION

    @property
    def antenna(self) -> Antenna:
        """The antenna as the tracer takes it."""
        if not self.has_direction:
            return antenna_of(self.name)
        azimuth, elevation = radians(self.azimuth_deg), radians(self.elevation_deg)
        x, y, z = (
            round(part, _DIGITS) + 0.0
            for part in (
                cos(elevation) * cos(azimuth), cos(elevation) * sin(azimuth), sin(elevation),
            )
        )  # fmt: skip
        return antenna_of(self.name, (x, y, z))
