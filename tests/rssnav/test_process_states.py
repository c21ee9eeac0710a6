"""A state of a decision process need not be a cell: an agent that pays for turns."""

from __future__ import annotations

from dataclasses import replace
from heapq import heappop, heappush
from itertools import pairwise

import numpy as np
import pytest
from heading_agent import N_HEADINGS, HeadingAgent
from small_worlds import SmallPlan, world_of

from rssnav import (
    DecisionProcess,
    LocationAgent,
    QLearning,
    RssAgent,
    TrainingResult,
    WorldError,
    greedy_path,
    shortest_path,
    train,
    value_iteration,
)
from rssnav.kernels import common
from rssnav.learning_rules import RULES, LearningProblem
from rssnav.optimal_flights import path_length_m
from rssnav.training import generator_states

LEARNING = QLearning(gamma=0.95, eta=1e-4, initial_q=200.0, max_steps=500)


def flown_turns(world, cells):
    """Turns of 45 degrees of a flight through cells, the first from heading east."""
    actions = [int(np.flatnonzero(world.next_state[a] == b)[0]) for a, b in pairwise(cells)]
    difference = np.abs(np.diff([0, *actions]))
    return int(np.minimum(difference, 8 - difference).sum())


def cheapest(world, price_per_turn):
    """Least length and price of turns of a flight to the goal, by Dijkstra's algorithm."""
    queue, done = [(0.0, world.start_state, 0)], set()
    while queue:
        cost, cell, heading = heappop(queue)
        if world.distance_m[cell] < 2.0:
            return cost
        if (cell, heading) not in done:
            done.add((cell, heading))
            for action in np.flatnonzero(world.action_mask[cell]).tolist():
                turn = min(abs(action - heading), 8 - abs(action - heading))
                step = world.step_length_m[action] + price_per_turn * turn
                heappush(queue, (cost + step, int(world.next_state[cell, action]), action))
    raise AssertionError("the goal cannot be reached")


@pytest.fixture
def slalom():
    """Between two walls a short flight of many turns, above both a long one of few."""
    walls = (((8.0, 0.0), (8.0, 2.0)), ((5.0, 2.0), (5.0, 5.0)))
    return world_of(SmallPlan((12.0, 7.0), (1.0, 1.0, 1.5), (10.5, 1.5), walls))


@pytest.fixture
def process(room_world):
    return HeadingAgent().decision_process(room_world, LEARNING)


def best_flight(world, price_per_turn):
    process = HeadingAgent(price_per_turn).decision_process(world, LEARNING)
    return greedy_path(world, process, value_iteration(process, 0.9999).q)


def test_where_a_state_is_a_cell_the_table_is_left_out(room_world):
    process = LocationAgent().decision_process(room_world, QLearning())
    assert np.array_equal(process.cell_of_state, np.arange(room_world.n_states))


def test_planning_trades_length_for_turns(slalom):
    few_turns, short = best_flight(slalom, 50.0), best_flight(slalom, 0.0)
    for price, path in ((50.0, few_turns), (0.0, short)):
        assert path.reached
        assert np.array_equal(path.cells, path.states // N_HEADINGS)
        assert path.cells[0] == slalom.start_state
        assert path.length_m == path_length_m(slalom, path.cells)
        cost = path.length_m + price * flown_turns(slalom, path.cells)
        assert cost == pytest.approx(cheapest(slalom, price))
    assert flown_turns(slalom, few_turns.cells) < flown_turns(slalom, short.cells)
    assert few_turns.length_m > short.length_m
    shortest = shortest_path(slalom, slalom.distance_m < 2.0, "metres")
    assert short.length_m == pytest.approx(shortest.length_m)


@pytest.mark.parametrize("rule", RULES)
def test_it_is_trained_and_its_visits_and_flights_are_cells(room_world, rule):
    learning = replace(LEARNING, rule=rule)
    result = train(
        room_world,
        HeadingAgent(),
        runs=3,
        episodes=600,
        learning=learning,
        snapshot_episodes=(50, 600),
        keep_q=True,
    )
    n_cells = room_world.n_states
    assert result.visit_counts.shape == (2, n_cells)
    assert result.visits.shape == (2, *room_world.shape)
    flown = result.steps[:, :600].sum() + result.steps.size  # the start counts
    assert result.visit_counts[1].sum() == flown
    assert result.q.shape == (3, N_HEADINGS * n_cells, 8)
    assert np.all(result.n_discrete_states == N_HEADINGS * n_cells)
    assert result.reached.all()
    for index, cells in enumerate(result.trajectories):
        cells = cells[cells >= 0]
        assert cells[0] == room_world.start_state
        assert np.all(np.any(room_world.next_state[cells[:-1]] == cells[1:, None], axis=1))
        assert room_world.distance_m[cells[-1]] < 2.0
        assert result.path_length_m[index] == path_length_m(room_world, cells)
        assert np.array_equal(result.trajectory_m(index), room_world.position[cells])


def test_learning_converges_to_value_iteration(room_world, process):
    """Without noise a learning rate of 1 is allowed, and with it Q becomes exact."""
    random = {"epsilon_max": 1.0, "epsilon_min": 1.0, "alpha_max": 1.0, "alpha_min": 1.0}
    learning = replace(LEARNING, **random)
    result = train(
        room_world, HeadingAgent(), runs=1, episodes=3000, learning=learning, keep_q=True
    )
    solution = value_iteration(process, learning.gamma)
    flown = process.action_mask & (result.q[0] != learning.initial_q)
    assert np.count_nonzero(flown[:, 0]) > room_world.n_states
    np.testing.assert_allclose(result.q[0][flown], solution.q[flown], atol=1e-9)
    best = greedy_path(room_world, process, solution.q)
    assert result.path_length_m[0] == pytest.approx(best.length_m)


def test_lengths_of_episodes_are_those_of_the_flown_cells(room_world):
    problem = LearningProblem.of(room_world, HeadingAgent(), LEARNING)
    learner = problem.learner(generator_states(0, 0), 1)
    learner.trace = np.empty(LEARNING.max_steps, dtype=np.int32)
    learner.advance(1)
    steps, diagonal, _ = learner.run.episodes[0]
    states = np.concatenate(([problem.process.start], learner.trace[:steps]))
    straight_m, diagonal_m = room_world.step_length_m[:2]
    assert (steps - diagonal) * straight_m + diagonal * diagonal_m == pytest.approx(
        path_length_m(room_world, problem.process.cell_of_state[states])
    )
    assert learner.run.visits.sum() == steps + 1
    visits = problem.process.per_cell(learner.run.visits, room_world.n_states)
    expected = np.bincount(states // N_HEADINGS, minlength=room_world.n_states)
    assert np.array_equal(visits, expected)
    assert learner.run.counters[common.EPISODE] == 1


def test_its_result_is_saved_loaded_and_resumed(room_world, tmp_path):
    agent = HeadingAgent(1.5)
    part = train(
        room_world, agent, runs=3, episodes=20, learning=LEARNING, only_runs=[1], keep_q=True
    )
    part.save(tmp_path / "part.h5")
    loaded = TrainingResult.load(tmp_path / "part.h5", agents=[HeadingAgent])
    assert loaded.agent == agent
    assert np.array_equal(loaded.cell_of_state, part.cell_of_state)
    assert np.array_equal(loaded.q, part.q)
    resumed = train(room_world, agent, runs=3, episodes=20, learning=LEARNING, resume=loaded)
    whole = train(room_world, agent, runs=3, episodes=20, learning=LEARNING)
    assert np.array_equal(resumed.steps, whole.steps)
    assert np.array_equal(resumed.trajectories, whole.trajectories)


@pytest.mark.parametrize("agent", [RssAgent(), HeadingAgent()], ids=["rss", "heading"])
def test_action_masks_are_the_possible_steps(room_world, agent):
    process = agent.decision_process(room_world, LEARNING)
    assert np.array_equal(room_world.action_mask, room_world.next_state >= 0)
    assert np.array_equal(process.action_mask, room_world.action_mask[process.cell_of_state])
    for mask in (room_world.action_mask, process.action_mask):
        assert mask.dtype == bool
        with pytest.raises(ValueError, match="read-only"):
            mask[0, 0] = True


def changed(process, **changes):
    fields = ("next_state", "reward", "terminal", "start", "cell_of_state")
    return DecisionProcess(**{name: getattr(process, name) for name in fields} | changes)


def through_a_wall(process, world):
    next_state = process.next_state.copy()
    state, action = np.argwhere(~process.action_mask & ~process.terminal[:, None])[0]
    next_state[state, action] = 0
    return changed(process, next_state=next_state)


def to_another_cell(process, world):
    next_state = process.next_state.copy()
    state, action = np.argwhere(process.action_mask)[0]
    next_state[state, action] = state
    return changed(process, next_state=next_state)


def without_an_action(process, world):
    next_state = process.next_state.copy()
    next_state[process.start] = -1
    return changed(process, next_state=next_state)


WRONG = {
    "through a wall": (through_a_wall, r"next_state must follow world.next_state, or be -1"),
    "to another cell": (to_another_cell, r"next_state must follow world.next_state"),
    "without an action": (without_an_action, r"has no possible action and is not terminal"),
    "reward's shape": (
        lambda process, world: changed(process, reward=process.reward[1:]),
        r"reward has shape \(\d+, 8\), expected \(\d+, 8\)",
    ),
    "cells": (
        lambda process, world: changed(process, cell_of_state=process.cell_of_state + 1),
        r"cell_of_state holds 1 to \d+, outside 0 to \d+",
    ),
    "start": (lambda process, world: changed(process, start=-1), r"start holds -1 to -1"),
}


@pytest.mark.parametrize(("make", "message"), WRONG.values(), ids=WRONG)
def test_a_process_that_does_not_fit_the_world_is_refused(room_world, process, make, message):
    process.check(room_world)
    with pytest.raises(WorldError, match=message):
        make(process, room_world).check(room_world)
