"""Lookup tables of the field kernels."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from scipy.special import fresnel

from raytrace.arrays import Floats
from raytrace.kernels.field_tables import FieldTables
from raytrace.kernels.utd import TRANSITION_MAX, TRANSITION_STEPS
from raytrace.radio.antennas import (
    Antenna,
    HalfWaveDipole,
    antenna_tables,
    is_vertical,
    vertical_amplitude,
)
from raytrace.radio.materials import SLAB_TABLE_STEPS, Slab, slab_tables, transmission_tables
from raytrace.radio.transmitter import Transmitter

CIS_STEPS = 256
ANTENNA_STEPS = 8192


def field_tables(
    transmitter: Transmitter,
    slabs: Sequence[Slab],
    *,
    receive_antenna: Antenna | None = None,
    through_walls: bool = False,
) -> FieldTables:
    """Tabulate materials, antennas and special functions at the transmitter's frequency."""
    turn = np.arange(CIS_STEPS + 1) * (2.0 * np.pi / CIS_STEPS)
    return FieldTables(
        wavelength=transmitter.wavelength_m,
        slab_rows=SLAB_TABLE_STEPS + 2,
        reflection=slab_tables(slabs, transmitter.frequency_hz).reshape(-1, 4),
        transmission=transmission_tables(slabs, transmitter.frequency_hz).reshape(-1, 4)
        if through_walls
        else np.empty((0, 4)),
        max_reflectance=max_reflectance(slabs, transmitter.frequency_hz).ravel(),
        transition=transition_table(),
        cis=np.column_stack([np.cos(turn), np.sin(turn)]),
        **_antennas(transmitter.antenna, receive_antenna or HalfWaveDipole()),
    )


def _antennas(transmit: Antenna, receive: Antenna) -> dict[str, Any]:
    """Tables of both antennas: over the elevation alone where that is all they depend on."""
    if is_vertical(transmit) and is_vertical(receive):
        tables = antenna_table(transmit), antenna_table(receive)
        return {
            "transmit": tables[0],
            "receive": tables[1],
            "patterns": (np.empty((0, 4)), np.empty((0, 4))),
            "azimuths": 1,
            "peak_gain": float(np.prod([np.max(t**2) for t in tables])),
        }
    found = [np.stack(antenna_tables(a), axis=-1) for a in (transmit, receive)]
    return {
        "transmit": np.zeros(2),
        "receive": np.zeros(2),
        "patterns": tuple(np.ascontiguousarray(p).view(np.float64).reshape(-1, 4) for p in found),
        "azimuths": found[0].shape[1],
        "peak_gain": float(np.prod([(np.abs(p) ** 2).sum(axis=-1).max() for p in found])),
    }


def antenna_table(antenna: Antenna) -> Floats:
    """Tabulate an antenna's amplitude over the z component of the direction, -1 to 1."""
    amplitude = vertical_amplitude(antenna, np.linspace(-1.0, 1.0, ANTENNA_STEPS + 1))
    return np.append(amplitude, amplitude[-1])


def max_reflectance(slabs: Sequence[Slab], frequency_hz: float) -> Floats:
    """Tabulate max(|R_te|^2, |R_tm|^2) over a cosine of incidence and all above (n, steps + 2)."""
    cos_i = np.append(np.linspace(0.0, 1.0, SLAB_TABLE_STEPS + 1), 1.0)
    rows: list[Floats] = []
    for slab in slabs:
        c = slab.material.coefficients(slab.thickness_m, frequency_hz, cos_i)
        share = np.maximum(np.abs(c.r_te), np.abs(c.r_tm)) ** 2
        rows.append(np.maximum.accumulate(share[::-1])[::-1])
    return np.array(rows)


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
