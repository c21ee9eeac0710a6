"""The benchmark: flights are scored as computed by hand and resumed, and splits never mix."""

from __future__ import annotations

import json
import shutil
from copy import deepcopy
from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from benchmark_records import record
from small_missions import room_mission

from rssnav.benchmark import running
from rssnav.benchmark.buildings import (
    DOORS,
    GOAL,
    LEAST_STEPS,
    Building,
    generated,
    paper,
)
from rssnav.benchmark.errors import BenchmarkError
from rssnav.benchmark.frozen import FINGERPRINTS
from rssnav.benchmark.policies import POLICIES, Briefing, Guarded, PolicySpec, policy_of
from rssnav.benchmark.protocol import CONDITIONS, FULL, Extent, conditions_of, extent_of
from rssnav.benchmark.running import run, shortest
from rssnav.benchmark.scores import WITHIN_S, scores, spl
from rssnav.missions import HOVER, Flights, ModeProcess, RandomPolicy, Task, fly
from rssnav.policies import Hypotheses

CONDITION = {condition.name: condition for condition in CONDITIONS}
SMALL = Extent(split="train", generated=1, paper=False, seeds=1)
ORACLES = [policy for policy in POLICIES if policy.track == "world"]


@pytest.fixture(scope="module")
def building() -> Building:
    return next(generated("train", 1))


@pytest.fixture(scope="module")
def maps(tmp_path_factory):
    """Folder of maps, traced once for all tests."""
    return tmp_path_factory.mktemp("maps")


@pytest.fixture(scope="module")
def mission(building, maps):
    return building.mission(maps)


@pytest.fixture
def folder(tmp_path, maps):
    """Folder of a run that finds its maps traced."""
    (tmp_path / "maps").symlink_to(maps)
    return tmp_path


def test_scores_are_those_computed_by_hand():
    assert spl(record()) == pytest.approx((1.0 + 20 / 25 + 0.0) / 3)
    other = record(building="c", found=[False] * 3, false_alarm=[False] * 3)
    (score,) = scores([record(), other])
    assert score.flights == 6
    assert score.spl_by_building == [0.6, 0.0]
    assert score.spl.value == pytest.approx(0.3)
    assert (score.spl.low, score.spl.high) == (0.0, 0.6)  # buildings are resampled, not flights
    assert score.success.value == pytest.approx(1 / 3, abs=1e-4)
    assert score.false_alarms.value == pytest.approx(1 / 6, abs=1e-4)
    assert score.median_s is None
    assert score.found_within == [0.1667, 0.3333, 0.3333, 0.3333, 0.3333]
    assert len(score.found_within) == len(WITHIN_S)
    assert (score.energy_kj, score.turns, score.collisions) == (3.0, 2.0, 8)
    assert score.step_us == pytest.approx(1e6 * 0.018 / 180)
    (alone,) = scores([record()])
    assert alone.median_s == 30.0


def flights_of(cells, modes) -> Flights:
    zeros = np.zeros(1)
    path = np.array(cells, dtype=np.int32)
    return Flights(
        *(zeros > 1, zeros > 1, zeros.astype(int), zeros, zeros, zeros.astype(int), zeros, zeros),
        mode=np.array([[modes[0], modes[-1]]]),
        cells=(path,),
        modes=(np.array(modes, dtype=np.int32),),
    )


def test_the_shortest_flight_is_that_of_one_who_knows_the_jumps_beforehand():
    hops = np.array([[5, 2, 9]])
    stays, near_soon = [0] * 9, [0, 0, 0, 1, 1, 1, 1, 1, 1]
    near_too_soon = [0, 1, 0, 0, 0, 0, 0, 0, 0]
    away_and_back = [0, 0, 0, 0, 2, 2, 2, 0, 0]
    for modes, steps in ((stays, 5), (near_soon, 2), (near_too_soon, 5), (away_and_back, 5)):
        assert shortest(flights_of([0] * 9, modes), hops).tolist() == [steps]
    assert shortest(flights_of([0] * 3, [0] * 3), hops).tolist() == [5]  # ended before


@pytest.mark.parametrize("name", ["static", "jumps"])
def test_no_flight_beats_the_clairvoyant(mission, building, name):
    world, task = CONDITION[name].world(mission), CONDITION[name].task
    hops = Hypotheses.of_mission(mission, task).hops
    for spec in (ORACLES[0], next(e for e in POLICIES if e.name == "frontier search")):
        policy = spec.make(Briefing(CONDITION[name], spec.track, building, mission))
        sight = CONDITION[name].observation(world_seen=spec.track == "world")
        flights = fly(world, task, sight, policy, episodes=20)
        assert np.all(shortest(flights, hops)[flights.found] <= flights.actions[flights.found])


def test_oracles_have_an_spl_of_one_and_the_least_energy(folder):
    walk = next(policy for policy in POLICIES if policy.track == "places")
    flown = run([*ORACLES, walk], SMALL, folder, threads=1)
    by_name = {(r.policy, r.condition): r for r in flown}
    for name in ("static", "battery"):
        assert spl(by_name["oracle, fewest steps", name]) == 1.0
        assert all(by_name["oracle, least energy", name].found)
    energy = {r.policy: np.array(r.energy_kj) for r in flown if r.condition == "static"}
    least = energy.pop("oracle, least energy")
    for others in energy.values():
        assert np.all(least <= others + 1e-9)
    noisy = by_name["oracle, fewest steps", "4 dB"]
    assert all(noisy.found)
    assert all(s >= m for s, m in zip(noisy.steps, noisy.actions, strict=True))
    assert sum(noisy.steps) > sum(noisy.actions)  # readings in place cost time, not length


def test_flights_begin_far_from_all_places(mission):
    hops = Hypotheses.of_mission(mission, Task(GOAL)).hops
    assert hops[mission.starts].min() == LEAST_STEPS


def test_splits_have_no_building_in_common_and_are_those_that_were_frozen():
    for a, b in combinations(FINGERPRINTS.values(), 2):
        assert not set(a) & set(b)
    assert [len(set(known)) for known in FINGERPRINTS.values()] == [200, 50, 50, 2]
    for site, known in FINGERPRINTS.items():
        chosen = paper() if site == "paper" else generated(site, 2)
        found = [building.fingerprint for building in chosen]
        assert [f[:8] for f in found] == known[:2]


def test_another_building_than_the_frozen_one_is_refused(monkeypatch):
    monkeypatch.setitem(FINGERPRINTS, "test", ["00000000"])
    with pytest.raises(ValueError, match="test-000 is not that of the benchmark"):
        next(generated("test", 1))


def test_a_policy_is_told_what_its_track_allows(building, mission):
    def briefing(track):
        return Briefing(CONDITION["static"], track, building, mission)

    assert np.all(briefing("RSS").layout.next_state == -1)
    assert np.any(briefing("plan").layout.next_state >= 0)
    assert briefing("places").hypotheses.position.shape == (len(building.places), 2)
    for track in ("RSS", "plan"):
        with pytest.raises(ValueError, match="has no maps"):
            _ = briefing(track).hypotheses
        with pytest.raises(ValueError, match="must not see it"):
            briefing(track).world_of("world")


@pytest.fixture(scope="module")
def doors(maps):
    """Building whose doors matter, and its mission."""
    *_, building = generated("validation", 3)
    return building.with_doors, building.with_doors.mission(maps)


def test_doors_that_open_and_close_cut_no_cell_off_and_lengthen_ways(doors):
    building, mission = doors
    assert len(building.doors) == DOORS
    assert mission.n_modes == 3 * 2**DOORS
    for layout in mission.layouts:
        assert layout.reachable(0).size == building.layout.n_states
    hops = Hypotheses.of_mission(mission, Task(GOAL)).hops[mission.starts]
    assert hops[:, :3].mean() < hops[:, -3:].mean()  # all open, all closed


def test_doors_by_sight_cost_more_than_known_ones_and_memory_saves_flights(doors):
    building, mission = doors
    condition = CONDITION["doors"]
    flown = {}
    for name in ("oracle, fewest steps", "oracle, doors by sight", "distance law, greedy",
                 "distance law, doors forgotten"):  # fmt: skip
        spec = next(s for s in POLICIES if s.name == name and s.track != "RSS")
        policy = spec.make(Briefing(condition, spec.track, building, mission))
        sight = condition.observation(world_seen=spec.track == "world")
        flown[name] = fly(mission, condition.task, sight, policy, episodes=60)
    steps = {name: flights.steps.mean() for name, flights in flown.items()}
    assert steps["oracle, fewest steps"] < steps["oracle, doors by sight"]
    assert flown["oracle, doors by sight"].found.all()
    assert flown["distance law, greedy"].found.all()
    assert flown["distance law, doors forgotten"].found.mean() < 0.9


@pytest.mark.parametrize("track", ["plan", "maps", "places", "world"])
def test_what_a_policy_writes_into_its_briefing_stays_there(building, mission, track, monkeypatch):
    coarse = Hypotheses.of_mission(mission, Task(GOAL))
    monkeypatch.setitem(vars(building), "hypotheses", coarse)  # as many maps as needed here
    told = Briefing(CONDITION["static"], track, building, mission)
    mine = [told.layout.next_state, told.layout.position]
    if track in ("maps", "places"):
        maps = told.hypotheses
        mine += [maps.rss_dbm, maps.found, maps.position, maps.hops, maps.layout.next_state]
    if track == "world":
        world = told.world_of("world")
        mine += [world.rss_dbm, world.source, world.starts, world.layout.next_state]
    before = deepcopy((building.layout, mission.rss_dbm, mission.source, mission.starts, coarse))
    for array in mine:
        array[:] = 0
    after = (building.layout, mission.rss_dbm, mission.source, mission.starts, coarse)
    for one, other in zip(before[1:4], after[1:4], strict=True):
        np.testing.assert_array_equal(one, other)
    for name in ("next_state", "position"):
        np.testing.assert_array_equal(getattr(before[0], name), getattr(after[0], name))
    for name in ("rss_dbm", "found", "position", "hops"):
        np.testing.assert_array_equal(getattr(before[4], name), getattr(after[4], name))
    np.testing.assert_array_equal(before[4].layout.next_state, after[4].layout.next_state)


def test_the_papers_buildings_have_no_doors_that_open_and_close():
    assert CONDITION["doors"] not in conditions_of("paper")
    assert conditions_of("test") == CONDITIONS


class Stubborn(RandomPolicy):
    """Always flies east."""

    def act(self, observation, mask):
        return 0


class Lost(RandomPolicy):
    """Asks for an action that there is not."""

    def act(self, observation, mask):
        return 99


def test_the_flight_that_loads_kernels_is_neither_counted_nor_scored(folder):
    for flown in run([PolicySpec("lost", "RSS", lambda _: Lost())], SMALL, folder, threads=1):
        assert len(flown.steps) == 3
        assert flown.collisions == sum(flown.actions)


def test_impossible_actions_are_counted_and_become_hovering():
    mission, policy = room_mission(ModeProcess.steady(4)), Guarded(Stubborn())
    sight = CONDITION["static"].observation()
    flights = fly(mission, Task(GOAL, "none", max_steps=30), sight, policy, episodes=1)
    assert flights.steps[0] == 30
    assert policy.collisions == 30 - np.count_nonzero(np.diff(flights.cells[0]))
    assert Guarded(Stubborn()).act(None, np.ones(8, dtype=bool)) == 0
    assert policy.act(None, np.zeros(8, dtype=bool)) == HOVER


class Forger(RandomPolicy):
    """Writes into the mask that all is possible, and returns what it was made with."""

    def __init__(self, action):
        super().__init__()
        self.action = action

    def act(self, observation, mask):
        mask[:] = True
        return self.action


def test_masks_cannot_be_forged_and_what_is_no_action_is_named():
    mission, sight = room_mission(ModeProcess.steady(4)), CONDITION["static"].observation()
    east = Guarded(Forger(0))
    flights = fly(mission, Task(GOAL, "none", max_steps=30), sight, east, episodes=2)
    moved = sum(np.count_nonzero(np.diff(cells)) for cells in flights.cells)
    assert east.collisions == 60 - moved
    for action in (float("nan"), None, "east", 2.0):
        with pytest.raises(BenchmarkError, match="expected a whole number, 0 to 7 or HOVER"):
            Guarded(Forger(action)).act(None, np.ones(8, dtype=bool))


class Leaver:
    """Calls exit when it begins, or acts."""

    def __init__(self, at: str) -> None:
        self.at = at

    def begin(self, generator):
        self.leave("begin")

    def act(self, observation, mask):
        self.leave("act")

    def leave(self, at: str) -> None:
        if at == self.at:
            raise SystemExit(0)


@pytest.mark.parametrize("at", ["make", "begin", "act"])
def test_a_policy_that_calls_exit_is_told(at: str):
    def make(_briefing: Briefing) -> Leaver:
        leaver = Leaver(at)
        leaver.leave("make")
        return leaver

    def act() -> int:
        policy = Guarded.made(PolicySpec("leaver", "RSS", make), Briefing(None, "RSS", None, None))
        policy.begin(np.random.default_rng(0))
        return policy.act(None, np.ones(8, dtype=bool))

    with pytest.raises(BenchmarkError, match=r"policy '\w+': it called exit\(0\)"):
        act()


WALK = PolicySpec("walk", "RSS", lambda _: RandomPolicy())
EAST = PolicySpec("east", "RSS", lambda _: Stubborn())


def test_an_interrupted_run_is_resumed_with_the_same_result(folder):
    def interrupted(_):
        raise KeyboardInterrupt

    broken = PolicySpec("east", "RSS", interrupted)
    whole = run([WALK, EAST], SMALL, folder, threads=1)
    shutil.rmtree(folder / "flights")
    with pytest.raises(KeyboardInterrupt):
        run([WALK, broken], SMALL, folder, threads=1)
    unflyable = PolicySpec("walk", "RSS", interrupted)  # what is finished is not flown again
    parts = run([unflyable, EAST], SMALL, folder, threads=1)
    assert [replace(r, cpu_s=0.0) for r in parts] == [replace(r, cpu_s=0.0) for r in whole]


def test_several_processes_give_the_same_as_one(folder):
    extent = replace(SMALL, generated=2)
    alone = run(POLICIES[:1], extent, folder, threads=1)
    shutil.rmtree(folder / "flights")
    together = run(POLICIES[:1], extent, folder, threads=2)
    assert [r.building for r in together] == sorted(r.building for r in together)
    assert [replace(r, cpu_s=0.0) for r in together] == [replace(r, cpu_s=0.0) for r in alone]


def test_flights_of_another_program_are_flown_again(folder, monkeypatch):
    before = run([EAST], SMALL, folder, threads=1)
    (file,) = (folder / "flights").iterdir()
    content = file.read_text()
    run([EAST], SMALL, folder, threads=1)
    assert file.read_text() == content
    monkeypatch.setattr(running, "_program", lambda: "another")
    after = run([EAST], SMALL, folder, threads=1)
    assert json.loads(file.read_text())["program"] == "another"
    assert [replace(r, cpu_s=0.0) for r in after] == [replace(r, cpu_s=0.0) for r in before]


def test_a_damaged_file_of_flights_is_flown_again(folder):
    before = run([EAST], SMALL, folder, threads=1)
    (file,) = (folder / "flights").iterdir()
    whole = json.loads(file.read_text())
    other = [{**whole["records"][0], "steps": "many"}, *whole["records"][1:]]
    for damage in (
        "",
        "{",
        "[" * 100_000,
        '{"version": 1, "records": 3}',
        "\x00",
        json.dumps({**whole, "seeds": 9}),
        json.dumps({**whole, "records": other}),
    ):
        file.write_text(damage)
        after = run([EAST], SMALL, folder, threads=1)
        assert [replace(r, cpu_s=0.0) for r in after] == [replace(r, cpu_s=0.0) for r in before]
        assert json.loads(file.read_text())["seeds"] == SMALL.seeds


def test_what_is_no_policy_is_named():
    with pytest.raises(BenchmarkError, match="policy: 3; expected an object with a method begin"):
        Guarded(3)


def test_unknown_policies_tracks_and_splits_are_named():
    with pytest.raises(BenchmarkError, match="expected module:function"):
        policy_of("nowhere:make", "RSS")
    with pytest.raises(BenchmarkError, match="a function that takes a Briefing"):
        policy_of("math:pi", "RSS")
    with pytest.raises(BenchmarkError, match="track"):
        policy_of("json:loads", "everything")
    with pytest.raises(BenchmarkError, match="split"):
        extent_of(FULL, "dev", None, ())
    with pytest.raises(BenchmarkError, match="0 to 50"):
        extent_of(FULL, "test", 51, ())
    with pytest.raises(BenchmarkError, match="at least 1, or a plan"):
        extent_of(FULL, "train", 0, ())
    assert extent_of(FULL, "test", 0, ()).buildings == 2
