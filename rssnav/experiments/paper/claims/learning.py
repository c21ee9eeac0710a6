"""Claims about steps and visits during training (the paper shows Scenario 1)."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import NDArray

from rssnav.experiments.paper.claims.comparing import PerRun, agents_differ, falls_with_speed, place
from rssnav.experiments.paper.claims.verdicts import Case, Claim, between, case
from rssnav.experiments.paper.data import (
    AGENT_LABELS,
    AGENTS,
    SHOWN_EPISODES,
    VISIT_EPISODES,
    AgentName,
    Configuration,
    PaperData,
)
from rssnav.experiments.statistics import difference, mean
from rssnav.results import TrainingResult

SCENARIO, SHOWN_SPEED = 1, 1
EARLY_EPISODES = VISIT_EPISODES[0]
WINDOW = 100
NEAR_START_M = 10.0
GOOD_FACTOR = 1.1
GOOD_FRACTION = 0.9


def mean_steps(first: int, last: int) -> PerRun:
    """Return the function from a training to each run's mean steps in episodes first..last-1."""
    return lambda result: result.steps[:, first:last].mean(axis=1, dtype=np.float64)


def fluctuation(result: TrainingResult) -> NDArray[np.float64]:
    """Mean absolute change of the number of steps from one episode to the next, per run."""
    steps = result.steps[:, :SHOWN_EPISODES].astype(np.float64)
    return np.abs(np.diff(steps, axis=1)).mean(axis=1)


def _per_speed(value: PerRun, larger: AgentName) -> Callable[[PaperData], list[Case]]:
    return lambda data: [
        agents_differ(data, SCENARIO, speed, value, larger=larger) for speed in data.speeds
    ]


def _visits_near_start(data: PaperData) -> Iterator[Case]:
    per_run: dict[AgentName, NDArray[np.float64]] = {}
    for agent in AGENTS:
        key = Configuration(SCENARIO, agent, SHOWN_SPEED)
        world = data.results[key].world
        offset_m = np.hypot(*(world.position - world.position[world.start_state]).T)
        near = offset_m <= NEAR_START_M
        first = data.first_episodes[key]
        per_run[agent] = first.visits[:, near].sum(axis=1) / first.early
    location, rss = per_run["location"], per_run["rss"]
    compared = (("location-based", float(location.mean())), ("RSS-based", float(rss.mean())))
    yield case(place(SCENARIO, SHOWN_SPEED), compared, difference(location, rss))


def _fall_with_episode(data: PaperData) -> Iterator[Case]:
    for agent in AGENTS:
        for speed in data.speeds:
            result = data.result(SCENARIO, agent, speed)
            last = min(SHOWN_EPISODES, result.steps.shape[1])
            first = mean_steps(0, WINDOW)(result)
            final = mean_steps(last - WINDOW, last)(result)
            compared = (
                (f"first {WINDOW}", float(first.mean())),
                (f"last {WINDOW}", float(final.mean())),
            )
            yield case(_name(agent, speed), compared, mean(first - final))


def _good_policies(data: PaperData) -> Iterator[Case]:
    fewest = data.shortest_in_steps[SCENARIO, SHOWN_SPEED].steps
    for agent in AGENTS:
        key = Configuration(SCENARIO, agent, SHOWN_SPEED)
        first = data.first_episodes[key]
        good = first.reached & (first.path_steps <= GOOD_FACTOR * fewest)
        flown = mean_steps(first.episodes - WINDOW, first.episodes)(data.results[key])
        compared = (
            ("greedy flights that arrive [%]", 100.0 * float(first.reached.mean())),
            (f"steps flown in the last {WINDOW} episodes", float(flown.mean())),
            ("fewest steps possible", float(fewest)),
        )
        decide = between(GOOD_FRACTION, 1.0)
        yield case(_name(agent, SHOWN_SPEED), compared, mean(good), decide)


def _name(agent: AgentName, speed: int) -> str:
    return f"{AGENT_LABELS[agent]}, {place(SCENARIO, speed)}"


CLAIMS = (
    Claim(
        "visits-near-start",
        f"In the first {EARLY_EPISODES} episodes the location-based agent visits places near the "
        "start more often than the RSS-based one.",
        f"Visits per episode of cells within {NEAR_START_M:g} m of the start, in the first "
        f"{EARLY_EPISODES} episodes of each run. Reproduced if the location-based "
        "agent's are more.",
        "visits per episode, location-based minus RSS-based",
        lambda data: list(_visits_near_start(data)),
    ),
    Claim(
        "early-steps",
        "In early episodes the location-based agent takes more steps on average.",
        f"Mean steps of the first {EARLY_EPISODES} episodes. Reproduced where the location-based "
        "agent takes more.",
        "steps, location-based minus RSS-based",
        _per_speed(mean_steps(0, EARLY_EPISODES), "location"),
    ),
    Claim(
        "steps-fall-with-episode",
        "The number of steps falls with the episode.",
        f"Mean steps of the first {WINDOW} against the last {WINDOW} of the first "
        f"{SHOWN_EPISODES} episodes, run by run. Reproduced where they fall.",
        f"steps, first {WINDOW} episodes minus last {WINDOW}",
        lambda data: list(_fall_with_episode(data)),
    ),
    Claim(
        "steps-fall-with-speed",
        "The number of steps falls with speed, as there are fewer states to visit.",
        f"Mean steps of the first {SHOWN_EPISODES} episodes. Reproduced where each speed takes "
        "fewer than the next slower one.",
        "steps, slower minus faster",
        lambda data: list(falls_with_speed(data, SCENARIO, mean_steps(0, SHOWN_EPISODES))),
    ),
    Claim(
        "good-by-1000",
        f"Both agents learn good policies within the first {SHOWN_EPISODES} episodes.",
        f"The greedy flight of each run after {SHOWN_EPISODES} episodes counts as good if "
        f"it arrives in at most {GOOD_FACTOR:g} times the fewest steps possible. Reproduced where "
        f"at least {100 * GOOD_FRACTION:g} % of the runs are good.",
        "fraction of good runs",
        lambda data: list(_good_policies(data)),
    ),
    Claim(
        "rss-fluctuates-less",
        "The RSS-based agent's learning curves fluctuate less.",
        "Mean absolute change of the steps from one episode to the next over the first "
        f"{SHOWN_EPISODES} episodes. Reproduced where the location-based agent's is larger.",
        "steps, location-based minus RSS-based",
        _per_speed(fluctuation, "location"),
    ),
)
