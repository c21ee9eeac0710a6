"""Step counts of printed lengths."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rssnav.experiments.paper.printed_values import PATH_LENGTH_M
from rssnav.experiments.studies.readings.lengths import (
    DIAGONALS,
    StepCounts,
    nearest_counts,
    printed_counts,
    step_counts,
)

SPEEDS = st.sampled_from([1, 2, 4])
LENGTHS = st.sampled_from(list(DIAGONALS.values()))


def length_m(counts: StepCounts, speed: int, diagonal: float) -> float:
    return speed * (counts.straight + counts.diagonal * diagonal)


@given(st.integers(0, 120), st.integers(0, 60), SPEEDS, LENGTHS)
def test_the_steps_of_a_rounded_length_are_found(
    straight: int, n_diagonal: int, speed: int, diagonal: float
) -> None:
    counts = StepCounts(straight + n_diagonal, n_diagonal)
    printed = round(length_m(counts, speed, diagonal), 2)
    assert counts in step_counts(printed, speed, diagonal)


@given(st.integers(0, 20_000), SPEEDS, LENGTHS)
def test_all_that_is_found_rounds_to_the_length(cm: int, speed: int, diagonal: float) -> None:
    for counts in step_counts(cm / 100, speed, diagonal):
        assert length_m(counts, speed, diagonal) == pytest.approx(cm / 100, abs=0.005 + 1e-6)
        assert counts.straight >= 0


@given(st.integers(1000, 13_000), SPEEDS)
def test_no_steps_are_nearer_than_the_nearest(cm: int, speed: int) -> None:
    nearest = nearest_counts(cm / 100, speed, 1.4142)
    off = abs(length_m(nearest, speed, 1.4142) - cm / 100)
    straight, n_diagonal = np.meshgrid(np.arange(140), np.arange(100))
    others = speed * (straight + n_diagonal * 1.4142)
    assert off <= np.abs(others - cm / 100).min() + 1e-9


def test_a_rounded_diagonal_explains_more_of_the_printed_lengths_than_the_root() -> None:
    rounded, exact = printed_counts(1.4142), printed_counts(math.sqrt(2))
    assert {key for key, found in exact.items() if found} < {k for k, f in rounded.items() if f}
    unexplained = [PATH_LENGTH_M[key] for key, found in rounded.items() if not found]
    assert unexplained == [121.65]
