"""SARSA and Double Q-learning against their twins, against Q-learning, and against exact values."""

from dataclasses import replace

import numpy as np
import pytest
from q_learning_twin import Twin, low_index
from small_worlds import SmallPlan, world_of

from rssnav import IntervalStates, LocationAgent, QLearning, RssAgent, train, value_iteration
from rssnav.kernels import common
from rssnav.learning_rules import LearningProblem
from rssnav.training import generator_states

QUICK = QLearning(eta=2e-2, max_steps=60, epsilon_min=0.1)
INTERPRETATIONS = {
    "defaults": QUICK,
    "maximum over all": replace(QUICK, maximum_over="all"),
    "random ties": replace(QUICK, tie_break="random"),
    "decay per episode": replace(QUICK, decay="episode", eta=0.3),
}
AGENTS = pytest.mark.parametrize("agent", [RssAgent(), LocationAgent()], ids=["rss", "location"])


class TwoTables(Twin):
    """SARSA or Double Q-learning in plain Python; the first part of a key is the table."""

    def ranked(self, state: int) -> list[float]:
        tables = 2 if self.learning.rule == "double_q" else 1
        return [sum(self.value((t, state), a) for t in range(tables)) for a in range(8)]

    def choose(self, cell: int, state: int) -> int:
        score = self.ranked(cell)
        best = max(score[a] for a in self.counted(cell))
        ties = [a for a in self.counted(cell) if score[a] == best]
        action = ties[0]
        if self.learning.tie_break == "random":
            action = ties[low_index(self.tie_generator.bits(), len(ties))]
        bits = self.generator.bits()
        blocked = self.process.next_state[cell, action] < 0
        if (bits >> 32) * 2.0**-32 < self.epsilon or blocked:
            possible = self.possible(cell)
            action = possible[low_index(bits, len(possible))]
        return action

    def fly(self):
        self.decay("episode")
        sarsa = self.learning.rule == "sarsa"
        cell, path, terminated, following = self.process.start, [], False, None
        self.visits[cell] += 1
        while not terminated and len(path) < self.learning.max_steps:
            self.decay("step")
            action = self.choose(cell, cell) if following is None else following
            arrived = int(self.process.next_state[cell, action])
            terminated = bool(self.process.terminal[arrived])
            table = 0 if sarsa else self.generator.bits() >> 63
            future = 0.0
            if not terminated and sarsa:
                following = self.choose(arrived, arrived)
                future = self.value((0, arrived), following)
            elif not terminated:
                best = max(self.counted(arrived), key=lambda a: self.value((table, arrived), a))
                future = self.value((1 - table, arrived), best)
            target = float(self.process.reward[cell, action]) + self.learning.gamma * future
            old = self.value((table, cell), action)
            new = (1.0 - self.alpha) * old + self.alpha * target
            self.q[(table, cell), action] = new
            path.append(action)
            self.visits[arrived] += 1
            cell = arrived
        self.paths.append(path)
        self.reached.append(terminated)


def advance(learner, episodes):
    while learner.run.counters[common.EPISODE] < episodes:
        learner.advance(episodes)
    return learner


@AGENTS
@pytest.mark.parametrize("rule", ["sarsa", "double_q"])
@pytest.mark.parametrize("reading", INTERPRETATIONS.values(), ids=INTERPRETATIONS)
def test_the_loop_equals_its_twin(room_world, agent, rule, reading):
    learning = replace(reading, rule=rule)
    problem = LearningProblem.of(room_world, agent, learning)
    run = advance(problem.learner(generator_states(3, 0), 40), 40).run
    twin = TwoTables(problem.process, learning, generator_states(3, 0))
    for _ in range(40):
        twin.fly()
    assert run.episodes[:, common.STEPS].tolist() == [len(path) for path in twin.paths]
    assert run.counters[common.CONVERGED_EPISODE] == twin.converged_episode()
    assert np.array_equal(run.visits, twin.visits)
    q = run.q.reshape(-1, room_world.n_states, 8)
    assert all(q[table, state, a] == value for ((table, state), a), value in twin.q.items())


@AGENTS
@pytest.mark.parametrize("learning", INTERPRETATIONS.values(), ids=INTERPRETATIONS)
def test_with_the_maximum_it_is_the_fast_loop_to_the_last_bit(room_world, agent, learning):
    problem = LearningProblem.of(room_world, agent, learning)
    generators = generator_states(5, 0)
    fast = advance(problem.learner(generators, 40), 40)
    slow = problem.learner(generators, 40, row_maxima=False)
    advance(slow, 40)
    assert np.array_equal(fast.run.episodes, slow.run.episodes)
    assert np.array_equal(fast.run.q, slow.run.q)
    assert np.array_equal(fast.run.counters, slow.run.counters)


@AGENTS
def test_sarsa_that_never_explores_is_q_learning(room_world, agent):
    greedy = replace(QUICK, epsilon_max=0.0, epsilon_min=0.0)
    options = {"runs": 1, "episodes": 100, "keep_q": True}
    q_learning = train(room_world, agent, learning=greedy, **options)
    sarsa = train(room_world, agent, learning=replace(greedy, rule="sarsa"), **options)
    assert np.array_equal(q_learning.q, sarsa.q)
    assert np.array_equal(q_learning.steps, sarsa.steps)


def corridor_world():
    """A 6 m x 1 m corridor: only east and west are possible."""
    return world_of(SmallPlan((6.0, 1.0), (0.3, 0.5, 1.5), (4.5, 0.5)))


def random_policy_values(process, gamma):
    """Q of the policy that picks any possible action, by solving its linear equations."""
    possible = process.action_mask
    chance = np.where(possible, 1.0, 0.0) / possible.sum(axis=1, keepdims=True)
    chance[process.terminal] = 0.0
    states = np.arange(process.terminal.size)
    onward = np.zeros((states.size, states.size))
    np.add.at(onward, (np.repeat(states, 8), process.next_state.reshape(-1)), chance.reshape(-1))
    value = np.linalg.solve(np.eye(states.size) - gamma * onward, (chance * process.reward).sum(1))
    return process.reward + gamma * value[process.next_state]


EXPLORING = QLearning(epsilon_min=1.0, eta=2e-5, alpha_min=1e-3, goal_reward=10.0, gamma=0.9)


def test_sarsa_learns_the_values_of_the_policy_it_flies():
    world, learning = corridor_world(), replace(EXPLORING, rule="sarsa")
    process = RssAgent().decision_process(world, learning)
    result = train(world, RssAgent(), runs=1, episodes=40_000, learning=learning, keep_q=True)
    leaves = process.action_mask & ~process.terminal[:, None]
    expected = random_policy_values(process, learning.gamma)
    assert np.allclose(result.q[0][leaves], expected[leaves], rtol=0.02)


def test_double_q_learns_the_optimal_values():
    world, learning = corridor_world(), replace(EXPLORING, rule="double_q")
    process = RssAgent().decision_process(world, learning)
    result = train(world, RssAgent(), runs=1, episodes=5_000, learning=learning, keep_q=True)
    leaves = process.action_mask & ~process.terminal[:, None]
    expected = value_iteration(process, learning.gamma).q
    assert np.allclose(result.q[0][leaves], expected[leaves], rtol=1e-9)


@pytest.mark.parametrize("rule", ["sarsa", "double_q"])
def test_states_made_from_readings_are_refused(room_world, rule):
    agent = RssAgent(IntervalStates((-40.0, -30.0)))
    with pytest.raises(ValueError, match=r"rule: .* needs a row of Q per cell"):
        train(room_world, agent, runs=1, learning=QLearning(rule=rule))


def test_a_rule_survives_the_file(room_world, tmp_path):
    learning = replace(QUICK, rule="double_q")
    result = train(room_world, RssAgent(), runs=2, episodes=20, learning=learning, keep_q=True)
    result.save(tmp_path / "result.h5")
    loaded = type(result).load(tmp_path / "result.h5")
    assert loaded.learning == learning
    assert np.array_equal(loaded.q, result.q)
