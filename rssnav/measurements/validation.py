"""The tracer, and the usual models beside it, compared with a survey."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from floorplans import FloorPlan
from raytrace.arrays import Floats, Ints
from rssnav.measurements.agreement import Agreement, Floor, floor_of, slope_of
from rssnav.measurements.hold_out import SQUARE_M, Fold, by_space, by_transmitter
from rssnav.measurements.predictors import (
    OffsetPer,
    Predictor,
    fitted,
    held_out,
    offset_groups,
    usual_models,
)
from rssnav.measurements.survey import Survey, SurveyError
from rssnav.measurements.wall_count import walls_crossed

TRACER = "tracer"


@dataclass(frozen=True)
class Row:
    """A model in the table of a validation.

    Attributes
    ----------
    name
        Of the model.
    slope
        Of measured on predicted RSS, with offsets and coefficients fitted to all readings.
    space, transmitter
        Its agreement with readings held out by space and by transmitter; None where the survey
        does not allow the comparison.
    """

    name: str
    slope: float
    space: Agreement | None
    transmitter: Agreement | None


@dataclass(frozen=True, eq=False)
class Validation:
    """What a comparison found.

    Attributes
    ----------
    rows
        The usual models, and the tracer at the end.
    floor
        What the readings' own neighbours allow; None for too few of them.
    predicted_dbm
        (n,) the tracer's prediction with offsets fitted to all readings.
    residual_db
        (n,) measured minus predicted; -inf or inf where there is no path.
    walls
        (n,) walls between transmitter and receiver.
    offsets
        What an offset was fitted for.
    square_m
        Side of the squares that are held out together [m].
    n_censored, n_censored_below
        Readings below the sensitivity, and how many of them are predicted below it.
    """

    rows: tuple[Row, ...]
    floor: Floor | None
    predicted_dbm: Floats
    residual_db: Floats
    walls: Ints
    offsets: OffsetPer
    square_m: float
    n_censored: int
    n_censored_below: int

    @property
    def tracer(self) -> Row:
        """The tracer's row."""
        return self.rows[-1]

    def summary(self) -> dict[str, Any]:
        """Return the numbers, for programs."""
        return {
            "offset": self.offsets,
            "square_m": self.square_m,
            "models": {
                row.name: {
                    "slope": row.slope,
                    "held_out_by_space": row.space and asdict(row.space),
                    "held_out_by_transmitter": row.transmitter and asdict(row.transmitter),
                }
                for row in self.rows
            },
            "floor": self.floor and asdict(self.floor),
            "censored": {"n": self.n_censored, "predicted_below": self.n_censored_below},
        }


def validate(
    plan: FloorPlan,
    survey: Survey,
    traced_dbm: Floats,
    *,
    offsets: OffsetPer = "one",
    square_m: float = SQUARE_M,
) -> Validation:
    """Compare the tracer and the usual models with a survey.

    Parameters
    ----------
    plan, survey
        The building and the readings.
    traced_dbm
        (n,) the tracer's prediction [dBm], see `traced.traced_dbm`.
    offsets
        Whether one offset is fitted for all readings, or one for each transmitter or device.
    square_m
        Side of the squares that are held out together [m].

    Raises
    ------
    SurveyError
        Where no part of the survey can be held out.
    """
    groups, tracer = offset_groups(survey, offsets), Predictor(TRACER, traced_dbm, _none(survey))
    folds = by_space(survey, square_m)
    if len(folds) < 2:
        raise SurveyError(
            f"all places lie in squares of one colour of a chequerboard of {square_m:g} m: "
            "expected a smaller square, or more places",
            survey.path,
        )
    others, read = by_transmitter(survey), ~survey.is_censored
    rows = tuple(
        Row(
            predictor.name,
            slope_of(survey.rss_dbm, fitted(predictor, survey, groups, read), read),
            _agreement(predictor, survey, groups, folds),
            _agreement(predictor, survey, groups, others) if others else None,
        )
        for predictor in (*usual_models(plan, survey), tracer)
    )
    predicted = fitted(tracer, survey, groups, read)
    below = survey.is_censored & (predicted < survey.rss_dbm)
    return Validation(
        rows=rows,
        floor=floor_of(survey),
        predicted_dbm=predicted,
        residual_db=survey.rss_dbm - predicted,
        walls=walls_crossed(plan, survey.positions, survey.points),
        offsets=offsets,
        square_m=square_m,
        n_censored=int(survey.is_censored.sum()),
        n_censored_below=int(below.sum()),
    )


def _none(survey: Survey) -> Floats:
    return np.empty((len(survey), 0))


def _agreement(
    predictor: Predictor, survey: Survey, groups: Ints, folds: tuple[Fold, ...]
) -> Agreement | None:
    predicted = held_out(predictor, survey, groups, folds)
    tested = np.logical_or.reduce([fold.test for fold in folds])
    return Agreement.of(survey.rss_dbm, predicted, tested)
