"""The stepping kernel against its readable twin, in a mission that has everything."""

from __future__ import annotations

import numpy as np
import pytest
from mission_twin import MissionTwin
from small_missions import room_mission

from rssnav import ExactStates, Fluctuation, IntervalStates
from rssnav.kernels import stepping
from rssnav.missions import (
    ModeProcess,
    MultirotorEnergy,
    Observation,
    ReadingAbove,
    Task,
    Within,
)
from rssnav.missions.flights import Flyer
from rssnav.training import generator_states

STATUS = {stepping.RUNNING: "running", stepping.FOUND: "found", stepping.TRUNCATED: "truncated"}
NOISE = Fluctuation(2.0, 0.5)
BINS = IntervalStates.uniform(-50.0, -15.0, 5.0)
CASES = {
    "steady": (ModeProcess.steady(4), Task(Within(2.0)), Observation(ExactStates())),
    "jumps": (
        ModeProcess.jumping(4, 0.2),
        Task(Within(2.0), "closeness", goal_reward_is="instead", max_steps=30),
        Observation(ExactStates(), cell=True),
    ),
    "noise, confirmed": (
        ModeProcess.jumping(4, 0.1),
        Task(ReadingAbove(-23.0, 3), goal_reward_is="instead", per_second=-1.0, max_steps=40),
        Observation(BINS, cell=True, doors=True, fluctuation=NOISE),
    ),
    "noise, tested": (
        ModeProcess.jumping(4, 0.1),
        Task(ReadingAbove(-23.0, 7, 0.01), per_second=-1.0, max_steps=40),
        Observation(BINS, cell=True, fluctuation=NOISE),
    ),
    "energy": (
        ModeProcess.switching(2, 0.3, 0.05),
        Task(
            Within(1.0), "none", per_kj=-2.0, energy=MultirotorEnergy(), battery_kj=1.5
        ),
        Observation(None, cell=True, heading=True, doors=True, sensitivity_dbm=-30.0),
    ),
}  # fmt: skip


@pytest.mark.parametrize(("modes", "task", "observation"), CASES.values(), ids=CASES)
def test_flights_equal_their_twin(modes, task, observation):
    mission = room_mission(modes).from_starts(np.arange(20, 35))
    flyer, chooser = Flyer(mission, task, observation), np.random.default_rng(0)
    ends, rows = set(), {}
    for episode in range(30):
        words = generator_states(5, episode)[:4]
        twin = MissionTwin(mission, task, observation, words)
        seen, status = flyer.begin(words), "running"
        twin.begin()
        while status == "running":
            assert (flyer.fleet.whole[0, :2] == (twin.mode, twin.cell)).all()
            assert flyer.fleet.whole[0, stepping.SECONDS] == twin.seconds
            assert seen.reading_dbm == pytest.approx(twin.reading, abs=1e-9)
            assert flyer.mask().tolist() == [twin.possible(a) >= 0 for a in range(8)]
            if observation.doors:
                assert (seen.doors_seen, seen.doors_closed) == (
                    sum(1 << d for d in twin.doors),
                    sum(closed << d for d, closed in twin.doors.items()),
                )
            told = what_is_told(observation, mission, twin)
            assert rows.setdefault(seen.row, told) == told  # a row never means two things
            action = int(chooser.integers(0, 9))
            (reward, code), (expected, status) = flyer.step(action), twin.step(action)
            assert STATUS[code] == status
            assert reward == pytest.approx(expected, abs=1e-9)
            assert flyer.fleet.real[0, stepping.ENERGY_J] == pytest.approx(twin.energy_j)
            seen = flyer.seen()
        ends.add(status)
    assert len(set(rows.values())) == len(rows)  # and two rows never the same
    assert "truncated" in ends or task.max_steps == 20_000
    assert "found" in ends or task.energy


def what_is_told(observation, mission, twin):
    """All that a row of the table may depend on."""
    parts = []
    if observation.cell:
        parts.append(twin.cell)
    if observation.heading:
        parts.append(twin.heading)
    if observation.doors:
        parts.append(tuple(sorted(twin.doors.items())))
    if isinstance(observation.reading, ExactStates):
        parts.append(float(mission.rss_dbm[twin.mode, twin.cell]))
    elif observation.reading is not None:
        parts.append(int(np.searchsorted(BINS.edges_dbm, twin.reading, side="right")))
    return tuple(parts)
