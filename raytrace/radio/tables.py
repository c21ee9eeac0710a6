"""Lookup tables of the field kernels: slabs, antennas, special functions."""

from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from itertools import product
from typing import Any

import numpy as np
from scipy.special import fresnel

from raytrace.arrays import Complexes, Floats, Ints
from raytrace.kernels.field_tables import FieldTables, Unknown
from raytrace.kernels.utd import TRANSITION_MAX, TRANSITION_STEPS
from raytrace.radio.antennas import (
    Antenna,
    HalfWaveDipole,
    is_vertical,
    polarisations,
    vertical_amplitude,
)
from raytrace.radio.materials import Material, Slab
from raytrace.radio.slabs import SlabCoefficients
from raytrace.radio.transmitter import Transmitter

CIS_STEPS = 256
ANTENNA_STEPS = 8192
SLAB_TABLE_STEPS = 4096
ELEVATION_STEPS = 256
AZIMUTH_STEPS = 512
"""Steps of the tables: of one turn; of the sine of elevation; of the cosine of incidence; of a
pattern from the nadir to the zenith and once around, 0.9 deg at most."""


def field_tables(
    transmitter: Transmitter,
    slabs: Sequence[Slab],
    *,
    receive_antenna: Antenna | None = None,
    through_walls: bool = False,
) -> FieldTables:
    """Tabulate materials, antennas and special functions at the transmitter's frequency.

    For an antenna of unknown polarisation see `FieldTables.unknown`.
    """
    turn = np.arange(CIS_STEPS + 1) * (2.0 * np.pi / CIS_STEPS)
    found = _at_all_angles(slabs, transmitter.frequency_hz)
    return FieldTables(
        wavelength=transmitter.wavelength_m,
        slab_rows=SLAB_TABLE_STEPS + 2,
        reflection=_reflection(found).reshape(-1, 4),
        transmission=_transmission(found).reshape(-1, 4) if through_walls else np.empty((0, 4)),
        max_reflectance=_max_reflectance(found).ravel(),
        transition=transition_table(),
        cis=np.column_stack([np.cos(turn), np.sin(turn)]),
        **_ends(transmitter.antenna, receive_antenna or HalfWaveDipole()),
    )


def tables_of_polarisations(
    transmitter: Transmitter,
    slabs: Sequence[Slab],
    *,
    receive_antenna: Antenna | None = None,
) -> tuple[FieldTables, ...]:
    """Tabulate antennas of known polarisations, whose received powers are to be added.

    One element, that of `field_tables`, unless the polarisation of an antenna is unknown: then one
    for each of its two components, or four if both are unknown.
    """
    transmit = polarisations(transmitter.antenna)
    receive = polarisations(receive_antenna or HalfWaveDipole())
    sender = replace(transmitter, antenna=transmit[0])
    first = field_tables(sender, slabs, receive_antenna=receive[0], through_walls=True)
    others = list(product(transmit, receive))[1:]
    return (first, *(first._replace(**_antennas(*both)) for both in others))


def pairs_of(unknown: Unknown | None) -> Ints:
    """Columns of `Sums.field` in the order of `tables_of_polarisations`."""
    if unknown is None:
        return np.zeros(1, np.int64)
    sent, received = (np.arange(2 if amplitude > 0.0 else 1) for amplitude in unknown)
    return (sent[:, None] + 2 * received).ravel()


def step_tables(
    transmitter: Transmitter, slabs: Sequence[Slab], *, receive_antenna: Antenna | None = None
) -> FieldTables:
    """Tabulate all that powers of known paths depend on, see `step_gains.add_powers`.

    The table of an antenna of unknown polarisation has one element, the amplitude of either
    component.
    """
    first, *_ = tables_of_polarisations(transmitter, slabs, receive_antenna=receive_antenna)
    ends = {"transmit": transmitter.antenna, "receive": receive_antenna or HalfWaveDipole()}
    components = {end: polarisations(antenna) for end, antenna in ends.items()}
    one = {
        end: np.asarray(parts[0].amplitudes(np.zeros(1), np.zeros(1)).v, dtype=np.float64)
        for end, parts in components.items()
        if len(parts) > 1
    }
    return first._replace(**one)


def _ends(transmit: Antenna, receive: Antenna) -> dict[str, Any]:
    """Tables of both antennas, and the amplitudes of those of unknown polarisation.

    The squared elements of a path's matrix add up to its largest squared gain at most once if one
    polarisation is unknown, and twice if both are; the peak gain accounts for that.
    """
    components = [polarisations(antenna) for antenna in (transmit, receive)]
    tables = _antennas(components[0][0], components[1][0])
    if all(len(parts) == 1 for parts in components):
        return tables
    amplitudes = [
        float(parts[0].amplitudes(np.zeros(1), np.zeros(1)).v[0]) if len(parts) > 1 else 0.0
        for parts in components
    ]
    once = 2.0 if all(amplitudes) else 1.0
    return {
        **tables,
        "unknown": (amplitudes[0], amplitudes[1]),
        "peak_gain": once * tables["peak_gain"],
    }


def _antennas(transmit: Antenna, receive: Antenna) -> dict[str, Any]:
    """Tables of both antennas: over the elevation alone where that is all they depend on."""
    if is_vertical(transmit) and is_vertical(receive):
        tables = elevation_table(transmit), elevation_table(receive)
        return {
            "transmit": tables[0],
            "receive": tables[1],
            "patterns": (np.empty((0, 4)), np.empty((0, 4))),
            "azimuths": 1,
            "peak_gain": float(np.prod([np.max(t**2) for t in tables])),
        }
    found = [np.stack(pattern_tables(a), axis=-1) for a in (transmit, receive)]
    return {
        "transmit": np.zeros(2),
        "receive": np.zeros(2),
        "patterns": tuple(np.ascontiguousarray(p).view(np.float64).reshape(-1, 4) for p in found),
        "azimuths": found[0].shape[1],
        "peak_gain": float(np.prod([(np.abs(p) ** 2).sum(axis=-1).max() for p in found])),
    }


def elevation_table(antenna: Antenna) -> Floats:
    """Tabulate an antenna's amplitude over the z component of the direction, -1 to 1."""
    amplitude = vertical_amplitude(antenna, np.linspace(-1.0, 1.0, ANTENNA_STEPS + 1))
    return np.append(amplitude, amplitude[-1])


def pattern_tables(antenna: Antenna) -> tuple[Complexes, Complexes]:
    """Tabulate an antenna's amplitudes for look-up by bilinear interpolation.

    The grid is regular in two quotients instead of two angles, which cost no trigonometry and have
    nodes at the zenith, the horizon and the axes: sigma / (|sigma| + c), and quarter by quarter
    |y| / (|x| + |y|) or |x| / (|x| + |y|).
    The error for a half-wave dipole of any axis is below 1e-4 of its peak amplitude.

    Returns
    -------
    v, h : ndarray
        (ELEVATION_STEPS + 1, AZIMUTH_STEPS + 1) complex: first index elevation from nadir to
        zenith, second azimuth from +x once around, the last column repeating the first.
    """
    rise = np.linspace(-1.0, 1.0, ELEVATION_STEPS + 1)
    elevation = np.arctan2(rise, 1.0 - np.abs(rise))
    turn = np.linspace(0.0, 4.0, AZIMUTH_STEPS + 1)
    quarter = np.minimum(np.floor(turn), 3.0)
    azimuth = quarter * (0.5 * np.pi) + np.arctan2(turn - quarter, quarter + 1.0 - turn)
    found = antenna.amplitudes(*np.meshgrid(np.sin(elevation), azimuth, indexing="ij"))
    v, h = (np.asarray(part, dtype=np.complex128) for part in found)
    return v, h


def slab_tables(slabs: Sequence[tuple[Material | str, float]], frequency_hz: float) -> Floats:
    """Tabulate the reflection of each slab over the cosine of incidence, for the kernels.

    Parameters
    ----------
    slabs
        (material or built-in name, thickness [m]) of each.
    frequency_hz
        Frequency [Hz].

    Returns
    -------
    ndarray
        (n_slabs, SLAB_TABLE_STEPS + 2, 4): real and imaginary parts of R_tm and of
        (R_te + R_tm) / sin^2 theta, at cosines 0, 1/n, ..., 1 and once more. The second is
        what couples the polarisations (docs/theory.md, eq. 12); it is smooth at normal incidence.

    Raises
    ------
    SceneError
        Where a material is not known at that frequency.
    """
    return _reflection(_at_all_angles(slabs, frequency_hz))


def transmission_tables(
    slabs: Sequence[tuple[Material | str, float]], frequency_hz: float
) -> Floats:
    """Tabulate the transmission of each slab like its reflection in `slab_tables`.

    Returns
    -------
    ndarray
        (n_slabs, SLAB_TABLE_STEPS + 2, 4): real and imaginary parts of T_tm and of
        (T_te - T_tm) / sin^2 theta, at the cosines of `slab_tables`; docs/theory.md, eqs. 28-30.
        T is relative to free space across the same thickness, so that a slab of vacuum has
        T = 1: a ray goes straight on through the sheet, and its length holds the phase.
    """
    return _transmission(_at_all_angles(slabs, frequency_hz))


def both_tables(slabs: Sequence[Slab], frequency_hz: float) -> tuple[Floats, Floats]:
    """Return `slab_tables` and `transmission_tables`, with the coefficients computed once."""
    found = _at_all_angles(slabs, frequency_hz)
    return _reflection(found), _transmission(found)


def _reflection(found: Sequence[SlabCoefficients]) -> Floats:
    return np.stack([_table(c.r_tm, c.r_te + c.r_tm) for c in found])


def _transmission(found: Sequence[SlabCoefficients]) -> Floats:
    return np.stack([_table(c.t_tm, c.t_te - c.t_tm) for c in found])


def _at_all_angles(
    slabs: Sequence[tuple[Material | str, float]], frequency_hz: float
) -> list[SlabCoefficients]:
    """Coefficients at the cosines of the tables, transmission relative to air."""
    cos_i = np.linspace(0.0, 1.0, SLAB_TABLE_STEPS + 1)
    found: list[SlabCoefficients] = []
    for material, thickness_m in slabs:
        slab = Slab.of(material, thickness_m)
        c = slab.material.coefficients(thickness_m, frequency_hz, cos_i)
        found.append(c.relative_to_air(thickness_m, frequency_hz, cos_i))
    return found


def _table(tm: Complexes, difference: Complexes) -> Floats:
    """Columns (steps + 2, 4) of a coefficient and of a difference over sin^2 theta."""
    sin2 = 1.0 - np.linspace(0.0, 1.0, len(tm)) ** 2
    mix = np.empty_like(tm)
    mix[:-1] = difference[:-1] / sin2[:-1]
    mix[-1] = 2.0 * mix[-2] - mix[-3]
    columns = np.column_stack([tm.real, tm.imag, mix.real, mix.imag])
    return np.concatenate([columns, columns[-1:]])


def _max_reflectance(found: Sequence[SlabCoefficients]) -> Floats:
    """Tabulate max(|R_te|^2, |R_tm|^2) over a cosine of incidence and all above (n, steps + 2)."""
    rows: list[Floats] = []
    for c in found:
        reflectance = np.maximum(np.abs(c.r_te), np.abs(c.r_tm)) ** 2
        rows.append(np.maximum.accumulate(np.append(reflectance, reflectance[-1])[::-1])[::-1])
    return np.array(rows)


@cache
def transition_table() -> Floats:
    """Tabulate F(s^2) / s over s (TRANSITION_STEPS + 2, 2), F of Kouyoumjian-Pathak eq. 27.

    F(X) = 2 j sqrt(X) e^(jX) * integral of e^(-j t^2) from sqrt(X) to infinity. Divided by
    sqrt(X) it is smooth at 0, where the cotangent it is multiplied with is singular.
    """
    s = np.arange(TRANSITION_STEPS + 2) * (TRANSITION_MAX / TRANSITION_STEPS)
    sine, cosine = fresnel(s * np.sqrt(2.0 / np.pi))
    tail = np.sqrt(np.pi / 2.0) * ((0.5 - cosine) - 1j * (0.5 - sine))
    ratio = 2j * np.exp(1j * s**2) * tail
    return np.column_stack([ratio.real, ratio.imag])
