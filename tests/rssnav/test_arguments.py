"""Numbers of callers and files, of any size, are finite or refused with a message."""

from __future__ import annotations

import math
import sys

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rssnav import QLearning
from rssnav.arguments import is_finite
from rssnav.missions import ModeProcess, MultirotorEnergy, ReadingAbove, Task, Within

HUGE = 10**400
"""A whole number that float64 cannot hold."""


@given(st.floats())
def test_finite_floats_are_those_of_the_standard(value: float) -> None:
    assert is_finite(value) == math.isfinite(value)


@pytest.mark.parametrize("kind", [np.float16, np.float32, np.float64, np.int8, np.int64])
def test_numbers_of_numpy_are_numbers(kind) -> None:
    assert is_finite(kind(4))


@given(st.integers(-(10**400), 10**400))
def test_whole_numbers_are_finite_where_a_float_holds_them(value: int) -> None:
    assert is_finite(value) == (abs(value) <= sys.float_info.max)


@pytest.mark.parametrize(
    "made",
    [
        lambda: QLearning(initial_q=HUGE),
        lambda: QLearning(goal_reward=-HUGE),
        lambda: Within(HUGE),
        lambda: ReadingAbove(HUGE),
        lambda: Task(Within(2.0), per_second=HUGE),
        lambda: Task(Within(2.0), max_steps=HUGE),
        lambda: MultirotorEnergy(HUGE),
        lambda: MultirotorEnergy(turn_j_per_deg=HUGE),
        lambda: ModeProcess.steady(HUGE),
    ],
)
def test_numbers_beyond_float64_are_refused(made) -> None:
    with pytest.raises(ValueError, match="expected"):
        made()
