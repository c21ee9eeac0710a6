"""What the interpretations of the paper allow."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from rssnav.experiments.paper.counting import Count
from rssnav.experiments.studies.readings import study, tables
from rssnav.experiments.studies.readings.interpretations import (
    GOALS,
    OFFSETS_M,
    STATED_GOAL,
    Geometry,
    geometries,
)
from rssnav.experiments.studies.readings.outcome import Outcome, measure
from rssnav.experiments.studies.study import run_study


@pytest.fixture(scope="module")
def ours() -> Outcome:
    return measure(Geometry(0.5, (0.0, 0.0), STATED_GOAL))


def test_our_interpretation_needs_one_step_left_out(ours: Outcome) -> None:
    assert [ours.n_possible(count) for count in Count] == [8, 12, 12]


def test_a_larger_goal_allows_whatever_a_smaller_one_allows_with_fewer_steps(
    ours: Outcome,
) -> None:
    larger = measure(Geometry(0.5, (0.0, 0.0), GOALS[-1]))
    for key, least in ours.least_steps.items():
        assert larger.least_steps[key] <= least


@pytest.mark.parametrize("offset", [(0.25, -0.5), (-0.75, 0.125), (1.0, 1.0)])
def test_where_parity_forbids_both_flights_the_search_finds_at_most_one(
    offset: tuple[float, float],
) -> None:
    outcome = measure(Geometry(0.0, offset, STATED_GOAL))
    possible = dict(zip(outcome.least_steps, outcome.possible[Count.ALL], strict=True))
    for scenario, speed, *_, verdict in tables.parities().rows:
        both = [ok for k, ok in possible.items() if (k.scenario, k.speed) == (scenario, speed)]
        assert verdict == "yes" or sum(both) < 2


def test_the_study_writes_its_tables_and_figure(
    tmp_path: Path, ours: Outcome, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(study, "measure", lambda geometry: replace(ours, geometry=geometry))
    result = run_study(study.STUDY, tmp_path)
    assert all(file.stat().st_size for file in result.files)
    assert not (tmp_path / "maps").exists()
    rows = {table.key: len(table.rows) for table in result.tables}
    assert rows["readings"] == 3 * len(geometries())
    assert rows["readings_offsets"] == OFFSETS_M.size**2
