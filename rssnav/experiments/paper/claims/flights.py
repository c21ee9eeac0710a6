"""Claims about the final flights."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import product

import numpy as np
from numpy.typing import NDArray

from rssnav.discrete_states import AGENT_SENSITIVITY_DBM, heard
from rssnav.experiments.paper.claims.comparing import PerRun, agents_alike, agents_differ, place
from rssnav.experiments.paper.claims.verdicts import Case, Claim, between, case, undecided
from rssnav.experiments.paper.counting import COMPARED_COUNTS, Count, counted_lengths_m
from rssnav.experiments.paper.data import AGENT_LABELS, AGENTS, PaperData, flights, terminal_states
from rssnav.experiments.paper.printed_values import PATH_LENGTH_M
from rssnav.experiments.paper.shortest_flights import shortest_flights
from rssnav.experiments.statistics import difference, mean
from rssnav.results import TrainingResult
from rssnav.world import GridWorld

SHOWN_SPEED = 1
"""Speed of the paper's trajectory figure [m/s]."""

WEAK_FRACTION = 0.25
"""A cell is weak when its RSS is in this lowest fraction of the reachable cells."""

FLIGHTS_DRAWN = 500
"""Number of shortest flights that trajectories are compared with."""

Flights = Sequence[NDArray[np.integer]]
"""Flights, each as its states (n + 1,)."""

_CLOSE = max(
    max(ratio, 1.0 / ratio)
    for key, rss_m in PATH_LENGTH_M.items()
    if key.agent == "rss"
    for ratio in [rss_m / PATH_LENGTH_M[type(key)(key.scenario, "location", key.speed)]]
)
"""Largest ratio of lengths in the paper's table; the paper calls them very close."""


def mean_rss_dbm(world: GridWorld, several: Flights) -> NDArray[np.float64]:
    """Mean RSS [dBm] over the cells of each flight (n,), as an agent reads it: never -inf."""
    read_dbm = heard(world.rss_dbm, AGENT_SENSITIVITY_DBM)
    return np.array([read_dbm[flight].mean() for flight in several])


def strong_percentage(world: GridWorld, several: Flights) -> NDArray[np.float64]:
    """Percentage of each flight's cells that are not weak (n,)."""
    strong = world.rss_dbm > np.quantile(world.rss_dbm, WEAK_FRACTION)
    return np.array([100.0 * strong[flight].mean() for flight in several])


def turns(world: GridWorld, flight: NDArray[np.integer]) -> float:
    """Number of changes of heading on a flight."""
    steps = np.diff(world.position[flight], axis=0)
    return float(np.count_nonzero(np.any(steps[1:] != steps[:-1], axis=1)))


def _turns_per_run(result: TrainingResult) -> NDArray[np.float64]:
    return np.array([turns(result.world, flight) for flight in flights(result)])


def _steps(result: TrainingResult) -> NDArray[np.float64]:
    return result.path_steps[result.reached].astype(np.float64)


_RSS_STATISTICS: dict[str, Callable[[GridWorld, Flights], NDArray[np.float64]]] = {
    "mean RSS [dBm]": mean_rss_dbm,
    f"cells above the weakest {100 * WEAK_FRACTION:g} % [%]": strong_percentage,
}


def _avoids_low_rss(data: PaperData) -> Iterator[Case]:
    for scenario in data.scenarios:
        result = data.result(scenario, "rss", SHOWN_SPEED)
        shortest = shortest_flights(result.world, terminal_states(result), FLIGHTS_DRAWN)
        for what, statistic in _RSS_STATISTICS.items():
            name = f"{place(scenario, SHOWN_SPEED)}, {what}"
            learned = statistic(result.world, flights(result))
            reference = float(statistic(result.world, shortest).mean())
            if learned.size == 0:
                yield undecided(name)
                continue
            compared = [("RSS-based", float(learned.mean())), ("shortest flights", reference)]
            unaware = data.result(scenario, "location", SHOWN_SPEED)
            if others := flights(unaware):
                compared.append(("location-based", float(statistic(unaware.world, others).mean())))
            yield case(name, compared, mean(learned - reference))


def _everywhere(test: Callable[[PaperData, int, int], Case]) -> Callable[[PaperData], list[Case]]:
    """Apply a test to every scenario and speed."""
    return lambda data: [
        test(data, scenario, speed) for scenario in data.scenarios for speed in data.speeds
    ]


def _lengths(count: Count) -> PerRun:
    return lambda result: counted_lengths_m(result, count)


def _length_cases(data: PaperData) -> Iterator[tuple[int, int, Count]]:
    """Scenarios and speeds, under each count of the steps."""
    return product(data.scenarios, data.speeds, COMPARED_COUNTS)


def _scenario_2_needs_more_steps(data: PaperData) -> Iterator[Case]:
    for agent in AGENTS:
        for speed in data.speeds:
            first, second = (_steps(data.result(scenario, agent, speed)) for scenario in (2, 1))
            name = f"{AGENT_LABELS[agent]}, {speed} m/s"
            if first.size == 0 or second.size == 0:
                yield undecided(name)
                continue
            compared = (("Scenario 2", float(first.mean())), ("Scenario 1", float(second.mean())))
            yield case(name, compared, difference(first, second))


CLAIMS = (
    Claim(
        "avoids-low-rss",
        "The RSS-based agent's trajectories tend to keep away from regions of low RSS.",
        f"Final flights at {SHOWN_SPEED} m/s against the average of {FLIGHTS_DRAWN} flights drawn "
        "at random from all shortest ones: mean RSS over the cells, and percentage of cells "
        f"not among the weakest {100 * WEAK_FRACTION:g} % of the building. Reproduced where the "
        "RSS-based flights' is higher.",
        "RSS-based minus shortest flights",
        lambda data: list(_avoids_low_rss(data)),
    ),
    Claim(
        "location-straighter",
        "The location-based agent flies straighter trajectories.",
        "Changes of heading on the final flight. Reproduced where the RSS-based agent makes more.",
        "changes of heading, RSS-based minus location-based",
        _everywhere(lambda d, s, v: agents_differ(d, s, v, _turns_per_run, larger="rss")),
    ),
    Claim(
        "location-shorter",
        "The location-based agent's final path is shorter, as it is straighter.",
        "Length of the final flight. Reproduced where the RSS-based agent's is longer.",
        "length [m], RSS-based minus location-based",
        lambda data: [
            agents_differ(data, s, v, _lengths(count), larger="rss", detail=count)
            for s, v, count in _length_cases(data)
        ],
    ),
    Claim(
        "lengths-close",
        "The RSS-based agent comes very close to the location-based one in its final trajectory.",
        f"Ratio of the mean lengths. Reproduced where it lies within a factor {_CLOSE:.3f}, the "
        "largest in the paper's table.",
        "ratio of lengths, RSS-based over location-based",
        lambda data: [
            agents_alike(data, s, v, _lengths(count), between(1.0 / _CLOSE, _CLOSE), count)
            for s, v, count in _length_cases(data)
        ],
    ),
    Claim(
        "scenario-2-longer",
        "Scenario 2 takes more steps than Scenario 1, as its hallways are longer.",
        "Steps of the final flight. Reproduced where Scenario 2 takes more.",
        "steps, Scenario 2 minus Scenario 1",
        lambda data: list(_scenario_2_needs_more_steps(data)),
    ),
)
