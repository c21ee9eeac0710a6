"""Searchers: their flights are flights, and do what their rule says."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.sparse import csr_array
from scipy.sparse.csgraph import shortest_path as all_distances
from small_worlds import SmallPlan, room_plan, world_of

from rssnav import Fluctuation
from rssnav.agents import RssAgent
from rssnav.kernels import particle_filter
from rssnav.kernels.particle_filter import Belief, Chart, Model
from rssnav.learning_parameters import QLearning
from rssnav.learning_rules import process_moves
from rssnav.searchers import ParticleFilter, RandomWalk, RssAscent, search
from rssnav.training import generator_states

SEARCHERS = pytest.mark.parametrize(
    "searcher",
    [RandomWalk(), RssAscent(), RssAscent(readings=3), ParticleFilter(particles=50)],
    ids=["walk", "ascent", "averaging ascent", "particle filter"],
)
OPEN = SmallPlan((12.0, 9.0), (1.3, 1.4, 1.5), (10.5, 7.5))
POCKET = replace(OPEN, start=(10.5, 1.5), segments=(((6.0, 0.0), (6.0, 8.0)),))


@SEARCHERS
def test_a_flight_is_a_chain_of_possible_steps(room_world, searcher):
    result = search(room_world, searcher, runs=10, max_steps=400, seed=3)
    for states, length_m in zip(result.flights, result.length_m, strict=True):
        assert states[0] == room_world.start_state
        moved = states[1:] != states[:-1]
        follows = room_world.next_state[states[:-1]]
        assert np.all(np.any(follows == states[1:, None], axis=1) | ~moved)
        gaps = np.diff(room_world.position[states], axis=0)
        assert length_m == pytest.approx(np.hypot(gaps[:, 0], gaps[:, 1]).sum())


@SEARCHERS
def test_the_number_of_threads_changes_nothing_and_the_seed_does(room_world, searcher):
    options = {"runs": 6, "max_steps": 300}
    one = search(room_world, searcher, seed=1, threads=1, **options)
    many = search(room_world, searcher, seed=1, threads=4, **options)
    other = search(room_world, searcher, seed=2, threads=4, **options)
    same = [np.array_equal(a, b) for a, b in zip(one.flights, many.flights, strict=True)]
    assert all(same)
    assert any(not np.array_equal(a, b) for a, b in zip(one.flights, other.flights, strict=True))


@SEARCHERS
def test_a_flight_ends_at_the_first_cell_of_the_goal_or_in_time(room_world, searcher):
    result = search(room_world, searcher, runs=20, max_steps=40, seed=4)
    terminal = room_world.rss_dbm > -21.0
    for states, found in zip(result.flights, result.found, strict=True):
        assert found == terminal[states[-1]]
        assert found or states.size == 41
    assert not result.false_alarm.any()


def test_a_random_walk_takes_as_long_as_its_equations_say():
    """Mean first passage times m = 1 + P m, m = 0 at the goal, in a corridor."""
    world = world_of(SmallPlan((7.0, 1.0), (0.3, 0.5, 1.5), (5.5, 0.5)))
    terminal = world.rss_dbm > -21.0
    possible = world.action_mask
    passing = np.zeros((world.n_states, world.n_states))
    for state in np.flatnonzero(~terminal):
        for there in world.next_state[state][possible[state]]:
            passing[state, there] += 1.0 / possible[state].sum()
    costs = np.where(terminal, 0.0, 1.0)
    expected = np.linalg.solve(np.eye(world.n_states) - passing, costs)[world.start_state]
    steps = search(world, RandomWalk(), runs=3000, max_steps=2000).steps
    assert abs(steps.mean() - expected) < 4.0 * steps.std() / np.sqrt(steps.size)


def test_ascent_keeps_only_steps_that_read_more():
    world = world_of(OPEN)
    result = search(world, RssAscent(escape_steps=0), runs=20)
    assert result.found.all()
    for states in result.flights:
        rss_dbm = world.rss_dbm[states]
        level_dbm, k = rss_dbm[0], 1
        while k < rss_dbm.size:
            if rss_dbm[k] > level_dbm:
                level_dbm, k = rss_dbm[k], k + 1
            else:
                assert states[k + 1] == states[k - 1]
                k += 2


def test_ascent_alone_gives_up_in_a_pocket_and_escapes_lead_out():
    world = world_of(POCKET)
    alone = search(world, RssAscent(escape_steps=0), runs=20, max_steps=3000)
    escaping = search(world, RssAscent(escape_steps=20), runs=20)
    assert not alone.found.any()
    assert alone.steps.max() < 200
    assert escaping.found.all()


def test_averaging_stays_for_its_readings_and_helps_against_fluctuation():
    world, noise = world_of(OPEN), Fluctuation(2.0)
    single = search(world, RssAscent(1, 0), runs=200, fluctuation=noise)
    averaged = search(world, RssAscent(32, 0), runs=200, fluctuation=noise)
    for states in averaged.flights:
        stays = np.diff(np.flatnonzero(np.diff(states) != 0))
        assert set(stays.tolist()) <= {32, 1}  # 1 where it flies back
    assert averaged.found.sum() > single.found.sum() + 40
    assert single.false_alarm.any()
    assert not (single.found & single.false_alarm).any()


@pytest.fixture
def model():
    return Model(
        low=np.array([0.0, 0.0, -20.0, 1.5]),
        high=np.array([10.0, 8.0, -10.0, 5.0]),
        jitter=np.zeros(4),
        sigma_db=6.0,
        fresh_fraction=0.0,
        found_m=2.0,
        steps_to_draw=10,
        sensitivity_dbm=-120.0,
    )


def belief_of(model, count=200):
    rng = np.random.default_rng(0)
    particles = rng.uniform(model.low, model.high, (count, 4))
    return Belief(particles, np.full(count, 1.0 / count), np.empty((count, 4)))


def test_weights_are_bayes_rule(model):
    belief = belief_of(model)
    assert particle_filter.weigh(belief, model, 3.5, 4.5, -40.0)
    x, y, power_dbm, exponent = belief.particles.T
    distance_m = np.hypot(x - 3.5, y - 4.5)
    expected_dbm = power_dbm - 10.0 * exponent * np.log10(distance_m)
    likelihood = np.exp(-0.5 * ((-40.0 - expected_dbm) / 6.0) ** 2) * (distance_m >= 2.0)
    assert np.allclose(belief.weights, likelihood / likelihood.sum())


def test_impossible_readings_are_noticed(model):
    belief = belief_of(model)
    belief.particles[:, :2] = (3.5, 4.5)
    assert not particle_filter.weigh(belief, model, 3.0, 4.0, -40.0)


def test_systematic_resampling_keeps_each_particle_in_proportion(model):
    belief = belief_of(model)
    belief.weights[:] = np.random.default_rng(1).dirichlet(np.ones(belief.weights.size))
    expected = belief.weights.size * belief.weights
    before = belief.particles.copy()
    particle_filter.resample(belief, model, generator_states(0, 0)[:4])
    copies = np.array([np.all(belief.particles == particle, axis=1).sum() for particle in before])
    assert np.all(np.abs(copies - expected) < 1.0)
    assert np.allclose(belief.weights, 1.0 / belief.weights.size)


def test_hops_are_shortest_distances(room_world):
    process = RssAgent().decision_process(room_world, QLearning())
    size = room_world.n_states
    state, action = np.nonzero(room_world.action_mask)
    graph = csr_array(
        (np.ones(state.size), (state, room_world.next_state[state, action])), shape=(size, size)
    )
    hops, queue = np.empty(size, dtype=np.int32), np.empty(size, dtype=np.int32)
    chart = Chart(room_world.position, hops, queue)
    distances = all_distances(graph, unweighted=True)
    for place in range(0, size, 7):
        particle_filter.count_hops(process_moves(process), chart, place)
        assert np.array_equal(hops, distances[:, place])


def test_the_filter_finds_the_source_where_its_model_holds():
    world = world_of(POCKET)
    filtered = search(world, ParticleFilter(), runs=50)
    walked = search(world, RandomWalk(), runs=50)
    assert filtered.found.all()
    assert filtered.steps.mean() < walked.steps.mean() / 3.0


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: RssAscent(readings=0), "readings = 0: expected at least 1"),
        (lambda: RssAscent(escape_steps=-1), "escape_steps = -1: expected at least 0"),
        (lambda: ParticleFilter(particles=1), "particles = 1: expected at least 2"),
        (lambda: ParticleFilter(exponent=(3.0, 2.0)), "exponent = .* lower and a higher"),
        (lambda: ParticleFilter(fresh_fraction=1.0), "fresh_fraction = 1.0: expected"),
    ],
)
def test_parameters_out_of_range_are_refused(make, message):
    with pytest.raises(ValueError, match=message):
        make()


@pytest.mark.parametrize("wrong", [{"runs": 0}, {"max_steps": 0}, {"threads": 0}])
def test_budgets_out_of_range_are_refused(wrong):
    with pytest.raises(ValueError, match=f"{next(iter(wrong))} = 0: expected at least 1"):
        search(world_of(room_plan()), RandomWalk(), **wrong)
