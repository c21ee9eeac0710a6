"""How a reading, and what else an agent observes, becomes a row of Q.

A row belongs to a discrete state, not to a cell: several cells can share one, and a cell can have
several when readings fluctuate. A reading that is not above the sensitivity is "no signal": it
equals the sensitivity, and has a discrete state of its own.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rssnav.kernels.compiling import jit
from rssnav.kernels.stepping import (
    CELL,
    HEADING,
    MEMORY,
    MODE,
    READING_DBM,
    Flight,
    Rows,
    Sensor,
)

BY_CELL, TOLERANCE, INTERVALS = range(3)
"""How a reading becomes a discrete state: by a table of cells, tolerance states, intervals."""

_NEIGHBOUR_BINS = 3  # a threshold is two bins wide; one more for rounding


@jit(fused=True)
def _bin(rows: Rows, reading: float) -> int:
    position = int((reading - rows.low_dbm) * (2.0 / rows.threshold_db))
    return min(max(position, 0), rows.state_of_bin.size - 1)


@jit(fused=True)
def _nearest_known(rows: Rows, reading: float) -> int:
    """Nearest known state within Th of a reading, at equal distance the older; -1 if none."""
    centre = _bin(rows, reading)
    nearest, least_db = -1, rows.threshold_db
    last = min(centre + _NEIGHBOUR_BINS, rows.state_of_bin.size - 1)
    for b in range(max(centre - _NEIGHBOUR_BINS, 0), last + 1):
        state = rows.state_of_bin[b]
        if state < 0:
            continue
        gap_db = abs(reading - rows.value_dbm[state])
        if gap_db < least_db or (gap_db == least_db and nearest >= 0 and state < nearest):
            nearest, least_db = state, gap_db
    return nearest


@jit(fused=True)
def _next_number(rows: Rows) -> int:
    rows.n_known[0] += 1
    return int(rows.n_known[0] - 1)


@jit(fused=True)
def discrete_state_of(sensor: Sensor, place: int, reading: float) -> int:
    """Discrete state of a reading; "no signal" and tolerance states are created when needed."""
    rows = sensor.rows
    if rows.kind == BY_CELL:
        return int(rows.state_of_cell[place])
    if reading <= sensor.receiver.sensitivity_dbm:
        if rows.no_signal[0] < 0:
            rows.no_signal[0] = _next_number(rows)
        return int(rows.no_signal[0])
    if rows.kind == INTERVALS:
        return int(np.searchsorted(rows.edges_dbm, reading, side="right"))
    state = _nearest_known(rows, reading)
    if state < 0:
        state = _next_number(rows)
        rows.value_dbm[state] = reading
        rows.state_of_bin[_bin(rows, reading)] = state
    return state


@jit(fused=True)
def row_of(sensor: Sensor, flight: Flight) -> int:
    """Row of Q of what the agent of a flight observes."""
    rows, whole = sensor.rows, flight.whole
    place = whole[MODE] * sensor.n_cells + whole[CELL]
    row = whole[MEMORY]
    if rows.heading:
        row = 9 * row + whole[HEADING]
    row = row * rows.n_readings
    row += discrete_state_of(sensor, int(place), flight.real[READING_DBM])
    return int(row * rows.n_cells + whole[CELL]) if rows.n_cells > 1 else int(row)


@jit()
def steady_discrete_states(sensor: Sensor, states: NDArray[np.int32]) -> None:
    """Discrete state of every cell's reading without fluctuation; -1 where none is known."""
    rows = sensor.rows
    for cell in range(states.size):
        reading = sensor.receiver.rss_dbm[cell]
        if rows.kind == BY_CELL:
            states[cell] = rows.state_of_cell[cell]
        elif reading <= sensor.receiver.sensitivity_dbm:
            states[cell] = rows.no_signal[0]
        elif rows.kind == INTERVALS:
            states[cell] = np.searchsorted(rows.edges_dbm, reading, side="right")
        else:
            states[cell] = _nearest_known(rows, reading)
