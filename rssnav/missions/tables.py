"""Mission, task and observation -> the tables that the compiled loops fly by."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rssnav.discrete_states import ExactStates, IntervalStates, StateRule, heard
from rssnav.kernels.reading_states import BY_CELL, INTERVALS, TOLERANCE
from rssnav.kernels.stepping import (
    Doors,
    Modes,
    Moves,
    Receiver,
    Rows,
    Sensor,
    Steady,
    TaskTables,
)
from rssnav.missions.mission import Mission
from rssnav.missions.modes import ModeProcess
from rssnav.missions.observation import Observation
from rssnav.missions.task import ReadingAbove, Task

_FLUCTUATION_RANGE = 9.0  # standard deviations; Box-Muller from 53 bits ends at 8.6
_NO_BYTES = np.empty(0, dtype=np.int32)
_NO_FLAGS = np.empty(0, dtype=np.bool_)
_NO_REALS = np.empty(0)


@dataclass(frozen=True, eq=False)
class SensorTables:
    """Readings, task and rows of Q in the loops' terms, shared by all realisations.

    Attributes
    ----------
    sensor : Sensor
        Without what a realisation learns of its readings.
    n_bins : int
        Bins of the tolerance states' table (0 for the other rules).
    n_initial : int
        Discrete states of readings that exist from the start (0 for tolerance states).
    n_rows : int
        Most rows of Q that can come to be used.
    """

    sensor: Sensor
    n_bins: int
    n_initial: int
    n_rows: int

    def of_one_run(self) -> Sensor:
        """Return a sensor of one realisation, which knows no tolerance state."""
        rows = self.sensor.rows._replace(
            state_of_bin=np.full(self.n_bins, -1, dtype=np.int32),
            value_dbm=np.zeros(self.sensor.rows.n_readings),
            no_signal=np.full(1, -1, dtype=np.int32),
            n_known=np.full(1, self.n_initial, dtype=np.int64),
        )
        return self.sensor._replace(rows=rows)


def moves_of(
    next_state: NDArray[np.int32],
    starts: NDArray[np.int32],
    start_probability: NDArray[np.float64],
    reward: NDArray[np.float64] = _NO_REALS,
    terminal: NDArray[np.bool_] = _NO_FLAGS,
) -> Moves:
    """Arrange steps (G, S, 8) or (S, 8) for the loops; rewards and terminal states if no sensor."""
    steps = next_state.reshape(-1, 8)
    possible = steps >= 0
    # A stable sort brings the possible actions of each state to the front, in their order.
    order = np.argsort(~possible, axis=1, kind="stable").astype(np.uint8)
    return Moves(
        next_state=np.ascontiguousarray(steps, dtype=np.int32).reshape(-1),
        possible=order.reshape(-1),
        n_possible=possible.sum(axis=1).astype(np.uint8),
        reward=reward.reshape(-1),
        terminal=terminal,
        starts=starts.astype(np.int32),
        start_cumulative=np.cumsum(start_probability),
    )


def mission_moves(mission: Mission) -> Moves:
    """Steps and starts of a mission."""
    return moves_of(mission.next_state, mission.starts, mission.start_probability)


def sensor_tables(mission: Mission, task: Task, observation: Observation) -> SensorTables:
    """Tables of what an agent reads in a mission, what that is worth, and what it makes of it."""
    rows, n_bins, n_initial = _reading_rows(mission, observation)
    doors = _doors(mission, observation)
    memories = 4**doors.n_doors
    sensor = Sensor(
        n_cells=mission.n_states,
        modes=_modes(mission.modes, mission.layout_of_mode),
        receiver=_receiver(mission, task, observation),
        task=_task(mission, task),
        doors=doors,
        rows=rows,
    )
    headings = 9 if rows.heading else 1
    n_rows = memories * headings * rows.n_readings * rows.n_cells
    return SensorTables(sensor, n_bins, n_initial, n_rows)


def steady_tables(mission: Mission, task: Task, observation: Observation) -> Steady | None:
    """Tables for one mode in which nothing is drawn and energy does not count; else None."""
    drawn = observation.fluctuation.sigma_db > 0.0 or mission.n_modes > 1
    confirms = isinstance(task.goal, ReadingAbove) and task.goal.confirmations > 1
    if drawn or confirms or task.energy is not None:
        return None
    rss_dbm = heard(np.ascontiguousarray(mission.rss_dbm[0]), observation.sensitivity_dbm)
    return Steady(rss_dbm, np.ascontiguousarray(task.goal.cells(mission)[0]), _task(mission, task))


def _modes(modes: ModeProcess, layout_of_mode: NDArray[np.int64]) -> Modes:
    stays = np.diag(modes.transition).copy()
    onward = modes.transition - np.diag(stays)
    return Modes(
        layout=layout_of_mode.astype(np.int64),
        initial_cumulative=np.cumsum(modes.initial),
        stays=stays,
        next_cumulative=np.cumsum(onward, axis=1).reshape(-1),
        change=modes.changes,
    )


def _receiver(mission: Mission, task: Task, observation: Observation) -> Receiver:
    return Receiver(
        rss_dbm=np.ascontiguousarray(mission.rss_dbm).reshape(-1),
        sigma_db=float(observation.fluctuation.sigma_db),
        correlation=float(observation.fluctuation.correlation),
        found_dbm=float(task.goal.level_dbm) if isinstance(task.goal, ReadingAbove) else np.inf,
        sensitivity_dbm=float(observation.sensitivity_dbm),
    )


def _task(mission: Mission, task: Task) -> TaskTables:
    goal, by_reading = _NO_FLAGS, isinstance(task.goal, ReadingAbove)
    arrival = _NO_REALS
    confirmations, log_accept, log_reject = 1, 0.0, 0.0
    if isinstance(task.goal, ReadingAbove):
        confirmations, (log_accept, log_reject) = task.goal.confirmations, task.goal.log_bounds
    else:
        goal = np.ascontiguousarray(task.goal.cells(mission)).reshape(-1)
    if task.reward == "closeness":
        arrival = np.ascontiguousarray(1.0 / mission.distance_m).reshape(-1)
    return TaskTables(
        by_reading=by_reading,
        goal=goal,
        confirmations=int(confirmations),
        log_accept=float(log_accept),
        log_reject=float(log_reject),
        difference=task.reward == "rss",
        arrival=arrival,
        per_second=float(task.per_second),
        per_joule=task.per_kj / 1000.0,
        goal_reward=float(task.goal_reward),
        goal_replaces=task.goal_reward_is == "instead",
        energy_j=np.ascontiguousarray(task.energy_j(mission)).reshape(-1),
        hover_j=0.0 if task.energy is None else float(task.energy.hover_j),
        budget_j=1000.0 * task.battery_kj,
        max_seconds=int(task.max_steps),
    )


def _doors(mission: Mission, observation: Observation) -> Doors:
    count = mission.closed.shape[1] if observation.doors else 0
    bits = 1 << np.arange(count, dtype=np.int64)
    if not count:
        return Doors(0, np.empty(0, dtype=np.int64), np.empty(0, dtype=np.int64))
    return Doors(count, mission.sees @ bits, mission.closed @ bits)


def _reading_rows(mission: Mission, observation: Observation) -> tuple[Rows, int, int]:
    """Rows of Q, bins of tolerance states, and discrete states of readings at the start."""
    m, s = mission.rss_dbm.shape
    rule: StateRule | None = observation.reading
    heard_dbm = heard(mission.rss_dbm.reshape(-1), observation.sensitivity_dbm)
    sigma_db = observation.fluctuation.sigma_db
    margin_db = _FLUCTUATION_RANGE * sigma_db
    low_dbm, high_dbm = float(heard_dbm.min()) - margin_db, float(heard_dbm.max()) + margin_db
    kind, state_of_cell, edges, threshold, n_bins = BY_CELL, _NO_BYTES, _NO_REALS, 0.0, 0
    if rule is None:
        modes = np.arange(m, dtype=np.int32) if observation.mode else np.zeros(m, dtype=np.int32)
        state_of_cell = np.repeat(modes, s)
        n_initial = n_most = int(modes.max()) + 1
    elif isinstance(rule, ExactStates):
        state_of_cell = rule.discrete_states(heard_dbm)
        n_initial = n_most = int(state_of_cell.max()) + 1
    elif isinstance(rule, IntervalStates):
        kind, edges = INTERVALS, np.array(rule.edges_dbm, dtype=np.float64)
        n_initial = edges.size + 1
        n_most = n_initial + 1
    else:
        kind, threshold = TOLERANCE, float(rule.threshold_db)
        n_bins = int((high_dbm - low_dbm) * 2.0 / threshold) + 1
        n_most = 1 + (n_bins if sigma_db > 0.0 else min(n_bins, heard_dbm.size))
        n_initial = 0
    rows = Rows(
        kind=kind,
        state_of_cell=state_of_cell,
        edges_dbm=edges,
        threshold_db=threshold,
        low_dbm=low_dbm,
        n_readings=n_most,
        n_cells=s if observation.cell else 1,
        heading=observation.heading,
        state_of_bin=_NO_BYTES,
        value_dbm=_NO_REALS,
        no_signal=np.full(1, -1, dtype=np.int32),
        n_known=np.zeros(1, dtype=np.int64),
    )
    return rows, n_bins, n_initial
