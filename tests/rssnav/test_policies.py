"""Searchers as policies: laws, twins in NumPy, and flights in a small room."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import norm
from small_missions import room_mission

import floorplans
from raytrace import Grid, TraceConfig
from rssnav.discrete_states import Fluctuation
from rssnav.kernels.grid_search import expected_cost, marginal, weigh_by_distance
from rssnav.missions import (
    Layout,
    ModeProcess,
    Observation,
    ReadingAbove,
    Seen,
    Task,
    fly,
    plan_mission,
)
from rssnav.missions.places import are_in_sight, places_beside, reachable_layout
from rssnav.policies import (
    DistanceSearch,
    FrontierSearch,
    GaussianProcessSearch,
    Hypotheses,
    Infotaxis,
    Likelihood,
    MapParticleFilter,
    MapSearch,
    Qmdp,
    StepMemory,
)
from rssnav.policies.hypotheses import NO_WAY
from rssnav.policies.map_belief import MapBelief

TASK = Task(ReadingAbove(-21.0), "none", max_steps=200)
SIGHT = Observation(None, cell=True)


def open_room(modes=None):
    """Room with two places and its door open."""
    room = room_mission()
    return replace(
        room,
        layouts=room.layouts[:1],
        layout_of_mode=np.zeros(2, dtype=np.int64),
        rss_dbm=room.rss_dbm[:2],
        distance_m=room.distance_m[:2],
        source=room.source[:2],
        modes=modes or ModeProcess.steady(2),
        closed=np.empty((0, 0), dtype=bool),
        sees=np.empty((0, 0), dtype=bool),
    )


def policies(mission):
    maps = Hypotheses.of_mission(mission, TASK)
    return [
        FrontierSearch(mission.layout),
        GaussianProcessSearch(mission.layout),
        DistanceSearch(mission.layout),
        DistanceSearch(mission.layout, targets="thompson"),
        DistanceSearch(mission.layout, plan_known=True),
        MapSearch(maps),
        MapSearch(maps, targets="thompson"),
        MapParticleFilter(maps),
        Qmdp(maps),
        Infotaxis(maps),
        Infotaxis(maps, space_aware=False),
    ]


class Watched:
    """A policy whose actions are checked against the mask."""

    def __init__(self, policy):
        self.policy, self.name = policy, policy.name

    def begin(self, generator):
        self.policy.begin(generator)

    def act(self, observation, mask):
        action = self.policy.act(observation, mask)
        assert 0 <= action < 8
        assert mask[action]
        return action


@pytest.mark.parametrize("number", range(11))
@pytest.mark.parametrize("sigma_db", [0.0, 2.0])
def test_every_policy_finds_the_transmitter_by_possible_steps_alone(number, sigma_db):
    mission = open_room()
    sight = replace(SIGHT, fluctuation=Fluctuation(sigma_db))
    once, again = (
        fly(mission, TASK, sight, Watched(policies(mission)[number]), episodes=8, seed=3)
        for _ in range(2)
    )
    pure_entropy = number == 10  # does not approach what it is sure of, but for ties
    assert (once.found | once.false_alarm).mean() >= (0.5 if pure_entropy else 1.0)
    assert all(np.array_equal(a, b) for a, b in zip(once.cells, again.cells, strict=True))


def test_names_differ_between_policies():
    names = [policy.name for policy in policies(open_room())]
    assert len(set(names)) == len(names)


@pytest.mark.parametrize("make", [MapSearch, Qmdp, Infotaxis])
def test_one_hypothesis_that_is_true_is_reached_by_the_fewest_steps(make):
    mission = open_room()
    for mode in range(2):
        known = mission.with_modes(ModeProcess(np.eye(2)[mode], np.eye(2)))
        maps = Hypotheses.of_mission(mission, TASK)
        one = Hypotheses(
            maps.layout, maps.rss_dbm[:, [mode]], maps.found[:, [mode]], maps.position[[mode]]
        )
        flights = fly(known, TASK, SIGHT, make(one), episodes=3)
        assert np.all(flights.steps == plan_mission(known, TASK).expected)


def test_hops_are_those_of_value_iteration():
    mission = open_room()
    cost = plan_mission(mission, TASK).cost[-1]
    np.testing.assert_allclose(Hypotheses.of_mission(mission, TASK).hops.T, cost)


def test_a_known_plan_has_the_steps_of_the_layout_and_an_unknown_one_those_of_an_empty_floor():
    layout = open_room().layout
    known, unknown = (StepMemory(layout, plan_known=which) for which in (True, False))
    maps = Hypotheses(
        layout,
        np.zeros((layout.n_states, layout.n_states)),
        np.eye(layout.n_states, dtype=bool),
        layout.position,
    )
    for memory in (known, unknown):
        memory.begin()
    for cell in range(layout.n_states):
        known.see(cell, layout.action_mask[cell])
        np.testing.assert_array_equal(known.hops[known.grid_cell], maps.hops[cell])
    free = StepMemory(layout, plan_known=False)
    row, column = layout.cell[0]
    free.see(0, np.ones(8, dtype=bool))
    rows, columns = np.divmod(np.arange(free.hops.size), layout.shape[1])
    np.testing.assert_array_equal(free.hops, np.maximum(abs(rows - row), abs(columns - column)))
    for cell in range(layout.n_states):
        unknown.see(cell, layout.action_mask[cell])
    unknown.see(0, layout.action_mask[0])
    np.testing.assert_array_equal(unknown.hops[unknown.grid_cell], maps.hops[0])


def test_weights_by_distance_are_those_of_the_law():
    generator = np.random.default_rng(1)
    shape, exponents = (4, 5), np.array([2.0, 3.5])
    rows, columns = np.divmod(np.arange(20), 5)
    drop_db = generator.uniform(0.0, 60.0, (*shape, 2))
    log_weight, weight = np.zeros((20, 2)), np.empty(20)
    total = np.zeros((20, 2))
    for reading_dbm, here in ((-40.0, (1, 2)), (-90.0, (3, 0)), (-55.0, (0, 4))):
        weigh_by_distance(log_weight, drop_db, here, 5, (-15.0, 6.0, 0.5, -90.0), reading_dbm)
        expected_dbm = -15.0 - drop_db[abs(rows - here[0]), abs(columns - here[1])]
        misfit = (reading_dbm - expected_dbm) / 6.0
        total += 0.5 * (norm.logcdf(misfit) if reading_dbm == -90.0 else -0.5 * misfit**2)
    np.testing.assert_allclose(log_weight, total, rtol=1e-9)
    alive = generator.random(20) < 0.7
    assert marginal(log_weight, alive, weight)
    expected = np.where(alive, np.exp(total).sum(axis=1), 0.0)
    np.testing.assert_allclose(weight, expected / expected.sum(), rtol=1e-9)
    assert not marginal(log_weight, np.zeros(20, dtype=bool), weight)
    assert exponents.size == log_weight.shape[1]


def twin_of_expected_cost(belief, expected_dbm, found, hops, levels_dbm, sigma_db, space_aware):
    """Posterior after each level, its entropy, and the mean of the costs."""
    likelihood = norm.pdf(levels_dbm[:, None], expected_dbm, sigma_db)
    joint = belief * ~found * likelihood * (levels_dbm[1] - levels_dbm[0])
    cost = 0.0
    for row in joint:
        posterior = row / row.sum()
        entropy = -np.sum(posterior[posterior > 0] * np.log2(posterior[posterior > 0]))
        if space_aware:
            entropy = np.log2(posterior @ hops + 2 ** (entropy - 1) - 0.5)
        cost += row.sum() * entropy
    return cost


@pytest.mark.parametrize("space_aware", [False, True])
def test_expected_costs_equal_their_definition(space_aware):
    generator = np.random.default_rng(2)
    belief = generator.dirichlet(np.ones(6))
    arguments = (
        belief,
        generator.uniform(-60.0, -50.0, 6),
        np.array([False, True, False, False, False, False]),
        generator.integers(1, 20, 6).astype(np.int32),
        np.arange(-75.0, -35.0, 0.5),
        4.0,
        space_aware,
    )
    assert expected_cost(*arguments) == pytest.approx(twin_of_expected_cost(*arguments), rel=1e-3)


def test_a_known_place_costs_the_logarithm_of_the_steps_to_it():
    levels_dbm = np.arange(-80.0, -20.0, 0.5)
    for steps in (1, 2, 8):
        one = (np.ones(1), np.full(1, -50.0), np.zeros(1, dtype=bool))
        cost = expected_cost(*one, np.array([steps], dtype=np.int32), levels_dbm, 2.0, True)
        assert cost == pytest.approx(np.log2(steps), abs=1e-3)


def test_a_reading_is_expected_to_teach_something_unless_all_maps_are_equal_there():
    belief, hops, none = np.full(4, 0.25), np.ones(4, dtype=np.int32), np.zeros(4, dtype=bool)
    levels_dbm = np.arange(-100.0, -20.0, 0.5)
    apart = expected_cost(
        belief, np.array([-90.0, -70.0, -50.0, -30.0]), none, hops, levels_dbm, 2.0, False
    )
    alike = expected_cost(belief, np.full(4, -60.0), none, hops, levels_dbm, 2.0, False)
    assert apart < 0.01
    assert alike == pytest.approx(2.0, abs=1e-3)


def test_the_belief_is_that_of_bayes_rule_after_the_step_of_the_chain():
    transition = np.array([[0.9, 0.1], [0.3, 0.7]])
    mission = open_room(ModeProcess(np.array([0.5, 0.5]), transition))
    maps = Hypotheses.of_mission(mission, TASK)
    belief = MapBelief(maps, Likelihood(sigma_db=5.0, temper=1.0))
    expected = np.array([0.5, 0.5])
    for n, (cell, reading_dbm) in enumerate(((3, -30.0), (4, -35.0), (9, -28.0))):
        expected = expected @ transition if n else expected
        expected = expected * norm.pdf(reading_dbm, mission.rss_dbm[:, cell], 5.0)
        expected *= np.where(maps.found[cell], 0.02, 1.0)
        expected /= expected.sum()
        belief.update(cell, reading_dbm, moved=n > 0)
        np.testing.assert_allclose(belief.probability, expected, rtol=1e-9)


def test_many_particles_are_close_to_the_whole_belief():
    maps = Hypotheses.of_mission(open_room(), TASK)
    likelihood = Likelihood(sigma_db=8.0)
    whole = MapBelief(maps, likelihood)
    particles = MapParticleFilter(maps, likelihood=likelihood, particles=50_000, fresh_fraction=0.0)
    particles.begin(np.random.default_rng(0))
    for cell in (3, 4, 5):
        whole.update(cell, -33.0, moved=cell > 3)
        particles.belief.update(cell, -33.0, moved=cell > 3)
    np.testing.assert_allclose(particles.belief.probability, whole.probability, atol=0.02)


def test_gaussian_process_equals_the_textbook_formula():
    layout = open_room().layout
    search = GaussianProcessSearch(layout, length_m=2.0, amplitude_db=10.0, sigma_db=1.0)
    search.begin(np.random.default_rng(0))
    readings = {3: -30.0, 4: -35.0, 9: -28.0}
    for cell, reading_dbm in readings.items():
        seen = fly_seen(cell, reading_dbm)
        search.act(seen, layout.action_mask[cell])
    at, asked = layout.position[list(readings)], layout.position[[3, 20]]
    grid_cells = StepMemory(layout, plan_known=False).grid_cell[[3, 20]]
    mean, deviation = search.predict(grid_cells)

    def covariance(a, b):
        return 100.0 * np.exp(-np.sum((a[:, None] - b) ** 2, axis=-1) / 8.0)

    inverse = np.linalg.inv(covariance(at, at) + np.eye(3))
    values = np.array(list(readings.values()))
    across = covariance(asked, at)
    np.testing.assert_allclose(
        mean, values.mean() + across @ inverse @ (values - values.mean()), rtol=1e-9
    )
    variance = 100.0 - np.einsum("ij,jk,ik->i", across, inverse, across)
    np.testing.assert_allclose(deviation, np.sqrt(variance), rtol=1e-6)


def fly_seen(cell, reading_dbm):
    return Seen(reading_dbm, -1, cell, -1, -1, -1, -1, 0)


def test_hypotheses_of_a_plan_are_at_most_a_step_from_every_cell_and_where_they_are_found():
    plan = floorplans.load("flat")
    layout = reachable_layout(plan)
    maps = Hypotheses.of_plan(plan, layout, config=TraceConfig(0, 0, 2))
    nearest = np.array([layout.nearest(*place) for place in maps.position])
    covered = np.zeros(layout.n_states, dtype=bool)
    covered[nearest] = True
    for cell in nearest:
        assert not covered[layout.next_state[cell, layout.action_mask[cell]]].any()
    for cell in nearest:
        covered[layout.next_state[cell, layout.action_mask[cell]]] = True
    assert covered.all()
    assert maps.found[nearest, np.arange(nearest.size)].all()
    assert maps.hops.max() < NO_WAY


@pytest.mark.parametrize("width_m", [6.51, 6.6, 6.99])
def test_places_of_hypotheses_are_inside_where_a_wall_is_beside_a_cells_centre(width_m):
    corners = [[0, 0], [width_m, 0], [width_m, 4.55], [0, 4.55], [0, 0]]
    plan = floorplans.loads(f"""
        name = "narrow"
        format = 1
        height_m = 2.5
        floor_material = "concrete"
        ceiling_material = "concrete"
        outline = {corners}
        start = [1.5, 1.5]
        [[walls]]
        points = {corners}
        material = "brick"
        thickness_m = 0.2
    """)
    layout = reachable_layout(plan)
    maps = Hypotheses.of_plan(plan, layout, config=TraceConfig(0, 0, 0))
    assert (maps.position > 0.0).all()
    assert (maps.position < (width_m, 4.55)).all()
    nearest = [layout.nearest(*place) for place in maps.position]
    assert maps.position == pytest.approx(layout.position[nearest], abs=0.15)
    assert np.isfinite(maps.rss_dbm).all()


def test_places_beside_a_cell_are_not_behind_a_wall():
    plan = floorplans.load("scenario1")
    wall = plan.solid_segments(1.2)[5]
    along = (wall[1] - wall[0]) / np.hypot(*(wall[1] - wall[0]))
    beside = wall.mean(axis=0) + 0.05 * np.array([-along[1], along[0]])
    (place,) = places_beside(plan, beside[None], (0.2, 0.15), 1.2)
    assert are_in_sight(plan, beside[None], place[None], 1.2)


@pytest.mark.parametrize("make", [MapSearch, Qmdp, Infotaxis])
def test_searchers_with_maps_find_ways_round_doors_that_they_saw_closed(make):
    """Of one hypothesis that is true, they reach it after the detour, and not later."""
    mission = room_mission(ModeProcess(np.eye(4)[2], np.eye(4)))  # door closed, first place
    opened = room_mission().layouts[0]
    rss_dbm, found = mission.rss_dbm[2][:, None], TASK.goal.cells(mission)[2][:, None]
    maps = Hypotheses(opened, rss_dbm, found, mission.source[[2]])
    flights = fly(mission, TASK, SIGHT, make(maps), episodes=3)
    assert flights.found.all()
    closed = Hypotheses(mission.layouts[1], rss_dbm, found, mission.source[[2]])
    start = mission.starts[0]
    beside = mission.layout.nearest(4.5, 1.5)  # the door, on the side of the start
    detour = _steps_between(opened, start, beside) + closed.hops[beside, 0]
    assert np.all(flights.steps <= detour)
    assert np.all(flights.steps >= closed.hops[start, 0])


def _steps_between(layout, start, cell):
    goal = np.zeros((layout.n_states, 1), dtype=bool)
    goal[cell] = True
    return Hypotheses(layout, np.zeros(goal.shape), goal, layout.position[[cell]]).hops[start, 0]


def test_without_memory_a_step_that_was_seen_blocked_is_tried_again():
    layout = open_room().layout
    for remembers in (True, False):
        memory = StepMemory(layout, plan_known=True, remembers=remembers)
        memory.begin()
        cell = int(np.argmax(layout.action_mask.sum(axis=1)))
        blocked = layout.action_mask[cell].copy()
        action = int(np.argmax(blocked))
        beyond = layout.next_state[cell, action]
        blocked[action] = False
        memory.see(cell, blocked)
        assert not memory.possible[memory.grid_cell[cell], action]
        other = int(layout.next_state[cell, np.flatnonzero(blocked)[-1]])
        memory.see(other, layout.action_mask[other])
        assert memory.possible[memory.grid_cell[cell], action] != remembers
        assert memory.possible[memory.grid_cell[beyond], (action + 4) % 8] != remembers


@pytest.mark.parametrize(
    ("make", "name"),
    [
        (lambda layout: DistanceSearch(layout, sigma_db=0.0), "sigma_db"),
        (lambda layout: DistanceSearch(layout, targets="best"), "targets"),
        (lambda layout: FrontierSearch(layout, steps_per_db=-1.0), "steps_per_db"),
        (lambda layout: GaussianProcessSearch(layout, length_m=0.0), "length_m"),
        (lambda layout: DistanceSearch(layout, exponents=()), "exponents"),
        (lambda _: Likelihood(temper=2.0), "temper"),
    ],
)
def test_settings_out_of_range_are_named(make, name):
    with pytest.raises(ValueError, match=name):
        make(open_room().layout)


@pytest.mark.parametrize("number", range(11))
def test_searchers_that_are_not_told_their_cell_say_so(number):
    mission = open_room()
    with pytest.raises(ValueError, match="cell = -1: expected the UAV's own"):
        fly(mission, TASK, Observation(None), policies(mission)[number], episodes=1)


def test_a_faster_uav_knows_the_same_steps():
    plan = floorplans.load("flat")
    layout = Layout.of_plan(plan, Grid.over(plan.bounds, 1.0, 2.0), speed=2)
    start = int(np.argmax(layout.action_mask.sum(axis=1)))
    memory = StepMemory(layout, plan_known=True)
    memory.see(start, layout.action_mask[start])
    reached = np.sort(layout.reachable(start))
    np.testing.assert_array_equal(np.flatnonzero(memory.hops[memory.grid_cell] >= 0), reached)
