from dataclasses import replace

import numpy as np
import pytest
from small_worlds import log_distance_map

from rssnav import (
    ExactStates,
    Fluctuation,
    GridWorld,
    LocationAgent,
    QLearning,
    RssAgent,
    ToleranceStates,
    WorldError,
)

E, W = 0, 4


def test_rss_reward_is_the_difference_of_readings(room_world):
    process = RssAgent().decision_process(room_world, QLearning())
    start = room_world.start_state
    west = room_world.next_state[start, W]
    assert process.reward[start, W] == room_world.rss_dbm[west] - room_world.rss_dbm[start]


def test_location_reward_is_the_inverse_distance_after_the_step(room_world):
    process = LocationAgent().decision_process(room_world, QLearning())
    west = room_world.next_state[room_world.start_state, W]
    assert process.reward[room_world.start_state, W] == 1.0 / room_world.distance_m[west]


@pytest.mark.parametrize("agent", [RssAgent(), LocationAgent()], ids=["rss", "location"])
def test_the_goal_reward_is_added_or_stands_instead(room_world, agent):
    added = agent.decision_process(room_world, QLearning())
    instead = agent.decision_process(room_world, QLearning(goal_reward_is="instead"))
    without = agent.decision_process(room_world, QLearning(goal_reward=0.0))
    arrives = added.action_mask & added.terminal[added.next_state]
    assert arrives.any()
    assert np.array_equal(added.reward[arrives], without.reward[arrives] + 1000.0)
    assert np.all(instead.reward[arrives] == 1000.0)
    assert np.array_equal(added.reward[~arrives], instead.reward[~arrives])


def test_both_agents_end_at_the_same_cells(room_world):
    learning = QLearning()
    by_rss = RssAgent().decision_process(room_world, learning).terminal
    by_distance = LocationAgent().decision_process(room_world, learning).terminal
    assert np.array_equal(by_rss, by_distance)
    assert by_rss.any()


def test_a_goal_that_no_cell_meets_is_refused(room_world):
    with pytest.raises(WorldError, match="no cell with RSS > 0 dBm can be reached at speed 1"):
        RssAgent(terminal_dbm=0.0).decision_process(room_world, QLearning())
    with pytest.raises(WorldError, match=r"no cell with D < 0.1 m can be reached"):
        LocationAgent(0.1).decision_process(room_world, QLearning())


def test_a_start_at_the_goal_is_refused(room_world):
    with pytest.raises(WorldError, match="the start already has D < 20 m"):
        LocationAgent(20.0).decision_process(room_world, QLearning())


def test_a_source_at_a_cell_centre_is_refused_for_the_location_agent(room):
    radio_map = log_distance_map(room)
    world = GridWorld.from_map(replace(room, source=(1.5, 1.5, 1.5)), radio_map)
    with pytest.raises(WorldError, match="exactly at a cell centre"):
        LocationAgent().decision_process(world, QLearning())


def test_exact_states_and_fluctuating_readings_exclude_each_other():
    with pytest.raises(ValueError, match="use ToleranceStates or IntervalStates"):
        RssAgent(ExactStates(), fluctuation=Fluctuation(1.0))
    RssAgent(ToleranceStates(1.0), fluctuation=Fluctuation(1.0))


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("gamma", 1.1),
        ("epsilon_max", 2.0),
        ("epsilon_min", -0.1),
        ("alpha_max", -1.0),
        ("alpha_min", 0.6),
        ("eta", -1e-5),
        ("eta", np.nan),
        ("goal_reward", np.inf),
        ("goal_reward_is", "multiplied"),
        ("initial_q", np.nan),
        ("maximum_over", "some"),
        ("decay", "run"),
        ("tie_break", "last"),
        ("max_steps", 0),
    ],
)
def test_parameters_out_of_range_are_refused_by_name(name, value):
    with pytest.raises(ValueError, match=f"{name} = .*: expected"):
        QLearning(**{name: value})


def test_a_terminal_distance_that_is_not_positive_is_refused():
    with pytest.raises(ValueError, match=r"terminal_distance_m = 0\.0: expected a positive number"):
        LocationAgent(0.0)
