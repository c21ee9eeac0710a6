"""Parameters of Algorithm 1 and of the learning rules that it is compared with.

Each choice that the paper leaves open is a named parameter; its default is our interpretation.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, get_args

from rssnav.arguments import is_finite, require

LearningRule = Literal["q_learning", "sarsa", "double_q"]
"""Names of the learning rules; :mod:`rssnav.learning_rules` holds the loop of each."""


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
        Reward for finding the transmitter.
    goal_reward_is : {"added", "instead"}
        The goal reward is added to the last step's reward, or replaces it. The paper says "it will
        get a reward of 1000"; "added" keeps the last step's RSS difference or 1/D, which differ
        between the target cells, and is our interpretation.
    initial_q : float
        Q of every state and action before learning. Not stated in the paper; 100 is about the
        discounted value of the goal at these distances, so optimistic. With 0 some agents are
        trapped in cycles of positive reward.
    maximum_over : {"possible", "all"}
        Actions that the maximum runs over, for the greedy choice and for max Q(s', a'): those
        possible in the state (our interpretation), or also those that would crash, which then keep
        their initial value; a random possible action replaces a blocked greedy choice.
    decay : {"step", "episode"}
        When epsilon and alpha decay: before every step as in Algorithm 1, or every episode.
    tie_break : {"first", "random"}
        Which of several greedy actions is taken: the first in the order of
        :data:`rssnav.world.ACTIONS`, or any with equal probability.
    max_steps : int
        Steps after which an episode is truncated. Not stated in the paper. A truncated episode is
        not terminated: its last step bootstraps like any other.
    rule : {"q_learning", "sarsa", "double_q"}
        Learning rule: Algorithm 1, or one of two rules it is compared with, SARSA and Double
        Q-learning. Those need a row of Q per state of the decision process, so not an RSS agent
        whose cells share discrete states or whose readings fluctuate.

    Raises
    ------
    ValueError
        For a parameter out of range; the message names it.
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
    rule: LearningRule = "q_learning"

    def __post_init__(self) -> None:
        require(0.0 <= self.gamma <= 1.0, "gamma", self.gamma, "0 to 1")
        for name in ("epsilon", "alpha"):
            low, high = getattr(self, f"{name}_min"), getattr(self, f"{name}_max")
            require(0.0 <= high <= 1.0, f"{name}_max", high, "0 to 1")
            require(0.0 <= low <= high, f"{name}_min", low, f"0 to {name}_max = {high:g}")
        require(0.0 <= self.eta < math.inf, "eta", self.eta, "a finite number of at least 0")
        for name in ("goal_reward", "initial_q"):
            value = getattr(self, name)
            require(is_finite(value), name, value, "a finite number")
        whole = 1 <= self.max_steps < 2**31 and self.max_steps % 1 == 0
        require(whole, "max_steps", self.max_steps, "an integer from 1 to 2147483647")
        for name, choices in _CHOICES.items():
            value = getattr(self, name)
            require(value in choices, name, value, " or ".join(map(repr, choices)))
        for name in _FLOATS:  # kernels are compiled for each type, and Q has that of `initial_q`
            object.__setattr__(self, name, float(getattr(self, name)))
        object.__setattr__(self, "max_steps", int(self.max_steps))


_FLOATS = (
    "gamma", "epsilon_max", "epsilon_min", "alpha_max", "alpha_min", "eta", "goal_reward",
    "initial_q",
)  # fmt: skip
_CHOICES = {
    "goal_reward_is": ("added", "instead"),
    "maximum_over": ("possible", "all"),
    "decay": ("step", "episode"),
    "tie_break": ("first", "random"),
    "rule": get_args(LearningRule),
}
