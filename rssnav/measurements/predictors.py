"""Predictions of RSS: the tracer's, and the usual models that it is compared with.

Each is ``base + offset + sum of coefficients times features`` [dB]. Offsets and coefficients are
fitted by least squares, so that a survey needs neither transmit powers nor receiver gains.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from floorplans import FloorPlan
from raytrace.arrays import Bools, Floats, Ints
from rssnav.measurements.hold_out import Fold
from rssnav.measurements.survey import Survey
from rssnav.measurements.wall_count import walls_crossed

OffsetPer = Literal["one", "transmitter", "device"]


@dataclass(frozen=True, eq=False)
class Predictor:
    """A model of RSS.

    Attributes
    ----------
    name
        In tables.
    base
        (n,) prediction without the offset [dB]; -inf where there is none.
    features
        (n, k) what coefficients are fitted to.
    """

    name: str
    base: Floats
    features: Floats


def offset_groups(survey: Survey, per: OffsetPer) -> Ints:
    """Return the number (n,) of the offset that each reading shares."""
    if per == "transmitter":
        return survey.transmitter
    return survey.device if per == "device" else np.zeros(len(survey), dtype=np.int64)


def usual_models(plan: FloorPlan, survey: Survey) -> tuple[Predictor, ...]:
    """Return what needs no tracer: constant, free space, log-distance, and with counted walls."""
    power_dbm, n = survey.power_dbm, len(survey)
    level_db = -20.0 * np.log10(np.maximum(survey.distance_m, 1e-3))
    walls = walls_crossed(plan, survey.positions, survey.points).astype(np.float64)
    none = np.empty((n, 0))
    return (
        Predictor("constant", power_dbm, none),
        Predictor("free space", power_dbm + level_db, none),
        Predictor("log-distance", power_dbm, level_db[:, None]),
        Predictor("log-distance and walls", power_dbm, np.column_stack([level_db, walls])),
    )


def fitted(predictor: Predictor, survey: Survey, groups: Ints, fit: Bools) -> Floats:
    """Fit offsets and coefficients to some readings, and predict all (n,) [dBm].

    An offset of which no reading is fitted is the mean of the others. Readings without a
    prediction, of -inf, are left out of the fit.

    Parameters
    ----------
    predictor, survey
        The model and the readings.
    groups
        (n,) see `offset_groups`.
    fit
        (n,) which readings to fit to.
    """
    used = fit & np.isfinite(predictor.base)
    present, column = np.unique(groups[used], return_inverse=True)
    if not len(present):
        return np.full(len(survey), -np.inf)
    one_hot = np.eye(len(present))[column]
    design = np.column_stack([one_hot, predictor.features[used]])
    above = survey.rss_dbm[used] - predictor.base[used]
    solution = np.linalg.lstsq(design, above, rcond=None)[0]
    share = np.bincount(column) / len(column)
    offsets = np.full(int(groups.max()) + 1, float(share @ solution[: len(present)]))
    offsets[present] = solution[: len(present)]
    return predictor.base + offsets[groups] + predictor.features @ solution[len(present) :]


def held_out(predictor: Predictor, survey: Survey, groups: Ints, folds: tuple[Fold, ...]) -> Floats:
    """Predict each reading with what was fitted to the others (n,) [dBm]; -inf where none is."""
    predicted = np.full(len(survey), -np.inf)
    for fold in folds:
        predicted[fold.test] = fitted(predictor, survey, groups, fold.fit)[fold.test]
    return predicted
