"""Calibrations with parts of the readings, and how far these predict the others."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from raytrace.arrays import Bools, Floats, Ints
from rssnav.doors import Door
from rssnav.measurements.agreement import Agreement
from rssnav.measurements.calibration import (
    Calibrated,
    Levels,
    TracedSurvey,
    fit_what_is_told,
    residuals_db,
)
from rssnav.measurements.doors import NO_DOORS, DoorSearch
from rssnav.measurements.hold_out import Fold
from rssnav.measurements.material_values import MaterialValue, plan_values
from rssnav.measurements.survey import SurveyError

CURVE_PLACES = (5, 10, 20, 40)
CURVE_DRAWS = 3


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


class Work(NamedTuple):
    """What all fits share.

    Attributes
    ----------
    traced, of
        The readings, and the properties that may be fitted.
    groups
        (n,) which offset each reading has.
    at_plan
        All readings predicted with the plan's values.
    doors, changed
        How states of doors are found, if they are; those that `traced` has in their other state.
    """

    traced: TracedSurvey
    of: tuple[MaterialValue, ...]
    groups: Ints
    at_plan: Levels
    doors: DoorSearch | None
    changed: frozenset[Door]

    def base(self, fit: Bools) -> tuple[TracedSurvey, Levels]:
        """Return `traced` and `at_plan` with the states of doors that some of the readings tell.

        Other states than those of `traced` are traced with the plan's materials.
        """
        changed = self.changed if self.doors is None else self.doors.changed(fit)
        if self.doors is None or changed == self.changed:
            return self.traced, self.at_plan
        traced = self.doors.traced(changed)
        return traced, traced.levels_db(self.of, plan_values(self.of), slopes=True)

    def fitted(self, fit: Bools) -> Calibrated:
        """Calibrate with some of the readings, from the plan's values on."""
        return self._fitted(*self.base(fit), fit)

    def _fitted(self, traced: TracedSurvey, at_plan: Levels, fit: Bools) -> Calibrated:
        return fit_what_is_told(traced.rows(fit), self.of, self.groups[fit], at_plan.rows(fit))

    def predicted(self, fit: Bools) -> tuple[Floats, Floats]:
        """Predict all readings (n,) [dBm] before and after a calibration with some of them.

        The offset is fitted to the same readings.
        """
        traced, at_plan = self.base(fit)
        found = self._fitted(traced, at_plan, fit)
        after = traced.levels_db(found.told, found.fit.values, slopes=False)
        return self._with_offset(self._before(), fit), self._with_offset(after, fit)

    def _before(self) -> Levels:
        """All readings predicted with the plan as it was."""
        level = self.doors.level_dbm(NO_DOORS) if self.doors is not None and self.changed else None
        return self.at_plan if level is None else Levels(level, np.zeros((len(level), 0)))

    def _with_offset(self, levels: Levels, fit: Bools) -> Floats:
        groups = self.groups
        *_, offset = residuals_db(self.traced.survey.rows(fit), groups[fit], levels.rows(fit))
        known = np.full(int(groups.max(initial=0)) + 1, np.mean(offset))
        known[groups[fit]] = offset
        return levels.level + known[groups]


def change_of(work: Work, folds: tuple[Fold, ...], advance: Callable[[], None]) -> Change:
    """Repeat a calibration without the readings of each fold, and predict these."""
    survey = work.traced.survey
    both = np.full((2, len(survey)), -np.inf)
    for fold in folds:
        both[:, fold.test] = np.array(work.predicted(fold.fit))[:, fold.test]
        advance()
    tested = np.logical_or.reduce([fold.test for fold in folds])
    before, after = (Agreement.of(survey.rss_dbm, predicted, tested) for predicted in both)
    if before is None or after is None:
        raise SurveyError("no path reaches any reading: allow more transmissions", survey.path)
    return Change(before, after)


def curve_of(work: Work) -> tuple[CurvePoint, ...]:
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


def _draw(work: Work, place: Ints, chosen: Ints) -> list[float]:
    """Mean squares of residuals [dB^2] at other places, with the plan's and fitted materials."""
    survey = work.traced.survey
    fit = np.isin(place, chosen) & ~survey.is_censored
    test = ~np.isin(place, chosen) & ~survey.is_censored
    both = (Agreement.of(survey.rss_dbm, p, test) for p in work.predicted(fit))
    return [np.inf if agreement is None else agreement.sigma_db**2 for agreement in both]
