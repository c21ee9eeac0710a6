"""Fluctuating readings against their NumPy twin, alone and within the learning loop."""

from __future__ import annotations

import numpy as np
import pytest
from q_learning_twin import ToleranceTwin, Twin, Xoshiro
from rss_fluctuation_twin import fluctuation_db

from rssnav import Fluctuation, QLearning, RssAgent, ToleranceStates
from rssnav.kernels import common
from rssnav.kernels.stepping import fluctuating
from rssnav.learning_rules import LearningProblem
from rssnav.training import generator_states


@pytest.mark.parametrize("sigma_db", [0.0, 0.5, 3.0])
@pytest.mark.parametrize("correlation", [0.0, 0.5, 0.95])
def test_readings_equal_their_twin(sigma_db, correlation):
    state = generator_states(4, 0)[:4].copy()
    mean_dbm = -50.0 + np.sin(np.arange(500))
    twin = fluctuation_db(Xoshiro(state), mean_dbm.size, sigma_db, correlation)
    last_db = np.zeros(1)
    readings = [fluctuating(m, sigma_db, correlation, last_db, state) for m in mean_dbm]
    np.testing.assert_allclose(readings - mean_dbm, twin, rtol=0.0, atol=1e-12)
    assert last_db[0] == pytest.approx(twin[-1], abs=1e-12)


@pytest.mark.parametrize("correlation", [0.0, 0.8])
def test_the_loop_draws_a_reading_after_each_choice(room_world, correlation):
    """One generator serves choices and readings; the twin draws in the loop's order."""
    fluctuation = Fluctuation(1.0, correlation)
    agent = RssAgent(ToleranceStates(1.0), -25.0, fluctuation)
    learning = QLearning(eta=2e-2, max_steps=60, epsilon_min=0.1)
    problem = LearningProblem.of(room_world, agent, learning)
    generators = generator_states(5, 0)
    learner = problem.learner(generators, 40)
    while learner.run.counters[common.EPISODE] < 40:
        learner.advance(40)
    known, last_db = ToleranceTwin(1.0), [0.0]

    def read(cell):
        new_db = fluctuation_db(twin.generator, 1, fluctuation.sigma_db, correlation)[0]
        last_db[0] = correlation * last_db[0] + new_db
        return float(room_world.rss_dbm[cell] + last_db[0])

    twin = Twin(
        problem.process, learning, generators, state_of=known, read=read, terminal_dbm=-25.0
    )
    for _ in range(40):
        twin.fly()
    assert learner.run.episodes[:, common.STEPS].tolist() == [len(path) for path in twin.paths]
    assert np.array_equal(learner.run.visits, twin.visits)
    assert learner.n_discrete_states() == len(known.known)
    q = learner.run.q.reshape(-1, 8)
    for entry, value in twin.q.items():
        assert q[entry] == pytest.approx(value, rel=1e-9)
