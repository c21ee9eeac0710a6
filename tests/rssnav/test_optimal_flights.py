from dataclasses import replace

import numpy as np
import pytest
from small_worlds import SmallPlan, world_of

from rssnav import (
    LocationAgent,
    QLearning,
    RssAgent,
    greedy_path,
    shortest_path,
    train,
    value_iteration,
)
from rssnav.optimal_flights import discounted_return

AGENTS = pytest.mark.parametrize("agent", [RssAgent(), LocationAgent()], ids=["rss", "location"])


@pytest.fixture
def hall():
    """An empty hall, 12 m x 6 m."""
    return world_of(SmallPlan((12.0, 6.0), (1.0, 1.0, 1.5), (11.5, 5.5)))


def breadth_first_steps(world, terminal):
    """Fewest steps from the start to a terminal state."""
    frontier, seen, steps = {world.start_state}, {world.start_state}, 0
    while not any(terminal[state] for state in frontier):
        reached = {int(n) for s in frontier for n in world.next_state[s] if n >= 0}
        frontier, steps = reached - seen, steps + 1
        seen |= frontier
    return steps


def test_shortest_flights_in_an_empty_hall_are_those_of_a_chess_king(hall):
    """The nearest cell within 2 m is 9 columns and 4 rows away: 4 steps are diagonal."""
    terminal = hall.distance_m < 2.0
    for cost in ("steps", "metres"):
        path = shortest_path(hall, terminal, cost)
        assert path.reached
        assert path.steps == 9
        assert path.length_m == pytest.approx(5.0 + 4.0 * np.sqrt(2.0))


@pytest.mark.parametrize("speed", [1, 2])
def test_fewest_steps_equal_a_breadth_first_search(room, speed):
    world = world_of(room, speed)
    terminal = world.distance_m < 2.0
    fewest = shortest_path(world, terminal, "steps")
    shortest = shortest_path(world, terminal, "metres")
    assert fewest.steps == breadth_first_steps(world, terminal)
    assert shortest.length_m <= fewest.length_m + 1e-12
    assert shortest.steps >= fewest.steps


def test_flight_in_a_building_of_one_cell_has_no_step():
    world = world_of(SmallPlan((1.0, 1.0), (0.3, 0.5, 1.5), (0.5, 0.5)))
    path = shortest_path(world, world.distance_m < 2.0)
    assert (path.steps, path.length_m, path.reached) == (0, 0.0, True)


def test_no_goal_within_reach_is_an_error(room_world):
    with pytest.raises(ValueError, match="no terminal state can be reached"):
        shortest_path(room_world, np.zeros(room_world.n_states, dtype=bool))


@AGENTS
def test_value_iteration_satisfies_the_bellman_equation(room_world, agent):
    process = agent.decision_process(room_world, QLearning())
    solution = value_iteration(process, 0.98)
    value = np.where(process.terminal, 0.0, solution.q.max(axis=1))
    possible = process.action_mask & ~process.terminal[:, None]
    expected = process.reward + 0.98 * value[process.next_state]
    assert np.allclose(solution.q[possible], expected[possible], rtol=0.0, atol=1e-9)
    assert np.all(np.isneginf(solution.q[~process.action_mask]))


def test_the_optimal_value_of_a_corridor_is_known_in_closed_form():
    """A corridor one cell wide: n - 1 steps of reward 1/D, then one of 1/D + 1000."""
    plan = SmallPlan((9.0, 1.0), (1.0, 0.5, 1.5), (8.5, 0.5))
    world = world_of(plan)
    process = LocationAgent().decision_process(world, QLearning())
    solution = value_iteration(process, 0.9)
    distances = np.arange(6.5, 1.0, -1.0)
    discount = 0.9 ** np.arange(distances.size)
    expected = np.sum(discount / distances) + 1000.0 * discount[-1]
    assert solution.q[world.start_state].max() == pytest.approx(expected, abs=1e-8)


def test_a_discount_of_one_is_refused(room_world):
    process = RssAgent().decision_process(room_world, QLearning())
    with pytest.raises(ValueError, match="gamma"):
        value_iteration(process, 1.0)


@AGENTS
def test_the_optimal_flight_earns_the_optimal_value(room_world, agent):
    process = agent.decision_process(room_world, QLearning())
    solution = value_iteration(process, 0.98)
    path = greedy_path(room_world, process, solution.q)
    assert path.reached
    earned = discounted_return(process, path.states, 0.98)
    assert earned == pytest.approx(solution.q[room_world.start_state].max(), abs=1e-8)
    assert path.steps >= shortest_path(room_world, process.terminal).steps


@AGENTS
@pytest.mark.parametrize("speed", [1, 2])
def test_q_learning_converges_to_value_iteration(room, agent, speed):
    """All actions tried for ever at a fixed rate, in a deterministic world: Q becomes Q*."""
    world = world_of(room, speed)
    learning = QLearning(eta=0.0, max_steps=200)
    result = train(world, agent, runs=2, episodes=4000, learning=learning, keep_q=True)
    process = agent.decision_process(world, learning)
    optimal = value_iteration(process, learning.gamma).q
    learnt = process.action_mask & ~process.terminal[:, None]
    for q in result.q:
        assert np.allclose(q[learnt], optimal[learnt], rtol=0.0, atol=1e-6)


@AGENTS
def test_trained_agents_fly_nearly_optimally(room_world, agent):
    learning = QLearning(eta=1e-4, max_steps=500)
    result = train(room_world, agent, runs=5, episodes=5000, learning=learning)
    process = agent.decision_process(room_world, learning)
    best = value_iteration(process, learning.gamma).q[room_world.start_state].max()
    for states in result.trajectories:
        earned = discounted_return(process, states[states >= 0], learning.gamma)
        assert best * 0.97 <= earned <= best + 1e-9
    assert result.reached.all()


def test_a_greedy_flight_stops_where_it_begins_to_repeat(room_world):
    process = LocationAgent().decision_process(room_world, QLearning())
    there_and_back = np.where(process.action_mask, 0.0, -np.inf)
    east = room_world.next_state[room_world.start_state, 0]
    there_and_back[room_world.start_state, 0] = there_and_back[east, 4] = 1.0
    path = greedy_path(room_world, process, there_and_back)
    assert not path.reached
    assert path.states.tolist() == [0, east, 0]


def test_a_path_knows_its_length(room_world):
    process = LocationAgent().decision_process(room_world, QLearning())
    path = greedy_path(room_world, process, value_iteration(process, 0.98).q)
    action = [
        int(np.flatnonzero(room_world.next_state[a] == b)[0])
        for a, b in zip(path.states[:-1], path.states[1:], strict=True)
    ]
    assert path.length_m == pytest.approx(room_world.step_length_m[action].sum())


def test_shortest_path_by_metres_takes_steps_to_save_length(room):
    """In a world without cheap diagonals the two costs part."""
    world = world_of(room)
    dear = replace(world, step_length_m=np.where(np.arange(8) % 2, 3.0, 1.0))
    terminal = world.distance_m < 2.0
    fewest = shortest_path(dear, terminal, "steps")
    shortest = shortest_path(dear, terminal, "metres")
    assert shortest.steps > fewest.steps
