"""The learning rules behind one interface: which loop runs for which agent and parameters.

:meth:`LearningProblem.learner` decides: an agent that acts on readings learns with
:class:`ReadingLearner`; for others ``LEARNERS`` holds a learner for each value of
:attr:`QLearning.rule <rssnav.learning_parameters.QLearning.rule>`. A new rule is a name in
:data:`~rssnav.learning_parameters.LearningRule`, a loop in :mod:`rssnav.kernels`, and a row here.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from rssnav.agents import Agent
from rssnav.decision_process import DecisionProcess
from rssnav.discrete_states import ReadingStates
from rssnav.kernels import common, q_learning, q_learning_from_readings, temporal_difference
from rssnav.kernels.common import Moves, Parameters, Run
from rssnav.learning_parameters import LearningRule, QLearning
from rssnav.world import ACTION_NAMES, GridWorld

N_ACTIONS = len(ACTION_NAMES)


class Learner(Protocol):
    """A Q-table that learns by flying episodes.

    Attributes
    ----------
    run : Run
        All that it has learned and counted.
    trace : (max_steps,) int32, or None
        Receives the states that an episode arrives at; each episode overwrites the one before.
    """

    run: Run
    trace: NDArray[np.int32] | None

    def advance(self, until_episode: int) -> None:
        """Fly to ``until_episode``, or to the episode in which the run converges."""
        ...

    def state_values(self) -> NDArray[np.float64]:
        """Q of each state (of its reading without fluctuation), shape (S, 8); -inf if blocked."""
        ...

    def n_discrete_states(self) -> int:
        """Discrete states that the agent distinguishes so far."""
        ...


@dataclass(frozen=True, eq=False)
class LearningProblem:
    """A decision process and the parameters to learn it with; shared by all realisations.

    Attributes
    ----------
    process : DecisionProcess
        States, steps, rewards and terminal states.
    learning : QLearning
        Parameters of Algorithm 1.
    """

    process: DecisionProcess
    learning: QLearning

    @classmethod
    def of(cls, world: GridWorld, agent: Agent, learning: QLearning) -> LearningProblem:
        """Apply an agent to a world.

        Raises
        ------
        WorldError
            When the agent cannot learn in this world, or makes no valid decision process of it.
        ValueError
            When the rule cannot learn the agent's states.
        """
        process = agent.decision_process(world, learning)
        process.check(world)
        if process.readings is not None and learning.rule != "q_learning":
            raise ValueError(
                f"rule: {learning.rule!r} needs a row of Q per cell, so an RssAgent with "
                "ExactStates on a map whose values all differ, or an agent that knows its state; "
                "states made from readings can only learn by 'q_learning'"
            )
        return cls(process, learning)

    @property
    def n_states(self) -> int:
        """Number S of states."""
        return self.process.n_states

    def learner(self, generators: NDArray[np.uint64], episodes: int) -> Learner:
        """Begin a realisation of at most ``episodes`` from two xoshiro256++ states (8,)."""
        if self.process.readings is not None:
            return ReadingLearner(self, self.process.readings, generators, episodes)
        return LEARNERS[self.learning.rule](self, generators, episodes)


def moves_of(process: DecisionProcess) -> Moves:
    """Arrange a decision process for the loops."""
    possible = process.action_mask
    # A stable sort brings the possible actions of each state to the front, in their order.
    order = np.argsort(~possible, axis=1, kind="stable").astype(np.uint8)
    return Moves(
        next_state=np.ascontiguousarray(process.next_state, dtype=np.int32).reshape(-1),
        possible=order.reshape(-1),
        n_possible=possible.sum(axis=1).astype(np.uint8),
        terminal=process.terminal,
        start=process.start,
    )


def parameters_of(learning: QLearning) -> Parameters:
    """Scalars of Algorithm 1 for the loops."""
    factor = math.exp(-learning.eta)
    return Parameters(
        gamma=learning.gamma,
        epsilon_min=learning.epsilon_min,
        alpha_min=learning.alpha_min,
        step_decay=factor if learning.decay == "step" else 1.0,
        episode_decay=factor if learning.decay == "episode" else 1.0,
        max_steps=learning.max_steps,
        all_actions=learning.maximum_over == "all",
        random_ties=learning.tie_break == "random",
    )


def _new_run(
    problem: LearningProblem,
    q: NDArray[np.float64],
    generators: NDArray[np.uint64],
    episodes: int,
) -> Run:
    counters = np.zeros(common.N_COUNTERS, dtype=np.int64)
    counters[common.CONVERGED_EPISODE] = counters[common.CONVERGED_STEPS] = -1
    learning = problem.learning
    return Run(
        q=q.reshape(-1),
        visits=np.zeros(problem.n_states, dtype=np.int32),
        generator=generators[:4].copy(),
        tie_generator=generators[4:].copy(),
        rates=np.array([learning.epsilon_max, learning.alpha_max]),
        counters=counters,
        episodes=np.empty((episodes, 3), dtype=np.int32),
    )


def _initial_q(problem: LearningProblem) -> NDArray[np.float64]:
    """Q (S, 8) before learning. Blocked actions are -inf unless the maximum runs over all."""
    process, learning = problem.process, problem.learning
    q = np.full(process.next_state.shape, learning.initial_q)
    if learning.maximum_over == "possible":
        q[~process.action_mask] = -np.inf
    q[process.terminal] = 0.0
    return q


class TabularLearner:
    """Q-learning with one row of Q per state."""

    trace: NDArray[np.int32] | None = None

    def __init__(
        self, problem: LearningProblem, generators: NDArray[np.uint64], episodes: int
    ) -> None:
        process = problem.process
        self.moves = moves_of(process)
        self.parameters = parameters_of(problem.learning)
        self._reward = process.reward.reshape(-1)
        self._possible = process.action_mask
        self.run = _new_run(problem, _initial_q(problem), generators, episodes)
        self.greedy = q_learning.Greedy(
            value=np.empty(problem.n_states), action=np.empty(problem.n_states, dtype=np.uint8)
        )
        q_learning.fill_greedy(self.run.q, self.greedy)

    def advance(self, until_episode: int) -> None:
        """Fly to ``until_episode``, or to the episode in which the run converges."""
        q_learning.learn(
            self.moves,
            self._reward,
            self.parameters,
            self.run,
            self.greedy,
            self.run.tie_generator if self.parameters.random_ties else None,
            until_episode,
            self.trace,
        )

    def state_values(self) -> NDArray[np.float64]:
        """Q of each state, shape (S, 8); -inf where the step is impossible."""
        return np.where(self._possible, self.run.q.reshape(-1, N_ACTIONS), -np.inf)

    def n_discrete_states(self) -> int:
        """Discrete states that the agent distinguishes: all states."""
        return self._possible.shape[0]


class TemporalDifferenceLearner:
    """Q-learning, SARSA or Double Q-learning with one row of Q per state, by the slower loop."""

    trace: NDArray[np.int32] | None = None

    def __init__(
        self,
        problem: LearningProblem,
        generators: NDArray[np.uint64],
        episodes: int,
        *,
        rule: int,
    ) -> None:
        self.moves = moves_of(problem.process)
        self.parameters = parameters_of(problem.learning)
        self._reward = problem.process.reward.reshape(-1)
        self._possible = problem.process.action_mask
        self._rule = rule
        tables = 2 if rule == temporal_difference.DOUBLE_Q else 1
        q = np.concatenate([_initial_q(problem)] * tables)
        self.run = _new_run(problem, q, generators, episodes)

    def advance(self, until_episode: int) -> None:
        """Fly to ``until_episode``, or to the episode in which the run converges."""
        temporal_difference.learn(
            self.moves,
            self._reward,
            self.parameters,
            self.run,
            self._rule,
            self.run.tie_generator if self.parameters.random_ties else None,
            until_episode,
            self.trace,
        )

    def state_values(self) -> NDArray[np.float64]:
        """Q of each state (the mean of two tables), shape (S, 8); -inf where impossible."""
        q = self.run.q.reshape(-1, *self._possible.shape).mean(axis=0)
        return np.where(self._possible, q, -np.inf)

    def n_discrete_states(self) -> int:
        """Discrete states that the agent distinguishes: all states."""
        return self._possible.shape[0]


class ReadingLearner:
    """Q-learning with one row of Q per discrete state, made from the readings."""

    trace: NDArray[np.int32] | None = None

    def __init__(
        self,
        problem: LearningProblem,
        states: ReadingStates,
        generators: NDArray[np.uint64],
        episodes: int,
    ) -> None:
        self._states = states
        self.moves = moves_of(problem.process)
        self.parameters = parameters_of(problem.learning)
        self._possible = problem.process.action_mask
        self._initial_q = problem.learning.initial_q
        q = np.full((states.max_discrete_states, N_ACTIONS), self._initial_q)
        self.run = _new_run(problem, q, generators, episodes)
        self.run.counters[common.N_DISCRETE_STATES] = states.n_initial
        self._known = q_learning_from_readings.KnownStates(
            state_of_bin=np.full(states.n_bins, -1, dtype=np.int32),
            value_dbm=np.zeros(states.max_discrete_states),
            fluctuation_db=np.zeros(1),
            no_signal=np.full(1, -1, dtype=np.int32),
        )

    def advance(self, until_episode: int) -> None:
        """Fly to ``until_episode``, or to the episode in which the run converges."""
        q_learning_from_readings.learn(
            self.moves,
            self._states.sensor,
            self.parameters,
            self.run,
            self._known,
            until_episode,
            self.trace,
        )

    def state_values(self) -> NDArray[np.float64]:
        """Q of each cell's reading without fluctuation, (S, 8); the initial Q where unknown."""
        states = np.empty(self._possible.shape[0], dtype=np.int32)
        q_learning_from_readings.steady_discrete_states(self._states.sensor, self._known, states)
        q = self.run.q.reshape(-1, N_ACTIONS)[states]
        q = np.where((states >= 0)[:, None], q, self._initial_q)
        return np.where(self._possible, q, -np.inf)

    def n_discrete_states(self) -> int:
        """Discrete states that the agent distinguishes so far."""
        return int(self.run.counters[common.N_DISCRETE_STATES])


LEARNERS: dict[LearningRule, Callable[[LearningProblem, NDArray[np.uint64], int], Learner]] = {
    "q_learning": TabularLearner,
    "sarsa": partial(TemporalDifferenceLearner, rule=temporal_difference.SARSA),
    "double_q": partial(TemporalDifferenceLearner, rule=temporal_difference.DOUBLE_Q),
}
"""Learner of each rule, for agents that know their state."""
