"""Doors that open and close: steps, fields and choices beside the plan's, plans beside a twin."""

from __future__ import annotations

from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from small_missions import room_mission
from small_plans import box

from floorplans import Opening, Wall
from raytrace import Grid, HalfWaveDipole, TraceConfig, Transmitter
from rssnav.doors import Door, doors_of, shut_doors, with_changed
from rssnav.maps import CELL_SIZE_M, HEIGHT_M, make_map
from rssnav.missions import Layout, ModeProcess, Task, Within, fly, plan_mission
from rssnav.missions.door_planning import plan_by_sight
from rssnav.missions.doors import detour_doors, mission_of_doors
from rssnav.missions.layout import WorldError
from rssnav.policies import Hypotheses

PLACES = ((1.2, 0.6, 1.2), (1.2, 3.4, 1.2))
QUICK = TraceConfig(0, 0, 2)
NEAR = Task(Within(1.0), "none", max_steps=500)


def door(offset_m, material=None):
    return Opening(offset_m, 0.8, 0.0, 2.1, "door", material, None if material is None else 0.04)


def two_rooms(*offsets):
    """Return a box whose partition has open doors at some distances from its end."""
    openings = tuple(door(offset) for offset in offsets)
    return box((Wall((3.0, 0.0), (3.0, 4.0), "brick", 0.1, 3.0, openings),))


def layout_of(plan):
    return Layout.of_plan(plan, Grid.over(plan.bounds, CELL_SIZE_M, HEIGHT_M))


def test_open_doors_are_shut_and_opened_again():
    plan = two_rooms(0.1, 2.1)
    first, second = doors_of(plan)
    assert shut_doors(plan) == ()
    shut = with_changed(plan, [second])
    assert shut_doors(shut) == (second,)
    assert with_changed(shut, shut_doors(shut)).sha256 == plan.sha256
    assert first == Door(4, 0)


def test_no_choice_of_doors_cuts_a_cell_off():
    for offsets, most in (((0.1,), 0), ((0.1, 2.1), 1), ((0.1, 1.1, 3.1), 2)):
        plan = two_rooms(*offsets)
        layout = layout_of(plan)
        chosen = detour_doors(plan, layout, PLACES, 3)
        assert len(chosen) == most
        closed = layout_of(with_changed(plan, chosen))
        assert closed.reachable(0).size == layout.n_states


def test_the_door_whose_detour_is_longest_is_chosen():
    """Ways to the lower corner: the lower door is on them, the upper ones are not."""
    plan = two_rooms(0.1, 2.1, 3.1)
    lower = doors_of(plan)[0]
    assert detour_doors(plan, layout_of(plan), PLACES[:1], 1) == (lower,)


def test_each_mode_has_the_steps_and_the_field_of_the_plan_with_its_doors_closed():
    plan = two_rooms(0.1, 1.1, 3.1)
    layout, doors = layout_of(plan), doors_of(plan)[:2]
    mission = mission_of_doors(
        plan, layout, doors, PLACES, config=QUICK, antenna=HalfWaveDipole(), threads=1
    )
    assert mission.n_modes == 8
    for mode in range(8):
        state, place = divmod(mode, 2)
        shut = [each for i, each in enumerate(doors) if state >> i & 1]
        assert mission.closed[mode].tolist() == [bool(state & 1), bool(state & 2)]
        other = with_changed(plan, shut)
        steps = mission.layouts[mission.layout_of_mode[mode]].next_state
        np.testing.assert_array_equal(steps, layout_of(other).next_state)
        source = Transmitter(position=PLACES[place], antenna=HalfWaveDipole())
        field = make_map(other, config=QUICK, transmitter=source, threads=1)
        np.testing.assert_allclose(mission.rss_dbm[mode], layout.on_cells(field.rss_dbm))
        assert mission.source[mode].tolist() == list(PLACES[place][:2])


@pytest.mark.parametrize("doors", [(Door(99, 0),), (Door(4, 1),), (Door(4, 0), Door(4, 0))])
def test_what_is_no_open_door_of_the_plan_is_refused(doors):
    """There is no wall 99, the second door is shut, and none can be given twice."""
    plan = two_rooms(0.1, 2.1)
    plan = with_changed(plan, [Door(4, 1)])
    with pytest.raises(ValueError, match=r"doors = .*: expected different open doors of plan"):
        mission_of_doors(plan, layout_of(plan), doors, PLACES, antenna=HalfWaveDipole())


def test_a_door_is_seen_from_where_a_step_leads_through_it():
    plan = two_rooms(0.1, 2.1)
    layout, (first, _) = layout_of(plan), doors_of(plan)
    mission = mission_of_doors(
        plan, layout, (first,), PLACES[:1], config=QUICK, antenna=HalfWaveDipole(), threads=1
    )
    seen = {tuple(layout.position[s]) for s in np.flatnonzero(mission.sees[:, 0])}
    assert {(2.5, 0.5), (3.5, 0.5)} <= seen
    assert all(abs(x - 3.0) < 1.0 and y < 2.0 for x, y in seen)


def expected_steps(mission, task, sweeps=60):
    """Fewest expected steps of one who sees doors from beside only, in plain Python.

    States are (place, what is known of each door, cell); doors are independent and even.
    """
    goal, n_doors = task.goal.cells(mission), mission.closed.shape[1]
    sources = sorted({tuple(xy) for xy in mission.source.tolist()})

    def mode_of(place, doors):
        for mode, closed in enumerate(mission.closed.tolist()):
            if closed == list(doors) and tuple(mission.source[mode]) == sources[place]:
                return mode
        raise AssertionError("no such mode")

    def arrivals(known, cell):
        """What is known after a look, each with its probability."""
        fresh = [d for d in range(n_doors) if mission.sees[cell, d] and known[d] is None]
        for states in product((False, True), repeat=len(fresh)):
            new = dict(zip(fresh, states, strict=True))
            yield tuple(new.get(d, known[d]) for d in range(n_doors)), 0.5 ** len(fresh)

    def possible(place, known, cell):
        mode = mode_of(place, [bool(state) for state in known])
        steps = mission.layouts[mission.layout_of_mode[mode]].next_state[cell]
        return [int(there) for there in steps if there >= 0]

    cells = range(mission.n_states)
    states = [
        (place, known, cell)
        for place in range(len(sources))
        for known in product((None, False, True), repeat=n_doors)
        for cell in cells
        if all(known[d] is not None or not mission.sees[cell, d] for d in range(n_doors))
    ]
    cost = dict.fromkeys(states, 0.0)

    def on_arrival(place, known, cell):
        return sum(chance * cost[place, new, cell] for new, chance in arrivals(known, cell))

    for _ in range(sweeps):
        for place, known, cell in states:
            mode = mode_of(place, [bool(state) for state in known])
            cost[place, known, cell] = (
                0.0
                if goal[mode, cell]
                else 1.0 + min(on_arrival(place, known, c) for c in possible(place, known, cell))
            )
    unknown = (None,) * n_doors
    return np.mean([on_arrival(p, unknown, int(mission.starts[0])) for p in range(len(sources))])


@pytest.mark.parametrize("start", [(6.5, 1.5), (7.5, 4.5), (4.5, 0.5)])
def test_plans_by_sight_are_those_of_a_twin(start):
    mission = room_mission(start=start)
    plan = plan_by_sight(mission, NEAR)
    assert plan.expected == pytest.approx(expected_steps(mission, NEAR))


def two_door_mission():
    plan = two_rooms(0.1, 1.1, 3.1)
    layout, doors = layout_of(plan), doors_of(plan)[:2]
    mission = mission_of_doors(
        plan, layout, doors, PLACES, config=QUICK, antenna=HalfWaveDipole(), threads=1
    )
    return mission.from_starts(np.array([layout.nearest(5.5, 0.5)]))


def test_plans_by_sight_with_two_doors_are_those_of_a_twin_and_are_flown_as_expected():
    mission = two_door_mission()
    plan = plan_by_sight(mission, NEAR)
    assert plan.expected == pytest.approx(expected_steps(mission, NEAR))
    flights = fly(mission, NEAR, plan.observation, plan.policy, episodes=2000)
    error = flights.steps.std() / np.sqrt(flights.steps.size)
    assert flights.found.all()
    assert abs(flights.steps.mean() - plan.expected) < 4.0 * error
    assert plan_mission(mission, NEAR).expected < plan.expected


def test_a_door_that_is_in_sight_from_the_start_costs_nothing_to_learn():
    mission = room_mission(start=(4.5, 1.5))
    assert plan_by_sight(mission, NEAR).expected == plan_mission(mission, NEAR).expected


def test_without_doors_sight_is_all():
    mission = room_mission()
    bare = replace(
        mission, closed=np.empty((0, 0), bool), sees=np.empty((0, 0), bool), layouts=mission.layouts
    )
    open_only = replace(bare, layout_of_mode=np.zeros(4, dtype=np.int64))
    by_sight, plan = plan_by_sight(open_only, NEAR), plan_mission(open_only, NEAR)
    assert by_sight.expected == pytest.approx(plan.expected)


def test_doors_that_change_during_a_flight_are_refused():
    mission = room_mission(ModeProcess.jumping(4, 0.1))
    with pytest.raises(WorldError, match="its modes change during a flight"):
        plan_by_sight(mission, NEAR)


def test_hypotheses_of_modes_have_the_steps_of_their_doors():
    mission = room_mission()
    maps = Hypotheses.of_mission(mission, NEAR)
    np.testing.assert_allclose(maps.hops.T, plan_mission(mission, NEAR).cost[-1])
    assert np.any(maps.hops[:, 0] < maps.hops[:, 2])
    with pytest.raises(ValueError, match="layouts: 1, expected 4"):
        replace(maps, layouts=maps.layouts[:1])


def test_two_chains_at_once_are_independent():
    doors, places = ModeProcess.switching(1, 0.25, 0.1), ModeProcess.jumping(3, 0.3)
    both = doors.times(places)
    assert both.n_modes == 6
    assert both.initial[4] == pytest.approx(0.25 / 3)
    assert both.transition[1, 5] == pytest.approx(0.1 * 0.1)
