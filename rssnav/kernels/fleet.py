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
    MODE,
    READING_DBM,
    RUNNING,
    Flight,
    Moves,
    Sensor,
    Steady,
    begin,
    begin_steady,
    first_entry,
    fly,
    fly_steady,
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
def begin_some(moves: Moves, sensor: Sensor, fleet: Fleet, chosen: NDArray[np.bool_]) -> None:
    """Begin an episode of the chosen flights (N,)."""
    for i in range(chosen.size):
        if chosen[i]:
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


class View(NamedTuple):
    """What the environments' agents see (N of them)."""

    history: NDArray[np.float64]  # (N, k) latest readings [dBm], the latest last
    cells: NDArray[np.int64]  # (N,)
    rows: NDArray[np.int64]  # (N,) or empty
    masks: NDArray[np.uint64]  # (N,) eight bytes, 1 where an action is possible
    mask_of: NDArray[np.uint64]  # (G * S,) the same of each layout and cell
    final_history: NDArray[np.float64]  # (N, k) at the end of the episode that has just ended
    final_cells: NDArray[np.int64]  # (N,)
    final_rows: NDArray[np.int64]  # (N,) or empty
    final_masks: NDArray[np.uint64]  # (N,)


@jit(fused=True)
def _look(
    sensor: Sensor | None, steady: Steady | None, fleet: Fleet, view: View, i: int, new: bool
) -> None:
    """See where the flight is; ``new`` at the begin of an episode."""
    cell = fleet.whole[i, CELL]
    place, reading = cell, 0.0
    if steady is not None:
        reading = steady.rss_dbm[cell]
    if sensor is not None:
        reading = fleet.real[i, READING_DBM]
        place = sensor.modes.layout[fleet.whole[i, MODE]] * sensor.n_cells + cell
        if view.rows.size:
            flight = Flight(fleet.whole[i], fleet.real[i], fleet.generator[i])
            view.rows[i] = row_of(sensor, flight)
    last = view.history.shape[1] - 1
    for k in range(last):
        view.history[i, k] = reading if new else view.history[i, k + 1]
    view.history[i, last] = reading
    view.cells[i] = cell
    view.masks[i] = view.mask_of[place]


@jit(fused=True)
def _begin(
    moves: Moves, sensor: Sensor | None, steady: Steady | None, fleet: Fleet, view: View, i: int
) -> None:
    flight = Flight(fleet.whole[i], fleet.real[i], fleet.generator[i])
    if steady is not None:
        begin_steady(moves, flight)
    if sensor is not None:
        begin(moves, sensor, flight)
    fleet.reward[i], fleet.status[i] = 0.0, RUNNING
    _look(sensor, steady, fleet, view, i, True)


@jit(fused=True)
def _step(
    moves: Moves,
    sensor: Sensor | None,
    steady: Steady | None,
    fleet: Fleet,
    i: int,
    action: int,
) -> None:
    if sensor is not None:
        step_flight(moves, sensor, fleet, i, action)
    if steady is not None:
        arrived = int(fleet.whole[i, CELL])
        if action != HOVER:
            there = moves.next_state[8 * arrived + action]
            arrived = int(there) if there >= 0 else arrived
        flight = Flight(fleet.whole[i], fleet.real[i], fleet.generator[i])
        fleet.reward[i], fleet.status[i] = fly_steady(steady, flight, arrived)


@jit()
def reset_some(
    moves: Moves,
    sensor: Sensor | None,
    steady: Steady | None,
    fleet: Fleet,
    view: View,
    chosen: NDArray[np.bool_],
) -> None:
    """Begin an episode of the chosen environments (N,)."""
    for i in range(chosen.size):
        if chosen[i]:
            _begin(moves, sensor, steady, fleet, view, i)


@jit()
def step_all(
    moves: Moves,
    sensor: Sensor | None,
    steady: Steady | None,
    fleet: Fleet,
    view: View,
    actions: NDArray[np.int64],
    n_actions: int,
    same_step: bool,
    ended: NDArray[np.int8],
) -> bool:
    """Step all environments; ``ended`` (N,) receives FOUND, TRUNCATED or RUNNING.

    Returns False, and steps none, if an action is not one of ``n_actions``. An environment whose
    episode ended begins the next one in the same step, or in place of the next step.
    """
    unknown = 0  # counted without a branch, which vectorises
    for action in actions:
        unknown += (action < 0) | (action >= n_actions)
    if unknown:
        return False
    for i in range(actions.size):
        if fleet.status[i] != RUNNING:
            _begin(moves, sensor, steady, fleet, view, i)
            ended[i] = RUNNING
            continue
        _step(moves, sensor, steady, fleet, i, actions[i])
        _look(sensor, steady, fleet, view, i, False)
        ended[i] = fleet.status[i]
        if same_step and ended[i] != RUNNING:
            for k in range(view.history.shape[1]):
                view.final_history[i, k] = view.history[i, k]
            view.final_cells[i], view.final_masks[i] = view.cells[i], view.masks[i]
            if view.rows.size:
                view.final_rows[i] = view.rows[i]
            reward = fleet.reward[i]
            _begin(moves, sensor, steady, fleet, view, i)
            fleet.reward[i] = reward
    return True
