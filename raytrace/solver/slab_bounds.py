"""Bounds on what slabs reflect, transmit and shadow, between cosines of incidence.

See `raytrace.kernels.losses` and docs/theory.md, section 16.
"""

import numpy as np

from raytrace.arrays import Complexes, Floats
from raytrace.kernels.field_tables import FieldTables
from raytrace.kernels.losses import COSINE_BINS

INTERPOLATION = 1.001
"""Bounds on slabs are enlarged by this factor: tables are interpolated between their rows."""


def reflection_of(tables: FieldTables) -> tuple[Complexes, Complexes]:
    """Tabulated R_te and R_tm (n_slabs, steps + 1) over the cosine of incidence."""
    return _coefficients(tables, tables.reflection, -1.0)


def transmission_of(tables: FieldTables) -> tuple[Complexes, Complexes]:
    """Tabulated T_te and T_tm (n_slabs, steps + 1), relative to air."""
    return _coefficients(tables, tables.transmission, 1.0)


def _coefficients(tables: FieldTables, table: Floats, sign: float) -> tuple[Complexes, Complexes]:
    """TE and TM; TE is (the difference of the table) sin^2 + sign TM."""
    columns = table.reshape(-1, tables.slab_rows, 4)[:, :-1]
    tm, mix = columns[..., 0] + 1j * columns[..., 1], columns[..., 2] + 1j * columns[..., 3]
    return mix * (1.0 - np.linspace(0.0, 1.0, columns.shape[1]) ** 2) + sign * tm, tm


def slab_bounds(tables: FieldTables, te: Complexes, tm: Complexes) -> Floats:
    """Largest squared magnitude of either coefficient between intervals of the cosine of incidence.

    Parameters
    ----------
    tables
        Their size.
    te, tm
        (n_slabs, steps + 1) coefficients at cosines from 0 to 1.

    Returns
    -------
    ndarray
        (n_slabs, COSINE_BINS, COSINE_BINS), see `losses.LossLimit`.
    """
    power = INTERPOLATION * np.maximum(np.abs(tm), np.abs(te)) ** 2
    each = (tables.slab_rows - 2) // COSINE_BINS
    steps = [power[:, k * each : (k + 1) * each + 1] for k in range(COSINE_BINS)]
    within = np.stack([step.max(axis=1) for step in steps], axis=1)
    found = np.zeros((len(within), COSINE_BINS, COSINE_BINS))
    for low in range(COSINE_BINS):
        found[:, low, low:] = np.maximum.accumulate(within[:, low:], axis=1)
    return found


def shadow_bounds(tables: FieldTables) -> Floats:
    """Bound |1 - T'|^2 of the shadows of sheets, see `losses.LossLimit`; 1 of opaque ones."""
    if not len(tables.transmission):
        n_slabs = len(tables.reflection) // tables.slab_rows
        return np.ones((n_slabs, COSINE_BINS, COSINE_BINS))
    te, tm = transmission_of(tables)
    return slab_bounds(tables, 1.0 - te, 1.0 - tm)
