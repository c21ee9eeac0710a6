"""Q-learning with states made from RSS readings as they come.

A row of Q belongs to a state label, not to a cell: several cells can share one, and a cell can
have several when readings fluctuate. The possible actions are always those of the cell. With one
label per cell and steady readings this loop does exactly what :mod:`rssnav.kernels.tabular` does,
bit for bit, only slower.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rssnav.kernels.common import (
    EPISODE,
    HASH_START,
    N_LABELS,
    Moves,
    Parameters,
    Run,
    close_episode,
    decayed,
    extended_hash,
)
from rssnav.kernels.compiling import jit
from rssnav.kernels.readings import fluctuating
from rssnav.kernels.xoshiro import draw, index_from_low_bits, unit_from_high_bits

LISTED, TOLERANCE, INTERVALS = range(3)
"""How a reading becomes a label: by its cell's listed label, tolerance states, fixed bins."""

_NEIGHBOUR_BINS = 3  # a threshold is two bins wide; one more for rounding


class Sensor(NamedTuple):
    """What the RSS agent reads and how it names it."""

    rss_dbm: NDArray[np.float64]  # (S,) without fluctuation
    kind: int  # LISTED, TOLERANCE or INTERVALS
    listed: NDArray[np.int32]  # (S,) label of each cell, for LISTED
    edges_dbm: NDArray[np.float64]  # ascending bin edges, for INTERVALS
    threshold_db: float  # Th, for TOLERANCE
    low_dbm: float  # lower end of bin 0, for TOLERANCE
    sigma_db: float  # standard deviation of the fluctuation
    correlation: float  # of the fluctuation from one reading to the next
    terminal_dbm: float
    goal_reward: float
    goal_replaces: bool  # the goal reward stands instead of the RSS difference


class Book(NamedTuple):
    """Tolerance states of one run.

    Known states lie at least Th apart, so a bin of width Th / 2 holds at most one of them, and
    those that can fit a reading are in the bins beside its own.
    """

    label_of_bin: NDArray[np.int32]  # (bins,) -1 where no state is known
    value_dbm: NDArray[np.float64]  # (rows,) reading that created the state
    fluctuation_db: NDArray[np.float64]  # (1,) of the latest reading


@jit(inline="always")
def reading_in(sensor: Sensor, book: Book, generator: NDArray[np.uint64], cell: int) -> float:
    """RSS read in a cell [dBm]: a first-order autoregressive fluctuation on the map's value."""
    return fluctuating(
        sensor.rss_dbm[cell], sensor.sigma_db, sensor.correlation, book.fluctuation_db, generator
    )


@jit(inline="always")
def _bin(sensor: Sensor, book: Book, reading: float) -> int:
    position = int((reading - sensor.low_dbm) * (2.0 / sensor.threshold_db))
    return min(max(position, 0), book.label_of_bin.size - 1)


@jit(inline="always")
def _known_state(sensor: Sensor, book: Book, reading: float) -> int:
    """Nearest known state within Th of a reading, the older of two as near; -1 if there is none."""
    centre = _bin(sensor, book, reading)
    label, nearest = -1, sensor.threshold_db
    last = min(centre + _NEIGHBOUR_BINS, book.label_of_bin.size - 1)
    for b in range(max(centre - _NEIGHBOUR_BINS, 0), last + 1):
        known = book.label_of_bin[b]
        if known < 0:
            continue
        gap = abs(reading - book.value_dbm[known])
        if gap < nearest or (gap == nearest and label >= 0 and known < label):
            label, nearest = known, gap
    return label


@jit(inline="always")
def label_of(
    sensor: Sensor, book: Book, counters: NDArray[np.int64], cell: int, reading: float
) -> int:
    """Label of a reading; a tolerance state is created when none fits."""
    if sensor.kind == LISTED:
        return int(sensor.listed[cell])
    if sensor.kind == INTERVALS:
        return int(np.searchsorted(sensor.edges_dbm, reading, side="right"))
    label = _known_state(sensor, book, reading)
    if label < 0:
        label = counters[N_LABELS]
        book.value_dbm[label] = reading
        book.label_of_bin[_bin(sensor, book, reading)] = label
        counters[N_LABELS] += 1
    return label


@jit(inline="always")
def _best(
    moves: Moves, all_actions: bool, q: NDArray[np.float64], label: int, cell: int
) -> tuple[float, int]:
    """Maximum of a row over the actions that count in a cell, and how many attain it."""
    best, ties = -np.inf, 0
    for a in range(8):
        if all_actions or moves.next_state[8 * cell + a] >= 0:
            value = q[8 * label + a]
            ties = ties + 1 if value == best else 1 if value > best else ties
            best = max(best, value)
    return best, ties


@jit(inline="always")
def _greedy(moves: Moves, parameters: Parameters, run: Run, label: int, cell: int) -> int:
    """Greedy action in a cell; it may be blocked when the maximum runs over all actions."""
    q = run.q
    best, ties = _best(moves, parameters.all_actions, q, label, cell)
    skip = np.uint64(0)
    if parameters.random_ties:
        skip = index_from_low_bits(draw(run.tie_generator), np.uint64(ties))
    for a in range(8):
        counts = parameters.all_actions or moves.next_state[8 * cell + a] >= 0
        if counts and q[8 * label + a] == best:
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
    book: Book,
    trace: NDArray[np.int32] | None,
) -> tuple[int, int, np.uint64, bool]:
    """Fly and learn from the start to the goal or the cap.

    Returns (steps, diagonal steps, path hash, terminated).
    """
    q, generator, rates, counters = run.q, run.generator, run.rates, run.counters
    cell, steps, diagonal, terminated = moves.start, 0, 0, False
    path_hash = HASH_START
    reading = reading_in(sensor, book, generator, cell)
    label = label_of(sensor, book, counters, cell, reading)
    run.visits[cell] += 1
    while not terminated and steps < parameters.max_steps:
        rates[0] = decayed(rates[0], parameters.epsilon_min, parameters.step_decay)
        rates[1] = decayed(rates[1], parameters.alpha_min, parameters.step_decay)
        choice = _greedy(moves, parameters, run, label, cell)
        bits = draw(generator)
        if unit_from_high_bits(bits) < rates[0] or moves.next_state[8 * cell + choice] < 0:
            pick = index_from_low_bits(bits, np.uint64(moves.n_possible[cell]))
            choice = int(moves.possible[8 * cell + int(pick)])
        arrived = int(moves.next_state[8 * cell + choice])
        next_reading = reading_in(sensor, book, generator, arrived)
        terminated = next_reading > sensor.terminal_dbm
        reward = 0.0 if terminated and sensor.goal_replaces else next_reading - reading
        value = 0.0
        next_label = label_of(sensor, book, counters, arrived, next_reading)
        if terminated:
            reward += sensor.goal_reward
        else:
            value, _ = _best(moves, parameters.all_actions, q, next_label, arrived)
        entry = 8 * label + choice
        q[entry] = (1.0 - rates[1]) * q[entry] + rates[1] * (reward + parameters.gamma * value)
        path_hash = extended_hash(path_hash, np.uint64(choice))
        diagonal += choice & 1
        if trace is not None:
            trace[steps] = arrived
        steps += 1
        run.visits[arrived] += 1
        cell, label, reading = arrived, next_label, next_reading
    return steps, diagonal, path_hash, terminated


@jit()
def learn(
    moves: Moves,
    sensor: Sensor,
    parameters: Parameters,
    run: Run,
    book: Book,
    until_episode: int,
    trace: NDArray[np.int32] | None = None,
) -> None:
    """Go on learning to ``until_episode``, or to the episode in which the run converges.

    ``trace`` (max_steps,) takes the states an episode arrives at, each episode over the last.
    """
    rates, converged = run.rates, False
    while run.counters[EPISODE] < until_episode and not converged:
        rates[0] = decayed(rates[0], parameters.epsilon_min, parameters.episode_decay)
        rates[1] = decayed(rates[1], parameters.alpha_min, parameters.episode_decay)
        steps, diagonal, path_hash, terminated = _fly_episode(
            moves, sensor, parameters, run, book, trace
        )
        converged = close_episode(
            run.counters, run.episodes, steps, diagonal, path_hash, terminated
        )


@jit()
def steady_labels(sensor: Sensor, book: Book, labels: NDArray[np.int32]) -> None:
    """Label of every cell's reading without fluctuation; -1 where no known state fits."""
    for cell in range(labels.size):
        reading = sensor.rss_dbm[cell]
        if sensor.kind == LISTED:
            labels[cell] = sensor.listed[cell]
        elif sensor.kind == INTERVALS:
            labels[cell] = np.searchsorted(sensor.edges_dbm, reading, side="right")
        else:
            labels[cell] = _known_state(sensor, book, reading)
