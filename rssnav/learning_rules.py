"""The learning rules behind one interface: which rows and tables the loop of learning gets.

:data:`RULES` names the rule of each value of
:attr:`QLearning.rule <rssnav.learning_parameters.QLearning.rule>`. A new rule is a name in
:data:`~rssnav.learning_parameters.LearningRule`, its value of the next state in
:mod:`rssnav.kernels.learning`, and a row here.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rssnav.agents import Agent
from rssnav.decision_process import DecisionProcess
from rssnav.kernels import common, learning, reading_states
from rssnav.kernels.common import Parameters, Run
from rssnav.kernels.stepping import Moves, Sensor
from rssnav.learning_parameters import LearningRule, QLearning
from rssnav.missions.tables import SensorTables, moves_of
from rssnav.world import ACTION_NAMES, GridWorld

N_ACTIONS = len(ACTION_NAMES)

RULES: dict[LearningRule, int] = {
    "q_learning": learning.Q_LEARNING,
    "sarsa": learning.SARSA,
    "double_q": learning.DOUBLE_Q,
}


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

    def learner(
        self, generators: NDArray[np.uint64], episodes: int, *, row_maxima: bool = True
    ) -> Learner:
        """Begin a realisation.

        Parameters
        ----------
        generators : (8,) uint64
            States of two xoshiro256++ generators.
        episodes : int
            Most episodes that it will fly.
        row_maxima : bool
            Keep the maximum of each row beside the table where that is possible, which is faster
            and gives the same results.
        """
        process, parameters = self.process, self.learning
        moves = process_moves(process)
        if process.readings is not None:
            q = np.full((process.readings.n_rows, N_ACTIONS), parameters.initial_q)
            return Learner(moves, process.readings, parameters, q, (generators, episodes))
        tables = 2 if parameters.rule == "double_q" else 1
        q = np.concatenate([_initial_q(process, parameters)] * tables)
        learner = Learner(moves, None, parameters, q, (generators, episodes))
        if row_maxima and parameters.rule == "q_learning":
            learner.keep_row_maxima()
        return learner


def process_moves(process: DecisionProcess) -> Moves:
    """Arrange a decision process for the loops."""
    return moves_of(
        process.next_state,
        np.array([process.start]),
        np.ones(1),
        np.ascontiguousarray(process.reward, dtype=np.float64),
        process.terminal,
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
        rule=RULES[learning.rule],
    )


def _initial_q(process: DecisionProcess, learning: QLearning) -> NDArray[np.float64]:
    """Q (S, 8) before learning. Blocked actions are -inf unless the maximum runs over all."""
    q = np.full(process.next_state.shape, learning.initial_q)
    if learning.maximum_over == "possible":
        q[~process.action_mask] = -np.inf
    q[process.terminal] = 0.0
    return q


class Learner:
    """A Q-table that learns by flying episodes.

    Parameters
    ----------
    moves : Moves
        Steps and starts; rewards and terminal states where nothing is read.
    readings : SensorTables or None
        How readings become rows of Q, and what steps are worth.
    parameters : QLearning
        Parameters of Algorithm 1.
    q : (rows, 8) float64
        Q before learning; for Double Q-learning both tables, one after the other.
    realisation : ((8,) uint64, int)
        States of two xoshiro256++ generators, and the most episodes to be flown.

    Attributes
    ----------
    run : Run
        All that it has learned and counted.
    trace : (max_steps,) int32, or None
        Receives the states that an episode arrives at; each episode overwrites the one before.
    """

    trace: NDArray[np.int32] | None = None

    def __init__(
        self,
        moves: Moves,
        readings: SensorTables | None,
        parameters: QLearning,
        q: NDArray[np.float64],
        realisation: tuple[NDArray[np.uint64], int],
    ) -> None:
        self.moves = moves
        self.sensor: Sensor | None = None if readings is None else readings.of_one_run()
        self.parameters = parameters_of(parameters)
        self.greedy: learning.Greedy | None = None
        self.run = _new_run(moves, parameters, q, realisation)
        self._initial_q = parameters.initial_q
        self._possible = moves.next_state.reshape(-1, N_ACTIONS) >= 0
        self._random_ties = parameters.tie_break == "random"

    def keep_row_maxima(self) -> None:
        """Keep the maximum of each row and the first action that attains it."""
        n = self.run.q.size // N_ACTIONS
        self.greedy = learning.Greedy(np.empty(n), np.empty(n, dtype=np.uint8))
        learning.fill_greedy(self.run.q, self.greedy)

    def advance(self, until_episode: int) -> None:
        """Fly to ``until_episode``, or to the episode in which the run converges."""
        learning.learn(
            self.moves,
            self.sensor,
            self.parameters,
            self.run,
            self.greedy,
            self.run.tie_generator if self._random_ties else None,
            until_episode,
            self.trace,
        )

    def rows(self) -> NDArray[np.float64]:
        """Q of each row, the mean of two tables for Double Q-learning, shape (rows, 8)."""
        tables = 2 if self.parameters.rule == learning.DOUBLE_Q else 1
        return self.run.q.reshape(tables, -1, N_ACTIONS).mean(axis=0)

    def state_values(self) -> NDArray[np.float64]:
        """Q of each state, shape (S, 8); -inf where the step is impossible.

        For rows made from readings: that of the reading without fluctuation; the initial Q where
        that is unknown.
        """
        if self.sensor is None:
            return np.where(self._possible, self.rows(), -np.inf)
        states = np.empty(self._possible.shape[0], dtype=np.int32)
        reading_states.steady_discrete_states(self.sensor, states)
        q = np.where((states >= 0)[:, None], self.rows()[states], self._initial_q)
        return np.where(self._possible, q, -np.inf)

    def n_discrete_states(self) -> int:
        """Discrete states that the agent distinguishes so far."""
        if self.sensor is None:
            return self._possible.shape[0]
        return int(self.sensor.rows.n_known[0])


def _new_run(
    moves: Moves,
    parameters: QLearning,
    q: NDArray[np.float64],
    realisation: tuple[NDArray[np.uint64], int],
) -> Run:
    generators, episodes = realisation
    counters = np.zeros(common.N_COUNTERS, dtype=np.int64)
    counters[common.CONVERGED_EPISODE] = counters[common.CONVERGED_STEPS] = -1
    return Run(
        q=q.reshape(-1),
        visits=np.zeros(moves.n_possible.size, dtype=np.int32),
        generator=generators[:4].copy(),
        tie_generator=generators[4:].copy(),
        rates=np.array([parameters.epsilon_max, parameters.alpha_max]),
        whole=np.zeros(5, dtype=np.int64),
        real=np.zeros(3),
        counters=counters,
        episodes=np.empty((episodes, 3), dtype=np.int32),
    )
