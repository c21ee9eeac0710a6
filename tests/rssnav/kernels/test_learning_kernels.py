"""The compiled loops against the readable twin, bit for bit, and against each other."""

from dataclasses import replace

import numpy as np
import pytest
from q_learning_twin import ToleranceTwin, Twin, Xoshiro
from small_worlds import world_of

from rssnav import (
    ExactStates,
    IntervalStates,
    LocationAgent,
    QLearning,
    RssAgent,
    ToleranceStates,
)
from rssnav.kernels import common, xoshiro
from rssnav.learning_rules import LearningProblem
from rssnav.missions.tables import sensor_tables
from rssnav.training import generator_states

# A decay that takes epsilon and alpha to their minimum within the test, and a cap that truncates.
QUICK = QLearning(eta=2e-2, max_steps=60, epsilon_min=0.1)
INTERPRETATIONS = {
    "defaults": QUICK,
    "maximum over all": replace(QUICK, maximum_over="all"),
    "random ties": replace(QUICK, tie_break="random"),
    "all, random ties": replace(QUICK, maximum_over="all", tie_break="random"),
    "decay per episode": replace(QUICK, decay="episode", eta=0.3),
    "goal instead": replace(QUICK, goal_reward_is="instead"),
    "pessimistic": replace(QUICK, initial_q=-5.0),
}


def advance(learner, episodes):
    while learner.run.counters[common.EPISODE] < episodes:
        learner.advance(episodes)
    return learner


def assert_same(learner, twin):
    """Same flights and same Q, to the last bit."""
    run = learner.run
    assert run.episodes[:, common.STEPS].tolist() == [len(path) for path in twin.paths]
    diagonal = [sum(action % 2 for action in path) for path in twin.paths]
    assert run.episodes[:, common.DIAGONAL_STEPS].tolist() == diagonal
    assert run.episodes[:, common.TRUNCATED].tolist() == [not reached for reached in twin.reached]
    assert run.counters[common.CONVERGED_EPISODE] == twin.converged_episode()
    assert np.array_equal(run.visits, twin.visits)
    q = run.q.reshape(-1, 8)
    assert all(q[entry] == value for entry, value in twin.q.items())
    assert run.rates.tolist() == [twin.epsilon, twin.alpha]


def flown(twin, episodes):
    for _ in range(episodes):
        twin.fly()
    return twin


def test_generator_equals_its_twin():
    state = np.array([1, 2, 3, 4], dtype=np.uint64)
    twin = Xoshiro(state)
    assert [int(xoshiro.draw(state)) for _ in range(100)] == [twin.bits() for _ in range(100)]


def test_generator_gives_the_published_first_values():
    """First outputs of xoshiro256++ from the state 1, 2, 3, 4 (reference implementation)."""
    state = np.array([1, 2, 3, 4], dtype=np.uint64)
    assert [int(xoshiro.draw(state)) for _ in range(3)] == [
        41943041,
        58720359,
        3588806011781223,
    ]


@pytest.mark.parametrize("learning", INTERPRETATIONS.values(), ids=INTERPRETATIONS)
@pytest.mark.parametrize("agent", [RssAgent(), LocationAgent()], ids=["rss", "location"])
def test_tabular_loop_equals_its_twin(room_world, agent, learning):
    problem = LearningProblem.of(room_world, agent, learning)
    generators = generator_states(7, 0)
    learner = advance(problem.learner(generators, 40), 40)
    assert learner.run.episodes[:, common.TRUNCATED].any()
    assert_same(learner, flown(Twin(problem.process, learning, generators), 40))


@pytest.mark.parametrize("learning", INTERPRETATIONS.values(), ids=INTERPRETATIONS)
def test_reading_loop_equals_the_tabular_one_with_a_discrete_state_per_cell(room_world, learning):
    problem = LearningProblem.of(room_world, RssAgent(), learning)
    agent, generators = RssAgent(), generator_states(8, 0)
    readings = sensor_tables(room_world.mission(), agent.task(learning), agent.observation())
    reading = LearningProblem(replace(problem.process, readings=readings), learning)
    by_reading = advance(reading.learner(generators, 40), 40)
    tabular = advance(problem.learner(generators, 40), 40)
    assert np.array_equal(by_reading.run.episodes, tabular.run.episodes)
    assert np.array_equal(by_reading.run.visits, tabular.run.visits)
    leaves = ~problem.process.terminal  # rows of terminal states are never used
    assert np.array_equal(by_reading.state_values()[leaves], tabular.state_values()[leaves])


@pytest.mark.parametrize("learning", INTERPRETATIONS.values(), ids=INTERPRETATIONS)
@pytest.mark.parametrize("threshold_db", [0.3, 2.0])
def test_tolerance_states_equal_their_twin(room_world, learning, threshold_db):
    agent = RssAgent(ToleranceStates(threshold_db))
    problem = LearningProblem.of(room_world, agent, learning)
    generators = generator_states(9, 0)
    learner = advance(problem.learner(generators, 40), 40)
    state_of = ToleranceTwin(threshold_db)
    read = room_world.rss_dbm.tolist().__getitem__
    twin = Twin(problem.process, learning, generators, state_of=state_of, read=read)
    assert_same(learner, flown(twin, 40))
    assert learner.n_discrete_states() == len(state_of.known)


def test_interval_states_equal_their_twin(room_world):
    edges = (-32.0, -28.0, -24.0)
    problem = LearningProblem.of(room_world, RssAgent(IntervalStates(edges)), QUICK)
    generators = generator_states(10, 0)
    learner = advance(problem.learner(generators, 40), 40)

    def state_of(cell, reading):
        return sum(reading >= edge for edge in edges)

    read = room_world.rss_dbm.tolist().__getitem__
    twin = Twin(problem.process, QUICK, generators, state_of=state_of, read=read)
    assert_same(learner, flown(twin, 40))


def test_cells_that_read_the_same_share_a_row(room):
    rss_dbm = np.round(world_of(room).rss_dbm)
    world = replace(world_of(room), rss_dbm=rss_dbm)
    problem = LearningProblem.of(world, RssAgent(), QUICK)
    generators = generator_states(11, 0)
    learner = advance(problem.learner(generators, 40), 40)
    assert learner.n_discrete_states() == np.unique(rss_dbm).size < world.n_states
    states = ExactStates().discrete_states(rss_dbm).tolist()
    twin = Twin(
        problem.process,
        QUICK,
        generators,
        state_of=lambda cell, reading: states[cell],
        read=rss_dbm.tolist().__getitem__,
    )
    assert_same(learner, flown(twin, 40))


def test_a_truncated_episode_bootstraps_and_a_terminated_one_does_not(room_world):
    learning = QLearning(max_steps=1, eta=0.0, epsilon_max=0.0, epsilon_min=0.0)
    problem = LearningProblem.of(room_world, LocationAgent(), learning)
    run = advance(problem.learner(generator_states(0, 0), 1), 1).run
    assert run.episodes.tolist() == [[1, 0, 1]]
    reward = problem.process.reward[room_world.start_state, 0]
    assert run.q[0] == 0.5 * 100.0 + 0.5 * (reward + 0.98 * 100.0)


def test_a_step_into_the_goal_is_worth_its_reward_alone(room):
    beside = replace(room, start=(3.5, 1.5), segments=())
    world = world_of(beside)
    learning = QLearning(max_steps=50, eta=0.0, alpha_max=1.0)
    process = LocationAgent().decision_process(world, learning)
    problem = LearningProblem.of(world, LocationAgent(), learning)
    learner = advance(problem.learner(generator_states(0, 0), 200), 200)
    goes_in = process.action_mask & process.terminal[process.next_state]
    goes_in[process.terminal] = False
    q = learner.state_values()
    tried = goes_in & (q != learning.initial_q)
    assert tried.any()
    assert np.array_equal(q[tried], process.reward[tried])
