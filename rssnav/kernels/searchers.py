"""Flights that follow a rule without learning: the random walk and the ascent of the RSS.

A flight is logged every second: a step to another cell, or one more reading in the same cell.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rssnav.kernels.compiling import jit
from rssnav.kernels.stepping import Moves, Receiver, read
from rssnav.kernels.xoshiro import draw, index_from_low_bits


class FlightLog(NamedTuple):
    """A flight in progress."""

    states: NDArray[np.int32]  # (max_steps + 1,) the start first
    seconds: NDArray[np.int64]  # (1,) seconds flown
    generator: NDArray[np.uint64]  # (4,)
    fluctuation_db: NDArray[np.float64]  # (1,) of the latest reading


@jit(inline=True)
def reading_of(receiver: Receiver, flight: FlightLog, state: int) -> float:
    """Reading in a state [dBm]."""
    return read(receiver, flight.fluctuation_db, flight.generator, state)


@jit(inline=True)
def is_over(flight: FlightLog) -> bool:
    """Whether the time is up."""
    return flight.seconds[0] + 1 == flight.states.size


@jit(inline=True)
def spend_second(flight: FlightLog, state: int) -> None:
    """Log the state after another second."""
    flight.seconds[0] += 1
    flight.states[flight.seconds[0]] = state


@jit()
def random_step(moves: Moves, flight: FlightLog, state: int) -> int:
    """Fly one of the possible steps, each with the same probability."""
    pick = index_from_low_bits(draw(flight.generator), np.uint64(moves.n_possible[state]))
    arrived = int(moves.next_state[8 * state + moves.possible[8 * state + int(pick)]])
    spend_second(flight, arrived)
    return arrived


@jit()
def walk(moves: Moves, receiver: Receiver, flight: FlightLog, steps: int) -> bool:
    """Fly random steps on; returns whether a reading found the transmitter."""
    state = int(flight.states[flight.seconds[0]])
    for _ in range(steps):
        if is_over(flight):
            return False
        state = random_step(moves, flight, state)
        if reading_of(receiver, flight, state) > receiver.found_dbm:
            return True
    return False


@jit()
def _mean_reading(receiver: Receiver, flight: FlightLog, readings: int) -> float:
    """Mean of readings where the flight is, one a second, the first of them on arrival [dBm]."""
    state = int(flight.states[flight.seconds[0]])
    total, taken = reading_of(receiver, flight, state), 1
    while taken < readings and not is_over(flight):
        spend_second(flight, state)
        total += reading_of(receiver, flight, state)
        taken += 1
    return total / taken


@jit()
def _shuffle(
    moves: Moves, flight: FlightLog, state: int, heading: int, order: NDArray[np.int64]
) -> int:
    """Fill ``order`` with the possible actions, the heading first; returns how many there are."""
    count = int(moves.n_possible[state])
    for k in range(count):
        other = int(index_from_low_bits(draw(flight.generator), np.uint64(k + 1)))
        order[k] = order[other]
        order[other] = moves.possible[8 * state + k]
    for k in range(1, count):
        if order[k] == heading:
            order[0], order[k] = order[k], order[0]
    return count


@jit()
def _climb(
    moves: Moves,
    receiver: Receiver,
    flight: FlightLog,
    readings: int,
    level_dbm: float,
    heading: int,
    order: NDArray[np.int64],
) -> tuple[float, int]:
    """Try neighbours until one reads more than here, flying back from those that do not.

    Returns the level there and the action that led there, or the level here and -1.
    """
    state = int(flight.states[flight.seconds[0]])
    for k in range(_shuffle(moves, flight, state, heading, order)):
        if is_over(flight):
            break
        spend_second(flight, int(moves.next_state[8 * state + order[k]]))
        there_dbm = _mean_reading(receiver, flight, readings)
        if there_dbm > level_dbm:
            return there_dbm, int(order[k])
        if is_over(flight):
            break
        spend_second(flight, state)
    return level_dbm, -1


@jit(allocates=True)
def ascend(
    moves: Moves, receiver: Receiver, flight: FlightLog, readings: int, escape_steps: int
) -> bool:
    """Climb the mean reading to the goal; from a local maximum escape at random, or give up.

    Returns whether the readings say that the transmitter is found.
    """
    order = np.empty(8, dtype=np.int64)
    level_dbm, heading = _mean_reading(receiver, flight, readings), 0
    while level_dbm <= receiver.found_dbm and not is_over(flight):
        level_dbm, heading = _climb(moves, receiver, flight, readings, level_dbm, heading, order)
        if heading >= 0:
            continue
        if escape_steps == 0:
            return False
        if walk(moves, receiver, flight, escape_steps):
            return True
        level_dbm = _mean_reading(receiver, flight, readings)
    return level_dbm > receiver.found_dbm
