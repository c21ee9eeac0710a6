"""The search for plans: what it draws, which plans it keeps, and how it scores them."""

from __future__ import annotations

from dataclasses import replace
from itertools import product

import numpy as np
import pytest

import floorplans
from floorplans import Wall
from raytrace import Grid
from rssnav.experiments.paper.counting import Count
from rssnav.experiments.paper.data import CONFIGURATIONS
from rssnav.experiments.progress import ignore
from rssnav.experiments.studies.plan_search import figure, fits, tables
from rssnav.experiments.studies.plan_search.constraints import (
    PAPERS_AGENT,
    allows_printed_flights,
    arrivals,
    fewest_wanted,
    has_the_stated_map,
)
from rssnav.experiments.studies.plan_search.families import draw
from rssnav.experiments.studies.plan_search.fits import BUILT_IN, Fit, Piece
from rssnav.experiments.studies.readings.empty_floor import FLOORS, lattice
from rssnav.experiments.studies.readings.empty_floor import arrivals as empty_arrivals
from rssnav.experiments.studies.readings.interpretations import STATED_GOAL, Geometry
from rssnav.experiments.studies.readings.lengths import StepCounts
from rssnav.experiments.studies.study import Conditions
from rssnav.experiments.training_store import TrainingStore
from rssnav.missions.layout import Layout

KNOWN_SEED = {1: 560, 2: 36}
"""Seeds whose first plan allows the printed flights."""

scenarios = pytest.mark.parametrize("scenario", [1, 2])


@scenarios
def test_drawn_plans_have_what_the_paper_states(scenario: int) -> None:
    known = floorplans.load(f"scenario{scenario}")
    drawn = [draw(scenario, np.random.default_rng(seed)) for seed in range(30)]
    plans = [plan for plan in drawn if plan is not None]
    assert len(plans) > 15
    assert len({plan.sha256 for plan in plans}) == len(plans)
    for plan in plans:
        assert (plan.bounds, plan.source, plan.start) == (known.bounds, known.source, known.start)
        ends = plan.solid_segments(2.0)
        np.testing.assert_array_equal(ends, np.round(ends))


@scenarios
@pytest.mark.parametrize("speed", [2, 4])
def test_without_inner_walls_the_flights_are_those_of_the_empty_floor(scenario, speed) -> None:
    plan = floorplans.load(f"scenario{scenario}")
    outside = tuple(wall for wall in plan.walls if wall.material == "concrete")
    found = arrivals(replace(plan, walls=outside), speed, 40)
    geometry = Geometry(0.5, (0.0, 0.0), STATED_GOAL)
    empty = empty_arrivals(lattice(FLOORS[scenario], geometry, speed), 39)
    assert (found.straight, found.diagonal) == (empty.straight, empty.diagonal)


def test_flights_are_those_of_an_enumeration() -> None:
    """All flights of up to 4 steps from a cell near the source, one by one."""
    plan = floorplans.load("scenario1")
    plan = replace(plan, start=(8.5, 13.5))
    found = arrivals(plan, 1, 4)
    layout = Layout.of_plan(plan, Grid.over(plan.bounds, 1.0, 2.0), 1)
    goal = layout.distance_m(*plan.source[:2]) < 2.0
    for n, diagonal in product(range(1, 5), range(5)):
        flights = _flights(layout, goal, layout.nearest(*plan.start), n)
        exists = any(sum(a % 2 for a in flight) == diagonal for flight in flights)
        assert found.has(StepCounts(n, diagonal), Count.ALL) == exists


def _flights(layout, goal, start, n):
    """Actions of all flights that enter the goal with step n."""
    unfinished = [((), start)]
    for step in range(1, n + 1):
        longer = [
            ((*flight, action), int(layout.next_state[cell, action]))
            for flight, cell in unfinished
            for action in range(8)
            if layout.next_state[cell, action] >= 0
        ]
        arrived = [flight for flight, cell in longer if goal[cell]]
        unfinished = [(flight, cell) for flight, cell in longer if not goal[cell]]
        if step == n:
            return arrived
    return []


def test_the_wanted_steps_are_one_more_than_printed() -> None:
    assert [fewest_wanted(1, speed) for speed in (1, 2, 4)] == [87, 44, 23]
    assert [fewest_wanted(2, speed) for speed in (1, 2, 4)] == [100, 52, 28]


def test_a_wall_that_costs_steps_is_not_allowed() -> None:
    """It stands five steps west of the start, where the UAV must be twelve steps further north."""
    plan = floorplans.load("scenario1")
    assert allows_printed_flights(plan, 1)
    wall = Wall((88.0, 0.0), (88.0, 14.0), "plasterboard", 0.1, 3.0)
    longer = replace(plan, walls=(*plan.walls, wall))
    assert not allows_printed_flights(longer, 1)
    assert arrivals(longer, 1, 100).least_steps == 87 + 12 - 5


def fit(deviation, scenario=1, block=0, turns=(2.0, 1.0)) -> Fit:
    keys = [key for key in CONFIGURATIONS if key.scenario == scenario]
    per_agent = {"rss": turns[0], "location": turns[1]}
    return Fit(
        Piece(scenario, block),
        0,
        "",
        {key: deviation[key.speed] for key in keys},
        {key: per_agent[key.agent] for key in keys},
        dict.fromkeys(keys, 1.0),
    )


FOUND = [
    fit({1: 0.0, 2: 0.0, 4: 0.0}, block=BUILT_IN),
    fit({1: -0.01, 2: 0.02, 4: 0.3}),
    fit({1: 0.08, 2: 0.08, 4: 0.04}, turns=(1.0, 2.0)),
]


def test_the_score_counts_close_lengths_and_claims() -> None:
    """At equal deviations the RSS agent flies farther by the paper's lengths."""
    assert [(f.lengths(), f.claims(), f.score) for f in FOUND] == [
        (6, 6, 12),
        (4, 6, 10),
        (2, 3, 5),
    ]


def test_the_summary_counts_plans_that_fit_as_well_as_the_best_drawn_one() -> None:
    row, empty = tables.summary(FOUND, {1: 2, 2: 3}).records()
    assert (row["drawn"], row["allowed"], row["as_good"]) == (500, 2, 1)
    assert (row["best_score"], row["built_in_score"]) == (10, 12)
    assert row["best_percent"] == pytest.approx(8.0)
    assert row["built_in_percent"] == pytest.approx(0.0)
    assert (empty["drawn"], empty["allowed"], empty["best_score"]) == (750, 0, None)


def test_predictions_come_from_the_plans_that_fit_the_other_lengths() -> None:
    at_4, claims, *empty = tables.held_out(FOUND).records()
    assert at_4["chosen"] == at_4["best_tenth"] == pytest.approx(30.0)
    assert at_4["all"] == pytest.approx(17.0)
    assert at_4["correlation"] == pytest.approx(-1.0)
    assert (claims["chosen"], claims["correlation"]) == (3, pytest.approx(-1.0))
    assert all(row["chosen"] is None for row in empty)


def test_each_deviation_stands_below_its_configuration() -> None:
    """The deviations come in the order of training, the columns in the paper's."""
    keys = [key for key in CONFIGURATIONS if key.scenario == 2]
    by_speed = sorted(keys, key=lambda key: key.speed)
    deviation = {key: 0.01 * key.speed + 0.1 * (key.agent == "rss") for key in by_speed}
    one = Fit(Piece(2, 0), 0, "", deviation, dict.fromkeys(keys, 0.0), dict.fromkeys(keys, 1.0))
    row = tables.fits([one]).records()[0]
    for key in keys:
        assert row[f"{key.agent}_{key.speed}_percent"] == pytest.approx(100.0 * deviation[key])


def test_the_best_drawn_plan_is_written() -> None:
    texts = [replace(f, toml=f"score {f.score}") for f in (*FOUND, FOUND[2])]
    assert [row["score"] for row in tables.fits(texts).records()] == [12, 10, 5, 5]
    assert tables.best_plans(texts) == {"plans/scenario1.toml": "score 10"}


@scenarios
def test_the_built_in_maps_are_such_as_the_paper_says(scenario_map, scenario: int) -> None:
    """And those are not in which a cell is too weak, reads as another, or is wrongly a goal."""
    plan, radio_map = floorplans.load(f"scenario{scenario}"), scenario_map(f"scenario{scenario}")
    assert has_the_stated_map(plan, radio_map)
    for value in (-np.inf, PAPERS_AGENT.sensitivity_dbm, radio_map.rss_dbm[-1, -2], -20.0):
        rss_dbm = radio_map.rss_dbm.copy()
        rss_dbm[-1, -1] = value
        assert not has_the_stated_map(plan, replace(radio_map, rss_dbm=rss_dbm))


def test_plans_with_a_cell_that_cannot_be_flown_to_are_left_out(scenario_map) -> None:
    plan = floorplans.load("scenario1")
    ends = (95.0, 26.0), (96.0, 25.0)
    corner = [Wall((95.0, 25.0), end, "plasterboard", 0.1, 3.0) for end in ends]
    closed = replace(plan, walls=(*plan.walls, *corner))
    assert not has_the_stated_map(closed, scenario_map("scenario1"))


def test_only_plans_with_such_maps_are_trained_in(monkeypatch, tmp_path) -> None:
    plan = floorplans.load("flat")
    fitting = [True, False]
    monkeypatch.setattr(fits, "_plans", lambda *_: enumerate([plan, plan]))
    monkeypatch.setattr(fits, "make_map", lambda *_, **__: None)
    monkeypatch.setattr(fits, "has_the_stated_map", lambda *_: fitting.pop(0))
    monkeypatch.setattr(fits, "_fit", lambda piece, number, *_: number)
    store = TrainingStore(tmp_path, 1, True, ignore)
    assert fits.measure(Piece(1, 0), Conditions({}, {}, 1, 0, store)) == [0]


def test_the_figure_has_a_line_per_plan_and_agent() -> None:
    drawn = figure.draw(FOUND)
    lines = [[line for line in ax.lines if len(line.get_xdata()) == 3] for ax in drawn.axes]
    assert [len(each) for each in lines] == [2 * len(FOUND), 0]
    np.testing.assert_allclose(lines[0][2].get_ydata(), [-1.0, 2.0, 30.0])


def test_a_plan_without_arrivals_fits_worst() -> None:
    lost = fit({1: float("nan"), 2: 0.0, 4: 0.0})
    assert lost.worst() == np.inf
    assert tables.fits([lost]).records()[0]["worst_percent"] is None


@scenarios
def test_some_drawn_plans_allow_the_printed_flights(scenario: int) -> None:
    """The one of a seed that is known to have some, so that the ranges keep their purpose."""
    rng = np.random.default_rng(KNOWN_SEED[scenario])
    plan = draw(scenario, rng)
    assert plan is not None
    assert allows_printed_flights(plan, scenario)
