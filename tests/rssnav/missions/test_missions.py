"""Layouts, chains of modes and tasks."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from small_missions import room_mission
from small_worlds import log_distance_map, room_plan, world_of

from rssnav import GridWorld, IntervalStates, QLearning, RssAgent, WorldError
from rssnav.kernels import common
from rssnav.learning_rules import LearningProblem
from rssnav.mission_training import mission_learner, train_mission
from rssnav.missions import (
    GreedyTable,
    Layout,
    ModeProcess,
    Observation,
    RandomPolicy,
    ReadingAbove,
    Task,
    Within,
    fly,
)
from rssnav.training import generator_states


def test_cells_are_numbered_by_the_layout_and_not_by_the_start():
    plan = room_plan()
    radio_map = log_distance_map(plan)
    layout = Layout.of_plan(plan, radio_map.grid)
    flat = layout.cell[:, 0] * layout.shape[1] + layout.cell[:, 1]
    assert np.all(np.diff(flat) > 0)
    elsewhere = replace(plan, start=(1.5, 4.5), source=(6.3, 3.1, 1.5))
    again = Layout.of_plan(elsewhere, radio_map.grid)
    assert np.array_equal(layout.next_state, again.next_state)


@pytest.mark.parametrize("speed", [1, 2])
def test_worlds_of_one_layout_are_those_of_the_plan(speed):
    for start in ((6.5, 1.5), (1.5, 4.5)):
        plan = replace(room_plan(), start=start, source=(4.6, 3.4, 1.5))
        radio_map = log_distance_map(plan)
        layout = Layout.of_plan(plan, radio_map.grid, speed)
        shared = GridWorld.from_map(plan, radio_map, speed, layout=layout)
        alone = GridWorld.from_map(plan, radio_map, speed)
        for name in ("next_state", "rss_dbm", "cell", "distance_m", "position"):
            assert np.array_equal(getattr(shared, name), getattr(alone, name)), name


def test_a_part_of_a_layout_keeps_its_steps():
    layout = Layout.of_plan(room_plan(), log_distance_map(room_plan()).grid)
    kept = layout.reachable(layout.nearest(6.5, 1.5))[::-1]
    part = layout.part(kept)
    state, action = np.nonzero(part.action_mask)
    assert np.array_equal(
        kept[part.next_state[state, action]], layout.next_state[kept[state], action]
    )
    assert np.array_equal(part.on_grid(part.position[:, 0])[tuple(part.cell.T)], part.position.T[0])


def test_chains_of_modes_are_probabilities():
    jumping = ModeProcess.jumping(5, 0.01)
    assert jumping.changes
    assert not ModeProcess.steady(5).changes
    assert jumping.transition[0, 0] == pytest.approx(0.99 + 0.01 / 5)
    doors = ModeProcess.switching(2, closed=0.25, toggles=0.1)
    assert doors.initial.tolist() == pytest.approx([0.5625, 0.1875, 0.1875, 0.0625])
    assert doors.transition[0b01, 0b10] == pytest.approx(0.01)
    assert doors.transition[0b01, 0b11] == pytest.approx(0.09)
    with pytest.raises(ValueError, match="transition: expected probabilities that sum to 1"):
        ModeProcess(np.ones(1), np.array([[0.5]]))
    with pytest.raises(ValueError, match="initial: shape"):
        ModeProcess(np.ones((1, 1)), np.ones((1, 1)))


WRONG_TASKS = {
    "no cell": (Task(ReadingAbove(10.0)), r"no cell with RSS > 10 dBm can be reached .* in mode 0"),
    "at the start": (Task(Within(20.0)), r"the start already has D < 20 m"),
    "infinite": (Task(reward="closeness"), r"source .* lies exactly at a cell centre"),
}


@pytest.mark.parametrize(("task", "message"), WRONG_TASKS.values(), ids=WRONG_TASKS)
def test_tasks_that_cannot_be_done_are_refused(task, message):
    mission = room_mission()
    if task.reward == "closeness":
        distance_m = mission.distance_m.copy()
        distance_m[0, 3] = 0.0
        mission = replace(mission, distance_m=distance_m)
    with pytest.raises(WorldError, match=message):
        task.check(mission)


def test_a_budget_needs_a_model_of_energy():
    with pytest.raises(ValueError, match="energy: per_kj and battery_kj need a model"):
        Task(battery_kj=2.0)


def test_missions_of_wrong_shapes_are_refused():
    mission = room_mission()
    with pytest.raises(WorldError, match=r"rss_dbm has shape \(3, 40\), not \(4, 40\)"):
        replace(mission, rss_dbm=mission.rss_dbm[1:])
    with pytest.raises(WorldError, match="starts must be some of the 40 cells"):
        mission.from_starts(np.array([40]))
    for starts in ([2**40], [-1], []):
        with pytest.raises(WorldError, match="starts must be some of the 40 cells"):
            mission.from_starts(np.array(starts, dtype=np.int64))
    with pytest.raises(WorldError, match="starts must be numbers of cells"):
        mission.from_starts(np.array([0.5]))


@pytest.mark.parametrize("action", [-1, 9, 99, 2**40, None, 1.0, float("nan"), "east", True])
def test_what_is_no_action_is_refused(action):
    """The step is compiled: it would read beyond its tables."""

    class Wrong(RandomPolicy):
        def act(self, observation, mask):
            return action

    with pytest.raises(ValueError, match="expected a whole number from 0 to 7, or HOVER"):
        fly(room_mission(), Task(Within(1.0)), Observation(None, cell=True), Wrong())


def test_numbers_of_flights_and_probabilities_out_of_range_are_refused():
    with pytest.raises(ValueError, match=r"episodes = 1.5"):
        fly(room_mission(), Task(Within(1.0)), Observation(None), RandomPolicy(), episodes=1.5)
    with pytest.raises(ValueError, match="epsilon = 7"):
        GreedyTable(np.zeros((1, 8)), 7.0)


def test_flights_are_counted_by_what_was_flown(room_world):
    """A table of hops to the goal flies a shortest path; its metres and turns are its cells'."""
    mission, task = room_world.mission(), Task(Within(2.0))
    hops = np.full(room_world.n_states, 99.0)
    hops[room_world.distance_m < 2.0] = 0.0
    for _ in range(room_world.n_states):
        onward = np.where(room_world.action_mask, hops[room_world.next_state], 99.0)
        hops = np.minimum(hops, 1.0 + onward.min(axis=1))
    table = GreedyTable(-hops[room_world.next_state])
    flights = fly(mission, task, Observation(None, cell=True), table, episodes=2)
    assert flights.found.all()
    assert flights.steps.tolist() == [int(hops[room_world.start_state])] * 2
    assert flights.spl(hops[[0, 0]]) == 1.0
    path = room_world.position[flights.cells[0]]
    assert flights.length_m[0] == pytest.approx(np.hypot(*np.diff(path, axis=0).T).sum())
    angle = np.degrees(np.arctan2(*np.diff(path, axis=0).T[::-1]))
    turned = np.abs((np.diff(angle) + 180.0) % 360.0 - 180.0)
    assert flights.turned_deg[0] == pytest.approx(turned.sum())
    assert flights.turns[0] == np.count_nonzero(turned > 1.0)


def test_flights_depend_on_the_seed_alone():
    mission = room_mission(ModeProcess.jumping(4, 0.05))
    task, sight = Task(Within(1.5), max_steps=200), Observation(None, cell=True)
    one, same = (fly(mission, task, sight, RandomPolicy(), episodes=5, seed=3) for _ in range(2))
    other = fly(mission, task, sight, RandomPolicy(), episodes=5, seed=4)
    assert [c.tolist() for c in one.cells] == [c.tolist() for c in same.cells]
    assert [c.tolist() for c in one.cells] != [c.tolist() for c in other.cells]


def test_speed_of_a_world_is_that_of_its_layout():
    assert world_of(room_plan(), 2).layout.speed == 2


def test_learning_in_a_mission_is_that_of_the_paper_s_agent(room_world):
    """A mission of one mode, with the agent's task and observation, gives the agent's table."""
    agent, learning = RssAgent(IntervalStates.uniform(-50.0, -20.0, 1.0)), QLearning(max_steps=300)
    problem = LearningProblem.of(room_world, agent, learning)
    generators = generator_states(2, 0)
    alone = problem.learner(generators, 50)
    task, sight = agent.task(learning), agent.observation()
    within = mission_learner(room_world.mission(), task, sight, learning, generators, 50)
    for learner in (alone, within):
        while learner.run.counters[common.EPISODE] < 50:
            learner.advance(50)
    assert np.array_equal(alone.run.episodes, within.run.episodes)
    assert np.array_equal(alone.run.q, within.run.q)


def test_an_agent_that_knows_the_mode_learns_to_fly_by_doors():
    """Through the door where it is open, around where it is closed: the shortest ways of both."""
    mission = room_mission(ModeProcess.steady(4))
    task, sight = Task(Within(1.0), "none", per_second=-1.0), Observation(None, True, mode=True)
    policy = train_mission(mission, task, sight, steps=300_000, seed=1)
    flights = fly(mission, task, sight, policy, episodes=40)
    goal = task.goal.cells(mission)
    shortest = [fewest_steps(mission, mode, goal[mode]) for mode in range(4)]
    assert set(flights.mode[:, 0].tolist()) == {0, 1, 2, 3}
    assert flights.steps.tolist() == [shortest[mode] for mode in flights.mode[:, 0]]
    assert shortest[0] < shortest[2]


def fewest_steps(mission, mode, goal):
    """Steps from the start to any goal cell of a mode, breadth first."""
    steps = mission.layouts[mission.layout_of_mode[mode]].next_state
    reached, count = {int(mission.starts[0])}, 0
    while not any(goal[cell] for cell in reached):
        reached |= {int(there) for cell in reached for there in steps[cell] if there >= 0}
        count += 1
    return count
