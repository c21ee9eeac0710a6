"""Cases that compare two trainings by a value per realisation."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from rssnav.experiments.paper.claims.verdicts import Case, Verdict, case, positive, undecided
from rssnav.experiments.paper.data import AGENT_LABELS, AGENTS, AgentName, PaperData
from rssnav.experiments.statistics import Estimate, difference, ratio
from rssnav.results import TrainingResult

PerRun = Callable[[TrainingResult], NDArray[np.float64]]
"""From a training to one value per realisation that has one."""


def agents_differ(
    data: PaperData,
    scenario: int,
    speed: int,
    value: PerRun,
    *,
    larger: AgentName,
    detail: str = "",
) -> Case:
    """Test that a value's mean is larger for one agent than for the other."""
    smaller: AgentName = "rss" if larger == "location" else "location"
    first, second = (value(data.result(scenario, a, speed)) for a in (larger, smaller))
    labels = (AGENT_LABELS[larger], AGENT_LABELS[smaller])
    return _compare(place(scenario, speed, detail), labels, first, second, difference, positive)


def agents_alike(
    data: PaperData,
    scenario: int,
    speed: int,
    value: PerRun,
    decide: Callable[[Estimate], Verdict],
    detail: str = "",
) -> Case:
    """Test the ratio of a value's mean, RSS-based over location-based."""
    first, second = (value(data.result(scenario, a, speed)) for a in ("rss", "location"))
    labels = (AGENT_LABELS["rss"], AGENT_LABELS["location"])
    return _compare(place(scenario, speed, detail), labels, first, second, ratio, decide)


def falls_with_speed(data: PaperData, scenario: int, value: PerRun) -> Iterator[Case]:
    """Test for each agent that a value's mean falls from each speed to the next."""
    for agent in AGENTS:
        for slow, fast in pairwise(data.speeds):
            first, second = (value(data.result(scenario, agent, v)) for v in (slow, fast))
            labels = (f"{slow} m/s", f"{fast} m/s")
            name = f"Scenario {scenario}, {AGENT_LABELS[agent]}, {slow} to {fast} m/s"
            yield _compare(name, labels, first, second, difference, positive)


def place(scenario: int, speed: int, detail: str = "") -> str:
    """Return the text for a scenario and a speed."""
    return f"Scenario {scenario}, {speed} m/s" + (f", {detail}" if detail else "")


def _compare(
    name: str,
    labels: tuple[str, str],
    first: NDArray[np.float64],
    second: NDArray[np.float64],
    statistic: Callable[[NDArray[np.float64], NDArray[np.float64]], Estimate],
    decide: Callable[[Estimate], Verdict],
) -> Case:
    if first.size == 0 or second.size == 0:
        return undecided(name)
    compared = [(labels[0], float(first.mean())), (labels[1], float(second.mean()))]
    return case(name, compared, statistic(first, second), decide)
