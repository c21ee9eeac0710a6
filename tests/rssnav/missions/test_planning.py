"""Plans against independent oracles, and learning by a model against plans."""

from __future__ import annotations

from dataclasses import replace
from heapq import heappop, heappush

import numpy as np
import pytest
from small_missions import room_mission

from rssnav import Fluctuation, IntervalStates
from rssnav.kernels.stepping import CELL, FOUND, RUNNING
from rssnav.missions import (
    HOVER,
    GreedyTable,
    ModeProcess,
    MultirotorEnergy,
    Observation,
    RandomPolicy,
    ReadingAbove,
    Task,
    Within,
    fly,
    learn_by_model,
    plan_mission,
)
from rssnav.missions.flights import Flyer

ENERGY = MultirotorEnergy(turn_j_per_deg=2.0)
NEAR = Task(Within(1.0), "none", energy=ENERGY, max_steps=500)


def cheapest(mission, mode, goal, step_cost):
    """Least cost of a flight in a mode that does not change, by Dijkstra's algorithm."""
    steps = mission.layouts[mission.layout_of_mode[mode]].next_state
    queue, done = [(0.0, int(mission.starts[0]), 8)], set()
    while queue:
        cost, cell, heading = heappop(queue)
        if goal[mode, cell]:
            return cost
        if (cell, heading) not in done:
            done.add((cell, heading))
            for a in np.flatnonzero(steps[cell] >= 0).tolist():
                heappush(queue, (cost + step_cost[heading, a], int(steps[cell, a]), a))
    raise AssertionError("the goal cannot be reached")


@pytest.mark.parametrize("minimise", ["steps", "energy"])
def test_plans_of_steady_modes_are_cheapest_flights(minimise):
    mission = room_mission()
    goal = NEAR.goal.cells(mission)
    step_cost = NEAR.energy_j(mission) if minimise == "energy" else np.ones((9, 8))
    plan = plan_mission(mission, NEAR, minimise)
    least = np.array([cheapest(mission, mode, goal, step_cost) for mode in range(4)])
    assert plan.cost[-1][:, mission.starts[0]] == pytest.approx(least)
    flights = fly(mission, NEAR, plan.observation, plan.policy, episodes=20)
    spent = 1000.0 * flights.energy_kj if minimise == "energy" else flights.steps
    assert spent == pytest.approx(least[flights.mode[:, 0]])
    assert plan.expected == pytest.approx(least.mean())


def test_least_energy_turns_less_than_fewest_steps():
    mission = room_mission()
    flights = [
        fly(mission, NEAR, plan.observation, plan.policy, episodes=20)
        for plan in (plan_mission(mission, NEAR, "steps"), plan_mission(mission, NEAR, "energy"))
    ]
    assert flights[1].energy_kj.mean() < flights[0].energy_kj.mean()
    assert flights[1].turned_deg.mean() <= flights[0].turned_deg.mean()


def test_plans_of_jumping_modes_cost_what_they_say():
    """The mean of many flights is the expected cost, and no policy that ignores jumps is better."""
    mission = room_mission(ModeProcess.jumping(4, 0.1))
    plan = plan_mission(mission, NEAR)
    flights = fly(mission, NEAR, plan.observation, plan.policy, episodes=2000)
    error = flights.steps.std() / np.sqrt(flights.steps.size)
    assert flights.found.all()
    assert abs(flights.steps.mean() - plan.expected) < 4.0 * error
    blind = plan_mission(room_mission(), NEAR)
    without = fly(mission, NEAR, blind.observation, blind.policy, episodes=2000)
    assert flights.steps.mean() < without.steps.mean() + 4.0 * error


def test_planning_on_counts_is_as_good_as_the_plan():
    mission = room_mission(ModeProcess.jumping(4, 0.02))
    everywhere = mission.from_starts(np.arange(mission.n_states))
    policy, sight = learn_by_model(everywhere, NEAR, steps=60_000)
    learned = fly(mission, NEAR, sight, policy, episodes=400)
    assert learned.found.all()
    plan = plan_mission(mission, NEAR)
    best = fly(mission, NEAR, plan.observation, plan.policy, episodes=400)
    assert learned.steps.mean() <= 1.2 * best.steps.mean()


def test_power_is_that_of_the_published_model():
    """Zeng, Xu and Zhang (2019), table I: their craft, hover 168.5 W, least near 10 m/s."""
    weight_n, disc, tip = 20.0, 0.503, 120.0
    craft = MultirotorEnergy(weight_n / 9.81, disc, tip)
    blade_w = 0.012 / 8 * 1.225 * 0.05 * disc * 300.0**3 * 0.4**3
    induced_w = 1.1 * weight_n**1.5 / np.sqrt(2 * 1.225 * disc)
    assert craft.hover_j == pytest.approx(blade_w + induced_w)
    assert craft.hover_j == pytest.approx(168.5, abs=0.5)
    speeds = np.linspace(0.0, 30.0, 301)
    assert 9.0 < speeds[np.argmin(craft.power_w(speeds))] < 11.5


@pytest.mark.parametrize("turns", ["angle", "braking"])
def test_turns_cost_more_the_sharper_they_are(turns):
    step_j = MultirotorEnergy(turns=turns).step_j(np.hypot([1, 1] * 4, [0, 1] * 4))
    straight_on = np.diag(step_j[:8])
    assert np.allclose(step_j[8], straight_on)
    assert step_j[0, 0] < step_j[0, 2] < step_j[0, 4]
    free = MultirotorEnergy(turns="free").step_j(np.ones(8))
    assert np.allclose(free, free[0, 0])


def test_several_readings_confirm_the_goal():
    """Of flights at random, single readings end many elsewhere; the mean of sixteen hardly any."""
    mission = room_mission(ModeProcess.steady(4))
    bins = Observation(IntervalStates((-30.0,)), fluctuation=Fluctuation(2.0))
    alarms = {}
    for readings in (1, 16):
        task = Task(ReadingAbove(-20.0, readings), max_steps=3000)
        flights = fly(mission, task, bins, RandomPolicy(), episodes=300)
        alarms[readings] = flights.false_alarm.mean()
    assert alarms[1] > 0.15
    assert alarms[16] < 0.35 * alarms[1]


@pytest.mark.parametrize("correlation", [0.0, 0.6])
def test_a_sequential_test_keeps_its_error_in_the_worst_cell_and_misses_no_clear_one(correlation):
    """A UAV that hovers begins a test with each reading above the level."""
    mission, error, visits = room_mission(ModeProcess.steady(4)), 0.05, 4000
    start = int(mission.starts[0])
    mission = replace(mission, rss_dbm=np.full_like(mission.rss_dbm, -30.0))
    bins = Observation(IntervalStates((-30.0,)), fluctuation=Fluctuation(2.0, correlation))
    ends = {}
    for excess_db in (0.0, 8.0):
        goal = ReadingAbove(-30.0 - excess_db, 200, error)
        flyer = Flyer(mission, Task(goal, max_steps=10**9), bins)
        flyer.begin(np.arange(1, 5, dtype=np.uint64))
        tests: list[bool] = []
        for _ in range(visits):
            flyer.fleet.status[0] = RUNNING
            tests.append(flyer.step(HOVER)[1] == FOUND)
        ends[excess_db] = np.mean(tests)
        assert flyer.fleet.whole[0, CELL] == start
    # Visits whose first reading is not above the level are counted, as the bound does.
    assert 0.2 * error < ends[0.0] <= error
    assert ends[8.0] > 0.99


def test_energy_without_a_model_is_refused():
    with pytest.raises(ValueError, match="needs a task with a model of energy"):
        plan_mission(room_mission(), Task(Within(1.0)), "energy")
    with pytest.raises(ValueError, match="minimise = 'money': expected 'steps' or 'energy'"):
        plan_mission(room_mission(), Task(Within(1.0)), "money")


def test_what_was_never_tried_is_never_chosen():
    policy, _ = learn_by_model(room_mission(), NEAR, steps=256)
    assert isinstance(policy, GreedyTable)
    assert np.isfinite(policy.q).all()
