"""The sensitivity study: its alternatives, its arithmetic, its figure."""

from dataclasses import replace

import numpy as np
import pytest

from rssnav import LocationAgent, QLearning, RssAgent, train
from rssnav.experiments.paper.data import AGENTS, Configuration
from rssnav.experiments.paper.printed_values import PATH_LENGTH_M
from rssnav.experiments.progress import ignore
from rssnav.experiments.studies import run_study
from rssnav.experiments.studies.sensitivity import figure
from rssnav.experiments.studies.sensitivity import study as sensitivity
from rssnav.experiments.studies.sensitivity.alternatives import (
    ALTERNATIVES,
    FLOWN,
    OURS,
    Alternative,
    Outcome,
    Trial,
    measure,
)
from rssnav.experiments.studies.sensitivity.claims import claims_table
from rssnav.experiments.studies.sensitivity.tables import outcome_table, summary_table
from rssnav.experiments.studies.study import Conditions
from rssnav.experiments.training_store import TrainingStore

KEY = Configuration(1, "rss", 1)
QUICK = Alternative("decay", "quick", QLearning(eta=1e-3, max_steps=500), episodes=None)
NONE = np.empty(0)


def outcome(alternative, key, lengths_m, runs=2, episodes=(10.0, 20.0)):
    lengths = np.array(lengths_m, dtype=float)
    flown = np.array(episodes, dtype=float)
    return Outcome(alternative, key, runs, flown, 100.0 * flown, lengths, lengths / 2.0, lengths)


def test_every_alternative_differs_from_our_interpretation_in_one_respect():
    for alternative in ALTERNATIVES:
        changed = [
            name
            for name in QLearning.__dataclass_fields__
            if getattr(alternative.learning, name) != getattr(QLearning(), name)
        ]
        others = [alternative.coherent, alternative.episodes is not None]
        respects = len(set(changed) - {"eta"}) + sum(others)
        assert respects == 1 or (alternative.parameter == "training" and respects == 2)
    assert len({alternative.label for alternative in ALTERNATIVES}) == len(ALTERNATIVES)


def test_a_map_of_fields_concerns_the_rss_agent_only():
    coherent = next(alternative for alternative in ALTERNATIVES if alternative.coherent)
    assert [agent for agent in AGENTS if coherent.concerns(Configuration(1, agent, 1))] == ["rss"]


@pytest.fixture
def conditions(room_world, tmp_path):
    return Conditions(
        {}, {(1, 1): room_world}, runs=3, seed=0, store=TrainingStore(tmp_path, 1, True, ignore)
    )


def test_outcomes_are_those_of_the_training(room_world, conditions):
    (measured,) = measure(Trial(QUICK, KEY), conditions)
    result = train(
        room_world,
        RssAgent(),
        runs=3,
        episodes=20_000,
        learning=QUICK.learning,
        until_converged=True,
        min_episodes=1,
    )
    assert np.array_equal(measured.episodes, result.converged_episode)
    assert np.array_equal(measured.steps, result.converged_steps)
    assert np.array_equal(measured.length_m, result.path_length_m[result.reached])


def test_flown_trajectories_are_the_third_of_the_equal_flights(room_world, conditions):
    """Greedy and flown lengths agree once the policy no longer explores."""
    key = Configuration(1, "location", 1)
    _, flown = measure(Trial(OURS, key), conditions)
    result = train(
        room_world, LocationAgent(), runs=3, episodes=20_000, until_converged=True, min_episodes=1
    )
    assert flown.alternative is FLOWN
    for run, k in enumerate(result.converged_episode):
        assert len(set(result.steps[run, k - 3 : k].tolist())) == 1
        assert len(set(result.diagonal_steps[run, k - 3 : k].tolist())) == 1
        assert flown.length_m[run] == result.episode_length_m[run, k - 1]


def test_a_world_that_cannot_be_learnt_is_an_obstacle(room_world, conditions):
    dim = replace(room_world, rss_dbm=room_world.rss_dbm - 50.0)
    (measured,) = measure(Trial(QUICK, KEY), replace(conditions, worlds={(1, 1): dim}))
    assert "no cell with RSS > -21 dBm" in measured.obstacle
    assert measured.length_m.size == measured.episodes.size == 0


def test_summary_compares_with_our_interpretation():
    other = Configuration(1, "location", 1)
    paper_m, other_m = PATH_LENGTH_M[KEY], PATH_LENGTH_M[other]
    outcomes = [
        outcome(OURS, KEY, [paper_m, paper_m]),
        outcome(OURS, other, [other_m, other_m]),
        outcome(QUICK, KEY, [1.2 * paper_m, 1.2 * paper_m], episodes=(30.0, 30.0)),
        outcome(QUICK, other, [other_m], episodes=(10.0,)),
    ]
    ours, quick = summary_table(outcomes).records()
    assert (ours["agree"], ours["configurations"], ours["length_ratio"]) == (2, 2, 1.0)
    assert (quick["runs"], quick["converged"], quick["arrive"]) == (4, 3, 3)
    assert quick["episode_ratio"] == pytest.approx(2.0)
    assert quick["length_ratio"] == pytest.approx(1.2)
    assert quick["agree"] == 0


def test_outcome_table_has_an_interval_and_survives_runs_that_never_arrive():
    outcomes = [
        outcome(OURS, KEY, [100.0, 102.0]),
        outcome(QUICK, KEY, [110.0, 112.0]),
        outcome(FLOWN, KEY, [], episodes=()),
    ]
    _, quick, flown = outcome_table(outcomes).records()
    assert quick["difference_m"] == pytest.approx(10.0)
    assert quick["difference_low_m"] <= 10.0 <= quick["difference_high_m"]
    assert flown["mean_m"] is None
    assert flown["converged"] == 0


def test_claims_are_counted_by_their_means():
    keys = {(agent, speed): Configuration(1, agent, speed) for agent in AGENTS for speed in (1, 2)}
    outcomes = [
        replace(
            outcome(OURS, key, [length_m, length_m], episodes=(episodes, episodes)),
            turns=np.array([turns, turns], float),
            fewest_steps=fewest,
        )
        for key, length_m, episodes, turns, fewest in (
            (keys["rss", 1], 110.0, 50.0, 4, 52),
            (keys["location", 1], 100.0, 40.0, 5, 40),
            (keys["rss", 2], 99.0, 45.0, 4, 50),
            (keys["location", 2], 99.0, 45.0, 3, 50),
        )
    ]
    (row,) = claims_table(outcomes).records()
    assert (row["farther"], row["more_turns"]) == ("1 of 2", "1 of 2")
    assert (row["episodes_fall"], row["flight_time_falls"]) == ("1 of 2", "1 of 2")
    assert row["good"] == "1 of 2"  # 55 steps of 52, 50 of 40


def test_claims_without_flights_are_not_counted():
    (row,) = claims_table([outcome(FLOWN, KEY, [], episodes=())]).records()
    assert (row["farther"], row["episodes_fall"], row["good"]) == ("0 of 0", "0 of 0", "0 of 1")


def test_figure_has_a_marker_per_outcome_and_hollow_ones_where_runs_do_not_converge():
    outcomes = [
        outcome(OURS, KEY, [100.0, 102.0]),
        outcome(QUICK, KEY, [110.0, 112.0], episodes=(10.0,)),
        outcome(FLOWN, KEY, [], episodes=()),
    ]
    drawn = figure.draw(outcomes)
    ax = drawn.axes[0]
    filled = [bar.lines[0].get_markerfacecolor() != "white" for bar in ax.containers]
    assert filled == [True, False]
    assert [label.get_text() for label in ax.get_yticklabels()] == [
        alternative.label for alternative in (OURS, QUICK, FLOWN)
    ]


def test_the_whole_study_runs(small_study):
    coherent = next(alternative for alternative in ALTERNATIVES if alternative.coherent)
    keys = [Configuration(scenario, agent, 1) for scenario in (1, 2) for agent in AGENTS]
    pieces = (
        *(Trial(OURS, key) for key in keys),
        *(Trial(coherent, key) for key in keys if coherent.concerns(key)),
    )
    seen = []
    study = replace(sensitivity.STUDY, pieces=pieces)
    result = run_study(study, small_study, quick=True, progress=lambda *step: seen.append(step))
    assert seen[-1] == ("sensitivity", 6, 6)
    assert len(result.tables[0].rows) == 3
    assert [row["parameter"] for row in result.tables[1].records()] == [
        *["our interpretation"] * 4,
        *["final trajectory"] * 4,
        *["map"] * 2,
    ]
    assert (small_study / "figures" / "sensitivity.png").is_file()
