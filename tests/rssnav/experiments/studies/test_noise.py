"""The noise study: its settings, its measures, its figure."""

from dataclasses import replace

import numpy as np
import pytest

from rssnav import ExactStates, Fluctuation, IntervalStates, RssAgent, ToleranceStates, train
from rssnav.experiments.progress import ignore
from rssnav.experiments.studies import run_study
from rssnav.experiments.studies.noise import figure, measuring
from rssnav.experiments.studies.noise import study as noise
from rssnav.experiments.studies.noise.measuring import Outcome, Setting, measure, settings
from rssnav.experiments.studies.study import Conditions
from rssnav.experiments.training_store import TrainingStore


def test_settings_cross_every_rule_with_every_fluctuation_once():
    listed = [setting for setting in settings() if setting.scenario == 1]
    assert 2 * len(listed) == len(settings())
    assert len(set(listed)) == len(listed)
    rules = len(measuring.THRESHOLDS_DB) + len(measuring.WIDTHS_DB)
    steady = [setting for setting in listed if setting.fluctuation.sigma_db == 0.0]
    assert len(steady) == rules + 1
    fluctuating = (len(measuring.SIGMAS_DB) - 1) * len(measuring.CORRELATIONS)
    assert len(listed) == len(steady) + fluctuating * rules


def test_rules_become_states(room_world):
    still = Fluctuation()
    assert Setting(1, "exact", 0.0, still).states(room_world) == ExactStates()
    assert Setting(1, "tolerance", 0.5, still).states(room_world) == ToleranceStates(0.5)
    intervals = Setting(1, "intervals", 2.0, still).states(room_world)
    assert isinstance(intervals, IntervalStates)
    edges = np.array(intervals.edges_dbm)
    assert np.allclose(np.diff(edges), 2.0)
    assert edges[0] <= room_world.rss_dbm.min() < room_world.rss_dbm.max() <= edges[-1]


@pytest.fixture
def conditions(room_world, tmp_path):
    return Conditions(
        {},
        {(1, measuring.SPEED): room_world},
        runs=2,
        seed=3,
        store=TrainingStore(tmp_path, 1, True, ignore),
    )


def test_measures_are_those_of_the_last_episodes(room_world, conditions, monkeypatch):
    monkeypatch.setattr(measuring, "EPISODES", 150)
    setting = Setting(1, "tolerance", 0.5, Fluctuation(0.5))
    (outcome,) = measure(setting, conditions)
    result = train(
        room_world,
        RssAgent(ToleranceStates(0.5), fluctuation=Fluctuation(0.5)),
        runs=2,
        episodes=150,
        seed=3,
    )
    assert np.array_equal(outcome.steps, result.steps[:, 50:].mean(axis=1))
    assert np.array_equal(outcome.success, 1.0 - result.truncated[:, 50:].mean(axis=1))
    assert np.array_equal(outcome.n_states, result.n_discrete_states)


def test_last_episodes_of_a_short_run_are_all_it_has(room_world, conditions, monkeypatch):
    monkeypatch.setattr(measuring, "STEP_LIMIT", 1)
    (outcome,) = measure(Setting(1, "exact", 0.0, Fluctuation()), conditions)
    result = train(room_world, RssAgent(), runs=2, episodes=64, seed=3)
    assert np.array_equal(outcome.steps, result.steps.mean(axis=1))


def outcome_of(setting, success):
    ones = np.ones(3)
    return Outcome(setting, ones > 0, ones > 0, 5 * ones.astype(int), success * ones, 9 * ones)


def test_table_has_a_row_per_outcome():
    setting = Setting(1, "tolerance", 0.5, Fluctuation(1.0, 0.9))
    (row,) = noise.noise_table([outcome_of(setting, 0.75)]).records()
    assert (row["success"], row["steps"], row["steps_sd"]) == (0.75, 9.0, 0.0)
    assert (row["width_db"], row["sigma_db"], row["correlation"]) == (0.5, 1.0, 0.9)


def test_figure_has_a_curve_per_fluctuation():
    outcomes = [
        outcome_of(Setting(1, rule, width_db, Fluctuation(sigma_db)), 0.5)
        for rule in ("tolerance", "intervals")
        for sigma_db in (0.0, 2.0)
        for width_db in (0.5, 1.0)
    ]
    axes = figure.draw(outcomes).axes
    assert [len(ax.lines) for ax in axes] == [2] * 8
    assert axes[0].lines[0].get_ydata() == pytest.approx([0.5, 0.5])


def test_the_whole_study_runs(small_study, monkeypatch):
    monkeypatch.setattr(measuring, "SPEED", 1)
    still, noisy = Fluctuation(), Fluctuation(1.0)
    pieces = (
        Setting(1, "exact", 0.0, still),
        *(
            Setting(scenario, rule, 2.0, fluctuation)
            for scenario in (1, 2)
            for rule in ("tolerance", "intervals")
            for fluctuation in (still, noisy)
        ),
    )
    result = run_study(replace(noise.STUDY, pieces=pieces), small_study, quick=True)
    assert len(result.tables[0].rows) == len(pieces)
    assert (small_study / "figures" / "noise.png").is_file()
