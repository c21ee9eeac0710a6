"""Surveys and lists of transmitters in CSV files, checked against the plan they belong to."""

from __future__ import annotations

from collections.abc import Sequence
from difflib import get_close_matches
from pathlib import Path

import numpy as np
import shapely

from floorplans import FloorPlan
from raytrace.arrays import Bools, Floats
from rssnav.measurements.csv_table import CsvTable, read_table
from rssnav.measurements.survey import Survey, SurveyError, SurveyTransmitter, numbers_of
from rssnav.transmitters import antenna_of

REQUIRED = ("tx", "x", "y", "z", "rss_dbm")
OPTIONAL = ("n", "std_db", "frequency_hz", "device", "below_sensitivity")
COORDINATES = ("x", "y", "z")
LOWEST_DBM, HIGHEST_DBM = -200.0, 60.0
LOWEST_HZ, HIGHEST_HZ = 1e6, 1e12
SAME_PLACE_M = 1e-6
LEAST_EXTENT_M = 0.01
"""Places nearer together than this, in all, are no survey of a building: degrees, perhaps [m]."""

LEAST_READINGS = 8
"""Fewest readings, without censored ones, of which half can be held out."""


def _is_power(dbm: float) -> bool:
    return LOWEST_DBM < dbm < HIGHEST_DBM


def _is_frequency(hz: float) -> bool:
    return LOWEST_HZ <= hz <= HIGHEST_HZ


_IN_DBM = f"a power in dBm between {LOWEST_DBM:g} and {HIGHEST_DBM:g}", _is_power
_IN_HZ = f"a frequency in Hz between {LOWEST_HZ:g} and {HIGHEST_HZ:g}, such as 2.4e9", _is_frequency
_TRUE, _FALSE = ("1", "true", "yes"), ("0", "false", "no", "")


def read_transmitters(path: str | Path, plan: FloorPlan) -> tuple[SurveyTransmitter, ...]:
    """Read transmitters from a CSV file with the columns ``tx, x, y, z``.

    The columns ``power_dbm`` and ``frequency_hz`` are optional.

    Raises
    ------
    SurveyError
        With the row and the column of what is wrong.
    OSError
        Where the file cannot be read.
    """
    table = read_table(Path(path), REQUIRED[:4], ("power_dbm", "frequency_hz"))
    names = table.texts("tx")
    for k, name in enumerate(names):
        if not name:
            raise table.error(k, "tx", "expected a name")
        if name in names[:k]:
            first = table.numbers[names.index(name)]
            raise table.error(k, "tx", f"the transmitter stands in row {first} too")
    points = _points(table, plan)
    power = table.floats("power_dbm", *_IN_DBM) if "power_dbm" in table.columns else None
    frequency = table.floats("frequency_hz", *_IN_HZ) if "frequency_hz" in table.columns else None
    return tuple(
        SurveyTransmitter(
            name,
            (float(x), float(y), float(z)),
            0.0 if power is None else float(power[k]),
            None if frequency is None else float(frequency[k]),
        )
        for k, (name, (x, y, z)) in enumerate(zip(names, points, strict=True))
    )


def transmitters_of(plan: FloorPlan, folder: Path) -> tuple[SurveyTransmitter, ...]:
    """Return the transmitters that a plan names.

    Parameters
    ----------
    plan
        The plan.
    folder
        What the paths of pattern files in it are relative to.

    Raises
    ------
    AntennaError
        Where the file of a pattern is wrong.
    """
    return tuple(
        SurveyTransmitter(
            t.id,
            t.position,
            t.power_dbm or 0.0,
            t.frequency_hz,
            None if t.antenna is None else antenna_of(t.antenna, t.direction, folder),
        )
        for t in plan.transmitters
    )


def read_survey(
    path: str | Path, plan: FloorPlan, transmitters: Sequence[SurveyTransmitter]
) -> Survey:
    """Read a survey from a CSV file.

    Parameters
    ----------
    path
        A file with the columns ``tx, x, y, z`` [m], ``rss_dbm``, and optionally ``n`` (samples per
        reading), ``std_db``, ``frequency_hz``, ``device`` and ``below_sensitivity``.
    plan
        The building that it was made in.
    transmitters
        Those that the survey may name.

    Raises
    ------
    SurveyError
        With the row and the column of what is wrong.
    OSError
        Where the file cannot be read.
    """
    table = read_table(Path(path), REQUIRED, OPTIONAL)
    known = {transmitter.name: transmitter for transmitter in transmitters}
    for k, name in enumerate(table.texts("tx")):
        if name not in known:
            raise table.error(k, "tx", _unknown(name, tuple(known)))
    names, transmitter = numbers_of(table.texts("tx"))
    devices, device = ("",), np.zeros(len(table), dtype=np.int64)
    if "device" in table.columns:
        devices, device = numbers_of(table.texts("device"))
    used = tuple(known[name] for name in names)
    survey = Survey(
        transmitters=used,
        transmitter=transmitter,
        points=_points(table, plan),
        rss_dbm=_rss(table),
        is_censored=_censored(table),
        device=device,
        devices=devices,
        n_samples=_column(table, "n", "a number of samples, 1 or more", 1.0),
        std_db=_column(table, "std_db", "a standard deviation in dB, 0 or more", 0.0),
        frequency_hz=_frequency(table, used),
        path=Path(path),
    )
    _check_repeated(table, survey)
    _check_content(survey)
    return survey


def _unknown(name: str, known: tuple[str, ...]) -> str:
    if not known:
        return "the plan has no transmitters: expected a table [[transmitters]] for each"
    near = get_close_matches(name, known, n=1)
    hint = f"did you mean {near[0]!r}? " if near else ""
    return f"no such transmitter: {hint}known: {', '.join(known[:20])}"


def _column(table: CsvTable, name: str, expected: str, least: float) -> Floats | None:
    """Return an optional column of numbers."""
    if name not in table.columns:
        return None
    return table.floats(name, expected, lambda number: number >= least)


def _points(table: CsvTable, plan: FloorPlan) -> Floats:
    """Return places (n, 3), all of them inside the building."""
    points = np.column_stack([table.floats(c, "a finite number of metres") for c in COORDINATES])
    inside = shapely.contains_xy(plan.outline, points[:, 0], points[:, 1])
    if not inside.all():
        k = int(np.flatnonzero(~inside)[0])
        x_min, y_min, x_max, y_max = plan.bounds
        is_beside = not x_min <= points[k, 0] <= x_max
        raise table.error(
            k,
            "x" if is_beside else "y",
            f"({points[k, 0]:g}, {points[k, 1]:g}) is outside the plan {plan.name!r}, which "
            f"reaches from ({x_min:g}, {y_min:g}) to ({x_max:g}, {y_max:g}) m"
            + _other_unit(points[:, :2], plan),
        )
    low = np.flatnonzero((points[:, 2] <= 0.0) | (points[:, 2] >= plan.height_m))
    if len(low):
        problem = f"expected a height above 0 and below {plan.height_m:g} m, the ceiling"
        raise table.error(int(low[0]), "z", problem)
    return points


def _other_unit(xy: Floats, plan: FloorPlan) -> str:
    """Say which unit coordinates seem to be in, where they are not in metres."""
    if len(xy) > 1 and np.ptp(xy, axis=0).max() < LEAST_EXTENT_M:
        return ": expected metres in the plan's frame; these seem to be degrees"
    for unit, size_m in (("feet", 0.3048), ("centimetres", 0.01), ("millimetres", 0.001)):
        if shapely.contains_xy(plan.outline, *(xy * size_m).T).all():
            return f": expected metres; these seem to be {unit}"
    return ": expected metres in the plan's frame"


def _rss(table: CsvTable) -> Floats:
    """Return the powers (n,) in dBm, and not in another unit."""
    rss_dbm = table.floats("rss_dbm")
    if (rss_dbm > 0.0).all():
        if (rss_dbm < 1e-3).all():
            problem = "expected dBm; all values seem to be in W: 10 log10(P / 1 mW) is in dBm"
        else:
            problem = "expected dBm; all values are positive: is their minus sign missing?"
        raise table.error(0, "rss_dbm", problem)
    return table.floats("rss_dbm", *_IN_DBM)


def _censored(table: CsvTable) -> Bools:
    """Return which readings (n,) state only that RSS was below the sensitivity."""
    if "below_sensitivity" not in table.columns:
        return np.zeros(len(table), dtype=bool)
    texts = [text.lower() for text in table.texts("below_sensitivity")]
    for k, text in enumerate(texts):
        if text not in (*_TRUE, *_FALSE):
            raise table.error(k, "below_sensitivity", "expected 1 or 0")
    return np.array([text in _TRUE for text in texts], dtype=bool)


def _frequency(table: CsvTable, transmitters: Sequence[SurveyTransmitter]) -> float | None:
    """Return the one frequency that survey and transmitters state."""
    stated = {t.name: t.frequency_hz for t in transmitters if t.frequency_hz is not None}
    common = next(iter(stated.values()), None)
    for name, of_this_hz in stated.items():
        if of_this_hz != common:
            raise SurveyError(
                f"transmitter {name!r} sends at {of_this_hz:g} Hz, others at {common:g} Hz: "
                "expected one frequency; give one survey for each",
                table.path,
            )
    if "frequency_hz" not in table.columns:
        return common
    frequency = table.floats("frequency_hz", *_IN_HZ)
    expected_hz = frequency[0] if common is None else common
    other = np.flatnonzero(frequency != expected_hz)
    if len(other):
        which = f"as in row {table.numbers[0]}" if common is None else "of its transmitters"
        problem = f"expected {expected_hz:g} {which}: give one survey for each frequency"
        raise table.error(int(other[0]), "frequency_hz", problem)
    return float(expected_hz)


def _check_repeated(table: CsvTable, survey: Survey) -> None:
    """Refuse a place that a device read twice: readings that are not independent."""
    places = np.round(survey.points / SAME_PLACE_M).astype(np.int64)
    keys = np.column_stack([survey.transmitter, survey.device, places])
    _, first, group = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    again = np.flatnonzero(first[group] != np.arange(len(survey)))
    if len(again):
        k = int(again[0])
        earlier = table.numbers[int(first[group][k])]
        problem = f"the same place and transmitter as row {earlier}: give their mean once"
        raise table.error(k, "x", problem)


def _check_content(survey: Survey) -> None:
    """Refuse a survey from which nothing can be learnt."""
    read = survey.rss_dbm[~survey.is_censored]
    if len(read) < LEAST_READINGS:
        problem = f"{len(read)} readings above the sensitivity: expected {LEAST_READINGS} or more"
        raise SurveyError(problem, survey.path)
    if np.ptp(read) == 0.0:
        problem = f"all readings are {read[0]:g} dBm: expected different ones"
        raise SurveyError(problem, survey.path, column="rss_dbm")
    if np.ptp(survey.points[:, :2], axis=0).max() < LEAST_EXTENT_M:
        problem = (
            f"all places lie within {LEAST_EXTENT_M:g} m: expected metres in the plan's frame; "
            "degrees?"
        )
        raise SurveyError(problem, survey.path, column="x")
