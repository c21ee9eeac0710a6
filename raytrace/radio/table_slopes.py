"""Derivatives of the tables of slabs with respect to properties of their materials."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from raytrace.arrays import Floats, Ints
from raytrace.kernels.step_derivatives import TableSlopes
from raytrace.radio.materials import Slab
from raytrace.radio.tables import both_tables

STEP = 1e-7
"""Step of the differences, whose error is of the first order in it: rounding costs as much."""

SlabsAt = Callable[[Floats], Sequence[Slab]]
"""The slabs that given values of the properties make."""


def table_slopes(
    slabs_at: SlabsAt, values: Floats, frequency_hz: float, tables: tuple[Floats, Floats]
) -> tuple[TableSlopes, Ints]:
    """Differentiate the tables of slabs.

    Parameters
    ----------
    slabs_at
        The slabs for values of some properties, whose natural steps are of order 1, such as
        logarithms.
    values
        (n_values,) where to differentiate.
    frequency_hz
        Frequency [Hz].
    tables
        Reflection and transmission there, as `both_tables` makes them of the slabs.

    Returns
    -------
    slopes
        Tables for each slab and slot.
    value_of
        (n_slabs, n_slots) which value each slot belongs to; -1 for slots that a slab does not use.
    """
    slabs = slabs_at(values)
    moved = [slabs_at(_moved(values, k)) for k in range(len(values))]
    users = [[s for s, slab in enumerate(slabs) if other[s] != slab] for other in moved]
    slots = [[k for k, of_value in enumerate(users) if s in of_value] for s in range(len(slabs))]
    n_slots = max(1, *map(len, slots))
    value_of = np.full((len(slabs), n_slots), -1, dtype=np.int64)
    for s, of_slab in enumerate(slots):
        value_of[s, : len(of_slab)] = of_slab
    slopes = np.zeros((2, n_slots, *tables[0].shape))
    for k, of_value in enumerate(users):
        if not of_value:
            continue
        changed = both_tables([moved[k][s] for s in of_value], frequency_hz)
        for kind in (0, 1):
            for s, table in zip(of_value, changed[kind], strict=True):
                slopes[kind, slots[s].index(k), s] = (table - tables[kind][s]) / STEP
    reflection, transmission = slopes.reshape(2, n_slots, -1, 4)
    return TableSlopes(reflection, transmission), value_of


def _moved(values: Floats, k: int) -> Floats:
    moved = values.copy()
    moved[k] += STEP
    return moved
