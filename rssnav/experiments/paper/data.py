"""Input of the figures, tables and claims: plans, maps and training results."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from rssnav.agents import Agent, LocationAgent, RssAgent
from rssnav.experiments.paper.counting import SUPPORTED_COUNT, Count
from rssnav.experiments.paper.first_episodes import FirstEpisodes
from rssnav.experiments.paper.scenarios import PLANS, SPEEDS, Scenario
from rssnav.optimal_flights import Flight, shortest_path
from rssnav.results import TrainingResult
from rssnav.world import GridWorld

AgentName = Literal["rss", "location"]

AGENTS: dict[AgentName, Agent] = {"rss": RssAgent(), "location": LocationAgent()}
"""The paper's two agents, in its order."""

AGENT_LABELS: dict[AgentName, str] = {"rss": "RSS-based", "location": "location-based"}

SHOWN_EPISODES = 1000
"""Episodes that the paper's learning figures show."""

VISIT_EPISODES = (200, 500, SHOWN_EPISODES)
"""Episodes after which the paper shows the visits of each cell."""


@dataclass(frozen=True, order=True)
class Configuration:
    """One of the trainings of the paper.

    Attributes
    ----------
    scenario : int
        1 or 2.
    agent : str
        "rss" or "location".
    speed : int
        Cells per step [m/s on a 1 m grid].
    """

    scenario: int
    agent: AgentName
    speed: int

    @property
    def name(self) -> str:
        """Name of its files."""
        return f"scenario{self.scenario}_{self.agent}_{self.speed}mps"

    @property
    def label(self) -> str:
        """Name in texts."""
        return f"Scenario {self.scenario}, {AGENT_LABELS[self.agent]}, {self.speed} m/s"


CONFIGURATIONS = tuple(
    Configuration(scenario, agent, speed)
    for scenario in range(1, 1 + len(PLANS))
    for agent in AGENTS
    for speed in SPEEDS
)
"""All trainings of the paper: scenarios, in each both agents, each at all speeds."""

VISITS_CONFIGURATIONS = tuple(Configuration(1, agent, 1) for agent in AGENTS)
"""The trainings whose visits in the first episodes the paper shows."""


@dataclass(frozen=True, eq=False)
class PaperData:
    """Everything that a run of the paper measured.

    Attributes
    ----------
    scenarios : mapping of int to Scenario
        Plans and maps, by the scenario's number.
    results : mapping of Configuration to TrainingResult
        Trainings.
    first_episodes : mapping of Configuration to FirstEpisodes
        First episodes of each realisation, for :data:`VISITS_CONFIGURATIONS`.
    count : Count
        Which steps a length counts that is compared with the paper's.
    """

    scenarios: Mapping[int, Scenario]
    results: Mapping[Configuration, TrainingResult]
    first_episodes: Mapping[Configuration, FirstEpisodes]
    count: Count = SUPPORTED_COUNT

    def result(self, scenario: int, agent: AgentName, speed: int) -> TrainingResult:
        """Return the training of a configuration."""
        return self.results[Configuration(scenario, agent, speed)]

    @property
    def speeds(self) -> tuple[int, ...]:
        """Speeds of the trainings, ascending [m/s]."""
        return tuple(sorted({key.speed for key in self.results}))

    @property
    def n_runs(self) -> int:
        """Realisations of each configuration."""
        return next(iter(self.results.values())).run_ids.size

    @cached_property
    def shortest_in_metres(self) -> dict[tuple[int, int], Flight]:
        """Shortest flight in metres, by (scenario, speed)."""
        return {key: shortest_path(*world, "metres") for key, world in self._worlds().items()}

    @cached_property
    def shortest_in_steps(self) -> dict[tuple[int, int], Flight]:
        """Shortest flight in steps, by (scenario, speed); of several, the shortest in metres."""
        return {key: shortest_path(*world, "steps") for key, world in self._worlds().items()}

    def _worlds(self) -> dict[tuple[int, int], tuple[GridWorld, NDArray[np.bool_]]]:
        """World and the location agent's terminal states, by (scenario, speed)."""
        return {
            (key.scenario, key.speed): (result.world, terminal_states(result))
            for key, result in self.results.items()
            if key.agent == "location"
        }


def terminal_states(result: TrainingResult) -> NDArray[np.bool_]:
    """States (S,) that end an episode of a training."""
    return result.agent.decision_process(result.world, result.learning).terminal


def flights(result: TrainingResult) -> list[NDArray[np.int32]]:
    """States (n + 1,) of each final flight that reaches the source."""
    rows = result.trajectories[result.reached]
    return [row[row >= 0] for row in rows]
