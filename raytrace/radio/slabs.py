"""Reflection and transmission of a plane wave by a stack of flat layers in air.

Recommendation ITU-R P.2040-4, section 2.2.2; docs/theory.md, eqs. 14-15 and 25-28. Time runs as
e^(+j omega t). TE: electric field parallel to the layers; TM: magnetic field parallel.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from raytrace.arrays import Complexes, Floats
from raytrace.constants import SPEED_OF_LIGHT, TWO_PI

GRAZING = 1e-12
"""Smallest cosine of incidence; smaller ones are set to it."""


class SlabCoefficients(NamedTuple):
    """Reflection and transmission of a slab; complex arrays of the shape of the angles.

    TM signs are such that R_te = -R_tm at normal incidence. Transmission includes the phase
    across the slab, from its front face to its back face along the normal.
    """

    r_te: Complexes
    r_tm: Complexes
    t_te: Complexes
    t_tm: Complexes

    def relative_to_air(
        self, thickness_m: float, frequency_hz: float, cos_incidence: Floats
    ) -> "SlabCoefficients":
        """Return the same with transmission relative to air across the same thickness.

        A wall is a sheet without thickness in the geometry: the ray's length already holds the
        phase across it, so air gives 1 (eq. 28).
        """
        wavenumber = TWO_PI * frequency_hz / SPEED_OF_LIGHT
        air_phase = np.exp(1j * wavenumber * thickness_m * np.asarray(cos_incidence))
        return self._replace(t_te=self.t_te * air_phase, t_tm=self.t_tm * air_phase)


def slab_coefficients(
    permittivity: complex, thickness_m: float, frequency_hz: float, cos_incidence: Floats
) -> SlabCoefficients:
    """Coefficients of one homogeneous slab in air, eqs. 14-15; see `stack_coefficients`."""
    return stack_coefficients([(permittivity, thickness_m)], frequency_hz, cos_incidence)


def stack_coefficients(
    layers: Sequence[tuple[complex, float]], frequency_hz: float, cos_incidence: Floats
) -> SlabCoefficients:
    """Coefficients of layers in air.

    The recursion runs from the last interface to the first, eqs. 26-27. It is the transfer-matrix
    method written with decaying exponentials only, so metal of any thickness does not overflow.

    Parameters
    ----------
    layers
        (complex relative permittivity, thickness [m]) of each, the first one met first.
    frequency_hz
        Frequency [Hz].
    cos_incidence
        Cosine of the angle from the normal, any shape, 0 to 1.
    """
    cos_i = np.maximum(np.asarray(cos_incidence, dtype=np.float64), GRAZING)
    wavenumber = TWO_PI * frequency_hz / SPEED_OF_LIGHT
    permittivities = np.array([complex(eps) for eps, _ in layers])
    sines: list[Complexes] = [np.sqrt(eps - 1.0 + cos_i**2) for eps in permittivities]
    delays = [
        np.exp(-1j * wavenumber * thickness_m * q)
        for (_, thickness_m), q in zip(layers, sines, strict=True)
    ]
    te = [*sines]
    tm = [eps / q for eps, q in zip(permittivities, sines, strict=True)]
    r_te, t_te = _through(cos_i, te, delays)
    r_tm, t_tm = _through(1.0 / cos_i, tm, delays)
    return SlabCoefficients(r_te, -r_tm, t_te, t_tm)


def _through(
    air: Floats, admittances: Sequence[Complexes], delays: Sequence[Complexes]
) -> tuple[Complexes, Complexes]:
    """Reflection and transmission of the tangential electric field.

    Parameters
    ----------
    air
        Wave admittance of air over that of free space at normal incidence.
    admittances, delays
        Of each layer: the same, and exp(-j k q d).
    """
    behind = [*admittances[1:], air.astype(np.complex128)]
    reflected = _step(admittances[-1], behind[-1])
    transmitted = 1.0 + reflected
    before = [air.astype(np.complex128), *admittances[:-1]]
    for y, y_layer, p in reversed(list(zip(before, admittances, delays, strict=True))):
        step = _step(y, y_layer)
        echo = reflected * p**2
        transmitted = transmitted * p * (1.0 + step) / (1.0 + step * echo)
        reflected = (step + echo) / (1.0 + step * echo)
    return reflected, transmitted


def _step(y_before: Complexes, y_behind: Complexes) -> Complexes:
    """Reflection of the tangential electric field at one interface, eq. 25."""
    return (y_before - y_behind) / (y_before + y_behind)
