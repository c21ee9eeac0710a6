"""Calibration with readings that the tracer made from known materials."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from small_surveys import TRANSMITTERS, room

import floorplans
from floorplans import PlanMaterial
from raytrace import TraceConfig
from raytrace.radio.materials import Dielectric
from rssnav.measurements.calibrate import MOST_ROUNDS, Calibration, calibrate
from rssnav.measurements.calibration import TracedSurvey, residuals_db
from rssnav.measurements.calibration_page import calibration_page
from rssnav.measurements.material_values import (
    dielectrics_in,
    material_values,
    plan_with,
    slabs_with,
)
from rssnav.measurements.survey import Survey, SurveyError
from rssnav.measurements.traced import TraceSettings, traced_dbm
from rssnav.scenes import scene_of

FREQUENCY_HZ = 2.4e9
SETTINGS = TraceSettings(TraceConfig(2, 1, 1), FREQUENCY_HZ)
TRUTH = {"permittivity": 9.0, "conductivity": 0.15}
"""Of the partition, which the plan takes for plasterboard."""


def survey_at(points: np.ndarray) -> Survey:
    """Return a survey without readings: both transmitters at every place."""
    n = len(points)
    return Survey(
        transmitters=TRANSMITTERS,
        transmitter=np.repeat([0, 1], n),
        points=np.vstack([points, points]),
        rss_dbm=np.zeros(2 * n),
        is_censored=np.zeros(2 * n, bool),
        device=np.zeros(2 * n, np.int64),
        frequency_hz=FREQUENCY_HZ,
    )


def true_plan() -> floorplans.FloorPlan:
    plan = room()
    partition = PlanMaterial("partition", TRUTH["permittivity"], c=TRUTH["conductivity"])
    walls = tuple(
        replace(wall, material="partition") if wall.material == "plasterboard" else wall
        for wall in plan.walls
    )
    return replace(plan, walls=walls, materials=(partition,))


@pytest.fixture(scope="module")
def survey() -> Survey:
    """Return readings in the true room, 30 dB off, with a noise of 1 dB."""
    random = np.random.default_rng(7)
    empty = survey_at(random.uniform((0.3, 0.3, 1.5), (5.7, 3.7, 1.5), (60, 3)))
    exact = traced_dbm(scene_of(true_plan()), empty, SETTINGS)
    return replace(empty, rss_dbm=exact - 30.0 + random.normal(0.0, 1.0, len(exact)))


@pytest.fixture(scope="module")
def found(survey: Survey) -> Calibration:
    return calibrate(room(), scene_of(room()), survey, SETTINGS, materials=["plasterboard"])


def test_the_true_material_is_within_its_interval(found: Calibration) -> None:
    assert {value.kind for value in found.found.told} == set(TRUTH)
    for value, fitted, deviation in found.rows():
        truth = TRUTH[value.kind] - (value.kind == "permittivity")
        assert abs(fitted - np.log(truth)) < 3.0 * deviation + 0.1
        assert value.quantity(value.prior) != pytest.approx(TRUTH[value.kind], rel=0.3)


def test_readings_held_out_are_predicted_to_their_noise(found: Calibration) -> None:
    for change in (found.space, found.transmitter):
        assert change is not None
        assert change.after.sigma_db < 1.3
        assert change.before.sigma_db > change.after.sigma_db + 1.0
    assert found.is_better
    assert [point.n_places for point in found.curve] == [5, 10, 20]
    assert found.curve[-1].after_db < 1.5


def test_the_calibrated_plan_gives_the_levels_of_the_fit(
    found: Calibration, survey: Survey
) -> None:
    """Also after it was written and read: names and laws of materials are those of the fit."""
    again = floorplans.loads(floorplans.dumps(found.plan))
    assert "plasterboard_calibrated" in {wall.material for wall in again.walls}
    level = traced_dbm(scene_of(again), survey, SETTINGS)
    sigma = np.std(survey.rss_dbm - level)
    assert sigma == pytest.approx(1.0, abs=0.15)


def test_the_page_says_what_was_found(found: Calibration, survey: Survey) -> None:
    page = calibration_page(room(), survey, found, SETTINGS)
    assert f"{found.space.after.sigma_db:.2f} dB with fitted ones" in page
    assert "plasterboard" in page
    assert page.count("data:image/png;base64,") == 1
    assert not [part for part in ('src="http', "href=") if part in page]


def test_what_readings_do_not_tell_is_kept(survey: Survey) -> None:
    """Readings of one room alone say nothing about the partition's conductivity."""
    near = survey.rows((survey.points[:, 0] < 2.9) & (survey.transmitter == 0))
    one = replace(near, transmitters=TRANSMITTERS[:1])
    with pytest.raises(SurveyError, match="do not tell the properties of any material"):
        calibrate(room(), scene_of(room()), one, SETTINGS, materials=["plasterboard"])


def with_board(loss_db: float) -> floorplans.FloorPlan:
    """Return the room with a partition of a measured loss."""
    board = PlanMaterial("board", 2.7, loss_db=loss_db, loss_frequency_hz=FREQUENCY_HZ)
    walls = tuple(
        replace(wall, material="board") if wall.material == "plasterboard" else wall
        for wall in room().walls
    )
    return replace(room(), walls=walls, materials=(board,))


def test_a_measured_loss_is_kept_by_default() -> None:
    plan = with_board(6.0)
    of_loss = {m.name: m for m in plan.materials}
    of = material_values(scene_of(plan).slabs, FREQUENCY_HZ, None, of_loss)
    assert {value.material for value in of} == {"concrete", "ceiling_board"}


def test_a_measured_loss_is_fitted_where_it_is_named(survey: Survey) -> None:
    true, assumed = with_board(12.0), with_board(6.0)
    exact = traced_dbm(scene_of(true), survey, SETTINGS)
    noisy = np.random.default_rng(5).normal(0.0, 1.0, len(exact))
    measured = replace(survey, rss_dbm=exact - 30.0 + noisy)
    found = calibrate(assumed, scene_of(assumed), measured, SETTINGS, materials=["board"])
    ((value, fitted, deviation),) = found.rows()
    assert (value.kind, value.unit) == ("loss", "dB")
    assert value.quantity(value.prior) == pytest.approx(6.0)
    low, high = (value.quantity(fitted + 3.0 * side * deviation) for side in (-1, 1))
    assert low < 12.0 < high
    (board,) = floorplans.loads(floorplans.dumps(found.plan)).materials
    assert board.loss_db == pytest.approx(value.quantity(fitted))
    level = traced_dbm(scene_of(found.plan), measured, SETTINGS)
    assert np.std(measured.rss_dbm - level) == pytest.approx(1.0, abs=0.15)


def test_unknown_materials_are_refused(survey: Survey) -> None:
    with pytest.raises(SurveyError, match="no wall, floor or ceiling is made of 'gold'"):
        calibrate(room(), scene_of(room()), survey, SETTINGS, materials=["gold"])


def test_slopes_of_residuals_are_those_of_differences(survey: Survey) -> None:
    """Offsets, censored readings and several materials together."""
    random = np.random.default_rng(1)
    part = replace(survey, is_censored=random.random(len(survey)) < 0.2)
    traced = TracedSurvey.of(scene_of(room()), part, SETTINGS)
    of = material_values(traced.slabs, FREQUENCY_HZ)
    values = np.array([value.prior for value in of]) + 0.2
    groups = part.transmitter

    def residuals(point: np.ndarray) -> np.ndarray:
        return residuals_db(part, groups, traced.levels_db(of, point, slopes=False))[0]

    residual, change, _ = residuals_db(part, groups, traced.levels_db(of, values, slopes=True))
    np.testing.assert_allclose(residual, residuals(values), atol=1e-9)
    assert (residual[part.is_censored] == 0.0).any()
    assert (residual[part.is_censored] < 0.0).any()
    for k in range(len(values)):
        step = np.zeros(len(values))
        step[k] = 1e-4
        expected = (residuals(values + step) - residuals(values - step)) / 2e-4
        np.testing.assert_allclose(change[:, k], expected, atol=1e-4)


def test_a_law_keeps_its_exponents_and_layers_their_thickness() -> None:
    plan = replace(
        room(),
        floor_material="layers",
        floor_thickness_m=0.03,
        materials=(
            PlanMaterial("own", 3.0, 0.1, 0.02, 0.7),
            PlanMaterial(
                "layers",
                layers=(
                    floorplans.materials.MaterialLayer("own", 0.02),
                    floorplans.materials.MaterialLayer("brick", 0.01),
                ),
            ),
        ),
    )
    scene = scene_of(plan)
    of = material_values(scene.slabs, FREQUENCY_HZ, ["own", "brick"])
    values = np.array([value.prior for value in of]) + np.array([0.3, 0.5, -0.2, 0.4])
    changed = plan_with(plan, scene.slabs, of, values, FREQUENCY_HZ)
    again = scene_of(changed).slabs
    expected = slabs_with(scene.slabs, of, values, FREQUENCY_HZ)
    for slab, other in zip(again, expected, strict=True):
        names = dielectrics_in([slab]), dielectrics_in([other])
        for one, two in zip(*(n.values() for n in names), strict=True):
            assert isinstance(one, Dielectric)
            np.testing.assert_allclose(
                one.complex_permittivity(FREQUENCY_HZ), two.complex_permittivity(FREQUENCY_HZ)
            )
        assert slab.thickness_m == other.thickness_m
    own = next(m for m in changed.materials if m.name == "own")
    assert (own.b, own.d) == (0.1, 0.7)


def test_beams_that_a_loss_limits_are_those_of_the_fitted_materials(
    survey: Survey, found: Calibration, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With the plan's own beams alone, what the true partition lets through is missing."""
    limits = TraceConfig(2, 1, None, -120.0, dynamic_range_db=3.0)
    limited, off = replace(SETTINGS, config=limits), list[float]()
    for rounds in (MOST_ROUNDS, 0):
        monkeypatch.setattr("rssnav.measurements.calibrate.MOST_ROUNDS", rounds)
        fit = calibrate(room(), scene_of(room()), survey, limited, materials=["plasterboard"])
        off.append(float(np.abs(fit.found.fit.values - found.found.fit.values).max()))
        assert any("still change with the materials" in d for d in fit.doubts) == (rounds == 0)
    assert off[0] < 0.1
    assert off[0] < 0.6 * off[1]
