"""A plan calibrated with a survey: what was fitted, and how far traced RSS is off before and after.

How far traced RSS is off is computed from readings that were held out: the whole procedure is
repeated without them. Intervals of properties and the evidence for doors are of all readings.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from floorplans import FloorPlan, PlanMaterial
from raytrace import Scene
from rssnav.measurements.calibration import Calibrated, TracedSurvey
from rssnav.measurements.doors import NO_DOORS, DoorSearch, DoorState
from rssnav.measurements.held_out_fits import Change, CurvePoint, Work, change_of, curve_of
from rssnav.measurements.hold_out import SQUARE_M, by_space, by_transmitter
from rssnav.measurements.material_values import (
    MaterialValue,
    dielectrics_in,
    material_values,
    plan_values,
    plan_with,
    slabs_with,
)
from rssnav.measurements.predictors import OffsetPer, offset_groups
from rssnav.measurements.survey import Survey, SurveyError
from rssnav.measurements.traced import TraceSettings
from rssnav.progress import Progress

FAR = 1.9
"""A fitted value this many standard deviations of its prior away is flagged as doubtful."""


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
    doors
        What the readings tell of each door, if that was asked for.
    """

    plan: FloorPlan
    found: Calibrated
    space: Change
    transmitter: Change | None
    curve: tuple[CurvePoint, ...]
    doubts: tuple[str, ...]
    doors: tuple[DoorState, ...] = ()

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
            "doors": [state.summary() for state in self.doors],
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
    doors: bool = False,
    edition: str | None = None,
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
        Names of the materials; all dielectrics of the plan by default, but for those of a measured
        loss. Of these, the loss is fitted.
    square_m
        Side of the squares that are held out together [m].
    doors, edition
        Whether states of doors are found before materials are fitted, and the edition of the
        built-in materials, see `rssnav.scene_of`.
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
    groups, everything = offset_groups(survey, offsets), np.ones(len(survey), dtype=bool)
    n_fits = len(survey.transmitters) + 1 + len(folds) + len(others) + 1
    steps, search, changed = _Steps(n_fits, progress), None, NO_DOORS
    if doors:
        search = DoorSearch(plan, survey, settings, groups, edition, steps.add)
        changed = search.changed(everything)
        if materials is not None:
            material_values(scene.slabs, settings.frequency_hz, materials, _of_loss(plan))
        plan, scene = search.plan(changed), search.scene(changed)
        materials = _still_there(materials, scene)
    of = material_values(scene.slabs, settings.frequency_hz, materials, _of_loss(plan))
    traced = TracedSurvey.of(scene, survey, settings, lambda done, _: steps.advance())
    at_plan = traced.levels_db(of, plan_values(of), slopes=True)
    work = Work(traced, of, groups, at_plan, search, changed)
    found, settled = work.fitted(everything), True
    if found.told and settings.config.is_limited:
        work, found, settled = _grown_anew(work, found, scene)
    steps.advance()
    if not found.told and not changed:
        raise SurveyError(
            "the readings do not tell the properties of any material: "
            + "; ".join(f"{t.value.material}, {t.value.kind}" for t in found.not_told),
            survey.path,
        )
    space = change_of(work, folds, steps.advance)
    transmitter = change_of(work, others, steps.advance) if others else None
    curve = curve_of(work)
    steps.advance()
    return Calibration(
        plan_with(plan, scene.slabs, found.told, found.fit.values, settings.frequency_hz),
        found,
        space,
        transmitter,
        curve,
        _doubts(found, settled),
        () if search is None else search.states(changed),
    )


def _of_loss(plan: FloorPlan) -> dict[str, PlanMaterial]:
    return {m.name: m for m in plan.materials if m.loss_db is not None}


def _still_there(materials: Sequence[str] | None, scene: Scene) -> list[str] | None:
    """Leave out materials that no door or wall is made of any more; None for all."""
    known = dielectrics_in(scene.slabs)
    return None if materials is None else [name for name in materials if name in known] or None


MOST_ROUNDS = 3
"""Times that beams limited by power or loss are grown anew for the fitted materials."""

SETTLED_DB = 0.1
"""Root mean square change of the predictions below which they are not."""


def _grown_anew(work: Work, found: Calibrated, scene: Scene) -> tuple[Work, Calibrated, bool]:
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

    def advance(self) -> None:
        self._done += 1
        if self._progress is not None:
            self._progress(self._done, self._total)

    def add(self) -> None:
        """One more part than was known is done."""
        self._total += 1
        self.advance()


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
            quantity = f"{value.quantity(float(fitted)):.3g} {value.unit}".strip()
            doubts.append(
                f"{value.material}: a {value.kind} of {quantity} is "
                "at the limit, two standard deviations of building materials from the plan's: "
                "furniture, thickness or doors may be wrong instead"
            )
    return tuple(doubts)
