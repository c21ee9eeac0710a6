"""Doors that open and close during a flight: in flights, plans, learners and searchers."""

from __future__ import annotations

import numpy as np
import pytest
from small_plans import box

from floorplans import Opening, Wall
from raytrace import Grid, HalfWaveDipole, TraceConfig
from rssnav.doors import doors_of
from rssnav.maps import CELL_SIZE_M, HEIGHT_M
from rssnav.mission_training import train_mission
from rssnav.missions import (
    GreedyTable,
    Layout,
    Observation,
    Task,
    Within,
    fly,
    learn_by_model,
    mission_of_doors,
    plan_mission,
)
from rssnav.policies import (
    DistanceSearch,
    FrontierSearch,
    GaussianProcessSearch,
    Hypotheses,
    Infotaxis,
    MapParticleFilter,
    MapSearch,
    Qmdp,
)

TOGGLES = 0.1
PLACES = ((1.2, 0.6, 1.2), (1.2, 3.4, 1.2))
TASK = Task(Within(1.0), "none", per_second=-1.0, max_steps=400)
SIGHT = Observation(None, cell=True)
TRACE = {"config": TraceConfig(0, 0, 2), "antenna": HalfWaveDipole(), "threads": 1}


def rooms():
    """Return a box whose partition has three doors."""
    doors = tuple(Opening(x, 0.8, 0.0, 2.1, "door") for x in (0.1, 1.1, 3.1))
    return box((Wall((3.0, 0.0), (3.0, 4.0), "brick", 0.1, 3.0, doors),))


@pytest.fixture(scope="module")
def layout():
    plan = rooms()
    return Layout.of_plan(plan, Grid.over(plan.bounds, CELL_SIZE_M, HEIGHT_M))


@pytest.fixture(scope="module")
def mission(layout):
    """Two of the doors open and close; the flight begins in the other room."""
    plan = rooms()
    start = np.array([layout.nearest(5.5, 0.5)])
    return mission_of_doors(
        plan, layout, doors_of(plan)[:2], PLACES, toggles=TOGGLES, starts=start, **TRACE
    )


def flown(mission, sight, policy, episodes=2000):
    return fly(mission, TASK, sight, policy, episodes=episodes)


def mean_and_error(flights):
    return flights.steps.mean(), flights.steps.std() / np.sqrt(flights.steps.size)


def test_each_second_a_door_changes_with_its_probability_and_blocks_the_step(mission):
    plan = plan_mission(mission, TASK)
    flights = flown(mission, plan.observation, plan.policy)
    changes = np.concatenate(
        [mission.closed[m[1:]] != mission.closed[m[:-1]] for m in flights.modes]
    )
    error = np.sqrt(TOGGLES * (1.0 - TOGGLES) / changes.size)
    assert changes.mean() == pytest.approx(TOGGLES, abs=4.0 * error)
    for cells, modes in zip(flights.cells, flights.modes, strict=True):
        for here, there, mode in zip(cells[:-1], cells[1:], modes[:-1], strict=True):
            steps = mission.layouts[mission.layout_of_mode[mode]].next_state[here]
            assert there == here or there in steps  # by the doors before they change


def test_plans_cost_what_they_say_and_doors_in_sight_are_worth_it(mission):
    plan = plan_mission(mission, TASK)
    steps, error = mean_and_error(flown(mission, plan.observation, plan.policy))
    assert abs(steps - plan.expected) < 4.0 * error
    open_always = Hypotheses.of_mission(mission, TASK).hops[mission.starts, :2].mean()
    assert steps > open_always
    blind = GreedyTable(
        np.tile(plan.policy.q.reshape(-1, mission.n_states, 8)[:2], (4, 1, 1)).reshape(-1, 8)
    )
    assert mean_and_error(flown(mission, plan.observation, blind))[0] > steps


def test_learners_reach_the_plan(mission):
    plan = plan_mission(mission, TASK)
    everywhere = mission.from_starts(np.arange(mission.n_states))
    policy, sight = learn_by_model(everywhere, TASK, steps=100_000)
    assert mean_and_error(flown(mission, sight, policy))[0] <= 1.1 * plan.expected
    for sight in (plan.observation, Observation(None, cell=True, doors=True)):
        table = train_mission(mission, TASK, sight, steps=500_000)
        flights = flown(mission, sight, table)
        assert flights.found.all()
        assert mean_and_error(flights)[0] <= 1.3 * plan.expected


def test_searchers_find_the_transmitter(mission, layout):
    """All of them with true maps; with coarse ones those that do not stay where it is not."""
    true = Hypotheses.of_mission(mission, TASK)
    coarse = Hypotheses.of_plan(rooms(), layout, level_dbm=-28.0, **TRACE)
    searchers = [make(layout) for make in (FrontierSearch, GaussianProcessSearch, DistanceSearch)]
    searchers.append(DistanceSearch(layout, plan_known=True))
    searchers += [make(true) for make in (MapSearch, Qmdp, Infotaxis, MapParticleFilter)]
    searchers += [make(coarse) for make in (MapSearch, MapParticleFilter)]
    for searcher in searchers:
        assert flown(mission, SIGHT, searcher, 100).found.all(), searcher.name


def test_a_way_is_known_again_when_its_door_is_seen_open(layout):
    """From beside the first door the target lies behind it; the others are far."""
    policy = Qmdp(Hypotheses.of_plan(rooms(), layout, **TRACE))
    policy.begin(np.random.default_rng(0))
    known = policy._hops
    before = known.values.copy()
    here = layout.nearest(3.5, 0.5)
    shut = layout.action_mask[here].copy()
    shut[layout.position[layout.next_state[here]][:, 0] < 3.0] = False
    known.see(here, shut)
    assert np.any(known.values[here] > before[here])
    known.see(here, layout.action_mask[here])
    np.testing.assert_array_equal(known.values, before)
