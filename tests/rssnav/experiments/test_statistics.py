"""Bootstrap intervals behave as statistics says they must."""

import numpy as np
import pytest

from rssnav.experiments.statistics import difference, mean, ratio


def sample(size=100, centre=5.0, spread=2.0, seed=3):
    return np.random.default_rng(seed).normal(centre, spread, size)


def test_the_interval_of_a_mean_is_that_of_the_normal_approximation():
    data = sample()
    estimate = mean(data)
    half = 1.96 * data.std() / np.sqrt(data.size)
    assert estimate.value == data.mean()
    assert estimate.low == pytest.approx(data.mean() - half, abs=0.1 * half)
    assert estimate.high == pytest.approx(data.mean() + half, abs=0.1 * half)


def test_equal_values_have_no_spread():
    estimate = mean(np.full(20, 7.0))
    assert (estimate.value, estimate.low, estimate.high) == (7.0, 7.0, 7.0)


def test_the_same_data_gives_the_same_interval():
    assert mean(sample()) == mean(sample())


def test_two_samples_are_resampled_independently():
    data = sample()
    estimate = difference(data, data)  # paired resampling would give an interval of no width
    half = 1.96 * np.sqrt(2 * data.var() / data.size)
    assert estimate.value == 0.0
    assert estimate.high - estimate.low == pytest.approx(2 * half, rel=0.1)


def test_swapping_the_samples_turns_the_difference_round():
    one, other = sample(seed=1), sample(centre=6.0, seed=2)
    there, back = difference(one, other), difference(other, one)
    assert there.value == pytest.approx(-back.value)
    assert there.high < 0.0 < back.low


def test_a_ratio_is_of_the_means():
    one, other = sample(seed=1), sample(centre=10.0, seed=2)
    estimate = ratio(one, other)
    assert estimate.value == pytest.approx(one.mean() / other.mean())
    assert estimate.low < estimate.value < estimate.high < 1.0


@pytest.mark.parametrize("values", [[], [[1.0, 2.0]]])
def test_one_value_per_realisation_is_needed(values):
    with pytest.raises(ValueError, match="one value per realisation"):
        mean(values)


def test_a_ratio_needs_positive_values():
    with pytest.raises(ValueError, match="positive second values"):
        ratio([1.0, 2.0], [1.0, 0.0])
