"""One second of a flight in plain Python: the readable twin of `rssnav.kernels.stepping`."""

from __future__ import annotations

import math

import numpy as np
from q_learning_twin import Xoshiro, high_unit
from scipy.stats import multivariate_normal

from rssnav.missions import Mission, Observation, ReadingAbove, Task

STAY = 8


def pick(probabilities, level: float) -> int:
    """Index drawn by probabilities, for a level in [0, 1)."""
    sums = np.cumsum(probabilities)
    return int(np.flatnonzero(level * sums[-1] < sums)[0])


class MissionTwin:
    def __init__(self, mission: Mission, task: Task, observation: Observation, generator):
        self.mission, self.task, self.observation = mission, task, observation
        self.random = Xoshiro(generator)
        self.fluctuation = 0.0

    def level(self) -> float:
        return high_unit(self.random.bits())

    def read(self) -> float:
        mean = self.mission.rss_dbm[self.mode, self.cell]
        noise = self.observation.fluctuation
        if noise.sigma_db > 0.0:
            a, b = self.random.bits() >> 11, self.random.bits() >> 11
            normal = math.sqrt(-2 * math.log((a + 1) / 2**53)) * math.cos(2 * math.pi * b / 2**53)
            kept = noise.correlation * self.fluctuation
            self.fluctuation = kept + math.sqrt(1 - noise.correlation**2) * noise.sigma_db * normal
        return max(mean + self.fluctuation, self.observation.sensitivity_dbm)

    def look(self):
        for door in range(self.mission.closed.shape[1]):
            if self.mission.sees[self.cell, door]:
                self.doors[door] = bool(self.mission.closed[self.mode, door])

    def begin(self):
        modes = self.mission.modes
        self.mode = pick(modes.initial, self.level()) if modes.n_modes > 1 else 0
        several = self.mission.starts.size > 1
        start = pick(self.mission.start_probability, self.level()) if several else 0
        self.cell = int(self.mission.starts[start])
        self.heading, self.seconds, self.energy_j, self.doors = STAY, 0, 0.0, {}
        self.look()
        self.reading = self.read()

    def possible(self, action: int) -> int:
        layout = self.mission.layouts[self.mission.layout_of_mode[self.mode]]
        return int(layout.next_state[self.cell, action])

    def change_mode(self):
        modes = self.mission.modes
        if modes.changes:
            row = modes.transition[self.mode]
            if self.level() >= row[self.mode]:
                others = np.where(np.arange(row.size) == self.mode, 0.0, row)
                self.mode = pick(others, self.level())

    def step(self, action: int) -> tuple[float, str]:
        task, before_s, before_j, before_dbm = self.task, self.seconds, self.energy_j, self.reading
        arrived = self.possible(action) if action != STAY else self.cell
        if action == STAY or arrived < 0:
            self.energy_j += task.energy.hover_j if task.energy else 0.0
        else:
            self.energy_j += task.energy_j(self.mission)[self.heading, action]
            self.cell, self.heading = arrived, action
        self.seconds += 1
        self.change_mode()
        self.look()
        first = self.reading = self.read()
        found = self.is_found(first)
        reward = {
            "rss": first - before_dbm,
            "closeness": 1.0 / self.mission.distance_m[self.mode, self.cell],
            "none": 0.0,
        }[task.reward]
        if found and task.goal_reward_is == "instead":
            reward = 0.0
        reward += task.per_second * (self.seconds - before_s)
        reward += task.per_kj / 1000.0 * (self.energy_j - before_j)
        reward += task.goal_reward if found else 0.0
        if found:
            return reward, "found"
        empty = self.energy_j >= 1000.0 * task.battery_kj
        return reward, "truncated" if empty or self.seconds >= task.max_steps else "running"

    def is_found(self, first: float) -> bool:
        goal = self.task.goal
        if not isinstance(goal, ReadingAbove):
            return bool(goal.cells(self.mission)[self.mode, self.cell])
        readings = [first]
        while (
            first > goal.level_dbm
            and len(readings) < goal.confirmations
            and self.seconds < self.task.max_steps
            and self.verdict(readings) is None
        ):
            self.reading = self.read()
            self.seconds += 1
            self.energy_j += self.task.energy.hover_j if self.task.energy else 0.0
            readings.append(self.reading)
        if goal.error is not None:
            return first > goal.level_dbm and self.verdict(readings) is True
        enough = len(readings) == goal.confirmations
        return enough and sum(readings) > goal.level_dbm * len(readings)

    def verdict(self, readings) -> bool | None:
        """What Wald's test says of the readings so far, by the densities themselves."""
        goal, noise = self.task.goal, self.observation.fluctuation
        if goal.error is None:
            return None
        if noise.sigma_db == 0.0:
            return True
        lags = np.abs(np.subtract.outer(np.arange(len(readings)), np.arange(len(readings))))
        covariance = noise.sigma_db**2 * noise.correlation**lags
        low, high = (
            multivariate_normal(np.full(len(readings), mean_dbm), covariance).logpdf(readings)
            for mean_dbm in (goal.level_dbm, goal.level_dbm + noise.sigma_db)
        )
        if high - low >= math.log(1.0 / goal.error):
            return True
        return False if high - low <= math.log(0.05) else None
