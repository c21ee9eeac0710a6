"""Each claim's test says the opposite when the data say the opposite."""

from dataclasses import replace

import numpy as np
import pytest
from small_paper import small_data

import floorplans
from floorplans import Wall
from rssnav.experiments.paper.claims import CLAIMS, ClaimResult, Verdict, claims_table, examine
from rssnav.experiments.paper.claims.compartments import compartments
from rssnav.experiments.paper.claims.flights import mean_rss_dbm, strong_percentage, turns
from rssnav.experiments.paper.claims.learning import fluctuation
from rssnav.experiments.paper.claims.verdicts import between, case, positive
from rssnav.experiments.paper.data import AGENTS, Configuration, flights, terminal_states
from rssnav.experiments.paper.scenarios import SPEEDS
from rssnav.experiments.paper.shortest_flights import shortest_flights
from rssnav.experiments.statistics import Estimate
from rssnav.optimal_flights import path_length_m, shortest_path

YES, NO, OPEN = Verdict.REPRODUCED, Verdict.NOT_REPRODUCED, Verdict.INCONCLUSIVE


def verdict(key, data):
    (claim,) = (claim for claim in CLAIMS if claim.key == key)
    return ClaimResult(claim, tuple(claim.cases(data))).verdict


def changed(data, change):
    """The data with a function (key, result) -> result applied to every training."""
    return replace(data, results={k: change(k, r) for k, r in data.results.items()})


def swapped(data):
    """The data with the agents' names swapped."""
    other = {"rss": "location", "location": "rss"}
    swap = {key: replace(key, agent=other[key.agent]) for key in data.results}
    return replace(
        data,
        results={key: data.results[swap[key]] for key in data.results},
        first_episodes={key: data.first_episodes[swap[key]] for key in data.first_episodes},
    )


def with_steps(data, factor):
    """The data with steps that are a factor (key, episode) times 1000, a little apart by run."""

    def change(key, result):
        n_runs, n_episodes = result.steps.shape
        per_episode = 1000.0 * factor(key, np.arange(n_episodes) / 1000.0)
        steps = np.outer(1.0 + 0.001 * np.arange(n_runs), per_episode * np.ones(n_episodes))
        return replace(result, steps=steps.astype(np.int32))

    return changed(data, change)


def test_a_positive_statistic_is_judged_by_its_whole_interval():
    assert positive(Estimate(1.0, 0.1, 2.0)) is YES
    assert positive(Estimate(1.0, -0.1, 2.0)) is OPEN
    assert positive(Estimate(-1.0, -2.0, -0.1)) is NO
    assert positive(Estimate(0.0, 0.0, 0.0)) is NO


def test_a_range_is_judged_by_the_whole_interval():
    decide = between(0.8, 1.25)
    assert decide(Estimate(1.0, 0.9, 1.1)) is YES
    assert decide(Estimate(1.0, 0.7, 1.1)) is OPEN
    assert decide(Estimate(1.5, 1.3, 1.7)) is NO


def test_a_claim_holds_if_all_its_cases_do_and_fails_if_one_does():
    good, bad, open_ = (case("", (), Estimate(x, x - 0.5, x + 0.5)) for x in (1.0, -1.0, 0.0))
    assert ClaimResult(CLAIMS[0], (good, good)).verdict is YES
    assert ClaimResult(CLAIMS[0], (good, open_)).verdict is OPEN
    assert ClaimResult(CLAIMS[0], (good, open_, bad)).verdict is NO
    assert ClaimResult(CLAIMS[0], (good, open_, bad)).reproduced_cases == 1


def test_keys_of_claims_are_unique():
    assert len({claim.key for claim in CLAIMS}) == len(CLAIMS)


@pytest.mark.parametrize("key", ["early-steps", "rss-fluctuates-less"])
def test_agents_are_told_apart(key):
    more = {"location": 2.0, "rss": 1.0}
    data = with_steps(
        small_data(), lambda k, t: more[k.agent] * (1.0 + 0.5 * (np.arange(t.size) % 2))
    )
    assert verdict(key, data) is YES
    assert verdict(key, swapped(data)) is NO


def test_steps_must_fall_with_the_episode():
    falling = with_steps(small_data(), lambda _, t: np.maximum(2.0 - t, 0.1))
    rising = with_steps(small_data(), lambda _, t: 1.0 + t)
    assert verdict("steps-fall-with-episode", falling) is YES
    assert verdict("steps-fall-with-episode", rising) is NO


def test_steps_must_fall_with_speed():
    falling = with_steps(small_data(), lambda k, t: np.ones_like(t) / k.speed)
    assert verdict("steps-fall-with-speed", falling) is YES
    rising = with_steps(small_data(), lambda k, t: k.speed * np.ones_like(t))
    assert verdict("steps-fall-with-speed", rising) is NO


def test_visits_near_the_start_are_compared_per_episode():
    data = small_data()
    more = {"location": 3, "rss": 1}
    first = {
        key: replace(each, visits=np.full_like(each.visits, more[key.agent]))
        for key, each in data.first_episodes.items()
    }
    data = replace(data, first_episodes=first)
    assert verdict("visits-near-start", data) is YES
    assert verdict("visits-near-start", swapped(data)) is NO


def test_good_policies_arrive_in_few_steps():
    data = small_data()
    fewest = data.shortest_in_steps[1, 1].steps

    def with_policies(reached, steps):
        first = {
            key: replace(
                each,
                reached=np.full_like(each.reached, reached),
                path_steps=np.full_like(each.path_steps, steps),
            )
            for key, each in data.first_episodes.items()
        }
        return replace(data, first_episodes=first)

    assert verdict("good-by-1000", with_policies(True, fewest)) is YES
    assert verdict("good-by-1000", with_policies(True, 2 * fewest)) is NO
    assert verdict("good-by-1000", with_policies(False, 1)) is NO


def test_every_measure_of_convergence_must_fall_with_speed():
    data = small_data()

    def converging(time):
        return changed(
            data,
            lambda key, result: replace(
                result,
                converged_episode=time(key) + np.arange(result.run_ids.size),
                converged_steps=time(key) + np.arange(result.run_ids.size),
                converged_cpu_s=time(key) + 1e-3 * np.arange(result.run_ids.size),
            ),
        )

    falling, rising = converging(lambda k: 1000 // k.speed), converging(lambda k: 1000 * k.speed)
    for key in ("episodes-to-convergence-falls", "flight-time-h-falls", "cpu-time-ms-falls"):
        assert verdict(key, falling) is YES
        assert verdict(key, rising) is NO
    assert verdict("comparable-at-high-speed", falling) is YES
    slower = converging(lambda k: 2000 if k.agent == "rss" else 1000)
    assert verdict("comparable-at-high-speed", slower) is NO


def test_runs_that_do_not_converge_are_counted():
    data = small_data()
    assert verdict("all-converge", data) is YES
    key = Configuration(1, "rss", 4)
    one_short = data.results[key].converged_episode.copy()
    one_short[0] = -1
    short = {**data.results, key: replace(data.results[key], converged_episode=one_short)}
    assert verdict("all-converge", replace(data, results=short)) is NO


def test_no_converged_run_leaves_the_time_open():
    none = changed(
        small_data(),
        lambda _, result: replace(
            result, converged_episode=np.full_like(result.converged_episode, -1)
        ),
    )
    assert verdict("comparable-at-high-speed", none) is OPEN


def test_lengths_are_compared_between_the_agents():
    def lengths(rss_m, location_m):
        at = {"rss": rss_m, "location": location_m}
        return changed(
            small_data(),
            lambda key, result: replace(
                result, path_length_m=at[key.agent] + 0.01 * np.arange(result.run_ids.size)
            ),
        )

    assert verdict("location-shorter", lengths(101.0, 100.0)) is YES
    assert verdict("location-shorter", lengths(100.0, 101.0)) is NO
    assert verdict("lengths-close", lengths(101.0, 100.0)) is YES
    assert verdict("lengths-close", lengths(150.0, 100.0)) is NO


def test_turns_are_changes_of_heading():
    world = small_data().result(1, "location", 1).world
    west = [world.start_state]
    for _ in range(4):
        west.append(int(world.next_state[west[-1], 4]))
    assert turns(world, np.array(west)) == 0.0
    assert turns(world, np.array([*west[:2], *west])) == 2.0  # a step, back, and on


def detour(_, result):
    """Flights that first visit a neighbour of the start that no shortest flight visits."""
    rows = [np.concatenate(([0, detour_state(result), 0], row[1:])) for row in flights(result)]
    width = max(row.size for row in rows)
    padded = [np.pad(row, (0, width - row.size), constant_values=-1) for row in rows]
    return replace(result, trajectories=np.array(padded, dtype=np.int32))


def detour_state(result):
    return int(result.world.next_state[result.world.start_state, 2])  # to the north


@pytest.mark.parametrize(("detour_dbm", "expected"), [(-21.1, YES), (-90.0, NO)])
def test_low_rss_is_judged_against_the_shortest_flights(detour_dbm, expected):
    def light(_, result):
        rss_dbm = result.world.rss_dbm.copy()
        rss_dbm[detour_state(result)] = detour_dbm
        return replace(result, world=replace(result.world, rss_dbm=rss_dbm))

    cases = _cases("avoids-low-rss", changed(changed(small_data(), detour), light))
    assert [case.verdict for case in cases if "mean RSS" in case.name] == [expected] * 2


def _cases(key, data):
    (claim,) = (claim for claim in CLAIMS if claim.key == key)
    return claim.cases(data)


def test_statistics_of_flights():
    world = small_data().result(1, "rss", 1).world
    flight = np.array([0, 1, 2])
    assert mean_rss_dbm(world, [flight])[0] == pytest.approx(world.rss_dbm[:3].mean())
    dark = replace(world, rss_dbm=np.where(np.arange(world.n_states) < 2, -np.inf, world.rss_dbm))
    assert mean_rss_dbm(dark, [flight])[0] == pytest.approx((-300.0 + world.rss_dbm[2]) / 3.0)
    weakest = np.argsort(world.rss_dbm)[:1]
    strongest = np.argsort(world.rss_dbm)[-1:]
    assert strong_percentage(world, [weakest, strongest]).tolist() == [0.0, 100.0]


def test_fluctuation_is_the_mean_change_between_episodes():
    result = small_data().result(1, "rss", 1)
    steps = np.tile(np.array([10, 30], dtype=np.int32), 500)
    result = replace(result, steps=np.stack((steps, np.full(1000, 20, dtype=np.int32))))
    assert fluctuation(result).tolist() == [20.0, 0.0]


@pytest.mark.parametrize("speed", SPEEDS)
def test_drawn_flights_are_as_short_as_possible_and_differ(speed):
    result = small_data().result(1, "location", speed)
    world, terminal = result.world, terminal_states(result)
    least_m = shortest_path(world, terminal, "metres").length_m
    drawn = shortest_flights(world, terminal, 50)
    for flight in drawn:
        assert flight[0] == world.start_state
        assert terminal[flight[-1]]
        assert np.all(np.any(world.next_state[flight[:-1]] == flight[1:, None], axis=1))
        assert path_length_m(world, flight) == pytest.approx(least_m)


def test_drawn_flights_are_equally_likely(room_world):
    terminal = room_world.distance_m < 2.0
    drawn = shortest_flights(room_world, terminal, 4000)
    _, counts = np.unique([flight.tobytes() for flight in drawn], return_counts=True)
    assert counts.size > 1
    expected = len(drawn) / counts.size
    assert np.all(np.abs(counts - expected) < 5.0 * np.sqrt(expected))


def test_the_table_holds_every_case():
    findings = examine(small_data())
    table = claims_table(findings)
    assert len(table.rows) == sum(len(finding.cases) for finding in findings)
    assert {finding.claim.key for finding in findings} == {claim.key for claim in CLAIMS}
    assert all(len(finding.cases) > 0 for finding in findings)


def test_all_agents_and_speeds_are_examined():
    names = " ".join(case.name for case in _cases("all-converge", small_data()))
    for key in small_data().results:
        assert key.label in names
    assert len(small_data().results) == 2 * len(AGENTS) * len(SPEEDS)


def test_compartments_are_the_rooms_behind_doors():
    """Those of Scenario 2: eight rooms of its blocks and two store rooms, no hallways."""
    rooms = compartments(floorplans.load("scenario2"))
    assert len(rooms.geoms) == 10
    areas = sorted(round(room.area) for room in rooms.geoms)
    assert areas == [78, 78, 186, 186, 186, 200, 200, 220, 440, 540]


def test_flights_through_a_compartment_are_told_from_those_around_it():
    """A wall across the building, and one flight through the room that it makes."""
    data = small_data()
    plan = data.scenarios[2].plan
    assert compartments(plan).is_empty
    assert verdict("location-enters-compartments", data) is OPEN
    west = Wall((9.0, 0.0), (9.0, 12.0), "plasterboard", 0.1, 3.0)
    east = replace(west, start=(15.0, 0.0), end=(15.0, 12.0))
    across = replace(plan, walls=(*plan.walls, west, east))
    corner = replace(west, start=(0.0, 1.0), end=(1.0, 0.0))
    beside = replace(plan, walls=(*plan.walls, corner))
    cases = {}
    for name, walled in (("across", across), ("beside", beside)):
        scenarios = {**data.scenarios, 2: replace(data.scenarios[2], plan=walled)}
        (claim,) = (c for c in CLAIMS if c.key == "location-enters-compartments")
        cases[name] = [c.verdict for c in claim.cases(replace(data, scenarios=scenarios))]
    assert cases["across"] == [YES, NO, NO]
    assert cases["beside"] == [NO, YES, YES]
