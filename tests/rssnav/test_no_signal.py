"""Cells without coverage read "no signal": a state of its own, in which agents fly and learn."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from cli_plans import ROOM, done
from hypothesis import given
from hypothesis import strategies as st
from small_worlds import log_distance_map, room_plan, world_of
from state_rules import states_of

import floorplans
from floorplans import Opening
from rssnav import (
    ExactStates,
    Fluctuation,
    GridWorld,
    IntervalStates,
    LocationAgent,
    QLearning,
    RssAgent,
    ToleranceStates,
    TrainingResult,
    greedy_path,
    train,
    value_iteration,
)
from rssnav.discrete_states import AGENT_SENSITIVITY_DBM, heard
from rssnav.kernels import particle_filter
from rssnav.kernels.particle_filter import Belief, Model
from rssnav.searchers import ParticleFilter, RandomWalk, RssAscent, search

RULES = [
    ExactStates(),
    ToleranceStates(2.0),
    IntervalStates.uniform(-60.0, -20.0, 5.0),
    IntervalStates((-130.0, -30.0)),
]
ANY_RULE = pytest.mark.parametrize("rule", RULES, ids=["exact", "tolerance", "intervals", "two"])
LINE_OF_SIGHT = ("--reflections", "0", "--diffractions", "0", "--transmissions", "0")
DARK = slice(5, 8)  # columns of the map, the start's among them

readings = st.just(-math.inf) | st.floats(-170.0, -20.0) | st.just(AGENT_SENSITIVITY_DBM)


def dark_world(level_dbm: float = -math.inf) -> GridWorld:
    """Return a room in which cells of the start's half have a level, by default no path."""
    rss_dbm = log_distance_map(room_plan()).rss_dbm.copy()
    rss_dbm[:, DARK] = level_dbm
    return world_of(room_plan(), rss_dbm=rss_dbm)


@ANY_RULE
@given(st.lists(readings, min_size=1, max_size=30))
def test_no_signal_is_one_state_that_no_other_reading_has(rule, several) -> None:
    heard_dbm = heard(np.array(several), AGENT_SENSITIVITY_DBM)
    states = states_of(rule, heard_dbm)
    is_heard = heard_dbm > AGENT_SENSITIVITY_DBM
    silent = {s for s, above in zip(states, is_heard, strict=True) if not above}
    others = set(states) - silent
    loud = [s for s, above in zip(states, is_heard, strict=True) if above]
    assert len(silent) <= 1
    assert others == set(loud)
    assert silent.isdisjoint(loud)


def test_rewards_in_the_dark_are_finite_and_sum_to_the_rise_of_the_reading() -> None:
    world = dark_world()
    process = RssAgent().decision_process(world, QLearning(goal_reward=0.0))
    assert np.isfinite(process.reward).all()
    flight = greedy_path(world, process, value_iteration(process, 0.98).q)
    assert flight.reached
    here, there = flight.states[:-1], flight.states[1:]
    action = np.argmax(process.next_state[here] == there[:, None], axis=1)
    rise_db = world.rss_dbm[flight.states[-1]] - AGENT_SENSITIVITY_DBM
    assert process.reward[here, action].sum() == pytest.approx(rise_db)
    assert not process.reward[here, action][:1].any()  # from no signal to no signal


@ANY_RULE
def test_agent_learns_in_the_dark_as_where_all_is_just_at_its_sensitivity(rule) -> None:
    schedule = {"runs": 3, "episodes": 60, "keep_q": True}
    agent = RssAgent(rule)
    dark = train(dark_world(), agent, **schedule)
    assert not dark.truncated.all()
    faint = train(dark_world(AGENT_SENSITIVITY_DBM - 7.0), agent, **schedule)
    for name in ("steps", "trajectories", "n_discrete_states", "q"):
        assert np.array_equal(getattr(dark, name), getattr(faint, name)), name
    assert dark.n_discrete_states.max() <= (len(np.unique(dark_world().rss_dbm)))


@ANY_RULE
def test_sensitivity_that_all_readings_exceed_changes_nothing(room_world, rule) -> None:
    noise = Fluctuation() if isinstance(rule, ExactStates) else Fluctuation(1.0, 0.3)
    schedule = {"runs": 3, "episodes": 40, "keep_q": True}
    usual = train(room_world, RssAgent(rule, fluctuation=noise), **schedule)
    deaf = RssAgent(rule, fluctuation=noise, sensitivity_dbm=-1e6)
    other = train(room_world, deaf, **schedule)
    for name in ("steps", "trajectories", "n_discrete_states", "q", "visit_counts"):
        assert np.array_equal(getattr(usual, name), getattr(other, name)), name


def test_fluctuating_agent_crosses_the_dark() -> None:
    agent = RssAgent(ToleranceStates(2.0), fluctuation=Fluctuation(1.0))
    result = train(dark_world(), agent, runs=4, episodes=100)
    assert not result.truncated[:, -20:].any()


def test_location_agent_needs_no_signal() -> None:
    result = train(dark_world(), LocationAgent(), runs=3, episodes=300)
    assert result.reached.all()


@pytest.mark.parametrize("searcher", [RandomWalk(), RssAscent(), ParticleFilter()])
def test_searchers_find_the_source_from_the_dark(searcher) -> None:
    found = search(dark_world(), searcher, runs=20)
    assert found.found.all()


def test_no_signal_weighs_particles_by_the_probability_of_a_level_below_the_sensitivity() -> None:
    ranges = np.array([(0.0, 10.0), (0.0, 8.0), (-20.0, -10.0), (1.5, 5.0)]).T
    model = Model(*ranges, np.zeros(4), 6.0, 0.0, 2.0, 10, -50.0)
    particles = np.random.default_rng(0).uniform(*ranges, (100, 4))
    belief = Belief(particles, np.full(100, 0.01), np.empty((100, 4)))
    assert particle_filter.weigh(belief, model, 3.5, 4.5, -50.0)
    x, y, power_dbm, exponent = particles.T
    distance_m = np.hypot(x - 3.5, y - 4.5)
    excess = (power_dbm - 10.0 * exponent * np.log10(distance_m) + 50.0) / 6.0
    below = np.array([0.5 * math.erfc(e / math.sqrt(2.0)) for e in excess]) * (distance_m >= 2.0)
    assert np.allclose(belief.weights, below / below.sum())


@pytest.mark.parametrize("level_dbm", [-21.0, 0.0, -math.inf, math.nan])
def test_sensitivity_must_lie_below_the_goal(level_dbm) -> None:
    with pytest.raises(ValueError, match=r"sensitivity_dbm = .* a level below the goal's, -21 dBm"):
        RssAgent(sensitivity_dbm=level_dbm)


def test_result_file_holds_the_sensitivity(tmp_path) -> None:
    result = train(dark_world(), RssAgent(sensitivity_dbm=-95.0), runs=2, episodes=10)
    result.save(tmp_path / "rss.h5")
    assert TrainingResult.load(tmp_path / "rss.h5").agent == RssAgent(sensitivity_dbm=-95.0)


def test_a_drawing_is_imported_mapped_trained_and_flown(tmp_path) -> None:
    """A hall, and a store behind a door that line of sight does not pass: half the cells dark."""
    door = Opening(1.0, 1.0, 0.0, 2.4, "door")
    hall = floorplans.loads(ROOM)
    walls = (*hall.walls[:-1], replace(hall.walls[-1], openings=(door,)))
    drawing, plan, radio_map = (tmp_path / name for name in ("a.dxf", "a.toml", "a.h5"))
    floorplans.save(replace(hall, walls=walls), tmp_path / "drawn.toml")
    done("plan", "export", tmp_path / "drawn.toml", "-o", drawing)
    done("plan", "import", drawing, "-o", plan)
    done("map", plan, "-o", radio_map, *LINE_OF_SIGHT)
    trained = tmp_path / "rss.h5"
    done("train", plan, "--map", radio_map, "--runs", 3, "--episodes", 50, "-o", trained)
    world = TrainingResult.load(trained).world
    assert np.isneginf(world.rss_dbm).any()
    assert np.isneginf(world.rss_dbm[world.start_state])
    done("fly", plan, trained, "--map", radio_map, "-o", tmp_path / "flight.gif")
