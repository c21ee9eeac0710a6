"""Algorithm 1 in plain Python, line by line: the readable twin of the compiled loops.

It draws the same random numbers in the same order and keeps the same operand order in the
update, so that its results equal the kernels' bit for bit.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from rssnav.decision_process import DecisionProcess
from rssnav.learning_parameters import QLearning

MASK = (1 << 64) - 1


def _rotated(x: int, bits: int) -> int:
    return ((x << bits) | (x >> (64 - bits))) & MASK


class Xoshiro:
    """xoshiro256++ on Python integers."""

    def __init__(self, state):
        self.s = [int(word) for word in state]

    def bits(self) -> int:
        s = self.s
        result = (_rotated((s[0] + s[3]) & MASK, 23) + s[0]) & MASK
        shifted = (s[1] << 17) & MASK
        s[2] ^= s[0]
        s[3] ^= s[1]
        s[1] ^= s[2]
        s[0] ^= s[3]
        s[2] ^= shifted
        s[3] = _rotated(s[3], 45)
        return result


def high_unit(bits: int) -> float:
    return (bits >> 32) * 2.0**-32


def low_index(bits: int, count: int) -> int:
    return ((bits & 0xFFFFFFFF) * count) >> 32


@dataclass
class Twin:
    """One realisation: discrete states from ``state_of(cell, reading)``, readings from ``read``."""

    process: DecisionProcess
    learning: QLearning
    generators: np.ndarray
    state_of: Callable[[int, float], int] = lambda cell, reading: cell
    read: Callable[[int], float] | None = None
    terminal_dbm: float = -21.0
    q: dict[tuple[int, int], float] = field(default_factory=dict)
    paths: list[list[int]] = field(default_factory=list)
    reached: list[bool] = field(default_factory=list)

    def __post_init__(self):
        self.generator = Xoshiro(self.generators[:4])
        self.tie_generator = Xoshiro(self.generators[4:])
        self.epsilon = self.learning.epsilon_max
        self.alpha = self.learning.alpha_max
        self.visits = np.zeros(self.process.terminal.size, dtype=int)

    def value(self, state: int, action: int) -> float:
        return self.q.get((state, action), self.learning.initial_q)

    def possible(self, cell: int) -> list[int]:
        return [a for a in range(8) if self.process.next_state[cell, a] >= 0]

    def counted(self, cell: int) -> list[int]:
        """Actions that the maximum runs over."""
        return list(range(8)) if self.learning.maximum_over == "all" else self.possible(cell)

    def decay(self, per: str):
        if self.learning.decay == per:
            factor = math.exp(-self.learning.eta)
            if self.epsilon >= self.learning.epsilon_min:
                self.epsilon *= factor
            if self.alpha >= self.learning.alpha_min:
                self.alpha *= factor

    def choose(self, cell: int, state: int) -> int:
        best = max(self.value(state, a) for a in self.counted(cell))
        ties = [a for a in self.counted(cell) if self.value(state, a) == best]
        action = ties[0]
        if self.learning.tie_break == "random":
            action = ties[low_index(self.tie_generator.bits(), len(ties))]
        bits = self.generator.bits()
        blocked = self.process.next_state[cell, action] < 0
        if high_unit(bits) < self.epsilon or blocked:
            possible = self.possible(cell)
            action = possible[low_index(bits, len(possible))]
        return action

    def reading(self, cell: int) -> float:
        return 0.0 if self.read is None else self.read(cell)

    def fly(self):
        """One episode."""
        self.decay("episode")
        cell, path, terminated = self.process.start, [], False
        reading = self.reading(cell)
        state = self.state_of(cell, reading)
        self.visits[cell] += 1
        while not terminated and len(path) < self.learning.max_steps:
            self.decay("step")
            action = self.choose(cell, state)
            arrived = int(self.process.next_state[cell, action])
            next_reading = self.reading(arrived)
            if self.read is None:
                terminated = bool(self.process.terminal[arrived])
                reward = float(self.process.reward[cell, action])
            else:
                terminated = next_reading > self.terminal_dbm
                reward = next_reading - reading
                if terminated:
                    kept = 0.0 if self.learning.goal_reward_is == "instead" else reward
                    reward = kept + self.learning.goal_reward
            next_state = self.state_of(arrived, next_reading)
            future = 0.0
            if not terminated:
                future = max(self.value(next_state, a) for a in self.counted(arrived))
            target = reward + self.learning.gamma * future
            old = self.value(state, action)
            self.q[state, action] = (1.0 - self.alpha) * old + self.alpha * target
            path.append(action)
            self.visits[arrived] += 1
            cell, state, reading = arrived, next_state, next_reading
        self.paths.append(path)
        self.reached.append(terminated)

    def converged_episode(self) -> int:
        """Number of the first episode that ends three equal flights to the goal; -1 if none."""
        for k in range(2, len(self.paths)):
            same = self.paths[k] == self.paths[k - 1] == self.paths[k - 2]
            if same and all(self.reached[k - 2 : k + 1]):
                return k + 1
        return -1


class ToleranceTwin:
    """Tolerance states as a plain list of the readings that created them."""

    def __init__(self, threshold_db: float):
        self.threshold_db = threshold_db
        self.known: list[float] = []

    def __call__(self, cell: int, reading: float) -> int:
        gaps = [abs(reading - known) for known in self.known]
        if gaps and min(gaps) < self.threshold_db:
            return gaps.index(min(gaps))
        self.known.append(reading)
        return len(self.known) - 1
