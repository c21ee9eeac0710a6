"""An antenna that is mounted in another direction."""

from __future__ import annotations

from dataclasses import dataclass
from math import hypot

import numpy as np

from raytrace.arrays import Floats
from raytrace.radio.antenna_checks import Vector, unit_vector
from raytrace.radio.antennas import Amplitudes, Antenna

TOLERANCE = 1e-6
"""By which axes may differ from orthogonal unit vectors."""


@dataclass(frozen=True)
class Rotated:
    """An antenna with its own axes, whose field is that of the antenna in them.

    Attributes
    ----------
    antenna
        The antenna.
    x_axis, z_axis
        Its axes in the building, orthogonal unit vectors.

    Raises
    ------
    ValueError
        For axes that are not orthogonal unit vectors.
    """

    antenna: Antenna
    x_axis: Vector
    z_axis: Vector

    def __post_init__(self) -> None:
        """Check the axes; raise ValueError where they are not orthogonal unit vectors."""
        off = np.inf
        if np.shape(self.x_axis) == np.shape(self.z_axis) == (3,):
            axes = np.array([self.x_axis, self.z_axis], dtype=np.float64)
            if (np.abs(axes) <= 1.0 + TOLERANCE).all():
                off = np.abs(axes @ axes.T - np.eye(2)).max()
        if off > TOLERANCE:
            raise ValueError(
                f"x_axis = {self.x_axis}, z_axis = {self.z_axis}: expected orthogonal unit vectors"
            )

    def __repr__(self) -> str:
        """Antenna and directions of its axes in one line."""
        x_axis, z_axis = (
            ", ".join(f"{part + 0.0:.4g}" for part in axis) for axis in (self.x_axis, self.z_axis)
        )
        return f"Rotated({self.antenna!r}, x_axis=({x_axis}), z_axis=({z_axis}))"

    @classmethod
    def towards(cls, antenna: Antenna, direction: Vector) -> Rotated:
        """Point the +x axis of an antenna in a direction of any length, its y axis level.

        Raises
        ------
        ValueError
            For a direction that is none.
        """
        x, y, up = unit_vector("direction", direction)
        flat = hypot(x, y)
        cosine, sine = (x / flat, y / flat) if flat > 0.0 else (1.0, 0.0)
        return cls(antenna, (cosine * flat, sine * flat, up), (-cosine * up, -sine * up, flat))

    def amplitudes(self, sine: Floats, azimuth: Floats) -> Amplitudes:
        """Field amplitudes towards directions; see `raytrace.radio.antennas.Antenna.amplitudes`."""
        x_axis, z_axis = np.array(self.x_axis), np.array(self.z_axis)
        axes = np.array([x_axis, np.cross(z_axis, x_axis), z_axis])
        tau, psi, towards = unit_vectors(np.asarray(sine), np.asarray(azimuth))
        own = towards @ axes.T
        own_sine = np.clip(own[..., 2], -1.0, 1.0)
        own_azimuth = np.arctan2(own[..., 1], own[..., 0])
        v, h = self.antenna.amplitudes(own_sine, own_azimuth)
        own_tau, own_psi, _ = unit_vectors(own_sine, own_azimuth)
        own_tau, own_psi = own_tau @ axes, own_psi @ axes

        return Amplitudes(
            v * (own_tau * tau).sum(axis=-1) + h * (own_psi * tau).sum(axis=-1),
            v * (own_tau * psi).sum(axis=-1) + h * (own_psi * psi).sum(axis=-1),
        )

    def describe(self) -> str:
        """Name and direction in one line."""
        x, y, z = self.x_axis
        return f"{self.antenna.describe()}, towards ({x:.4g}, {y:.4g}, {z:.4g})"


def unit_vectors(sine: Floats, azimuth: Floats) -> tuple[Floats, Floats, Floats]:
    """Unit vectors tau, psi and s of directions (docs/theory.md, eq. 10); (..., 3) each."""
    cosine = np.sqrt(np.maximum(1.0 - sine**2, 0.0))
    cos_a, sin_a = np.cos(azimuth), np.sin(azimuth)
    zero = np.zeros_like(cosine * cos_a)
    tau = np.stack([-sine * cos_a, -sine * sin_a, cosine + zero], axis=-1)
    psi = np.stack([-sin_a + zero, cos_a + zero, zero], axis=-1)
    return tau, psi, np.stack([cosine * cos_a, cosine * sin_a, sine + zero], axis=-1)


def components(field: Floats, sine: Floats, azimuth: Floats) -> Amplitudes:
    """Amplitudes of a transverse field (..., 3) towards directions (...)."""
    tau, psi, _ = unit_vectors(sine, azimuth)
    return Amplitudes((field * tau).sum(axis=-1), (field * psi).sum(axis=-1))
