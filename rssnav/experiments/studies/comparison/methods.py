"""The methods that are compared, and their flights in a world.

The step budget of SARSA and Double Q-learning is the largest number of steps that any realisation
of Q-learning flew until it converged. Searchers do not learn: each flies once, up to the step limit
of an episode.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from rssnav.agents import Agent
from rssnav.decision_process import DecisionProcess
from rssnav.discrete_states import Fluctuation
from rssnav.experiments.paper.data import AGENT_LABELS, AGENTS, AgentName, flights
from rssnav.experiments.paper.trainings import EPISODE_LIMIT
from rssnav.experiments.search_store import SearchRequest, fly_or_reuse
from rssnav.experiments.studies.study import Conditions
from rssnav.learning_parameters import QLearning
from rssnav.optimal_flights import (
    Flight,
    discounted_return,
    greedy_path,
    shortest_path,
    value_iteration,
)
from rssnav.results import TrainingResult
from rssnav.schedule import NO_STEP_LIMIT
from rssnav.searchers import ParticleFilter, RandomWalk, RssAscent, Searcher
from rssnav.world import GridWorld

STEADY, NOISE = Fluctuation(), Fluctuation(sigma_db=2.0)
_RULES = {
    "Q-learning": QLearning(),
    "SARSA": QLearning(rule="sarsa"),
    "Double Q-learning": QLearning(rule="double_q"),
}
_TOLERANCE = 1e-6


@dataclass(frozen=True, eq=False)
class Performance:
    """Final flights of a method, over R runs of which A arrive.

    Attributes
    ----------
    kind : str
        "oracle", "learner" or "searcher".
    name, knows : str
        Name of the method, and the information it uses.
    runs : int
        R.
    steps, length_m : (A,) float64
        Steps and length [m] of the flights that arrive.
    converged : int or None
        Runs that converged, for learners.
    training_steps : (R,) float64
        Steps flown in training; empty for methods that do not learn.
    regret : (A,) float64
        Optimal return minus the flight's; empty for methods without a return.
    sigma_db : float
        Standard deviation of the RSS fluctuation [dB].
    false_alarms : float or None
        Fraction of the runs that ended away from the source by a reading above the goal's level,
        for searchers.
    """

    kind: str
    name: str
    knows: str
    runs: int
    steps: NDArray[np.float64]
    length_m: NDArray[np.float64]
    converged: int | None
    training_steps: NDArray[np.float64]
    regret: NDArray[np.float64]
    sigma_db: float = 0.0
    false_alarms: float | None = None


class Contender(Protocol):
    """One or more methods that are measured together."""

    def fly(self, world: GridWorld, conditions: Conditions) -> Iterator[Performance]:
        """Yield the performance of each method in a world."""
        ...


@dataclass(frozen=True)
class ShortestFlights:
    """Shortest flights in steps and in metres."""

    def fly(self, world: GridWorld, conditions: Conditions) -> Iterator[Performance]:
        """Yield both oracles."""
        terminal = AGENTS["location"].decision_process(world, QLearning()).terminal
        for cost in ("steps", "metres"):
            flight = shortest_path(world, terminal, cost)
            yield _oracle(f"fewest {cost} (Dijkstra)", "the plan", flight)


@dataclass(frozen=True)
class Learners:
    """The optimum of an agent's rewards, and the learning rules that approach it."""

    agent: AgentName

    def fly(self, world: GridWorld, conditions: Conditions) -> Iterator[Performance]:
        """Yield value iteration, then each learning rule."""
        task = _Task.of(world, AGENTS[self.agent])
        label = AGENT_LABELS[self.agent]
        yield _oracle(f"value iteration, {label} rewards", "plan and rewards", task.optimum)
        budget = NO_STEP_LIMIT
        for rule, learning in _RULES.items():
            result = conditions.train(
                f"{world.plan_name} {self.agent} {world.speed}mps {rule}",
                world,
                task.agent,
                EPISODE_LIMIT,
                learning=learning,
                until_converged=True,
                max_total_steps=budget,
            )
            performance = _learner(f"{rule}, {label}", task, result)
            budget = min(budget, int(performance.training_steps.max()))
            yield performance


@dataclass(frozen=True)
class Search:
    """A searcher, and how its RSS readings fluctuate."""

    searcher: Searcher
    fluctuation: Fluctuation

    @property
    def knows(self) -> str:
        """Information that the searcher uses."""
        if isinstance(self.searcher, RandomWalk):
            return "RSS at the goal"
        return "RSS, plan, own position" if isinstance(self.searcher, ParticleFilter) else "RSS"

    def fly(self, world: GridWorld, conditions: Conditions) -> Iterator[Performance]:
        """Yield the searcher's performance."""
        request = SearchRequest(
            world, self.searcher, self.fluctuation, conditions.runs, conditions.seed
        )
        result = fly_or_reuse(request, conditions.store)
        found = result.found
        yield Performance(
            kind="searcher",
            name=self.searcher.name,
            knows=self.knows,
            runs=conditions.runs,
            steps=result.steps[found].astype(np.float64),
            length_m=result.length_m[found],
            converged=None,
            training_steps=np.empty(0),
            regret=np.empty(0),
            sigma_db=self.fluctuation.sigma_db,
            false_alarms=float(result.false_alarm.mean()),
        )


CONTENDERS: tuple[Contender, ...] = (
    ShortestFlights(),
    *(Learners(agent) for agent in AGENTS),
    Search(RandomWalk(), STEADY),
    Search(RssAscent(escape_steps=0), STEADY),
    Search(RssAscent(), STEADY),
    Search(ParticleFilter(), STEADY),
    Search(RssAscent(), NOISE),
    Search(RssAscent(readings=8), NOISE),
    Search(ParticleFilter(), NOISE),
)


@dataclass(frozen=True, eq=False)
class _Task:
    """An agent's decision process in a world, and the flight that is optimal in it."""

    world: GridWorld
    agent: Agent
    process: DecisionProcess
    optimum: Flight

    @classmethod
    def of(cls, world: GridWorld, agent: Agent) -> _Task:
        learning = QLearning()
        process = agent.decision_process(world, learning)
        solution = value_iteration(process, learning.gamma, tolerance=_TOLERANCE)
        return cls(world, agent, process, greedy_path(world, process, solution.q))

    def regret(self, states: NDArray[np.int32]) -> float:
        """Optimal return from the start minus that of a flight."""
        gamma = QLearning().gamma
        best = discounted_return(self.process, self.optimum.states, gamma)
        return best - discounted_return(self.process, states, gamma)


def _oracle(name: str, knows: str, flight: Flight) -> Performance:
    none = np.empty(0)
    steps, length_m = np.array([float(flight.steps)]), np.array([flight.length_m])
    return Performance("oracle", name, knows, 1, steps, length_m, None, none, none)


def _learner(name: str, task: _Task, result: TrainingResult) -> Performance:
    arrived = result.reached
    knows = "own and transmitter's position" if task.agent.name == "location" else "RSS"
    flown = np.array([row[row > 0].sum() for row in result.steps], dtype=np.float64)
    return Performance(
        kind="learner",
        name=name,
        knows=knows,
        runs=arrived.size,
        steps=result.path_steps[arrived].astype(np.float64),
        length_m=result.path_length_m[arrived],
        converged=int(np.count_nonzero(result.converged_episode >= 0)),
        training_steps=flown,
        regret=np.array([task.regret(states) for states in flights(result)]),
    )
