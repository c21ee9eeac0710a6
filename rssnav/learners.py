"""One realisation of learning: the loop's arrays, and the loops behind one interface."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from rssnav.agents import Agent, DecisionProcess, QLearning, RssAgent
from rssnav.kernels import common, sensed, tabular, temporal_difference
from rssnav.kernels.common import Moves, Parameters, Run
from rssnav.states import ExactStates, GoalRule, SensedStates, sensed_states
from rssnav.world import GridWorld

N_ACTIONS = 8

_RULES = {
    "sarsa": temporal_difference.SARSA,
    "double_q": temporal_difference.DOUBLE_Q,
}


class Learner(Protocol):
    """A Q-table that learns by flying episodes.

    Attributes
    ----------
    run : Run
        Everything it has learnt and counted.
    trace : (max_steps,) int32, or None
        Where it is to write the states that an episode arrives at; the latest episode stays.
    """

    run: Run
    trace: NDArray[np.int32] | None

    def advance(self, until_episode: int) -> None:
        """Fly to ``until_episode``, or to the episode in which the run converges."""
        ...

    def cell_values(self) -> NDArray[np.float64]:
        """Q of each cell's steady reading, shape (S, 8); -inf where the step is impossible."""
        ...

    def n_labels(self) -> int:
        """States the agent tells apart so far."""
        ...


@dataclass(frozen=True, eq=False)
class LearningProblem:
    """World, agent and parameters in the loops' terms; shared by all realisations.

    Attributes
    ----------
    process : DecisionProcess
        Rewards and terminal states for steady readings.
    learning : QLearning
        Parameters of Algorithm 1.
    states : SensedStates or None
        How readings become labels; None when every cell has its own row of Q.
    """

    process: DecisionProcess
    learning: QLearning
    states: SensedStates | None

    @classmethod
    def of(cls, world: GridWorld, agent: Agent, learning: QLearning) -> LearningProblem:
        """Apply an agent to a world.

        Raises
        ------
        WorldError
            When the agent cannot learn in this world.
        ValueError
            When the rule cannot learn the agent's states.
        """
        process = agent.decision_process(world, learning)
        states = None
        if isinstance(agent, RssAgent) and not _has_a_row_per_cell(agent, world):
            goal = GoalRule(
                agent.terminal_dbm, learning.goal_reward, learning.goal_reward_is == "instead"
            )
            states = sensed_states(agent.states, agent.fluctuation, world.rss_dbm, goal)
        if states is not None and learning.rule != "q_learning":
            raise ValueError(
                f"rule: {learning.rule!r} needs a row of Q per cell, so an RssAgent with "
                "ExactStates on a map whose values all differ, or a LocationAgent; states made "
                "from readings can only learn by 'q_learning'"
            )
        return cls(process, learning, states)

    @property
    def n_states(self) -> int:
        """Number S of cells."""
        return self.process.next_state.shape[0]

    def learner(self, generators: NDArray[np.uint64], episodes: int) -> Learner:
        """Begin a realisation of at most ``episodes`` from two xoshiro256++ states (8,)."""
        if self.learning.rule != "q_learning":
            rule = _RULES[self.learning.rule]
            return TemporalDifferenceLearner(self, generators, episodes, rule)
        if self.states is None:
            return TabularLearner(self, generators, episodes)
        return SensedLearner(self, self.states, generators, episodes)


def _has_a_row_per_cell(agent: RssAgent, world: GridWorld) -> bool:
    unique = np.unique(world.rss_dbm).size == world.n_states
    return isinstance(agent.states, ExactStates) and unique


def moves_of(process: DecisionProcess) -> Moves:
    """Lay a decision process out for the loops."""
    possible = process.next_state >= 0
    # A stable sort brings the possible actions of each state to the front, in their order.
    order = np.argsort(~possible, axis=1, kind="stable").astype(np.uint8)
    return Moves(
        next_state=process.next_state.reshape(-1),
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
        q[process.next_state < 0] = -np.inf
    q[process.terminal] = 0.0
    return q


class TabularLearner:
    """Q-learning with one row of Q per cell."""

    trace: NDArray[np.int32] | None = None

    def __init__(
        self, problem: LearningProblem, generators: NDArray[np.uint64], episodes: int
    ) -> None:
        process = problem.process
        self.moves = moves_of(process)
        self.parameters = parameters_of(problem.learning)
        self._reward = process.reward.reshape(-1)
        self._blocked = process.next_state < 0
        self.run = _new_run(problem, _initial_q(problem), generators, episodes)
        self.greedy = tabular.Greedy(
            value=np.empty(problem.n_states), action=np.empty(problem.n_states, dtype=np.uint8)
        )
        tabular.fill_greedy(self.run.q, self.greedy)

    def advance(self, until_episode: int) -> None:
        """Fly to ``until_episode``, or to the episode in which the run converges."""
        tabular.learn(
            self.moves,
            self._reward,
            self.parameters,
            self.run,
            self.greedy,
            self.run.tie_generator if self.parameters.random_ties else None,
            until_episode,
            self.trace,
        )

    def cell_values(self) -> NDArray[np.float64]:
        """Q of each cell, shape (S, 8); -inf where the step is impossible."""
        return np.where(self._blocked, -np.inf, self.run.q.reshape(-1, N_ACTIONS))

    def n_labels(self) -> int:
        """States the agent tells apart: the cells."""
        return self._blocked.shape[0]


class TemporalDifferenceLearner:
    """Q-learning, SARSA or Double Q-learning with one row per cell, by the slower loop."""

    trace: NDArray[np.int32] | None = None

    def __init__(
        self,
        problem: LearningProblem,
        generators: NDArray[np.uint64],
        episodes: int,
        rule: int,
    ) -> None:
        self.moves = moves_of(problem.process)
        self.parameters = parameters_of(problem.learning)
        self._reward = problem.process.reward.reshape(-1)
        self._blocked = problem.process.next_state < 0
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

    def cell_values(self) -> NDArray[np.float64]:
        """Q of each cell (of two tables the mean), shape (S, 8); -inf where impossible."""
        q = self.run.q.reshape(-1, *self._blocked.shape).mean(axis=0)
        return np.where(self._blocked, -np.inf, q)

    def n_labels(self) -> int:
        """States the agent tells apart: the cells."""
        return self._blocked.shape[0]


class SensedLearner:
    """A row of Q per label, labels made from the readings."""

    trace: NDArray[np.int32] | None = None

    def __init__(
        self,
        problem: LearningProblem,
        states: SensedStates,
        generators: NDArray[np.uint64],
        episodes: int,
    ) -> None:
        self._states = states
        self.moves = moves_of(problem.process)
        self.parameters = parameters_of(problem.learning)
        self._blocked = problem.process.next_state < 0
        self._initial_q = problem.learning.initial_q
        q = np.full((states.max_labels, N_ACTIONS), self._initial_q)
        self.run = _new_run(problem, q, generators, episodes)
        self.run.counters[common.N_LABELS] = states.n_listed
        self._book = sensed.Book(
            label_of_bin=np.full(states.n_bins, -1, dtype=np.int32),
            value_dbm=np.zeros(states.max_labels),
            fluctuation_db=np.zeros(1),
        )

    def advance(self, until_episode: int) -> None:
        """Fly to ``until_episode``, or to the episode in which the run converges."""
        sensed.learn(
            self.moves,
            self._states.sensor,
            self.parameters,
            self.run,
            self._book,
            until_episode,
            self.trace,
        )

    def cell_values(self) -> NDArray[np.float64]:
        """Q of each cell's steady reading, shape (S, 8); the initial Q where no state fits it."""
        labels = np.empty(self._blocked.shape[0], dtype=np.int32)
        sensed.steady_labels(self._states.sensor, self._book, labels)
        q = self.run.q.reshape(-1, N_ACTIONS)[labels]
        q = np.where((labels >= 0)[:, None], q, self._initial_q)
        return np.where(self._blocked, -np.inf, q)

    def n_labels(self) -> int:
        """States the agent tells apart so far."""
        return int(self.run.counters[common.N_LABELS])
