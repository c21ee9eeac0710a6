"""A plan calibrated with a survey: what was fitted, and how far traced RSS is off before and after.

Everything that is said of the fit is computed from readings that were held out: the whole procedure
is repeated without them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from floorplans import FloorPlan
from raytrace import Scene
from raytrace.arrays import Bools, Floats, Ints
from rssnav.measurements.agreement import Agreement
from rssnav.measurements.calibration import (
    Calibrated,
    Levels,
    TracedSurvey,
    fit_what_is_told,
    residuals_db,
)
from rssnav.measurements.hold_out import SQUARE_M, Fold, by_space, by_transmitter
from rssnav.measurements.material_values import (
    MaterialValue,
    material_values,
    plan_values,
    plan_with,
    slabs_with,
)
from rssnav.measurements.predictors import OffsetPer, offset_groups
from rssnav.measurements.survey import Survey, SurveyError
from rssnav.measurements.traced import TraceSettings
from rssnav.progress import Progress

CURVE_PLACES = (5, 10, 20, 40)
CURVE_DRAWS = 3
FAR = 1.9
"""A fitted value this many standard deviations of its prior away is flagged as doubtful."""


@dataclass(frozen=True)
class Change:
    """Agreement with readings that were held out, before and after a calibration."""

    before: Agreement
    after: Agreement


@dataclass(frozen=True)
class CurvePoint:
    """What a calibration with few places gives at all others, on average over random draws.

    Attributes
    ----------
    n_places
        Places that are fitted to.
    before_db, after_db
        Sigma at the other places, with the plan's materials and with fitted ones; the offset is
        fitted to the same few places [dB].
    """

    n_places: int
    before_db: float
    after_db: float


@dataclass(frozen=True, eq=False)
class Calibration:
    """A calibrated plan.

    Attributes
    ----------
    plan
        The plan with fitted materials.
    found
        What was fitted to all readings.
    space, transmitter
        Agreement with readings held out by space and by transmitter; None where there is one
        transmitter.
    curve
        How many places are needed.
    doubts
        Fitted values that are unusual, in words.
    """

    plan: FloorPlan
    found: Calibrated
    space: Change
    transmitter: Change | None
    curve: tuple[CurvePoint, ...]
    doubts: tuple[str, ...]

    @property
    def is_better(self) -> bool:
        """Whether readings that were held out by space are predicted better than before."""
        return self.space.after.sigma_db < self.space.before.sigma_db

    def summary(self) -> dict[str, Any]:
        """Return the numbers, for programs."""
        held_out = {"space": self.space, "transmitter": self.transmitter}
        return {
            "held_out_sigma_db": {
                name: None
                if change is None
                else {"before": change.before.sigma_db, "after": change.after.sigma_db}
                for name, change in held_out.items()
            },
            "fitted": [
                {
                    "material": value.material,
                    "property": value.kind,
                    "before": value.quantity(value.prior),
                    "after": value.quantity(fitted),
                    "low": value.quantity(fitted - 2.0 * deviation),
                    "high": value.quantity(fitted + 2.0 * deviation),
                }
                for value, fitted, deviation in self.rows()
            ],
            "not_told": [
                {
                    "material": told.value.material,
                    "property": told.value.kind,
                    "sensitivity_db": told.sensitivity_db,
                    "narrowing": told.narrowing,
                }
                for told in self.found.not_told
            ],
            "places_needed": [
                {"places": p.n_places, "before_db": p.before_db, "after_db": p.after_db}
                for p in self.curve
            ],
            "doubts": list(self.doubts),
        }

    def rows(self) -> list[tuple[MaterialValue, float, float]]:
        """Return each fitted property with its value and its standard deviation."""
        fit = self.found.fit
        values, deviation = map(float, fit.values), map(float, fit.deviation)
        return list(zip(self.found.told, values, deviation, strict=True))


def calibrate(
    plan: FloorPlan,
    scene: Scene,
    survey: Survey,
    settings: TraceSettings,
    *,
    offsets: OffsetPer = "one",
    materials: Sequence[str] | None = None,
    square_m: float = SQUARE_M,
    progress: Progress | None = None,
) -> Calibration:
    """Fit a plan's materials to a survey.

    Parameters
    ----------
    plan, scene, survey, settings
        The building, the readings, and how they are traced.
    offsets
        What a constant offset is fitted for.
    materials
        Names of the materials; all dielectrics of the plan by default, but for those whose loss is
        measured.
    square_m
        Side of the squares that are held out together [m].
    progress
        Called with the number of finished parts of the work and of all parts.

    Raises
    ------
    SurveyError
        Where the survey tells nothing of the materials, or nothing can be held out.
    """
    folds, others = by_space(survey, square_m), by_transmitter(survey)
    if len(folds) < 2:
        raise SurveyError(
            f"all places lie in squares of one colour of a chequerboard of {square_m:g} m: "
            "expected a smaller square, or more places",
            survey.path,
        )
    steps = _Steps(len(survey.transmitters) + 1 + len(folds) + len(others) + 1, progress)
    measured = {m.name for m in plan.materials if m.loss_db is not None}
    of = material_values(scene.slabs, settings.frequency_hz, materials, measured)
    traced = TracedSurvey.of(scene, survey, settings, lambda done, _: steps.reached(done))
    groups = offset_groups(survey, offsets)
    work = _Work(traced, of, groups, traced.levels_db(of, plan_values(of), slopes=True))
    found = work.fitted(np.ones(len(survey), dtype=bool))
    settled = True
    if found.told and settings.config.is_limited:
        work, found, settled = _grown_anew(work, found, scene)
    steps.advance()
    if not found.told:
        raise SurveyError(
            "the readings do not tell the properties of any material: "
            + "; ".join(f"{t.value.material}, {t.value.kind}" for t in found.not_told),
            survey.path,
        )
    space = _change(work, folds, steps)
    transmitter = _change(work, others, steps) if others else None
    curve = _curve(work)
    steps.advance()
    return Calibration(
        plan_with(plan, scene.slabs, found.told, found.fit.values, settings.frequency_hz),
        found,
        space,
        transmitter,
        curve,
        _doubts(found, settled),
    )


MOST_ROUNDS = 3
"""Times that beams limited by power or loss are grown anew for the fitted materials."""

SETTLED_DB = 0.1
"""Root mean square change of the predictions below which they are not."""


def _grown_anew(work: _Work, found: Calibrated, scene: Scene) -> tuple[_Work, Calibrated, bool]:
    """Trace with the fitted materials and fit again, until the paths hold what is strong with them.

    A limit by power or loss leaves out what is weak with the materials of its own trace.

    Returns
    -------
    work, found
        With the paths of the last trace.
    settled
        Whether a last trace changed the predictions little.
    """
    survey, settings = work.traced.survey, work.traced.settings
    for _ in range(MOST_ROUNDS):
        told, values = found.told, found.fit.values
        slabs = slabs_with(scene.slabs, told, values, settings.frequency_hz)
        anew = TracedSurvey.of(replace(scene, slabs=tuple(slabs)), survey, settings)
        anew = replace(anew, slabs=scene.slabs)
        before, after = (t.levels_db(told, values, slopes=False).level for t in (work.traced, anew))
        work = work._replace(traced=anew)
        found = work.fitted(np.ones(len(survey), dtype=bool))
        heard = np.isfinite(before) & np.isfinite(after)
        change_db = after[heard] - before[heard]
        same = np.array_equal(np.isfinite(before), np.isfinite(after))
        if not found.told or (same and np.sqrt(np.mean(change_db**2)) < SETTLED_DB):
            return work, found, True
    return work, found, False


class _Steps:
    """Parts of the work that are done."""

    def __init__(self, total: int, progress: Progress | None) -> None:
        self._total, self._progress, self._done = total, progress, 0

    def reached(self, done: int) -> None:
        self._done = done
        if self._progress is not None:
            self._progress(done, self._total)

    def advance(self) -> None:
        self.reached(self._done + 1)


class _Work(NamedTuple):
    """What all fits share.

    Attributes
    ----------
    traced, of
        The readings, and the properties that may be fitted.
    groups
        (n,) which offset each reading has.
    at_plan
        All readings predicted with the plan's values.
    """

    traced: TracedSurvey
    of: tuple[MaterialValue, ...]
    groups: Ints
    at_plan: Levels

    def fitted(self, fit: Bools) -> Calibrated:
        """Calibrate with some of the readings, from the plan's values on."""
        traced = self.traced.rows(fit)
        return fit_what_is_told(traced, self.of, self.groups[fit], self.at_plan.rows(fit))

    def predicted(self, fit: Bools) -> tuple[Floats, Floats]:
        """Predict all readings (n,) [dBm] before and after a calibration with some of them.

        The offset is fitted to the same readings.
        """
        found = self.fitted(fit)
        after = self.traced.levels_db(found.told, found.fit.values, slopes=False)
        return self._with_offset(self.at_plan, fit), self._with_offset(after, fit)

    def _with_offset(self, levels: Levels, fit: Bools) -> Floats:
        groups = self.groups
        *_, offset = residuals_db(self.traced.survey.rows(fit), groups[fit], levels.rows(fit))
        known = np.full(int(groups.max(initial=0)) + 1, np.mean(offset))
        known[groups[fit]] = offset
        return levels.level + known[groups]


def _change(work: _Work, folds: tuple[Fold, ...], steps: _Steps) -> Change:
    """Repeat a calibration without the readings of each fold, and predict these."""
    survey = work.traced.survey
    both = np.full((2, len(survey)), -np.inf)
    for fold in folds:
        both[:, fold.test] = np.array(work.predicted(fold.fit))[:, fold.test]
        steps.advance()
    tested = np.logical_or.reduce([fold.test for fold in folds])
    before, after = (Agreement.of(survey.rss_dbm, predicted, tested) for predicted in both)
    if before is None or after is None:
        raise SurveyError("no path reaches any reading: allow more transmissions", survey.path)
    return Change(before, after)


def _curve(work: _Work) -> tuple[CurvePoint, ...]:
    """Calibrate with the readings at a few random places, and predict those at all others."""
    survey, random = work.traced.survey, np.random.default_rng(0)
    _, place = np.unique(survey.points[:, :2].round(1), axis=0, return_inverse=True)
    n_places = int(place.max()) + 1
    points: list[CurvePoint] = []
    for n in CURVE_PLACES:
        if 2 * n > n_places:
            break
        squares = np.array([_draw(work, place, random.permutation(n_places)[:n])
                            for _ in range(CURVE_DRAWS)])  # fmt: skip
        before, after = np.sqrt(squares.mean(axis=0))
        points.append(CurvePoint(n, float(before), float(after)))
    return tuple(points)


def _draw(work: _Work, place: Ints, chosen: Ints) -> list[float]:
    """Mean squares of residuals [dB^2] at other places, with the plan's and fitted materials."""
    survey = work.traced.survey
    fit = np.isin(place, chosen) & ~survey.is_censored
    test = ~np.isin(place, chosen) & ~survey.is_censored
    both = (Agreement.of(survey.rss_dbm, p, test) for p in work.predicted(fit))
    return [np.inf if agreement is None else agreement.sigma_db**2 for agreement in both]


def _doubts(found: Calibrated, settled: bool) -> tuple[str, ...]:
    """Say which fitted values are unusual for a building, and whether paths are missing."""
    doubts: list[str] = []
    if not settled:
        doubts.append(
            f"the paths above the limits still change with the materials after {MOST_ROUNDS} "
            "traces: a number of transmissions, or a wider range, would tell more"
        )
    for value, fitted in zip(found.told, found.fit.values, strict=True):
        away = (fitted - value.prior) / value.spread
        if abs(away) > FAR:
            unit = " S/m" if value.kind != "permittivity" else ""
            doubts.append(
                f"{value.material}: a {value.kind} of {value.quantity(float(fitted)):.3g}{unit} is "
                "at the limit, two standard deviations of building materials from the plan's: "
                "furniture, thickness or doors may be wrong instead"
            )
    return tuple(doubts)
