"""Derivatives of the tables of slabs with respect to properties of their materials."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from raytrace.arrays import Floats, Ints
from raytrace.kernels.step_derivatives import TableSlopes
from raytrace.radio.materials import Slab
from raytrace.radio.tables import SLAB_TABLE_STEPS, both_tables

STEP = 1e-4
"""Step of the central differences; their error is of the second order in it."""

SlabsAt = Callable[[Floats], Sequence[Slab]]
"""The slabs that given values of the properties make."""


def table_slopes(
    slabs_at: SlabsAt, values: Floats, frequency_hz: float, *, through_walls: bool
) -> tuple[TableSlopes, Ints]:
    """Differentiate the tables of slabs, by central differences.

    Parameters
    ----------
    slabs_at
        The slabs for values of some properties, whose natural steps are of order 1, such as
        logarithms.
    values
        (n_values,) where to differentiate.
    frequency_hz
        Frequency [Hz].
    through_walls
        Whether transmission is used.

    Returns
    -------
    slopes
        Tables for each slab and slot.
    value_of
        (n_slabs, n_slots) which value each slot belongs to; -1 for slots that a slab does not use.
    """
    slabs = slabs_at(values)
    users = [_users(slabs_at, values, k, slabs) for k in range(len(values))]
    slots = [[k for k, of_value in enumerate(users) if s in of_value] for s in range(len(slabs))]
    n_slots = max(1, *map(len, slots))
    value_of = np.full((len(slabs), n_slots), -1, dtype=np.int64)
    shape = n_slots, len(slabs), SLAB_TABLE_STEPS + 2, 4
    reflection = np.zeros(shape)
    transmission = np.zeros(shape if through_walls else (n_slots, 0, shape[2], 4))
    for k, of_value in enumerate(users):
        for sign in (1.0, -1.0) if of_value else ():
            changed = slabs_at(_moved(values, k, sign))
            tables = both_tables([changed[s] for s in of_value], frequency_hz)
            for s, *of_slab in zip(of_value, *tables, strict=True):
                slot, scale = slots[s].index(k), sign / (2.0 * STEP)
                reflection[slot, s] += scale * of_slab[0]
                if through_walls:
                    transmission[slot, s] += scale * of_slab[1]
    for s, of_slab in enumerate(slots):
        value_of[s, : len(of_slab)] = of_slab
    return TableSlopes(
        reflection.reshape(n_slots, -1, 4), transmission.reshape(n_slots, -1, 4)
    ), value_of


def _moved(values: Floats, k: int, steps: float) -> Floats:
    moved = values.copy()
    moved[k] += steps * STEP
    return moved


def _users(slabs_at: SlabsAt, values: Floats, k: int, slabs: Sequence[Slab]) -> list[int]:
    """Numbers of the slabs that depend on value k."""
    changed = slabs_at(_moved(values, k, 1.0))
    return [s for s, slab in enumerate(slabs) if changed[s] != slab]
