"""What a validation finds, on surveys whose answer is known."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import shapely
from small_surveys import TRANSMITTERS, room, survey_of

import floorplans
from raytrace import HalfWaveDipole, Isotropic
from rssnav.measurements.agreement import Agreement, floor_of, slope_of
from rssnav.measurements.hold_out import by_space, by_transmitter
from rssnav.measurements.predictors import (
    Predictor,
    fitted,
    held_out,
    offset_groups,
    usual_models,
)
from rssnav.measurements.survey import SurveyError
from rssnav.measurements.traced import TraceSettings
from rssnav.measurements.validation import validate
from rssnav.measurements.wall_count import walls_crossed

PLAN = room()


def scattered(seed: int = 0, n: int = 200):
    """Readings at random places of the room, from both transmitters in turn; all of 0 dBm."""
    random = np.random.default_rng(seed)
    points = random.uniform((0.1, 0.1, 0.5), (5.9, 3.9, 2.5), (n, 3))
    return survey_of(points, np.zeros(n), np.arange(n) % 2)


def test_each_model_recovers_what_it_describes() -> None:
    survey = scattered()
    constant, free_space, log_distance, walls = usual_models(PLAN, survey)
    distance, count = survey.distance_m, walls_crossed(PLAN, survey.positions, survey.points)
    for model, rss_dbm in (
        (constant, np.full(len(survey), -61.0)),
        (free_space, 7.0 - 20.0 * np.log10(distance)),
        (log_distance, -3.0 - 31.0 * np.log10(distance)),
        (walls, 5.0 - 18.0 * np.log10(distance) - 6.5 * count),
    ):
        measured = replace(survey, rss_dbm=rss_dbm)
        groups = offset_groups(measured, "one")
        for folds in (by_space(measured), by_transmitter(measured)):
            found = held_out(model, measured, groups, folds)
            np.testing.assert_allclose(found, rss_dbm, atol=1e-9)


def test_folds_part_the_readings_and_censored_ones_are_in_none() -> None:
    survey = replace(scattered(), is_censored=np.arange(200) % 7 == 0)
    for folds in (by_space(survey), by_transmitter(survey)):
        assert len(folds) == 2
        assert not any((fold.fit & fold.test).any() for fold in folds)
        tested = np.sum([fold.test for fold in folds], axis=0)
        np.testing.assert_array_equal(tested, ~survey.is_censored)


def test_an_offset_that_no_reading_shows_is_the_mean_of_the_others() -> None:
    survey = scattered()
    levels = np.where(survey.transmitter == 0, -40.0, -60.0)
    survey = replace(survey, rss_dbm=levels)
    model = Predictor("level", np.zeros(len(survey)), np.empty((len(survey), 0)))
    groups = offset_groups(survey, "transmitter")
    both = fitted(model, survey, groups, np.ones(len(survey), bool))
    np.testing.assert_allclose(both, levels)
    one = fitted(model, survey, groups, survey.transmitter == 0)
    np.testing.assert_allclose(one, -40.0)


def test_readings_without_a_path_are_counted_and_not_compared() -> None:
    survey = scattered()
    truth = -40.0 - 20.0 * np.log10(survey.distance_m)
    traced = np.where(np.arange(200) < 30, -np.inf, truth + 11.0)
    found = validate(PLAN, replace(survey, rss_dbm=truth), traced)
    tracer = found.tracer
    assert tracer.space is not None
    assert (tracer.space.n, tracer.space.n_without) == (170, 30)
    assert tracer.space.sigma_db < 1e-9
    assert tracer.slope == pytest.approx(1.0)
    assert found.rows[0].slope == 0.0


def test_the_figures_of_known_residuals() -> None:
    residual = np.array([3.0, -4.0, 0.0, 1.0])
    predicted = np.array([-50.0, -60.0, -70.0, -80.0])
    found = Agreement.of(predicted + residual, predicted, np.ones(4, bool))
    assert found is not None
    assert found.sigma_db == pytest.approx(np.sqrt(26.0 / 4.0))
    assert (found.mean_db, found.median_db) == (0.0, 2.0)
    assert slope_of(2.0 * predicted, predicted, np.ones(4, bool)) == pytest.approx(2.0)


def test_the_floor_is_the_noise_of_a_smooth_field() -> None:
    random = np.random.default_rng(3)
    x, y = np.meshgrid(np.arange(0.1, 5.9, 0.05), np.arange(0.1, 3.9, 0.05))
    points = np.column_stack([x.ravel(), y.ravel(), np.full(x.size, 1.5)])
    noise = random.normal(0.0, 2.5, len(points))
    found = floor_of(survey_of(points, -60.0 + points[:, 0] + noise))
    assert found is not None
    assert found.sigma_db == pytest.approx(2.5, rel=0.05)
    assert found.distance_m == pytest.approx(0.05)
    assert floor_of(survey_of(points[:4], noise[:4])) is None


def test_censored_readings_are_judged_by_the_prediction() -> None:
    survey = scattered()
    truth = -40.0 - 20.0 * np.log10(survey.distance_m)
    censored = np.arange(200) < 20
    limit = np.where(np.arange(200) < 15, truth + 1.0, truth - 1.0)
    measured = replace(survey, rss_dbm=np.where(censored, limit, truth), is_censored=censored)
    found = validate(PLAN, measured, truth)
    assert (found.n_censored, found.n_censored_below) == (20, 15)
    assert found.tracer.space is not None
    assert found.tracer.space.n == 180


def test_places_in_squares_of_one_colour_cannot_be_held_out() -> None:
    survey = scattered()
    with pytest.raises(SurveyError, match="expected a smaller square"):
        validate(PLAN, survey, np.zeros(200), square_m=50.0)


def test_walls_are_counted_as_shapely_counts_them() -> None:
    random = np.random.default_rng(5)
    plan = floorplans.load("flat")
    x_min, y_min, x_max, y_max = plan.bounds
    low, high = (x_min, y_min, 1.1), (x_max, y_max, 1.1)
    start, end = random.uniform(low, high, (2, 300, 3))
    solid = [shapely.LineString(segment) for segment in plan.solid_segments(1.1)]
    expected = [
        sum(shapely.LineString([a[:2], b[:2]]).crosses(line) for line in solid)
        for a, b in zip(start, end, strict=True)
    ]
    assert max(expected) >= 3
    np.testing.assert_array_equal(walls_crossed(plan, start, end), expected)


def test_doors_are_no_walls_and_lintels_are() -> None:
    start, end = np.array([[1.0, 1.5, 1.0]]), np.array([[5.0, 1.5, 1.0]])
    assert walls_crossed(PLAN, start, end) == [0]
    above = np.array([[0.0, 0.0, 1.5]])
    assert walls_crossed(PLAN, start + above, end + above) == [1]
    aside = np.array([[0.0, 1.5, 0.0]])
    assert walls_crossed(PLAN, start + aside, end + aside) == [1]
    assert TRANSMITTERS[0].position[0] < 3.0


def test_a_transmitter_of_the_plan_keeps_its_antenna_unless_one_is_chosen() -> None:
    own = HalfWaveDipole(axis=(1.0, 0.0, 0.0))
    survey = replace(scattered(), transmitters=(replace(TRANSMITTERS[0], antenna=own),))
    settings = TraceSettings(transmit_antenna=Isotropic())
    assert settings.transmitter(survey, 0).antenna == own
    chosen = replace(settings, is_antenna_chosen=True)
    assert chosen.transmitter(survey, 0).antenna == Isotropic()
