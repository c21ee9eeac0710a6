"""Flights -> success, SPL, times, energy, with intervals over buildings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rssnav.benchmark.protocol import CONFIRMATIONS
from rssnav.benchmark.running import Record
from rssnav.experiments.statistics import mean


@dataclass(frozen=True)
class Score:
    """An entrant's result in a task.

    Attributes
    ----------
    entrant, knows, condition : str
        Who, its track, which task.
    flights, buildings : int
        How many.
    success, false_alarms : float
        Parts of the flights.
    spl, spl_low, spl_high : float
        Success weighted by path length, and its 95 % interval over buildings. Where the goal is
        confirmed, the fewest steps include the readings that confirm it.
    time_s : list of float or None
        Time to find: quartiles and ninth decile over all flights, those that fail last; None where
        the quantile is a failure [s].
    energy_kj, turns : float
        Means over all flights.
    collisions : int
        Impossible actions.
    step_us : float
        Processor time of a second of flight, world included [microseconds].
    """

    entrant: str
    knows: str
    condition: str
    flights: int
    buildings: int
    success: float
    false_alarms: float
    spl: float
    spl_low: float
    spl_high: float
    time_s: list[float | None]
    energy_kj: float
    turns: float
    collisions: int
    step_us: float


QUANTILES = (0.25, 0.5, 0.75, 0.9)


def scores(records: Sequence[Record]) -> list[Score]:
    """Score of each entrant in each task, in the order of the records."""
    groups: dict[tuple[str, str, str], list[Record]] = {}
    for record in records:
        groups.setdefault((record.condition, record.knows, record.entrant), []).append(record)
    return [_score(group) for group in groups.values()]


def _score(group: list[Record]) -> Score:
    found, steps = _joined(group, "found").astype(bool), _joined(group, "steps")
    spl = mean([float(np.mean(_spl(record))) for record in group])
    times = np.sort(np.where(found, steps, np.inf))
    first = group[0]
    return Score(
        entrant=first.entrant,
        knows=first.knows,
        condition=first.condition,
        flights=found.size,
        buildings=len(group),
        success=float(found.mean()),
        false_alarms=float(_joined(group, "false_alarm").mean()),
        spl=spl.value,
        spl_low=spl.low,
        spl_high=spl.high,
        time_s=[_quantile(times, q) for q in QUANTILES],
        energy_kj=float(_joined(group, "energy_kj").mean()),
        turns=float(_joined(group, "turns").mean()),
        collisions=sum(record.collisions for record in group),
        step_us=1e6 * sum(record.cpu_s for record in group) / float(steps.sum()),
    )


def _joined(group: list[Record], name: str) -> NDArray[np.float64]:
    return np.concatenate([np.asarray(getattr(record, name), np.float64) for record in group])


def _spl(record: Record) -> NDArray[np.float64]:
    """Success of each flight, weighted by path length (Anderson et al. 2018, arXiv:1807.06757)."""
    steps = np.asarray(record.steps, np.float64)
    confirming = CONFIRMATIONS - 1 if "dB" in record.condition else 0
    least = np.asarray(record.shortest, np.float64) + confirming
    return np.asarray(record.found) * least / np.maximum(least, steps)


def _quantile(times: NDArray[np.float64], q: float) -> float | None:
    value = float(times[min(int(q * times.size), times.size - 1)])
    return value if np.isfinite(value) else None
