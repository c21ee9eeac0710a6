"""One second of a flight: the step that learners, environments and searchers share.

A mode is all that the UAV does not decide: where the transmitter is, and which doors are open. Each
has a radio field and a table of steps. Cells are numbered alike in all modes, so a table of modes
and cells is indexed by ``mode * n_cells + cell``. The mode is drawn when an episode begins, and may
change before every reading.

A process with tables of rewards and terminal states needs no :class:`Sensor`; with None in its
place numba compiles a loop without the code for readings.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rssnav.kernels.compiling import jit
from rssnav.kernels.xoshiro import draw, gaussian, unit_from_high_bits

N_ACTIONS = 8
NO_HEADING = 8
HOVER = 8
"""The action of staying in the cell for one more reading, where a task allows it."""


class Moves(NamedTuple):
    """Steps of a decision process: eight actions per state, row after row.

    The steps of several layouts follow one another: those of layout g begin at state ``g * S``.
    """

    next_state: NDArray[np.int32]  # (G * S * 8,) -1 where the step would crash
    possible: NDArray[np.uint8]  # (G * S * 8,) the possible actions first, in action order
    n_possible: NDArray[np.uint8]  # (G * S,)
    reward: NDArray[np.float64]  # (S * 8,) where no sensor decides
    terminal: NDArray[np.bool_]  # (S,) likewise
    starts: NDArray[np.int32]  # (n,) where an episode may begin
    start_cumulative: NDArray[np.float64]  # (n,) probability of these, summed up


class Modes(NamedTuple):
    """A Markov chain over M modes."""

    layout: NDArray[np.int64]  # (M,) table of steps of each mode
    initial_cumulative: NDArray[np.float64]  # (M,) probability at the start, summed up
    stays: NDArray[np.float64]  # (M,) probability to stay, per second
    next_cumulative: NDArray[np.float64]  # (M * M,) probability of the modes after a change
    change: bool  # whether modes change during an episode


class Receiver(NamedTuple):
    """What is read."""

    rss_dbm: NDArray[np.float64]  # (M * S,) without fluctuation
    sigma_db: float  # standard deviation of the fluctuation
    correlation: float  # of the fluctuation from one reading to the next
    found_dbm: float  # a reading above it means that the transmitter is found
    sensitivity_dbm: float  # readings that are not above it are "no signal"


class TaskTables(NamedTuple):
    """What a step is worth, and when the episode ends."""

    by_reading: bool  # it ends by a reading above `found_dbm`, otherwise in a cell of `goal`
    goal: NDArray[np.bool_]  # (M * S,) or empty
    confirmations: int  # readings that decide about `found_dbm`, one a second
    log_accept: float  # bounds of the sequential test that decides; 0 if the mean does
    log_reject: float
    difference: bool  # RSS_t - RSS_(t-1) is a reward [dB]
    arrival: NDArray[np.float64]  # (M * S,) reward of arriving in a cell, or empty
    per_second: float  # reward of every second
    per_joule: float  # reward of every joule
    goal_reward: float
    goal_replaces: bool  # it replaces the last step's reward
    energy_j: NDArray[np.float64]  # (9 * 8,) of flying an action after a heading; 8: no heading
    hover_j: float  # of a second in a cell
    budget_j: float  # energy after which the episode is truncated
    max_seconds: int  # after which it is truncated


class Doors(NamedTuple):
    """Doors whose last seen position is remembered."""

    n_doors: int
    sees: NDArray[np.int64]  # (S,) bits of the doors seen from a cell
    closed: NDArray[np.int64]  # (M,) bits of the doors that are closed


class Rows(NamedTuple):
    """How what the agent observes becomes a row of Q.

    A row is numbered by memory, heading, discrete state of the reading and cell, as far as the
    agent observes them. Tolerance states lie at least Th apart, so a bin of width Th / 2 holds at
    most one of them, and those within Th of a reading are in its own bin or near it.
    """

    kind: int  # BY_CELL, TOLERANCE or INTERVALS
    state_of_cell: NDArray[np.int32]  # (M * S,) discrete state in each mode, for BY_CELL
    edges_dbm: NDArray[np.float64]  # ascending edges of the intervals, for INTERVALS
    threshold_db: float  # Th, for TOLERANCE
    low_dbm: float  # lower end of bin 0, for TOLERANCE
    n_readings: int  # discrete states of readings, at most
    n_cells: int  # S if the agent knows its cell, else 1
    heading: bool  # whether the agent knows the direction it came from
    state_of_bin: NDArray[np.int32]  # (bins,) of one run; -1 where no state is known
    value_dbm: NDArray[np.float64]  # (n_readings,) of one run: reading that created the state
    no_signal: NDArray[np.int32]  # (1,) of one run: state of "no signal", -1 before the first
    n_known: NDArray[np.int64]  # (1,) of one run: discrete states of readings so far


class Sensor(NamedTuple):
    """What an agent that reads RSS reads, what that is worth, and what it makes of it."""

    n_cells: int  # S
    modes: Modes
    receiver: Receiver
    task: TaskTables
    doors: Doors
    rows: Rows


class Steady(NamedTuple):
    """A sensor of one mode whose readings never fluctuate: a lookup takes the place of drawing."""

    rss_dbm: NDArray[np.float64]  # (S,) as read
    found: NDArray[np.bool_]  # (S,)
    task: TaskTables


class Flight(NamedTuple):
    """A flight in progress."""

    whole: NDArray[np.int64]  # (5,) indexed by the names below
    real: NDArray[np.float64]  # (3,) likewise
    generator: NDArray[np.uint64]  # (4,)


MODE, CELL, HEADING, MEMORY, SECONDS = range(5)
READING_DBM, ENERGY_J, FLUCTUATION_DB = range(3)
RUNNING, FOUND, TRUNCATED = range(3)


@jit(fused=True)
def fluctuating(
    mean_dbm: float,
    sigma_db: float,
    correlation: float,
    fluctuation_db: NDArray[np.float64],
    generator: NDArray[np.uint64],
) -> float:
    """Reading [dBm] with a first-order autoregressive fluctuation (1,), which is updated."""
    if sigma_db == 0.0:
        return mean_dbm
    innovation = sigma_db * gaussian(draw(generator), draw(generator))
    kept = correlation * fluctuation_db[0]
    fluctuation_db[0] = kept + math.sqrt(1.0 - correlation * correlation) * innovation
    return mean_dbm + fluctuation_db[0]


@jit(fused=True)
def read(
    receiver: Receiver,
    fluctuation_db: NDArray[np.float64],
    generator: NDArray[np.uint64],
    place: int,
) -> float:
    """Reading in a place (mode and cell) [dBm]; the sensitivity where there is no signal.

    ``fluctuation_db`` (1,) is that of the latest reading.
    """
    level_dbm = fluctuating(
        receiver.rss_dbm[place],
        receiver.sigma_db,
        receiver.correlation,
        fluctuation_db,
        generator,
    )
    return max(level_dbm, receiver.sensitivity_dbm)


@jit(fused=True)
def drawn(cumulative: NDArray[np.float64], generator: NDArray[np.uint64]) -> int:
    """Index drawn by cumulative probabilities; nothing is drawn where there is no choice."""
    if cumulative.size == 1:
        return 0
    level = unit_from_high_bits(draw(generator)) * cumulative[-1]
    low, high = 0, cumulative.size - 1  # the first entry above the level is in low..high
    while low < high:
        middle = (low + high) // 2
        low, high = (low, middle) if cumulative[middle] > level else (middle + 1, high)
    return low


@jit(fused=True)
def _next_mode(modes: Modes, mode: int, generator: NDArray[np.uint64]) -> int:
    """Mode after a second."""
    if not modes.change or unit_from_high_bits(draw(generator)) < modes.stays[mode]:
        return mode
    n = modes.stays.size
    return drawn(modes.next_cumulative[mode * n : (mode + 1) * n], generator)


@jit(fused=True)
def _remember(doors: Doors, flight: Flight) -> None:
    """Note the doors seen from the cell: bits of those ever seen, then of those closed."""
    if doors.n_doors == 0:
        return
    memory, seen = flight.whole[MEMORY], doors.sees[flight.whole[CELL]]
    was_seen, was_closed = memory >> doors.n_doors, memory & ((1 << doors.n_doors) - 1)
    closed = (was_closed & ~seen) | (doors.closed[flight.whole[MODE]] & seen)
    flight.whole[MEMORY] = ((was_seen | seen) << doors.n_doors) | closed


@jit(fused=True)
def begin(moves: Moves, sensor: Sensor, flight: Flight) -> None:
    """Draw mode and cell of a new episode, and take its first reading."""
    whole = flight.whole
    whole[MODE] = drawn(sensor.modes.initial_cumulative, flight.generator)
    whole[CELL] = moves.starts[drawn(moves.start_cumulative, flight.generator)]
    whole[HEADING], whole[MEMORY], whole[SECONDS] = NO_HEADING, 0, 0
    flight.real[ENERGY_J] = 0.0
    _remember(sensor.doors, flight)
    place = whole[MODE] * sensor.n_cells + whole[CELL]
    flight.real[READING_DBM] = read(
        sensor.receiver, flight.real[FLUCTUATION_DB:], flight.generator, place
    )


@jit(fused=True)
def first_entry(sensor: Sensor, flight: Flight) -> int:
    """Entry of the flight's cell and action 0 in the table of steps of its mode."""
    layout = sensor.modes.layout[flight.whole[MODE]]
    return int(8 * (layout * sensor.n_cells + flight.whole[CELL]))


@jit(fused=True)
def _confirmed(sensor: Sensor, flight: Flight, place: int) -> bool:
    """Whether readings find the transmitter.

    A first reading above the level is followed by others in the same cell, one a second, while time
    is left; their mean decides, or a sequential test.
    """
    task, receiver, reading = sensor.task, sensor.receiver, flight.real[READING_DBM]
    if not task.by_reading:
        return bool(task.goal[place])
    if reading <= receiver.found_dbm:
        return False
    if task.log_accept > 0.0:
        return _accepted(sensor, flight, place)
    total, taken = reading, 1
    while taken < task.confirmations and flight.whole[SECONDS] < task.max_seconds:
        total += _one_more(sensor, flight, place)
        taken += 1
    return taken == task.confirmations and total > taken * receiver.found_dbm


@jit(fused=True)
def _one_more(sensor: Sensor, flight: Flight, place: int) -> float:
    """Reading after a second in the same cell, while the transmitter stays where it is."""
    reading = read(sensor.receiver, flight.real[FLUCTUATION_DB:], flight.generator, place)
    flight.whole[SECONDS] += 1
    flight.real[ENERGY_J] += sensor.task.hover_j
    flight.real[READING_DBM] = reading
    return reading


@jit(fused=True)
def _accepted(sensor: Sensor, flight: Flight, place: int) -> bool:
    """Sequential probability ratio test of the RSS (Wald 1945, doi:10.1214/aoms/1177731118).

    With z = (reading - level) / sigma, the hypotheses are that the mean of z is 0, or that it is 1.
    Of readings with correlation r from one to the next, z - r z' is independent of those before,
    with the variance 1 - r^2 and the mean 0 or 1 - r, which gives the logarithm of the ratio.
    """
    task, receiver = sensor.task, sensor.receiver
    if receiver.sigma_db == 0.0:
        return True
    r = receiver.correlation
    z = (flight.real[READING_DBM] - receiver.found_dbm) / receiver.sigma_db
    log_ratio, taken = z - 0.5, 1
    while (
        task.log_reject < log_ratio < task.log_accept
        and taken < task.confirmations
        and flight.whole[SECONDS] < task.max_seconds
    ):
        before = z
        z = (_one_more(sensor, flight, place) - receiver.found_dbm) / receiver.sigma_db
        log_ratio += (z - r * before - 0.5 * (1.0 - r)) / (1.0 + r)
        taken += 1
    return log_ratio >= task.log_accept


@jit(fused=True)
def _reward(
    task: TaskTables, place: int, rise_db: float, seconds: int, energy_j: float, found: bool
) -> float:
    """Reward of a step that arrived at a place (mode and cell)."""
    reward = rise_db if task.difference else 0.0
    if task.arrival.size:
        reward += task.arrival[place]
    if found and task.goal_replaces:
        reward = 0.0
    reward += task.per_second * seconds + task.per_joule * energy_j
    return reward + task.goal_reward if found else reward


@jit(fused=True)
def fly(sensor: Sensor, flight: Flight, action: int, arrived: int) -> tuple[float, int]:
    """Fly a possible step to a cell, or hover, and read: (reward, RUNNING, FOUND or TRUNCATED)."""
    whole, real, task = flight.whole, flight.real, sensor.task
    before_s, before_j, before_dbm = whole[SECONDS], real[ENERGY_J], real[READING_DBM]
    if action == HOVER:
        real[ENERGY_J] += task.hover_j
    else:
        real[ENERGY_J] += task.energy_j[8 * whole[HEADING] + action]
        whole[CELL], whole[HEADING] = arrived, action
    whole[SECONDS] += 1
    whole[MODE] = _next_mode(sensor.modes, int(whole[MODE]), flight.generator)
    _remember(sensor.doors, flight)
    place = whole[MODE] * sensor.n_cells + arrived
    reading = read(sensor.receiver, real[FLUCTUATION_DB:], flight.generator, place)
    real[READING_DBM] = reading
    found = _confirmed(sensor, flight, place)
    reward = _reward(
        task,
        place,
        reading - before_dbm,
        whole[SECONDS] - before_s,
        real[ENERGY_J] - before_j,
        found,
    )
    if found:
        return reward, FOUND
    over = whole[SECONDS] >= task.max_seconds or real[ENERGY_J] >= task.budget_j
    return reward, TRUNCATED if over else RUNNING


@jit(fused=True)
def fly_steady(steady: Steady, flight: Flight, arrived: int) -> tuple[float, int]:
    """`fly` where nothing is drawn and energy does not count."""
    whole, task = flight.whole, steady.task
    rise_db = steady.rss_dbm[arrived] - steady.rss_dbm[whole[CELL]]
    found = steady.found[arrived]
    whole[CELL] = arrived
    whole[SECONDS] += 1
    reward = _reward(task, arrived, rise_db, 1, 0.0, found)
    if found:
        return reward, FOUND
    return reward, TRUNCATED if whole[SECONDS] >= task.max_seconds else RUNNING


@jit(fused=True)
def begin_steady(moves: Moves, flight: Flight) -> None:
    """`begin` where readings and modes are not drawn."""
    flight.whole[CELL] = moves.starts[drawn(moves.start_cumulative, flight.generator)]
    flight.whole[SECONDS] = 0
