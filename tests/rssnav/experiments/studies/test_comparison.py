"""Oracles, learners and searchers in one table."""

from dataclasses import replace

import pytest

from rssnav.experiments.studies import run_study
from rssnav.experiments.studies.comparison import study as comparison


@pytest.fixture
def records(small_study):
    pieces = tuple(entry for entry in comparison.STUDY.pieces if entry.speed == 1)
    study = replace(comparison.STUDY, quick_runs=2, pieces=pieces)
    return run_study(study, small_study, quick=True).tables[0].records()


def test_every_method_is_there_and_obeys_its_bounds(records):
    assert {record["kind"] for record in records} == {"oracle", "learner", "searcher"}
    assert len(records) == 2 * 17
    for record in records:
        assert 0.0 <= record["success"] <= 1.0
        if record["success"] > 0.0:
            assert record["detour"] >= 1.0 - 1e-9
        if record["kind"] == "oracle":
            assert record["success"] == 1.0
        if record["mean_regret"] is not None:
            assert record["mean_regret"] >= -1e-4


def test_the_oracles_are_least(records):
    for scenario in (1, 2):
        rows = [record for record in records if record["scenario"] == scenario]
        fewest, shortest = rows[:2]
        flown = [record for record in rows if record["mean_steps"] is not None]
        assert fewest["mean_steps"] == min(record["mean_steps"] for record in flown)
        assert shortest["mean_m"] == min(record["mean_m"] for record in flown)


def test_no_learner_flies_more_than_q_learning_but_for_its_last_episodes(records):
    for scenario in (1, 2):
        for agent in ("RSS-based", "location-based"):
            rows = {
                record["method"]: record
                for record in records
                if record["scenario"] == scenario and agent in record["method"]
            }
            budget = rows[f"Q-learning, {agent}"]["training_steps"]
            assert rows[f"SARSA, {agent}"]["training_steps"] < 3.0 * budget
