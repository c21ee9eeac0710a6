"""Materials of a plan fitted to a survey: least squares with priors, offsets in closed form.

The paths are traced once. Every evaluation goes through their steps again, with derivatives
(`raytrace.evaluation`).
"""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from scipy.optimize import least_squares

from raytrace import Scene, TracedPoints, trace_points
from raytrace.arrays import Bools, Floats, Ints
from raytrace.kernels.field_tables import FieldTables
from raytrace.radio.materials import Slab
from raytrace.radio.table_slopes import table_slopes
from raytrace.radio.tables import both_tables, step_tables
from raytrace.threads import n_threads
from rssnav.measurements.material_values import MaterialValue, plan_values, slabs_with
from rssnav.measurements.survey import Survey
from rssnav.measurements.traced import TraceSettings
from rssnav.progress import Progress

MAX_LEFT_OUT = 1e-2
"""Fraction of the power of a reading whose paths are left out while fitting: 0.044 dB at most with
the plan's materials, nearly the same for all readings, so that offsets absorb it."""

NOISE_DB = 4.0
"""Standard deviation of readings about traced RSS, to weigh readings against priors [dB]."""

TOLERANCE = 1e-2
"""Relative change of values and of the sum of squares below which a fit ends."""

MOST_EVALUATIONS = 30

LIMIT = 2.0
"""A value stays within this many standard deviations of its prior: RSS has further minima where a
wall is a whole number of wavelengths thick, at permittivities that no building material has."""

PER_DB = 10.0 / np.log(10.0)


class Part(NamedTuple):
    """The readings of one transmitter.

    Attributes
    ----------
    traced
        The paths to their places.
    rows
        (n,) which readings they are.
    tables
        Of the antennas, with the materials of the plan.
    """

    traced: TracedPoints
    rows: Ints
    tables: FieldTables


class Levels(NamedTuple):
    """Readings as they are predicted without offsets.

    Attributes
    ----------
    level
        (n,) [dBm]; -inf without a path.
    slopes
        (n, n_values) derivatives with respect to properties of materials [dB]; 0 without a path.
    """

    level: Floats
    slopes: Floats

    def rows(self, which: Bools) -> Levels:
        """Return some of the readings."""
        return Levels(self.level[which], self.slopes[which])

    def of_values(self, numbers: Sequence[int]) -> Levels:
        """Return the derivatives with respect to some of the properties."""
        return Levels(self.level, self.slopes[:, list(numbers)])


@dataclass(frozen=True, eq=False)
class TracedSurvey:
    """A survey with the paths to its places, ready to be evaluated.

    Attributes
    ----------
    survey, settings
        The readings, and how they were traced.
    slabs
        Of the scene.
    parts
        Of each transmitter.
    """

    survey: Survey
    settings: TraceSettings
    slabs: tuple[Slab, ...]
    parts: tuple[Part, ...]

    @classmethod
    def of(
        cls,
        scene: Scene,
        survey: Survey,
        settings: TraceSettings,
        progress: Progress | None = None,
        *,
        max_left_out: float = MAX_LEFT_OUT,
    ) -> TracedSurvey:
        """Trace the paths to a survey's places; errors as of `traced.traced_dbm`.

        Parameters
        ----------
        scene, survey, settings, progress
            As of `traced.traced_dbm`.
        max_left_out
            Largest fraction of the power of a reading whose paths are left out.
        """
        parts: list[Part] = []
        for k in range(len(survey.transmitters)):
            rows = np.flatnonzero(survey.transmitter == k)
            traced = trace_points(
                scene,
                settings.transmitter(survey, k),
                survey.points[rows],
                settings.config,
                receive_antenna=settings.receive_antenna,
                max_left_out=max_left_out,
                threads=settings.threads,
                max_memory_bytes=settings.max_memory_bytes,
            )
            tables = step_tables(
                traced.transmitter, scene.slabs, receive_antenna=settings.receive_antenna
            )
            parts.append(Part(traced, rows, tables))
            if progress is not None:
                progress(k + 1, len(survey.transmitters))
        return cls(survey, settings, scene.slabs, tuple(parts))

    def rows(self, which: Bools) -> TracedSurvey:
        """Return some of the readings."""
        number = np.cumsum(which) - 1
        parts = (
            Part(
                part.traced.at(np.flatnonzero(which[part.rows])),
                number[part.rows[which[part.rows]]],
                part.tables,
            )
            for part in self.parts
            if which[part.rows].any()
        )
        return replace(self, survey=self.survey.rows(which), parts=tuple(parts))

    def levels_db(self, of: Sequence[MaterialValue], values: Floats, *, slopes: bool) -> Levels:
        """Predict all readings without offsets.

        Parameters
        ----------
        of, values
            Properties of materials, and what they are.
        slopes
            Whether derivatives are computed; otherwise they are 0.
        """
        frequency_hz = self.settings.frequency_hz

        def slabs_at(point: Floats) -> list[Slab]:
            return slabs_with(self.slabs, of, point, frequency_hz)

        of_slabs = both_tables(slabs_at(values), frequency_hz)
        reflection, transmission = (table.reshape(-1, 4) for table in of_slabs)
        power = np.zeros(len(self.survey))
        change = np.zeros((len(self.survey), len(values)))
        slope_tables, value_of = None, np.empty((0, 0), dtype=np.int64)
        if slopes:
            slope_tables, value_of = table_slopes(slabs_at, values, frequency_hz, of_slabs)

        def evaluated(part: Part) -> tuple[Floats, Floats]:
            kept = part.traced.kept
            tables = part.tables._replace(reflection=reflection, transmission=transmission)
            if slope_tables is None:
                return kept.powers(tables), np.empty((kept.n_points, 0, 0))
            return kept.powers_and_slopes(tables, slope_tables)

        with ThreadPoolExecutor(n_threads(self.settings.threads)) as pool:
            for part, found in zip(self.parts, pool.map(evaluated, self.parts), strict=True):
                power[part.rows] = found[0]
                for slab, slot in np.argwhere(value_of >= 0):
                    change[part.rows, value_of[slab, slot]] += found[1][:, slab, slot]
        heard = power > 0.0
        level = np.full(len(power), -np.inf)
        level[heard] = self.survey.power_dbm[heard] + PER_DB * np.log(power[heard])
        change[heard] *= PER_DB / power[heard, None]
        return Levels(level, change)


@dataclass(frozen=True, eq=False)
class Fit:
    """What fitting some readings found.

    Attributes
    ----------
    values
        (n_values,) of the properties.
    deviation
        (n_values,) standard deviations, given readings and priors.
    slopes_db
        (n, n_values) derivatives of the residuals there [dB].
    evaluations
        How many there were.
    """

    values: Floats
    deviation: Floats
    slopes_db: Floats
    evaluations: int


def residuals_db(survey: Survey, groups: Ints, predicted: Levels) -> tuple[Floats, Floats, Floats]:
    """Measured minus predicted with the best offset of each group, and its derivatives.

    A censored reading has the residual 0 where it is predicted below the sensitivity. A reading
    without a path has the residual 0 too.

    Returns
    -------
    residuals, slopes, offsets
        (n,) [dB], (n, n_values) [dB], and (n,) the offset of each reading's group [dB].
    """
    level, slopes = predicted
    n_groups = int(groups.max(initial=0)) + 1
    heard = np.isfinite(level)
    used = heard & ~survey.is_censored
    above = np.where(heard, survey.rss_dbm - np.where(heard, level, 0.0), 0.0)
    count = np.maximum(np.bincount(groups[used], minlength=n_groups), 1)
    offset = np.bincount(groups[used], above[used], n_groups) / count
    mean = np.zeros((n_groups, slopes.shape[1]))
    np.add.at(mean, groups[used], slopes[used])
    residual = np.where(heard, above - offset[groups], 0.0)
    change = np.where(heard[:, None], (mean / count[:, None])[groups] - slopes, 0.0)
    is_below = survey.is_censored & (residual > 0.0)
    residual[is_below], change[is_below] = 0.0, 0.0
    return residual, change, offset[groups]


def fit_values(
    traced: TracedSurvey,
    of: Sequence[MaterialValue],
    groups: Ints,
    start: Floats,
    at_start: Levels | None = None,
) -> Fit:
    """Fit properties of materials to readings, with a soft L1 loss and normal priors.

    Parameters
    ----------
    traced
        The readings to fit to.
    of
        The properties.
    groups
        (n,) which offset each reading has.
    start
        (n_values,) where to begin.
    at_start
        The readings predicted there, where they are known.
    """
    prior = plan_values(of)
    spread = np.array([value.spread for value in of])
    last: list[tuple[Floats, Floats, Floats]] = []

    def keep(values: Floats, predicted: Levels) -> None:
        residual, change, _ = residuals_db(traced.survey, groups, predicted)
        last[:] = [(values.copy(), residual / NOISE_DB, change / NOISE_DB)]

    def evaluated(values: Floats) -> tuple[Floats, Floats]:
        if not last or not np.array_equal(last[0][0], values):
            keep(values, traced.levels_db(of, values, slopes=True))
        return last[0][1:]

    if at_start is not None:
        keep(start, at_start)

    if not of:  # SciPy 1.15 cannot fit nothing
        slopes = evaluated(start)[1]
        return Fit(start, deviations(slopes, spread), slopes * NOISE_DB, 1)

    def rows(values: Floats) -> Floats:
        return np.append(evaluated(values)[0], (values - prior) / spread)

    def slopes_of_rows(values: Floats) -> Floats:
        return np.vstack([evaluated(values)[1], np.diag(1.0 / spread)])

    found = least_squares(
        rows,
        start,
        jac=slopes_of_rows,  # pyright: ignore[reportArgumentType]
        loss="soft_l1",
        bounds=(prior - LIMIT * spread, prior + LIMIT * spread),
        x_scale=spread,
        xtol=TOLERANCE,
        ftol=TOLERANCE,
        gtol=1e-6,
        max_nfev=MOST_EVALUATIONS,
    )
    slopes = evaluated(found.x)[1]
    return Fit(found.x, deviations(slopes, spread), slopes * NOISE_DB, int(found.nfev))


def deviations(slopes: Floats, spread: Floats) -> Floats:
    """Standard deviations (n_values,) given readings, of slopes over their noise, and priors."""
    information = slopes.T @ slopes + np.diag(1.0 / spread**2)
    return np.sqrt(np.diag(np.linalg.inv(information)))


@dataclass(frozen=True)
class Told:
    """What a survey can tell of a property.

    Attributes
    ----------
    value
        The property.
    sensitivity_db
        Root mean square of how much readings change, beyond an offset, over one standard deviation
        of the prior [dB].
    narrowing
        Standard deviation that is left, given the other properties, over that of the prior.
    """

    value: MaterialValue
    sensitivity_db: float
    narrowing: float


LEAST_NARROWING = 0.7
"""A property that the survey narrows less than to this fraction of its prior stays as it is."""


def tell(of: Sequence[MaterialValue], change: Floats) -> tuple[list[int], tuple[Told, ...]]:
    """Divide properties into those that a survey can tell and those that it cannot.

    The property that is narrowed least is given up first, and the others are judged without it.

    Parameters
    ----------
    of
        The properties.
    change
        (n, n_values) derivatives of the residuals [dB].

    Returns
    -------
    told, not_told
        Which properties to fit, and the others.
    """
    kept, given_up = list(range(len(of))), list[Told]()
    while kept:
        spread = np.array([of[k].spread for k in kept])
        narrowing = deviations(change[:, kept] / NOISE_DB, spread) / spread
        worst = int(np.argmax(narrowing))
        if narrowing[worst] <= LEAST_NARROWING:
            break
        k = kept.pop(worst)
        size = float(np.sqrt(np.mean(change[:, k] ** 2)) * of[k].spread)
        given_up.append(Told(of[k], size, float(narrowing[worst])))
    return kept, tuple(given_up)


@dataclass(frozen=True, eq=False)
class Calibrated:
    """Properties that readings tell, fitted to them.

    Attributes
    ----------
    told, not_told
        The properties that were fitted, and the others.
    fit
        What fitting found.
    """

    told: tuple[MaterialValue, ...]
    not_told: tuple[Told, ...]
    fit: Fit


def fit_what_is_told(
    traced: TracedSurvey, of: Sequence[MaterialValue], groups: Ints, at_plan: Levels
) -> Calibrated:
    """Fit the properties that readings tell at the values of the plan and at the fitted ones.

    Parameters
    ----------
    traced, of
        The readings to fit to, and the properties that may be fitted.
    groups
        (n,) which offset each reading has.
    at_plan
        The readings predicted with the plan's values of all properties.
    """
    prior = plan_values(of)
    _, change, _ = residuals_db(traced.survey, groups, at_plan)
    kept, not_told = tell(of, change)
    told = tuple(of[k] for k in kept)
    fit = fit_values(traced, told, groups, prior[kept], at_plan.of_values(kept))
    kept, also = tell(told, fit.slopes_db)
    if also:
        told = tuple(told[k] for k in kept)
        fit = fit_values(traced, told, groups, fit.values[kept])
    return Calibrated(told, (*not_told, *also), fit)
