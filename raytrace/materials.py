"""Building materials and the reflection of a plane wave by a wall of them.

Permittivity and conductivity follow Recommendation ITU-R P.2040-4 (09/2025), section 3:
``eps_r = a f^b`` and ``sigma = c f^d`` [S/m] with f in GHz; brick, chipboard, plywood, marble
and floorboard keep the values of P.2040-3. A wall is a homogeneous slab; its
reflection coefficients are those of P.2040-4 eqs. (37)-(43).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from raytrace.constants import SPEED_OF_LIGHT, TWO_PI, VACUUM_PERMITTIVITY
from raytrace.errors import SceneError

MATERIAL_EDITION = "ITU-R P.2040-4 (09/2025)"

METAL_CONDUCTIVITY = 1e7
"""Conductivity of `metal` [S/m], P.2040-4 table 3."""


@dataclass(frozen=True)
class Material:
    """Electrical properties of a building material over frequency.

    Attributes
    ----------
    name
        Its name in a floor plan.
    a, b
        Relative permittivity ``a f^b``, f in GHz [1].
    c, d
        Conductivity ``c f^d``, f in GHz [S/m].
    """

    name: str
    a: float
    b: float
    c: float
    d: float

    def complex_permittivity(self, frequency_hz: float) -> complex:
        """Relative permittivity eps_r - j sigma / (omega eps_0), for e^(+j omega t)."""
        f_ghz = frequency_hz * 1e-9
        sigma = self.c * f_ghz**self.d
        return self.a * f_ghz**self.b - 1j * sigma / (TWO_PI * frequency_hz * VACUUM_PERMITTIVITY)


MATERIALS: dict[str, Material] = {
    m.name: m
    for m in (
        Material("vacuum", 1.0, 0.0, 0.0, 0.0),
        Material("concrete", 5.24, 0.0, 0.0462, 0.7822),
        Material("brick", 3.91, 0.0, 0.0238, 0.16),
        Material("plasterboard", 2.94, 0.0, 0.0116, 0.7076),
        Material("wood", 1.99, 0.0, 0.0047, 1.0718),
        Material("glass", 6.27, 0.0, 0.0043, 1.1925),
        Material("ceiling_board", 1.48, 0.0, 0.0011, 1.1278),
        Material("chipboard", 2.58, 0.0, 0.0217, 0.78),
        Material("plywood", 2.71, 0.0, 0.33, 0.0),
        Material("marble", 7.074, 0.0, 0.0055, 0.9262),
        Material("floorboard", 3.66, 0.0, 0.0044, 1.3515),
        Material("metal", 1.0, 0.0, METAL_CONDUCTIVITY, 0.0),
    )
}


def find_material(name: str) -> Material:
    """Return the material of that name.

    Raises
    ------
    SceneError
        With the nearest known name, where there is none.
    """
    if name in MATERIALS:
        return MATERIALS[name]
    near = get_close_matches(name, MATERIALS, n=1)
    hint = f"did you mean {near[0]!r}? " if near else ""
    raise SceneError(f"unknown material {name!r}: {hint}known are {', '.join(MATERIALS)}")


class SlabCoefficients(NamedTuple):
    """Reflection and transmission of a slab; arrays of the shape of the angles."""

    r_te: NDArray[np.complex128]
    r_tm: NDArray[np.complex128]
    t_te: NDArray[np.complex128]
    t_tm: NDArray[np.complex128]


def slab_coefficients(
    permittivity: complex,
    thickness_m: float,
    frequency_hz: float,
    cos_incidence: NDArray[np.float64],
) -> SlabCoefficients:
    """Plane-wave coefficients of a slab in air, P.2040-4 eqs. (37)-(43).

    Parameters
    ----------
    permittivity
        Complex relative permittivity.
    thickness_m
        Thickness [m].
    frequency_hz
        Frequency [Hz].
    cos_incidence
        Cosine of the angle from the normal, any shape, 0 to 1.

    Returns
    -------
    SlabCoefficients
        TE: electric field parallel to the slab; TM: magnetic field parallel. TM signs are such
        that R_te = -R_tm at normal incidence. The reference plane is the slab's centre sheet
        taken as its surface; transmission includes the slab's phase.
    """
    cos_i = np.maximum(np.asarray(cos_incidence, dtype=np.float64), 1e-12)
    inner: NDArray[np.complex128] = np.sqrt(complex(permittivity) - 1.0 + cos_i**2)
    half_te: NDArray[np.complex128] = (cos_i - inner) / (cos_i + inner)
    half_tm: NDArray[np.complex128] = (permittivity * cos_i - inner) / (
        permittivity * cos_i + inner
    )
    delay = np.exp(-1j * TWO_PI * frequency_hz / SPEED_OF_LIGHT * thickness_m * inner)

    def reflect(r: NDArray[np.complex128]) -> NDArray[np.complex128]:
        return r * (1.0 - delay**2) / (1.0 - r**2 * delay**2)

    def transmit(r: NDArray[np.complex128]) -> NDArray[np.complex128]:
        return (1.0 - r**2) * delay / (1.0 - r**2 * delay**2)

    return SlabCoefficients(
        reflect(half_te), reflect(half_tm), transmit(half_te), transmit(half_tm)
    )


SLAB_TABLE_STEPS = 4096


def slab_tables(slabs: Sequence[tuple[str, float]], frequency_hz: float) -> NDArray[np.float64]:
    """Tabulate the reflection of each slab over the cosine of incidence, for the kernels.

    Parameters
    ----------
    slabs
        (material name, thickness [m]) of each.
    frequency_hz
        Frequency [Hz].

    Returns
    -------
    ndarray
        (n_slabs, SLAB_TABLE_STEPS + 2, 4): real and imaginary parts of R_tm and of
        (R_te + R_tm) / sin^2 theta, at cosines 0, 1/n, ..., 1 and once more. The second is
        what mixes the polarisations (docs/theory.md, eq. 12); it is smooth at normal incidence.
    """
    cos_i = np.linspace(0.0, 1.0, SLAB_TABLE_STEPS + 1)
    sin2 = 1.0 - cos_i**2
    table = np.empty((len(slabs), SLAB_TABLE_STEPS + 2, 4))
    for row, (name, thickness_m) in zip(table, slabs, strict=True):
        permittivity = find_material(name).complex_permittivity(frequency_hz)
        c = slab_coefficients(permittivity, thickness_m, frequency_hz, cos_i)
        mix = np.empty_like(c.r_tm)
        mix[:-1] = (c.r_te + c.r_tm)[:-1] / sin2[:-1]
        mix[-1] = 2.0 * mix[-2] - mix[-3]
        columns = np.column_stack([c.r_tm.real, c.r_tm.imag, mix.real, mix.imag])
        row[:-1], row[-1] = columns, columns[-1]
    return table
