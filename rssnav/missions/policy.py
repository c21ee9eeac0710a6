"""Who acts: learned tables, searchers, networks, all behind one protocol."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from rssnav.arguments import require

HOVER = 8
"""The action of staying in the cell for one more reading."""


class Seen(NamedTuple):
    """What an agent sees before it acts; -1 (or NaN) where its observation leaves it out.

    Attributes
    ----------
    reading_dbm : float
        RSS reading [dBm]; the receiver's sensitivity means "no signal".
    row : int
        Row of a table for what the observation holds.
    cell : int
        Cell of the mission's layout.
    heading : int
        Action that led here; 8 before the first step.
    mode : int
        Place of the transmitter and state of the doors.
    doors_seen, doors_closed : int
        Bits of the doors seen so far, and of those last seen closed.
    seconds : int
        Seconds flown.
    """

    reading_dbm: float
    row: int
    cell: int
    heading: int
    mode: int
    doors_seen: int
    doors_closed: int
    seconds: int


class Policy(Protocol):
    """What learners and searchers implement to fly."""

    @property
    def name(self) -> str:
        """Short name for tables and figures."""
        ...

    def begin(self, generator: np.random.Generator) -> None:
        """Forget the last flight; all random numbers of the next come from ``generator``."""
        ...

    def act(self, observation: Seen, mask: NDArray[np.bool_]) -> int:
        """Choose one of the possible actions, ``mask`` (8,), or :data:`HOVER`."""
        ...


@dataclass(eq=False)
class GreedyTable:
    """The best action of a row of Q, of equal ones the first.

    Parameters
    ----------
    q : (rows, 8) float64
        Action values.
    epsilon : float
        Probability of a random action, which frees a table from cycles of states that it cannot
        tell apart.
    name : str
        Short name for tables and figures.

    Raises
    ------
    ValueError
        For an epsilon that is no probability.
    """

    q: NDArray[np.float64]
    epsilon: float = 0.0
    name: str = "Q-learning"

    def __post_init__(self) -> None:
        require(0.0 <= self.epsilon <= 1.0, "epsilon", self.epsilon, "a number in [0, 1]")

    def begin(self, generator: np.random.Generator) -> None:
        """Take the random numbers of a flight."""
        self._generator = generator

    def act(self, observation: Seen, mask: NDArray[np.bool_]) -> int:
        """Return the best possible action; see `rssnav.missions.Policy.act`."""
        if self.epsilon > 0.0 and self._generator.random() < self.epsilon:
            return int(self._generator.choice(np.flatnonzero(mask)))
        return int(np.argmax(np.where(mask, self.q[observation.row], -np.inf)))


@dataclass(eq=False)
class RandomPolicy:
    """Every possible action is equally likely."""

    name: str = "random walk"

    def begin(self, generator: np.random.Generator) -> None:
        """Take the random numbers of a flight."""
        self._generator = generator

    def act(self, observation: Seen, mask: NDArray[np.bool_]) -> int:
        """Draw an action; see `rssnav.missions.Policy.act`."""
        return int(self._generator.choice(np.flatnonzero(mask)))
