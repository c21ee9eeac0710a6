"""The two agents of the paper.

An agent says what a state is, what a step is worth, and where an episode ends; applied to a
:class:`~rssnav.world.GridWorld` it gives a
:class:`~rssnav.decision_process.DecisionProcess`, which training and planning share. Each choice
that the paper leaves open is a named parameter; its default is our interpretation.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Literal, Protocol

from rssnav.arguments import require
from rssnav.decision_process import DecisionProcess, process_of
from rssnav.discrete_states import (
    AGENT_SENSITIVITY_DBM,
    ExactStates,
    Fluctuation,
    StateRule,
    check_sensitivity,
)
from rssnav.learning_parameters import QLearning
from rssnav.missions.observation import Observation
from rssnav.missions.task import GOAL_DISTANCE_M, ReadingAbove, Task, Within
from rssnav.world import GridWorld


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
        """States, steps, rewards and terminal states that a world has for this agent.

        Parameters
        ----------
        world : GridWorld
            Cells, steps and RSS.
        learning : QLearning
            Limits of an episode.
        """
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
        self.observation()

    @property
    def name(self) -> str:
        """Short name for tables and files."""
        return "rss"

    def decision_process(self, world: GridWorld, learning: QLearning) -> DecisionProcess:
        """Steps, rewards and terminal states of a world; see `Agent.decision_process`.

        Readings are without fluctuation.

        Raises
        ------
        WorldError
            When no reachable cell exceeds ``terminal_dbm``, or the start does.
        """
        return process_of(world, self.task(learning), self.observation())

    def task(self, learning: QLearning) -> Task:
        """What a step is worth to this agent, and when an episode ends."""
        return _task(learning, ReadingAbove(self.terminal_dbm), "rss")

    def observation(self) -> Observation:
        """What this agent sees."""
        return Observation(
            self.states, fluctuation=self.fluctuation, sensitivity_dbm=self.sensitivity_dbm
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

    Raises
    ------
    ValueError
        For a distance that is not positive and finite.
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
        """Steps, rewards and terminal states of a world; see `Agent.decision_process`.

        Raises
        ------
        WorldError
            When no reachable cell is near enough to the transmitter, the start is, or the
            transmitter is at a cell's centre (1 / D would be infinite).
        """
        return process_of(world, self.task(learning), self.observation())

    def task(self, learning: QLearning) -> Task:
        """What a step is worth to this agent, and when an episode ends."""
        return _task(learning, Within(self.terminal_distance_m), "closeness")

    def observation(self) -> Observation:
        """What this agent sees."""
        return Observation(reading=None, cell=True)


def _task(
    learning: QLearning, goal: ReadingAbove | Within, reward: Literal["rss", "closeness"]
) -> Task:
    """Task of a goal and a reward, with the goal reward and step limit of Algorithm 1."""
    return Task(
        goal,
        reward,
        goal_reward=learning.goal_reward,
        goal_reward_is=learning.goal_reward_is,
        max_steps=learning.max_steps,
    )
