import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from q_learning_twin import ToleranceTwin
from state_rules import states_of, tables_of

from rssnav import ExactStates, Fluctuation, IntervalStates, ToleranceStates
from rssnav.kernels.stepping import read


def test_exact_states_number_values_in_the_order_they_appear():
    rss_dbm = np.array([-50.0, -40.0, -50.0, -60.0, -40.0])
    assert ExactStates().discrete_states(rss_dbm).tolist() == [0, 1, 0, 2, 1]
    assert states_of(ExactStates(), rss_dbm) == [0, 1, 0, 2, 1]


def test_a_reading_strictly_within_the_threshold_is_the_known_state():
    """The paper: the same state within (RSS - Th, RSS + Th), else a new one is defined."""
    rule = ToleranceStates(1.0)
    assert states_of(rule, [-50.0, -50.5, -49.25, -50.0]) == [0, 0, 0, 0]
    assert states_of(rule, [-50.0, -51.0, -49.0]) == [0, 1, 2]


def test_a_reading_that_fits_two_states_is_the_nearer_and_of_two_as_near_the_older():
    rule = ToleranceStates(1.0)
    assert states_of(rule, [-50.0, -51.5, -50.625, -50.875, -50.75]) == [0, 1, 0, 1, 0]
    assert states_of(rule, [-51.5, -50.0, -50.75]) == [0, 1, 0]


def test_a_later_nearer_state_takes_a_reading_over():
    assert states_of(ToleranceStates(1.0), [-50.0, -50.875, -51.0, -50.875]) == [0, 0, 1, 1]


@settings(deadline=None)
@given(
    st.lists(st.floats(-119.0, -20.0), min_size=1, max_size=60),
    st.sampled_from([0.01, 0.1, 0.5, 1.0, 3.0, 200.0]),
)
def test_the_table_of_bins_finds_what_a_search_of_all_known_states_finds(readings, threshold_db):
    twin = ToleranceTwin(threshold_db)
    expected = [twin(cell, reading) for cell, reading in enumerate(readings)]
    assert states_of(ToleranceStates(threshold_db), readings) == expected


def test_intervals_are_closed_below_and_open_above():
    rule = IntervalStates((-80.0, -60.0, -40.0))
    assert states_of(rule, [-90.0, -80.0, -60.5, -60.0, -40.0, 0.0]) == [0, 1, 1, 2, 3, 3]


def test_uniform_intervals_cover_the_range():
    edges = IntervalStates.uniform(-100.0, -20.0, 10.0).edges_dbm
    assert edges[0] == -100.0
    assert edges[-1] >= -20.0
    assert np.allclose(np.diff(edges), 10.0)


@pytest.mark.parametrize("edges", [(-40.0, -50.0), (-40.0, -40.0), (-60.0, -50.0, -55.0)])
def test_intervals_that_overlap_are_refused(edges):
    with pytest.raises(ValueError, match="intervals overlap, edge"):
        IntervalStates(edges)


@pytest.mark.parametrize("edges", [(), (np.nan,), (-np.inf, -40.0)])
def test_intervals_without_finite_edges_are_refused(edges):
    with pytest.raises(ValueError, match="at least one edge, all of them finite"):
        IntervalStates(edges)


@pytest.mark.parametrize("width", [0.0, -1.0, np.nan])
def test_intervals_without_a_width_are_refused(width):
    with pytest.raises(ValueError, match="positive width"):
        IntervalStates.uniform(-100.0, -20.0, width)


@pytest.mark.parametrize("threshold_db", [0.0, -1.0, np.nan, np.inf])
def test_a_threshold_that_is_not_positive_is_refused(threshold_db):
    with pytest.raises(ValueError, match=r"threshold_db = .* use ExactStates"):
        ToleranceStates(threshold_db)


def test_fluctuation_out_of_range_is_refused():
    with pytest.raises(ValueError, match="sigma_db"):
        Fluctuation(sigma_db=-1.0)
    with pytest.raises(ValueError, match="correlation"):
        Fluctuation(sigma_db=1.0, correlation=1.0)


@pytest.mark.parametrize("correlation", [0.0, 0.9])
def test_fluctuation_has_the_stated_deviation_and_correlation(correlation):
    rss_dbm = np.array([-60.0, -50.0])
    fluctuation = Fluctuation(sigma_db=2.0, correlation=correlation)
    receiver = tables_of(ToleranceStates(1.0), fluctuation, rss_dbm).sensor.receiver
    generator, last_db = np.array([1, 2, 3, 4], dtype=np.uint64), np.zeros(1)
    readings = np.array([read(receiver, last_db, generator, 0) for _ in range(40_000)])
    fluctuations = readings[100:] - rss_dbm[0]
    n_independent = fluctuations.size * (1 - correlation) / (1 + correlation)
    assert abs(fluctuations.mean()) < 4 * 2.0 / np.sqrt(n_independent)
    assert fluctuations.std() == pytest.approx(2.0, rel=4 / np.sqrt(2 * n_independent))
    measured = np.corrcoef(fluctuations[1:], fluctuations[:-1])[0, 1]
    assert measured == pytest.approx(correlation, abs=0.02)
