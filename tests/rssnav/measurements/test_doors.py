"""States of doors found from readings that the tracer made with known ones."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from small_surveys import TRANSMITTERS, room, survey_of

from floorplans import FloorPlan, Opening
from raytrace import TraceConfig
from rssnav.doors import LEAF, Door, doors_of, with_changed
from rssnav.measurements.calibrate import Calibration, calibrate
from rssnav.measurements.calibration_page import calibration_page
from rssnav.measurements.doors import CLEAR, DoorSearch, DoorState
from rssnav.measurements.survey import Survey
from rssnav.measurements.traced import TraceSettings, traced_dbm
from rssnav.scenes import scene_of

SETTINGS = TraceSettings(TraceConfig(2, 1, 1))
NEAR, FAR = Door(4, 0), Door(4, 1)


def building(*shut: Door) -> FloorPlan:
    """Return a room with a heavy partition and two doors in it, of metal as the one outside."""
    walls = list(room().walls)
    outside = replace(walls[4].openings[0], material="metal", thickness_m=0.01)
    walls[0] = replace(walls[0], openings=(outside,))
    partition = walls[NEAR.wall]
    near = replace(partition.openings[0], offset_m=0.4)
    far = replace(near, offset_m=2.6)
    partition = replace(partition, material="concrete", thickness_m=0.2, openings=(near, far))
    return with_changed(replace(room(), walls=(*walls[: NEAR.wall], partition)), shut)


def wooden(plan: FloorPlan) -> FloorPlan:
    """Return a plan whose shut doors are of wood."""

    def of_wood(opening: Opening) -> Opening:
        return opening if opening.material is None else replace(opening, material="wood")

    walls = (replace(w, openings=tuple(map(of_wood, w.openings))) for w in plan.walls)
    return replace(plan, walls=tuple(walls))


def survey_in(plan: FloorPlan) -> Survey:
    """Return readings on both sides of the partition, 20 dB off, with a noise of 2 dB."""
    random = np.random.default_rng(3)
    points = random.uniform((0.3, 0.3, 1.5), (5.7, 3.7, 1.5), (60, 3))
    of = np.repeat([0, 1], len(points))
    empty = survey_of(np.vstack([points, points]), np.zeros(2 * len(points)), of)
    exact = traced_dbm(scene_of(plan), empty, SETTINGS)
    return replace(empty, rss_dbm=exact - 20.0 + random.normal(0.0, 2.0, len(exact)))


def found_in(plan: FloorPlan, survey: Survey) -> Calibration:
    return calibrate(plan, scene_of(plan), survey, SETTINGS, materials=["concrete"], doors=True)


@pytest.mark.parametrize("shut", [(), (NEAR,), (FAR,), (NEAR, FAR)])
@pytest.mark.parametrize("in_plan", [(), (FAR,)])
def test_the_true_states_are_found(shut: tuple[Door, ...], in_plan: tuple[Door, ...]) -> None:
    plan = building(*in_plan)
    found = found_in(plan, survey_in(building(*shut)))
    states = {state.door: state for state in found.doors}
    assert {door for door, state in states.items() if not state.is_open} == set(shut)
    assert {door for door, state in states.items() if not state.was_open} == set(in_plan)
    assert all(state.is_told and state.evidence >= CLEAR for state in states.values())
    openings = found.plan.walls[NEAR.wall].openings
    assert [o.material is not None for o in openings] == [d in shut for d in (NEAR, FAR)]
    assert found.space.after.sigma_db < 2.5


def test_held_out_readings_gain_from_the_true_state() -> None:
    found = found_in(building(), survey_in(building(NEAR, FAR)))
    assert found.space.before.sigma_db > found.space.after.sigma_db + 0.3
    summary = found.summary()["doors"]
    assert [(d["was_open"], d["is_open"], d["is_told"]) for d in summary] == [
        (True, False, True)
    ] * 2


def test_what_readings_do_not_tell_stays_as_it_is() -> None:
    """Places and transmitter are in one room, whose doors hardly matter to it."""
    plan = wooden(building(FAR))
    survey = survey_in(wooden(building()))
    near = survey.rows((survey.points[:, 0] < 2.5) & (survey.transmitter == 0))
    one = replace(near, transmitters=TRANSMITTERS[:1])
    one = replace(one, rss_dbm=one.rss_dbm + np.random.default_rng(1).normal(0, 4, len(one)))
    groups = np.zeros(len(one), np.int64)
    search = DoorSearch(plan, one, SETTINGS, groups, None, lambda: None)
    changed = search.changed(np.ones(len(one), bool))
    states = search.states(changed)
    assert not changed
    assert not any(state.is_told for state in states)
    assert all(state.is_open == state.was_open for state in states)


def cut_off(*shut: Door) -> tuple[FloorPlan, TraceSettings]:
    """Return the building and limits with which no path passes its partition."""
    return building(*shut), TraceSettings(TraceConfig(2, 1, 0))


def states_in(plan: FloorPlan, settings: TraceSettings, survey: Survey) -> dict[Door, DoorState]:
    search = DoorSearch(plan, survey, settings, np.zeros(len(survey), int), None, lambda: None)
    changed = search.changed(np.ones(len(survey), bool))
    return {state.door: state for state in search.states(changed)}


def far_and_near(settings: TraceSettings, plan: FloorPlan) -> Survey:
    """Return exact readings of the first transmitter on both sides; -90 dBm without a path."""
    random = np.random.default_rng(4)
    points = random.uniform((0.3, 0.3, 1.5), (5.7, 3.7, 1.5), (40, 3))
    empty = survey_of(points, np.zeros(len(points)))
    exact = traced_dbm(scene_of(plan), empty, settings)
    return replace(empty, rss_dbm=np.where(np.isfinite(exact), exact, -90.0))


def test_an_open_door_is_found_by_readings_that_have_no_path_otherwise() -> None:
    shut, settings = cut_off(NEAR, FAR)
    truth = building(FAR)
    states = states_in(shut, settings, far_and_near(settings, truth))
    assert states[NEAR].is_open
    assert states[NEAR].is_told
    assert not states[FAR].is_open


def test_a_shut_door_is_found_by_readings_below_the_sensitivity() -> None:
    plan, settings = cut_off(FAR)
    survey = far_and_near(settings, building(NEAR, FAR))
    survey = replace(survey, is_censored=survey.rss_dbm == -90.0)
    assert survey.is_censored.any()
    states = states_in(plan, settings, survey)
    assert not states[NEAR].is_open
    assert states[NEAR].is_told


def test_a_state_that_the_plan_does_not_allow_is_not_told_by_readings() -> None:
    state = DoorState(NEAR, (0.0, 0.0), True, True, np.inf)
    assert not state.is_told
    assert state.summary()["evidence"] is None


def test_a_material_of_a_door_that_is_open_after_all_is_not_fitted() -> None:
    plan = building(NEAR, FAR)
    walls = list(plan.walls)
    leaf = replace(walls[NEAR.wall].openings[0], material="chipboard", thickness_m=0.05)
    heavy = replace(walls[NEAR.wall], openings=(leaf, walls[NEAR.wall].openings[1]))
    plan = replace(plan, walls=(*walls[: NEAR.wall], heavy))
    survey = survey_in(building(FAR))
    found = calibrate(
        plan, scene_of(plan), survey, SETTINGS, materials=["concrete", "chipboard"], doors=True
    )
    assert {value.material for value in found.found.told} <= {"concrete", "chipboard"}


def test_doors_that_the_plan_needs_are_left_alone() -> None:
    """An outer door that is shut keeps the outline closed."""
    assert doors_of(building()) == (NEAR, FAR)


def test_a_shut_door_is_like_the_others() -> None:
    assert building(NEAR).walls[NEAR.wall].openings[0].material == "metal"
    shut = with_changed(room(), [NEAR])
    assert shut.walls[NEAR.wall].openings[0].material == LEAF
    assert with_changed(building(NEAR), [NEAR]) == building()


def test_the_page_lists_the_doors() -> None:
    plan = building()
    survey = survey_in(building(NEAR))
    page = calibration_page(plan, survey, found_in(plan, survey), SETTINGS)
    assert page.count("<td>open</td>") >= 2
    assert "<td>shut</td>" in page
