"""The two agents of the paper.

An agent says what a state is, what a step is worth, and where an episode ends; applied to a
:class:`~rssnav.world.GridWorld` it gives a
:class:`~rssnav.decision_process.DecisionProcess`, which training and planning share. Each choice
that the paper leaves open is a named parameter; its default is our interpretation.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from rssnav.arguments import require
from rssnav.decision_process import DecisionProcess
from rssnav.discrete_states import (
    AGENT_SENSITIVITY_DBM,
    ExactStates,
    Fluctuation,
    GoalRule,
    ReadingStates,
    StateRule,
    check_sensitivity,
    heard,
    reading_states,
)
from rssnav.learning_parameters import QLearning
from rssnav.world import GOAL_DISTANCE_M, GridWorld, WorldError


class Agent(Protocol):
    """What training needs of an agent: a name, and the decision process it makes of a world.

    `RssAgent` and `LocationAgent` are the paper's. Any other class with these two members can be
    trained as well. The result of one that is a frozen dataclass can be saved and loaded.
    """

    @property
    def name(self) -> str:
        """Short name for tables and figures."""
        ...

    def decision_process(self, world: GridWorld, learning: QLearning) -> DecisionProcess:
        """States, steps, rewards and terminal states that a world has for this agent."""
        ...


@dataclass(frozen=True)
class RssAgent:
    """The paper's agent: it knows only the RSS it reads.

    Its discrete state follows from the reading, its reward is RSS_t - RSS_(t-1) [dB], and an
    episode ends when the reading exceeds ``terminal_dbm``. In a cell without a path, or where the
    RSS does not exceed ``sensitivity_dbm``, the reading is "no signal": one discrete state for all
    such cells, worth ``sensitivity_dbm`` in the reward.

    Parameters
    ----------
    states : ExactStates, ToleranceStates or IntervalStates
        How a reading becomes a discrete state.
    terminal_dbm : float
        Reading above which the transmitter is found [dBm]; -21 dBm is free space at 2 m.
    fluctuation : Fluctuation
        How readings differ from the map; not at all by default, as in the paper.
    sensitivity_dbm : float
        Weakest level that the receiver hears [dBm].
    """

    states: StateRule = field(default_factory=ExactStates)
    terminal_dbm: float = -21.0
    fluctuation: Fluctuation = field(default_factory=Fluctuation)
    sensitivity_dbm: float = AGENT_SENSITIVITY_DBM

    def __post_init__(self) -> None:
        check_sensitivity(self.sensitivity_dbm, self.terminal_dbm)
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
        """Steps, rewards and terminal states of a world for readings without fluctuation.

        Raises
        ------
        WorldError
            When no reachable cell exceeds ``terminal_dbm``, or the start does.
        """
        heard_dbm = heard(world.rss_dbm, self.sensitivity_dbm)
        terminal = world.rss_dbm > self.terminal_dbm
        _check_terminal(world, terminal, f"RSS > {self.terminal_dbm:g} dBm")
        difference = heard_dbm[world.next_state] - heard_dbm[:, None]
        return _process(
            world, learning, difference, terminal, self._reading_states(world, learning)
        )

    def _reading_states(self, world: GridWorld, learning: QLearning) -> ReadingStates | None:
        """How readings become discrete states; None where each cell is a discrete state."""
        heard_dbm = heard(world.rss_dbm, self.sensitivity_dbm)
        if isinstance(self.states, ExactStates) and np.unique(heard_dbm).size == world.n_states:
            return None
        replaces = learning.goal_reward_is == "instead"
        goal = GoalRule(self.terminal_dbm, learning.goal_reward, replaces)
        return reading_states(
            self.states, self.fluctuation, world.rss_dbm, goal, self.sensitivity_dbm
        )


@dataclass(frozen=True)
class LocationAgent:
    """The baseline: it knows its own position and the transmitter's.

    Its state is the cell, its reward 1 / D_t [1/m] with D_t the horizontal distance to the
    transmitter after the step, and an episode ends when D_t < ``terminal_distance_m``.

    Parameters
    ----------
    terminal_distance_m : float
        Distance below which the transmitter is found [m].
    """

    terminal_distance_m: float = GOAL_DISTANCE_M

    def __post_init__(self) -> None:
        distance_m = self.terminal_distance_m
        require(0.0 < distance_m < math.inf, "terminal_distance_m", distance_m, "a positive number")

    @property
    def name(self) -> str:
        """Short name for tables and files."""
        return "location"

    def decision_process(self, world: GridWorld, learning: QLearning) -> DecisionProcess:
        """Steps, rewards and terminal states of a world.

        Raises
        ------
        WorldError
            When no reachable cell is near enough to the transmitter, the start is, or the
            transmitter is at a cell's centre (1 / D would be infinite).
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
    readings: ReadingStates | None = None,
) -> DecisionProcess:
    """Add the goal reward to the step rewards (S, 8) and clear the impossible steps."""
    possible = world.action_mask
    arrives = possible & terminal[world.next_state]
    kept = 0.0 if learning.goal_reward_is == "instead" else step_reward
    reward = np.where(arrives, kept + learning.goal_reward, np.where(possible, step_reward, 0.0))
    return DecisionProcess(world.next_state, reward, terminal, world.start_state, readings=readings)


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
