from dataclasses import replace

import numpy as np
import pytest
from small_worlds import SmallPlan, log_distance_map, world_of

from rssnav import ACTION_NAMES, ACTIONS, GridWorld, WorldError

E, NE, N, NW, W, SW, S, SE = range(8)


def state_at(world, x, y):
    (state,) = np.flatnonzero((world.position == (x, y)).all(axis=1))
    return state


def goes(world, x, y, action):
    return world.next_state[state_at(world, x, y), action] >= 0


def test_actions_are_the_compass_counter_clockwise():
    assert ACTION_NAMES[NE] == "NE"
    angle = np.degrees(np.arctan2(ACTIONS[:, 1], ACTIONS[:, 0])) % 360
    assert np.allclose(angle, 45.0 * np.arange(8))


@pytest.mark.parametrize("speed", [1, 2])
def test_steps_move_speed_cells_along_each_axis(room, speed):
    world = world_of(room, speed)
    state, action = np.nonzero(world.next_state >= 0)
    moved = world.position[world.next_state[state, action]] - world.position[state]
    assert np.array_equal(moved, speed * ACTIONS[action])
    assert np.allclose(np.hypot(*moved.T), world.step_length_m[action])


def test_every_step_can_be_flown_back(room_world):
    world = room_world
    state, action = np.nonzero(world.next_state >= 0)
    assert np.array_equal(
        world.next_state[world.next_state[state, action], (action + 4) % 8], state
    )


def test_no_step_leaves_the_plan_or_crosses_a_wall(room_world):
    world = room_world
    assert not goes(world, 0.5, 0.5, W)
    assert not goes(world, 0.5, 0.5, SE)
    assert not goes(world, 3.5, 1.5, E)
    assert goes(world, 3.5, 3.5, E)


def test_passing_exactly_through_the_end_of_a_wall_is_a_crash(room_world):
    """The wall ends at (4, 3); the diagonals through that point touch it."""
    assert not goes(room_world, 3.5, 2.5, NE)
    assert not goes(room_world, 4.5, 2.5, NW)
    assert not goes(room_world, 3.5, 3.5, SE)
    assert goes(room_world, 3.5, 3.5, NE)


def test_the_whole_segment_is_tested_not_only_its_end(room):
    """At 2 cells a step both ends of a step over the wall are free, its middle is not."""
    thin = replace(room, segments=(((3.0, 0.0), (3.0, 3.0)),), start=(4.5, 1.5))
    world = world_of(thin, speed=2)
    assert not goes(world, 4.5, 1.5, W)
    assert goes(world, 4.5, 3.5, W)


def test_only_cells_reachable_at_the_speed_are_states(room):
    world = world_of(room, speed=2)
    assert np.array_equal(np.unique(world.position % 2, axis=0), [(0.5, 1.5)])
    closed = replace(room, segments=(*room.segments, ((6.0, 3.0), (8.0, 3.0)), ((6, 3), (6, 5))))
    cut_off = (world_of(closed).position > (6.0, 3.0)).all(axis=1)
    assert not cut_off.any()


def test_the_start_is_state_zero_and_neighbours_have_near_numbers(room_world):
    assert room_world.start_state == 0
    assert tuple(room_world.position[0]) == (6.5, 1.5)
    state, action = np.nonzero(room_world.next_state >= 0)
    assert np.abs(room_world.next_state[state, action] - state).max() < room_world.n_states / 2


def test_per_state_values_agree_with_the_map(room):
    radio_map = log_distance_map(room)
    world = GridWorld.from_map(room, radio_map)
    assert np.array_equal(radio_map.rss_dbm[tuple(world.cell.T)], world.rss_dbm)
    on_grid = world.on_grid(world.rss_dbm, fill=-np.inf)
    assert np.array_equal(on_grid, radio_map.rss_dbm)
    assert np.allclose(world.distance_m, np.hypot(*(world.position - room.source[:2]).T))


def test_cells_nearer_than_two_metres_are_twelve_where_the_source_is_on_a_corner():
    plan = SmallPlan((8.0, 8.0), (4.0, 4.0, 1.5), (7.5, 7.5))
    assert np.count_nonzero(world_of(plan).distance_m < 2.0) == 12


@pytest.mark.parametrize("speed", [0, -1, 1.5, True, "2"])
def test_a_speed_that_is_no_positive_whole_number_is_refused(room, speed):
    with pytest.raises(WorldError, match="positive whole number"):
        world_of(room, speed)


def test_a_map_that_names_no_plan_is_taken_at_its_word(room):
    assert world_of(room, plan_sha256="").n_states == world_of(room).n_states


def test_a_map_of_another_plan_is_refused(room):
    with pytest.raises(WorldError, match=r"a different plan than 'small'.*compute the map again"):
        world_of(room, plan_sha256="6" * 64)


def test_a_map_with_nan_is_refused(room):
    rss_dbm = log_distance_map(room).rss_dbm
    rss_dbm[2, 3] = np.nan
    with pytest.raises(WorldError, match="NaN in 1 cells"):
        world_of(room, rss_dbm=rss_dbm)


def test_a_map_without_any_path_is_refused(room):
    with pytest.raises(WorldError, match="no cell has a path"):
        world_of(room, rss_dbm=np.full((5, 8), -np.inf))


def test_a_start_off_the_cell_centres_is_refused(room):
    with pytest.raises(WorldError, match=r"not at a cell centre.*nearest is \(6.5, 1.5\)"):
        world_of(replace(room, start=(6.7, 1.5)))


def test_a_start_outside_the_map_is_refused(room):
    with pytest.raises(WorldError, match="not at a cell centre"):
        world_of(replace(room, start=(8.5, 1.5)))


def test_a_source_that_cannot_be_reached_names_the_speeds_that_can(room):
    """The 3 m lattice from (6.5, 1.5) has (0.5, 1.5) near the source, but not past the wall."""
    with pytest.raises(WorldError, match=r"at speed 4 .* speeds that can: 1, 2"):
        world_of(room, speed=4)


def test_a_walled_off_source_is_refused(room):
    closed = replace(room, segments=(((4.0, 0.0), (4.0, 5.0)),))
    with pytest.raises(WorldError, match="no speed from 1 to 8 can"):
        world_of(closed)
