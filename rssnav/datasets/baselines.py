"""How well simple models predict the maps of held-out buildings: what a learned model must beat.

All are fitted to the buildings of the split train, and predict those of test. RSS is
``c0 + c1 log10(d) + c2 log10(f)``, and with counted walls ``+ c3 n``. Kriging knows 20 cells of
each map: what these exceed the log-distance model by is interpolated with an exponential
covariance. The nearest map is that of the training building, transmitter and frequency that are
most alike, laid over the other building.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from scipy.spatial.distance import cdist

import floorplans
from floorplans import FloorPlan
from raytrace.arrays import Bools, Floats, Ints
from rssnav.datasets.errors import DatasetError
from rssnav.datasets.exporters.pieces import index_of, n_plans, plan_pieces
from rssnav.measurements.wall_count import walls_crossed
from rssnav.progress import Progress

CELLS_A_MAP = 200
"""Cells of each training map that models are fitted to."""
KNOWN_CELLS = 20
NUGGET = 0.01
"""Share of the variance that is not correlated at all."""
MODELS = (
    "log-distance",
    "log-distance and walls",
    f"kriging from {KNOWN_CELLS} cells",
    "nearest map",
)


@dataclass(frozen=True, eq=False)
class ErrorRow:
    """How far a model is off.

    Attributes
    ----------
    model
        Its name.
    rmse_db, mae_db
        Root mean square and mean absolute error over all cells of all test maps [dB].
    n_maps, n_cells
        How many those are.
    """

    model: str
    rmse_db: float
    mae_db: float
    n_maps: int
    n_cells: int


@dataclass(frozen=True, eq=False)
class _Map:
    """A map, its plan, and the cells in it that have a path.

    Attributes
    ----------
    plan
        The building.
    position
        Of the transmitter [m].
    frequency_hz
        Carrier [Hz].
    x, y, rss_dbm, used
        Axes, values and which of them are used.
    height_m
        Of the receivers [m].
    """

    plan: FloorPlan
    position: Floats
    frequency_hz: float
    x: Floats
    y: Floats
    height_m: float
    rss_dbm: Floats
    used: Bools

    @cached_property
    def points(self) -> Floats:
        """(n, 3) cells that are used [m]."""
        xx, yy = np.meshgrid(self.x, self.y)
        z = np.full(self.rss_dbm.shape, self.height_m)
        return np.stack([xx, yy, z], axis=-1)[self.used]

    @cached_property
    def values(self) -> Floats:
        """(n,) their RSS [dBm]."""
        return self.rss_dbm[self.used].astype(np.float64)

    def features(self, points: Floats, walls: bool) -> Floats:
        """Return what the log-distance models depend on, (n, 3) or (n, 4)."""
        distance = np.maximum(np.linalg.norm(points - self.position, axis=1), 0.1)
        columns = [np.ones(len(points)), np.log10(distance)]
        columns.append(np.full(len(points), np.log10(self.frequency_hz)))
        if walls:
            starts = np.broadcast_to(self.position, points.shape)
            columns.append(walls_crossed(self.plan, starts, points).astype(np.float64))
        return np.column_stack(columns)

    @property
    def traits(self) -> Floats:
        """What makes two maps alike: size, place of the transmitter in it, and frequency."""
        low, high = np.array(self.plan.bounds).reshape(2, 2)
        size = high - low
        at = (self.position[:2] - low) / size
        return np.array([*np.log(size), *(2.0 * at), 10.0 * np.log10(self.frequency_hz)])


def baselines(folder: Path, seed: int, progress: Progress) -> list[ErrorRow]:
    """Fit models to the training buildings, and return their errors in the test buildings.

    Parameters
    ----------
    folder
        Of a data set that keeps `rss_dbm`.
    seed
        Chooses cells.
    progress
        Called with the number of plans that are read, and of all plans.

    Raises
    ------
    DatasetError
        Where there are no training or test maps with a path.
    """
    rng = np.random.default_rng(seed)
    training, tests = list[_Map](), list[_Map]()
    total = n_plans(folder)
    for done, (split, maps) in enumerate(_plans(folder), 1):
        (training if split == "train" else tests if split == "test" else []).extend(maps)
        progress(done, total)
    if not training or not tests:
        raise DatasetError("baselines need maps in the splits train and test", folder)
    models = _Models.fitted(training, rng)
    errors: dict[str, list[Floats]] = {name: [] for name in MODELS}
    for test in tests:
        known = rng.permutation(len(test.values))[:KNOWN_CELLS]
        for name, error in zip(MODELS, models.errors(test, known), strict=True):
            errors[name].append(error)
    rows: list[ErrorRow] = []
    for name, of_maps in errors.items():
        all_errors = np.concatenate(of_maps)
        rmse, mae = np.sqrt(np.mean(all_errors**2)), np.mean(np.abs(all_errors))
        rows.append(ErrorRow(name, float(rmse), float(mae), len(tests), len(all_errors)))
    return rows


def _plans(folder: Path) -> Iterator[tuple[str, list[_Map]]]:
    for piece in plan_pieces(folder):
        if "rss_dbm" not in piece.maps.layers:
            raise DatasetError("rss_dbm is not kept: expected it among the layers", folder)
        plan, maps = floorplans.loads(piece.about.plan_text), piece.maps
        found: list[_Map] = []
        for index in map(index_of, piece.rows):
            rss = maps.layers["rss_dbm"][index]
            used = maps.inside[index.height] & np.isfinite(rss)
            if used.sum() > KNOWN_CELLS and index.preset == index.antenna == 0:
                found.append(
                    _Map(
                        plan, maps.positions[index.transmitter],
                        maps.frequencies_hz[index.frequency], maps.x, maps.y,
                        maps.heights_m[index.height], rss, used,
                    )
                )  # fmt: skip
        yield piece.about.split, found


@dataclass(frozen=True, eq=False)
class _Models:
    """The fitted models.

    Attributes
    ----------
    by_distance, with_walls
        Coefficients.
    range_m
        At which the correlation of what exceeds the log-distance model falls to 1/e [m].
    training
        Maps to choose the nearest from, and their traits.
    """

    by_distance: Floats
    with_walls: Floats
    range_m: float
    training: list[_Map]
    traits: Floats

    @classmethod
    def fitted(cls, training: list[_Map], rng: np.random.Generator) -> _Models:
        """Fit to some cells of each map."""
        chosen = [rng.permutation(len(m.values))[:CELLS_A_MAP] for m in training]
        values = np.concatenate([m.values[k] for m, k in zip(training, chosen, strict=True)])
        rows = np.concatenate(
            [m.features(m.points[k], True) for m, k in zip(training, chosen, strict=True)]
        )
        by_distance = _least_squares(rows[:, :3], values)
        with_walls = _least_squares(rows, values)
        return cls(
            by_distance,
            with_walls,
            _range_m(training, chosen, by_distance),
            training,
            np.array([m.traits for m in training]),
        )

    def errors(self, test: _Map, known: Ints) -> Iterator[Floats]:
        """Yield the errors of each of `MODELS` on a map [dB]; kriging is tested on other cells."""
        rows = test.features(test.points, True)
        trend = rows[:, :3] @ self.by_distance
        yield trend - test.values
        yield rows @ self.with_walls - test.values
        excess = test.values - trend
        other = np.setdiff1d(np.arange(len(excess)), known)
        yield (trend + self._kriged(test.points, excess, known))[other] - test.values[other]
        yield self._of_nearest(test) - test.values

    def _kriged(self, points: Floats, excess: Floats, known: Ints) -> Floats:
        """Interpolate from known cells: simple kriging with an exponential covariance."""
        among = np.exp(-cdist(points[known], points[known]) / self.range_m)
        among[np.diag_indices_from(among)] += NUGGET
        towards = np.exp(-cdist(points, points[known]) / self.range_m)
        weights = np.asarray(np.linalg.solve(among, excess[known]), dtype=np.float64)
        return towards @ weights

    def _of_nearest(self, test: _Map) -> Floats:
        """Lay the training map that is most alike over a building; its mean where it has none."""
        nearest = self.training[int(((self.traits - test.traits) ** 2).sum(axis=1).argmin())]
        low, high = np.array(test.plan.bounds).reshape(2, 2)
        other_low, other_high = np.array(nearest.plan.bounds).reshape(2, 2)
        at = (test.points[:, :2] - low) / (high - low) * (other_high - other_low) + other_low
        column = np.abs(nearest.x[None] - at[:, :1]).argmin(axis=1)
        row = np.abs(nearest.y[None] - at[:, 1:]).argmin(axis=1)
        found = np.where(nearest.used, nearest.rss_dbm, nearest.values.mean())
        return np.asarray(found, dtype=np.float64)[row, column]


def _least_squares(rows: Floats, values: Floats) -> Floats:
    return np.asarray(np.linalg.lstsq(rows, values, rcond=None)[0], dtype=np.float64)


def _range_m(training: list[_Map], chosen: list[Ints], coefficients: Floats) -> float:
    """Return the range of an exponential correlation that fits pairs of cells best."""
    ranges = np.geomspace(0.5, 30.0, 25)
    misfit = np.zeros(len(ranges))
    for of_map, cells in zip(training, chosen, strict=True):
        points = of_map.points[cells]
        excess = of_map.values[cells] - of_map.features(points, False) @ coefficients
        distance = cdist(points, points)
        product = np.outer(excess, excess) / np.maximum(np.mean(excess**2), 1e-12)
        bins = np.digitize(distance, np.arange(0.5, 15.0, 0.5))
        count = np.maximum(np.bincount(bins.ravel()), 1)
        mean = np.bincount(bins.ravel(), product.ravel()) / count
        middle = np.bincount(bins.ravel(), distance.ravel()) / count
        for k, range_m in enumerate(ranges):
            misfit[k] += ((np.exp(-middle / range_m) - mean) ** 2)[1:-1].sum()
    return float(ranges[misfit.argmin()])
