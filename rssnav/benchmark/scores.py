"""Flights -> success, SPL, times, energy, with intervals over buildings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rssnav.benchmark.running import Record
from rssnav.experiments.statistics import Estimate, mean
from rssnav.missions.flights import weighted_by_length

WITHIN_S = (25, 50, 100, 200, 400)
"""Times at which the distribution of the time to find is given [s]."""


@dataclass(frozen=True)
class Score:
    """A policy's result in a condition and the buildings of a site.

    Attributes
    ----------
    site, condition, policy, track : str
        Where, under which condition, who, its track.
    flights : int
        In all buildings.
    spl_by_building : list of float
        Success weighted by path length in each building.
    spl, success, false_alarms : Estimate
        Means over the buildings with 95 % intervals, for which buildings are drawn with
        replacement.
    median_s : float or None
        Median time to find over all flights, those that fail last; None where it is a failure [s].
    found_within : list of float
        Part of the flights that have found the transmitter after each of `WITHIN_S`.
    energy_kj, turns : float
        Means over all flights, of those that found it and those that did not.
    collisions : int
        Impossible actions.
    step_us : float
        Processor time of a second of flight, world included [microseconds].
    """

    site: str
    condition: str
    policy: str
    track: str
    flights: int
    spl_by_building: list[float]
    spl: Estimate
    success: Estimate
    false_alarms: Estimate
    median_s: float | None
    found_within: list[float]
    energy_kj: float
    turns: float
    collisions: int
    step_us: float


def scores(records: Sequence[Record]) -> list[Score]:
    """Score of each policy in each condition and site, in the order of the records."""
    groups: dict[tuple[str, ...], list[Record]] = {}
    for record in records:
        key = (record.site, record.condition, record.track, record.policy)
        groups.setdefault(key, []).append(record)
    return [_score(group) for group in groups.values()]


def spl(record: Record) -> float:
    """Success weighted by path length (Anderson et al. 2018, arXiv:1807.06757).

    Lengths count actions: readings that confirm cost time, not length.
    """
    lists = (record.found, record.shortest, record.actions)
    return weighted_by_length(*map(np.asarray, lists))


def _score(group: list[Record]) -> Score:
    first, found, steps = group[0], _joined(group, "found"), _joined(group, "steps")
    times = np.sort(np.where(found > 0.0, steps, np.inf))
    median = float(times[(times.size - 1) // 2])
    by_building = [spl(record) for record in group]
    return Score(
        site=first.site,
        condition=first.condition,
        policy=first.policy,
        track=first.track,
        flights=found.size,
        spl_by_building=[round(value, 4) for value in by_building],
        spl=_rounded(by_building),
        success=_rounded([float(np.mean(record.found)) for record in group]),
        false_alarms=_rounded([float(np.mean(record.false_alarm)) for record in group]),
        median_s=median if np.isfinite(median) else None,
        found_within=[round(float(np.mean(times <= limit)), 4) for limit in WITHIN_S],
        energy_kj=round(float(_joined(group, "energy_kj").mean()), 4),
        turns=round(float(_joined(group, "turns").mean()), 3),
        collisions=sum(record.collisions for record in group),
        step_us=round(1e6 * sum(record.cpu_s for record in group) / float(steps.sum()), 1),
    )


def _rounded(of_buildings: list[float]) -> Estimate:
    estimate = mean(of_buildings)
    return Estimate(*(round(v, 4) for v in (estimate.value, estimate.low, estimate.high)))


def _joined(group: list[Record], name: str) -> NDArray[np.float64]:
    return np.concatenate([np.asarray(getattr(record, name), np.float64) for record in group])
