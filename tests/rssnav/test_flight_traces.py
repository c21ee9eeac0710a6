"""A learner that is asked to writes down where it flies, and learns the same."""

from __future__ import annotations

import numpy as np
import pytest

from rssnav import Fluctuation, LocationAgent, QLearning, RssAgent, ToleranceStates
from rssnav.kernels import common
from rssnav.learning_rules import LearningProblem
from rssnav.training import generator_states

EPISODES = 30
LEARNERS = {
    "tabular": (LocationAgent(), QLearning(eta=1e-3)),
    "random ties": (RssAgent(), QLearning(eta=1e-3, tie_break="random")),
    "sensed": (RssAgent(ToleranceStates(2.0), -25.0, Fluctuation(0.5)), QLearning(eta=1e-3)),
    "sarsa": (LocationAgent(), QLearning(eta=1e-3, rule="sarsa")),
}


@pytest.mark.parametrize(("agent", "learning"), LEARNERS.values(), ids=LEARNERS)
def test_trace_is_the_flight_and_changes_nothing(room_world, agent, learning) -> None:
    problem = LearningProblem.of(room_world, agent, learning)
    traced, plain = (problem.learner(generator_states(3, 0), EPISODES) for _ in range(2))
    traced.trace = np.empty(learning.max_steps, dtype=np.int32)
    visits = np.zeros(problem.n_states, dtype=np.int64)
    for episode in range(EPISODES):
        traced.advance(episode + 1)
        steps, diagonal, truncated = traced.run.episodes[episode]
        flight = np.concatenate(([problem.process.start], traced.trace[:steps]))
        steps_taken = problem.process.next_state[flight[:-1]] == flight[1:, None]
        action = np.argmax(steps_taken, axis=1)
        assert steps_taken.any(axis=1).all()
        assert np.count_nonzero(action % 2) == diagonal
        if problem.process.readings is None:
            assert problem.process.terminal[flight[-1]] == (not truncated)
        visits += np.bincount(flight, minlength=problem.n_states)
    np.testing.assert_array_equal(visits, traced.run.visits)
    while plain.run.counters[common.EPISODE] < EPISODES:
        plain.advance(EPISODES)
    np.testing.assert_array_equal(plain.run.q, traced.run.q)
    np.testing.assert_array_equal(plain.run.episodes, traced.run.episodes)
