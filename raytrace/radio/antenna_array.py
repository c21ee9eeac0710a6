"""Arrays of like antennas: their pattern for given weights, and the response of each element."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from raytrace.arrays import Complexes, Floats
from raytrace.radio.antenna_checks import (
    MAX_OFFSET,
    MAX_WEIGHT,
    Vector,
    check_elements,
    unit_vector,
)
from raytrace.radio.antennas import Amplitudes, Antenna, Isotropic
from raytrace.radio.rotated import unit_vectors

BLOCK = 1 << 20
"""Most phases of elements that `AntennaArray.amplitudes` holds at once."""


@dataclass(frozen=True)
class AntennaArray:
    """Antennas of one kind and orientation, without coupling, fed with complex weights.

    As an antenna its amplitudes are those of an element times the array factor
    sum w_k exp(j 2 pi r_k . s) towards s (Balanis, section 6.8). The weights are not normalised:
    where the squares of their magnitudes sum to 1, the elements share the power.

    Attributes
    ----------
    element
        Each antenna.
    offsets
        (x, y, z) of each element from the array's position [wavelengths]; 1 to 4096 elements.
    weights
        One for each element; by default all equal, with squares that sum to 1.

    Raises
    ------
    ValueError
        Where offsets and weights are not of the same number, or too large.
    """

    element: Antenna = field(default_factory=Isotropic)
    offsets: tuple[Vector, ...] = ((0.0, 0.0, 0.0),)
    weights: tuple[complex, ...] = ()

    def __post_init__(self) -> None:
        """Check the numbers; raise ValueError where they do not belong together."""
        check_elements("number of offsets", max(len(self.offsets), 1))
        offsets = np.asarray(self.offsets, dtype=np.float64)
        if offsets.ndim != 2 or offsets.shape[1] != 3 or not len(offsets):
            raise ValueError(f"offsets of shape {offsets.shape}: expected (n, 3), n at least 1")
        weights = np.asarray(self.weights, dtype=np.complex128)
        if not len(weights):
            weights = np.full(len(offsets), 1.0 / np.sqrt(len(offsets)), dtype=np.complex128)
        if weights.shape != (len(offsets),):
            raise ValueError(f"weights of shape {weights.shape}: expected ({len(offsets)},)")
        if not (np.abs(offsets) <= MAX_OFFSET).all():
            raise ValueError(f"offsets: expected numbers up to {MAX_OFFSET:g} wavelengths")
        if not (np.abs(weights) <= MAX_WEIGHT).all():
            raise ValueError(f"weights: expected magnitudes up to {MAX_WEIGHT:g}")
        object.__setattr__(self, "offsets", tuple(map(tuple, offsets.tolist())))
        object.__setattr__(self, "weights", tuple(weights.tolist()))

    def __repr__(self) -> str:
        """Number and kind of elements in one line."""
        return f"<AntennaArray: {self.describe()}>"

    @classmethod
    def linear(
        cls,
        n: int,
        element: Antenna | None = None,
        *,
        spacing: float = 0.5,
        axis: Vector = (0.0, 1.0, 0.0),
    ) -> AntennaArray:
        """Make a uniform linear array, centred on its position.

        Parameters
        ----------
        n
            Number of elements.
        element
            Each antenna; an isotropic one by default.
        spacing
            Between neighbours [wavelengths].
        axis
            Direction of the line, of any length.

        Raises
        ------
        ValueError
            For a number of elements out of range, or an axis that is no direction.
        """
        check_elements("n", n)
        _check_spacing(spacing)
        step = spacing * np.array(unit_vector("axis", axis))
        return cls(element or Isotropic(), _vectors(_centred(n)[:, None] * step))

    @classmethod
    def planar(
        cls, n_y: int, n_z: int, element: Antenna | None = None, *, spacing: float = 0.5
    ) -> AntennaArray:
        """Make a uniform array in the yz plane that faces +x, y running fastest.

        Parameters
        ----------
        n_y, n_z
            Numbers of columns and of rows.
        element
            Each antenna; an isotropic one by default.
        spacing
            Between neighbours [wavelengths].

        Raises
        ------
        ValueError
            For a number of rows, columns or elements out of range.
        """
        for name, n in (("n_y", n_y), ("n_z", n_z), ("n_y * n_z", n_y * n_z)):
            check_elements(name, n)
        _check_spacing(spacing)
        z, y = np.meshgrid(_centred(n_z), _centred(n_y), indexing="ij")
        offsets = spacing * np.stack([np.zeros(z.size), y.ravel(), z.ravel()], axis=-1)
        return cls(element or Isotropic(), _vectors(offsets))

    def __len__(self) -> int:
        """Number of elements."""
        return len(self.offsets)

    def steered(self, direction: Vector) -> AntennaArray:
        """Return the same array with the weights of equal magnitude that point its main lobe.

        Raises
        ------
        ValueError
            For a direction that is none.
        """
        phases = np.asarray(self.offsets) @ np.array(unit_vector("direction", direction))
        weights = np.exp(-2j * np.pi * phases) / np.sqrt(len(self))
        return replace(self, weights=tuple(weights.tolist()))

    def response(self, directions: Floats) -> Complexes:
        """Phase factor of each element towards directions, for array processing.

        Parameters
        ----------
        directions
            (..., 3) unit vectors away from the array.

        Returns
        -------
        ndarray
            (..., n) exp(j 2 pi r_k . s): a steering vector for each direction.
        """
        return np.exp(2j * np.pi * (np.asarray(directions) @ np.asarray(self.offsets).T))

    def amplitudes(self, sine: Floats, azimuth: Floats) -> Amplitudes:
        """Field amplitudes towards directions; see `raytrace.antennas.Antenna.amplitudes`."""
        towards = unit_vectors(np.asarray(sine), np.asarray(azimuth))[2]
        rows, weights = towards.reshape(-1, 3), np.asarray(self.weights)
        blocks = np.array_split(rows, 1 + len(rows) * len(weights) // BLOCK)
        factor = np.concatenate([self.response(block) @ weights for block in blocks])
        factor = factor.reshape(towards.shape[:-1])
        v, h = self.element.amplitudes(sine, azimuth)
        return Amplitudes(factor * v, factor * h)

    def describe(self) -> str:
        """Number and kind of elements in one line."""
        return f"array of {len(self)} elements, each: {self.element.describe()}"


def _check_spacing(spacing: float) -> None:
    if not abs(spacing) <= MAX_OFFSET:
        raise ValueError(f"spacing = {spacing}: expected up to {MAX_OFFSET:g} wavelengths")


def _centred(n: int) -> Floats:
    """Return n numbers, 1 apart, around 0."""
    return np.arange(n, dtype=np.float64) - 0.5 * (n - 1)


def _vectors(offsets: Sequence[Floats] | Floats) -> tuple[Vector, ...]:
    return tuple((float(x), float(y), float(z)) for x, y, z in offsets)
