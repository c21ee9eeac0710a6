"""Many flights at once, one second at a time: what environments and evaluations step."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rssnav.kernels.compiling import jit
from rssnav.kernels.reading_states import row_of
from rssnav.kernels.stepping import (
    CELL,
    HOVER,
    RUNNING,
    Flight,
    Moves,
    Sensor,
    begin,
    first_entry,
    fly,
)


class Fleet(NamedTuple):
    """Flights in progress (N of them)."""

    whole: NDArray[np.int64]  # (N, 5) see `stepping.Flight`
    real: NDArray[np.float64]  # (N, 3)
    generator: NDArray[np.uint64]  # (N, 4)
    reward: NDArray[np.float64]  # (N,) of the latest second
    status: NDArray[np.int64]  # (N,) RUNNING, FOUND or TRUNCATED

    @classmethod
    def of_size(cls, n: int) -> Fleet:
        """Return N flights that have not begun."""
        return cls(
            whole=np.zeros((n, 5), dtype=np.int64),
            real=np.zeros((n, 3)),
            generator=np.ones((n, 4), dtype=np.uint64),
            reward=np.zeros(n),
            status=np.zeros(n, dtype=np.int64),
        )


@jit(fused=True)
def begin_flight(moves: Moves, sensor: Sensor, fleet: Fleet, i: int) -> None:
    """Begin the next episode of a flight."""
    begin(moves, sensor, Flight(fleet.whole[i], fleet.real[i], fleet.generator[i]))
    fleet.reward[i], fleet.status[i] = 0.0, RUNNING


@jit(fused=True)
def step_flight(moves: Moves, sensor: Sensor, fleet: Fleet, i: int, action: int) -> None:
    """Fly one action; an impossible step leaves the UAV where it is, as hovering does."""
    flight = Flight(fleet.whole[i], fleet.real[i], fleet.generator[i])
    arrived = flight.whole[CELL]
    if action != HOVER:
        there = moves.next_state[first_entry(sensor, flight) + action]
        arrived, action = (there, action) if there >= 0 else (arrived, HOVER)
    fleet.reward[i], fleet.status[i] = fly(sensor, flight, action, arrived)


@jit()
def begin_all(moves: Moves, sensor: Sensor, fleet: Fleet) -> None:
    """Begin an episode of every flight."""
    for i in range(fleet.status.size):
        begin_flight(moves, sensor, fleet, i)


@jit()
def step_running(moves: Moves, sensor: Sensor, fleet: Fleet, actions: NDArray[np.int64]) -> None:
    """Fly an action of every flight that is not over."""
    for i in range(fleet.status.size):
        if fleet.status[i] == RUNNING:
            step_flight(moves, sensor, fleet, i, actions[i])


@jit()
def rows_of(sensor: Sensor, fleet: Fleet, rows: NDArray[np.int64]) -> None:
    """Row of Q of what each flight's agent observes."""
    for i in range(rows.size):
        rows[i] = row_of(sensor, Flight(fleet.whole[i], fleet.real[i], fleet.generator[i]))


@jit()
def masks_of(moves: Moves, sensor: Sensor, fleet: Fleet, masks: NDArray[np.int8]) -> None:
    """Possible actions of each flight (N, 8)."""
    for i in range(masks.shape[0]):
        flight = Flight(fleet.whole[i], fleet.real[i], fleet.generator[i])
        entry = first_entry(sensor, flight)
        for a in range(8):
            masks[i, a] = moves.next_state[entry + a] >= 0
