"""Q-learning with discrete states made from RSS readings.

A row of Q belongs to a discrete state, not to a cell: several cells can share one, and a cell can
have several when readings fluctuate. A reading that is not above the sensitivity is "no signal": it
equals the sensitivity, and has a discrete state of its own. The possible actions are always those
of the cell. With one discrete state per cell and readings without fluctuation this loop equals
:mod:`rssnav.kernels.q_learning` bit for bit, but is slower.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rssnav.kernels.common import (
    EPISODE,
    HASH_START,
    N_DISCRETE_STATES,
    Moves,
    Parameters,
    Run,
    close_episode,
    decayed,
    extended_hash,
)
from rssnav.kernels.compiling import jit
from rssnav.kernels.rss_fluctuation import fluctuating
from rssnav.kernels.xoshiro import draw, index_from_low_bits, unit_from_high_bits

BY_CELL, TOLERANCE, INTERVALS = range(3)
"""How a reading becomes a discrete state: by a table of cells, tolerance states, intervals."""

_NEIGHBOUR_BINS = 3  # a threshold is two bins wide; one more for rounding


class Sensor(NamedTuple):
    """What the RSS agent reads, its discrete states and its goal."""

    rss_dbm: NDArray[np.float64]  # (S,) without fluctuation
    kind: int  # BY_CELL, TOLERANCE or INTERVALS
    state_of_cell: NDArray[np.int32]  # (S,) discrete state of each cell, for BY_CELL
    edges_dbm: NDArray[np.float64]  # ascending edges of the intervals, for INTERVALS
    threshold_db: float  # Th, for TOLERANCE
    low_dbm: float  # lower end of bin 0, for TOLERANCE
    sigma_db: float  # standard deviation of the fluctuation
    correlation: float  # of the fluctuation from one reading to the next
    sensitivity_dbm: float  # readings that are not above it are "no signal"
    terminal_dbm: float
    goal_reward: float
    goal_replaces: bool  # the goal reward replaces the RSS difference


class KnownStates(NamedTuple):
    """Tolerance states of one run.

    Known states lie at least Th apart, so a bin of width Th / 2 holds at most one of them, and
    those within Th of a reading are in its own bin or near it.
    """

    state_of_bin: NDArray[np.int32]  # (bins,) -1 where no state is known
    value_dbm: NDArray[np.float64]  # (rows,) reading that created the state
    fluctuation_db: NDArray[np.float64]  # (1,) of the latest reading
    no_signal: NDArray[np.int32]  # (1,) state of "no signal", -1 before the first such reading


@jit(inline=True)
def reading_in(
    sensor: Sensor, known: KnownStates, generator: NDArray[np.uint64], cell: int
) -> float:
    """RSS read in a cell [dBm]: a first-order autoregressive fluctuation on the map's value.

    At least the sensitivity, which means "no signal".
    """
    level_dbm = fluctuating(
        sensor.rss_dbm[cell], sensor.sigma_db, sensor.correlation, known.fluctuation_db, generator
    )
    return max(level_dbm, sensor.sensitivity_dbm)


@jit(inline=True)
def _bin(sensor: Sensor, known: KnownStates, reading: float) -> int:
    position = int((reading - sensor.low_dbm) * (2.0 / sensor.threshold_db))
    return min(max(position, 0), known.state_of_bin.size - 1)


@jit(inline=True)
def _nearest_known(sensor: Sensor, known: KnownStates, reading: float) -> int:
    """Nearest known state within Th of a reading, at equal distance the older; -1 if none."""
    centre = _bin(sensor, known, reading)
    nearest, least_db = -1, sensor.threshold_db
    last = min(centre + _NEIGHBOUR_BINS, known.state_of_bin.size - 1)
    for b in range(max(centre - _NEIGHBOUR_BINS, 0), last + 1):
        state = known.state_of_bin[b]
        if state < 0:
            continue
        gap_db = abs(reading - known.value_dbm[state])
        if gap_db < least_db or (gap_db == least_db and nearest >= 0 and state < nearest):
            nearest, least_db = state, gap_db
    return nearest


@jit(inline=True)
def discrete_state_of(
    sensor: Sensor, known: KnownStates, counters: NDArray[np.int64], cell: int, reading: float
) -> int:
    """Discrete state of a reading; "no signal" and tolerance states are created when needed."""
    if sensor.kind == BY_CELL:
        return int(sensor.state_of_cell[cell])
    if reading <= sensor.sensitivity_dbm:
        if known.no_signal[0] < 0:
            known.no_signal[0] = counters[N_DISCRETE_STATES]
            counters[N_DISCRETE_STATES] += 1
        return int(known.no_signal[0])
    if sensor.kind == INTERVALS:
        return int(np.searchsorted(sensor.edges_dbm, reading, side="right"))
    state = _nearest_known(sensor, known, reading)
    if state < 0:
        state = counters[N_DISCRETE_STATES]
        known.value_dbm[state] = reading
        known.state_of_bin[_bin(sensor, known, reading)] = state
        counters[N_DISCRETE_STATES] += 1
    return state


@jit(inline=True)
def _best(
    moves: Moves, all_actions: bool, q: NDArray[np.float64], state: int, cell: int
) -> tuple[float, int]:
    """Maximum of a row over the actions that count in a cell, and how many attain it."""
    best, ties = -np.inf, 0
    for a in range(8):
        if all_actions or moves.next_state[8 * cell + a] >= 0:
            value = q[8 * state + a]
            ties = ties + 1 if value == best else 1 if value > best else ties
            best = max(best, value)
    return best, ties


@jit(inline=True)
def _greedy(moves: Moves, parameters: Parameters, run: Run, state: int, cell: int) -> int:
    """Greedy action in a cell; it may be blocked when the maximum runs over all actions."""
    q = run.q
    best, ties = _best(moves, parameters.all_actions, q, state, cell)
    skip = np.uint64(0)
    if parameters.random_ties:
        skip = index_from_low_bits(draw(run.tie_generator), np.uint64(ties))
    for a in range(8):
        counts = parameters.all_actions or moves.next_state[8 * cell + a] >= 0
        if counts and q[8 * state + a] == best:
            if skip == 0:
                return a
            skip -= np.uint64(1)
    return 0


@jit()
def _fly_episode(
    moves: Moves,
    sensor: Sensor,
    parameters: Parameters,
    run: Run,
    known: KnownStates,
    trace: NDArray[np.int32] | None,
) -> tuple[int, int, np.uint64, bool]:
    """Fly and learn from the start to the goal or to ``max_steps``.

    Returns (steps, diagonal steps, path hash, terminated).
    """
    q, generator, rates, counters = run.q, run.generator, run.rates, run.counters
    cell, steps, diagonal, terminated = moves.start, 0, 0, False
    path_hash = HASH_START
    reading = reading_in(sensor, known, generator, cell)
    state = discrete_state_of(sensor, known, counters, cell, reading)
    run.visits[cell] += 1
    while not terminated and steps < parameters.max_steps:
        rates[0] = decayed(rates[0], parameters.epsilon_min, parameters.step_decay)
        rates[1] = decayed(rates[1], parameters.alpha_min, parameters.step_decay)
        choice = _greedy(moves, parameters, run, state, cell)
        bits = draw(generator)
        if unit_from_high_bits(bits) < rates[0] or moves.next_state[8 * cell + choice] < 0:
            pick = index_from_low_bits(bits, np.uint64(moves.n_possible[cell]))
            choice = int(moves.possible[8 * cell + int(pick)])
        arrived = int(moves.next_state[8 * cell + choice])
        next_reading = reading_in(sensor, known, generator, arrived)
        terminated = next_reading > sensor.terminal_dbm
        reward = 0.0 if terminated and sensor.goal_replaces else next_reading - reading
        value = 0.0
        next_state = discrete_state_of(sensor, known, counters, arrived, next_reading)
        if terminated:
            reward += sensor.goal_reward
        else:
            value, _ = _best(moves, parameters.all_actions, q, next_state, arrived)
        entry = 8 * state + choice
        q[entry] = (1.0 - rates[1]) * q[entry] + rates[1] * (reward + parameters.gamma * value)
        path_hash = extended_hash(path_hash, np.uint64(choice))
        diagonal += choice & 1
        if trace is not None:
            trace[steps] = arrived
        steps += 1
        run.visits[arrived] += 1
        cell, state, reading = arrived, next_state, next_reading
    return steps, diagonal, path_hash, terminated


@jit()
def learn(
    moves: Moves,
    sensor: Sensor,
    parameters: Parameters,
    run: Run,
    known: KnownStates,
    until_episode: int,
    trace: NDArray[np.int32] | None = None,
) -> None:
    """Continue learning up to ``until_episode``, or to the episode in which the run converges.

    ``trace`` (max_steps,) receives the states that an episode arrives at; each episode overwrites
    the one before.
    """
    rates, converged = run.rates, False
    while run.counters[EPISODE] < until_episode and not converged:
        rates[0] = decayed(rates[0], parameters.epsilon_min, parameters.episode_decay)
        rates[1] = decayed(rates[1], parameters.alpha_min, parameters.episode_decay)
        steps, diagonal, path_hash, terminated = _fly_episode(
            moves, sensor, parameters, run, known, trace
        )
        converged = close_episode(
            run.counters, run.episodes, steps, diagonal, path_hash, terminated
        )


@jit()
def steady_discrete_states(sensor: Sensor, known: KnownStates, states: NDArray[np.int32]) -> None:
    """Discrete state of every cell's reading without fluctuation; -1 where none is known."""
    for cell in range(states.size):
        reading = sensor.rss_dbm[cell]
        if sensor.kind == BY_CELL:
            states[cell] = sensor.state_of_cell[cell]
        elif reading <= sensor.sensitivity_dbm:
            states[cell] = known.no_signal[0]
        elif sensor.kind == INTERVALS:
            states[cell] = np.searchsorted(sensor.edges_dbm, reading, side="right")
        else:
            states[cell] = _nearest_known(sensor, known, reading)
