"""The two agents of the paper, and the parameters of Q-learning.

An agent says what is a state, what a step is worth, and where an episode ends; applied to a
:class:`~rssnav.world.GridWorld` that makes a :class:`DecisionProcess`, which training and planning
share. Each choice the paper leaves open is a named parameter whose default is our reading.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from rssnav.states import ExactStates, Fluctuation, StateRule
from rssnav.world import GOAL_DISTANCE_M, GridWorld, WorldError

_LISTED = 5


@dataclass(frozen=True)
class QLearning:
    """Parameters of Algorithm 1.

    Parameters
    ----------
    gamma : float
        Discount factor.
    epsilon_max, epsilon_min : float
        Exploration probability: its first value, and the value below which it no longer decays.
    alpha_max, alpha_min : float
        Learning rate, likewise.
    eta : float
        Decay: epsilon and alpha are multiplied by exp(-eta) while not below their minimum.
    goal_reward : float
        Reward for finding the source.
    goal_reward_is : {"added", "instead"}
        The goal reward is added to the last step's reward, or stands instead of it. The paper
        says "it will get a reward of 1000"; added keeps the last step's RSS difference or 1/D,
        which differ between the target cells, and is our reading.
    initial_q : float
        Q of every state and action before learning. Not stated in the paper; 100 is about the
        discounted worth of the goal at these distances, so optimistic. With 0 some agents are
        caught by cycles of positive reward.
    maximum_over : {"possible", "all"}
        Actions that the maximum runs over, for the greedy choice and for max Q(s', a'): those
        possible in the state (our reading), or also those that would crash, which then keep their
        initial value; a blocked greedy choice is dropped for a random possible one.
    decay : {"step", "episode"}
        When epsilon and alpha decay: before every step as in Algorithm 1, or every episode.
    tie_break : {"first", "random"}
        Which of several greedy actions is taken: the first in the order of
        :data:`rssnav.world.ACTIONS`, or any with equal probability.
    max_steps : int
        Steps after which an episode is cut. Not stated in the paper. A cut episode is truncated,
        not terminated: its last step bootstraps like any other.
    rule : {"q_learning", "sarsa", "double_q"}
        What a step learns: Algorithm 1, or one of two rules it is compared with, SARSA and Double
        Q-learning. Those need a row of Q per cell, so steady readings that are all different.
    """

    gamma: float = 0.98
    epsilon_max: float = 1.0
    epsilon_min: float = 0.01
    alpha_max: float = 0.5
    alpha_min: float = 0.05
    eta: float = 1e-5
    goal_reward: float = 1000.0
    goal_reward_is: Literal["added", "instead"] = "added"
    initial_q: float = 100.0
    maximum_over: Literal["possible", "all"] = "possible"
    decay: Literal["step", "episode"] = "step"
    tie_break: Literal["first", "random"] = "first"
    max_steps: int = 20_000
    rule: Literal["q_learning", "sarsa", "double_q"] = "q_learning"

    def __post_init__(self) -> None:
        _require(0.0 <= self.gamma <= 1.0, "gamma", self.gamma, "in [0, 1]")
        for name in ("epsilon", "alpha"):
            low, high = getattr(self, f"{name}_min"), getattr(self, f"{name}_max")
            _require(0.0 <= high <= 1.0, f"{name}_max", high, "in [0, 1]")
            _require(0.0 <= low <= high, f"{name}_min", low, f"in [0, {name}_max = {high:g}]")
        _require(0.0 <= self.eta < math.inf, "eta", self.eta, "finite and not negative")
        for name in ("goal_reward", "initial_q"):
            value = getattr(self, name)
            _require(math.isfinite(value), name, value, "finite")
        _require(self.max_steps >= 1, "max_steps", self.max_steps, "at least 1")
        for name, choices in _CHOICES.items():
            value = getattr(self, name)
            _require(value in choices, name, value, " or ".join(map(repr, choices)))


_CHOICES = {
    "goal_reward_is": ("added", "instead"),
    "maximum_over": ("possible", "all"),
    "decay": ("step", "episode"),
    "tie_break": ("first", "random"),
    "rule": ("q_learning", "sarsa", "double_q"),
}


def _require(holds: bool, name: str, value: object, right: str) -> None:
    if not holds:
        raise ValueError(f"{name}: {value!r} must be {right}")


@dataclass(frozen=True, eq=False)
class DecisionProcess:
    """A world with rewards and terminal states: what planning solves and training samples.

    Attributes
    ----------
    next_state : (S, 8) int32
        State after each action, -1 where it is impossible.
    reward : (S, 8) float64
        Reward of each step, the goal reward included; 0 where the step is impossible.
    terminal : (S,) bool
        States that end an episode.
    start : int
        State an episode begins in.
    """

    next_state: NDArray[np.int32]
    reward: NDArray[np.float64]
    terminal: NDArray[np.bool_]
    start: int


class Agent(Protocol):
    """What training asks of an agent: a name, and what a world means to it.

    `RssAgent` and `LocationAgent` are the paper's. Any other class with these two members can be
    trained as well; its state is the cell, like the location agent's, and its result cannot be
    saved.
    """

    @property
    def name(self) -> str:
        """Short name for tables and figures."""
        ...

    def decision_process(self, world: GridWorld, learning: QLearning) -> DecisionProcess:
        """Rewards and terminal states of a world."""
        ...


@dataclass(frozen=True)
class RssAgent:
    """The paper's agent: it knows nothing but the RSS it reads.

    Its state is made from the reading, its reward is RSS_t - RSS_(t-1) [dB], and an episode ends
    when the reading exceeds ``terminal_dbm``.

    Parameters
    ----------
    states : ExactStates, ToleranceStates or IntervalStates
        How a reading becomes a state.
    terminal_dbm : float
        Reading above which the source is found [dBm]; -21 dBm is free space at 2 m.
    fluctuation : Fluctuation
        How readings differ from the map; not at all by default, as in the paper.
    """

    states: StateRule = field(default_factory=ExactStates)
    terminal_dbm: float = -21.0
    fluctuation: Fluctuation = field(default_factory=Fluctuation)

    def __post_init__(self) -> None:
        if self.fluctuation.sigma_db > 0.0 and isinstance(self.states, ExactStates):
            raise ValueError(
                f"states: with readings that fluctuate (sigma_db = {self.fluctuation.sigma_db:g}) "
                "every reading would be a new exact state; use ToleranceStates or IntervalStates"
            )

    @property
    def name(self) -> str:
        """Short name for tables and files."""
        return "rss"

    def decision_process(self, world: GridWorld, learning: QLearning) -> DecisionProcess:
        """Rewards and terminal states of a world for steady readings.

        Raises
        ------
        WorldError
            When a reachable cell has no path (-inf dBm: its reward would be infinite), no
            reachable cell exceeds ``terminal_dbm``, or the start does.
        """
        _refuse_dark_cells(world)
        terminal = world.rss_dbm > self.terminal_dbm
        _check_terminal(world, terminal, f"RSS > {self.terminal_dbm:g} dBm")
        difference = world.rss_dbm[world.next_state] - world.rss_dbm[:, None]
        return _process(world, learning, difference, terminal)


@dataclass(frozen=True)
class LocationAgent:
    """The baseline: it knows its position and the victim's.

    Its state is the cell, its reward 1 / D_t [1/m] with D_t the horizontal distance to the victim
    after the step, and an episode ends when D_t < ``terminal_distance_m``.

    Parameters
    ----------
    terminal_distance_m : float
        Distance below which the source is found [m].
    """

    terminal_distance_m: float = GOAL_DISTANCE_M

    def __post_init__(self) -> None:
        distance_m = self.terminal_distance_m
        _require(0.0 < distance_m < math.inf, "terminal_distance_m", distance_m, "positive")

    @property
    def name(self) -> str:
        """Short name for tables and files."""
        return "location"

    def decision_process(self, world: GridWorld, learning: QLearning) -> DecisionProcess:
        """Rewards and terminal states of a world.

        Raises
        ------
        WorldError
            When no reachable cell is near enough to the source, the start is, or a cell's centre
            is the source's place (1 / D would be infinite).
        """
        if not np.all(world.distance_m > 0.0):
            raise WorldError(
                f"plan {world.plan_name!r}: the source {world.source} lies exactly at a cell "
                "centre, where the reward 1/D is infinite; move the source or the grid"
            )
        terminal = world.distance_m < self.terminal_distance_m
        _check_terminal(world, terminal, f"D < {self.terminal_distance_m:g} m")
        closeness = 1.0 / world.distance_m[world.next_state]
        return _process(world, learning, closeness, terminal)


def _process(
    world: GridWorld,
    learning: QLearning,
    step_reward: NDArray[np.float64],
    terminal: NDArray[np.bool_],
) -> DecisionProcess:
    """Add the goal reward to the step rewards (S, 8) and clear the impossible steps."""
    possible = world.next_state >= 0
    arrives = possible & terminal[world.next_state]
    kept = 0.0 if learning.goal_reward_is == "instead" else step_reward
    reward = np.where(arrives, kept + learning.goal_reward, np.where(possible, step_reward, 0.0))
    return DecisionProcess(world.next_state, reward, terminal, world.start_state)


def _refuse_dark_cells(world: GridWorld) -> None:
    dark = np.flatnonzero(np.isneginf(world.rss_dbm))
    if dark.size:
        listed = ", ".join(f"({x:g}, {y:g})" for x, y in world.position[dark[:_LISTED]])
        more = ", ..." if dark.size > _LISTED else ""
        raise WorldError(
            f"plan {world.plan_name!r}: {dark.size} cells that can be reached at speed "
            f"{world.speed} have no path from the source (-inf dBm), at {listed}{more} m: an RSS "
            "agent has no reading there; allow more reflections or transmission in the map"
        )


def _check_terminal(world: GridWorld, terminal: NDArray[np.bool_], condition: str) -> None:
    if not terminal.any():
        raise WorldError(
            f"plan {world.plan_name!r}: no cell with {condition} can be reached at speed "
            f"{world.speed}; another speed, start or threshold is needed"
        )
    if terminal[world.start_state]:
        raise WorldError(
            f"plan {world.plan_name!r}: the start already has {condition}, so every episode would "
            "end before its first step; move the start or tighten the threshold"
        )
