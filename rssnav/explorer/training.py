"""One realisation of Q-learning that can be watched while it runs."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass, field
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from raytrace import RadioMap
from rssnav.agents import Agent, LocationAgent, RssAgent
from rssnav.decision_process import DecisionProcess
from rssnav.discrete_states import ExactStates, ToleranceStates
from rssnav.explorer.fair_turns import TabTurns
from rssnav.explorer.live_work import LiveWork
from rssnav.explorer.tracing import TracedMap
from rssnav.kernels import common
from rssnav.learning_parameters import QLearning
from rssnav.learning_rules import Learner, LearningProblem
from rssnav.optimal_flights import greedy_path, shortest_path
from rssnav.training import generator_states
from rssnav.world import GridWorld

KEPT_FLIGHTS = 200
MAX_EPISODES = 20_000
AgentName = Literal["rss", "location"]
_CHUNK_EPISODES = 64
_CHUNK_S = 0.1  # largest duration of a chunk at a limited pace


@dataclass(frozen=True)
class TrainingSettings:
    """Parameters of a training.

    Attributes
    ----------
    agent : {"rss", "location"}
    speed : int
        Cells per step along an axis.
    episodes : int
    seed : int
    goal_rss_dbm : float
        The RSS agent has found the source above this RSS [dBm].
    goal_distance_m : float
        The location agent has found the source within this distance [m].
    tolerance_db : float
        A reading within this of a known state is that state [dB]; 0 makes every value a state.
    learning : QLearning
    pace : float
        Maximum number of episodes per second, to slow it down for watching.
    """

    agent: AgentName = "rss"
    speed: int = 1
    episodes: int = 1000
    seed: int = 0
    goal_rss_dbm: float = RssAgent.terminal_dbm
    goal_distance_m: float = LocationAgent.terminal_distance_m
    tolerance_db: float = 0.0
    learning: QLearning = field(default_factory=QLearning)
    pace: float = math.inf

    def __post_init__(self) -> None:
        """Check agent, episodes and pace; agent and learning rule check the others."""
        if self.agent not in get_args(AgentName):
            raise ValueError(f"agent: {self.agent!r} must be 'rss' or 'location'")
        if not 1 <= self.episodes <= MAX_EPISODES:
            raise ValueError(f"episodes: {self.episodes} must be 1 to {MAX_EPISODES}")
        if not (isinstance(self.pace, float) and self.pace > 0.0):
            raise ValueError(f"pace: {self.pace!r} must be positive")

    def agent_itself(self) -> Agent:
        """Make the agent; raise ValueError for a parameter out of range."""
        if self.agent == "location":
            return LocationAgent(self.goal_distance_m)
        states = ToleranceStates(self.tolerance_db) if self.tolerance_db > 0.0 else ExactStates()
        return RssAgent(states, self.goal_rss_dbm)


@dataclass(frozen=True, eq=False)
class Flight:
    """The flight of one episode, or the one that was learned.

    Attributes
    ----------
    episode : int
        Counted from 1; the last one for the learned flight.
    position : (n + 1, 2) float64
        Cell centres [m], the start first.
    reached : bool
        Whether it found the source; otherwise the episode was truncated.
    learned : bool
        Whether it is the greedy flight after training.
    """

    episode: int
    position: NDArray[np.float64]
    reached: bool
    learned: bool = False

    @property
    def steps(self) -> int:
        """Number n of steps."""
        return len(self.position) - 1


def kept_episodes(episodes: int, kept: int = KEPT_FLIGHTS) -> NDArray[np.int64]:
    """Episodes (n,), counted from 1, whose flights are kept: all, or geometrically spaced.

    Parameters
    ----------
    episodes : int
        Number of episodes.
    kept : int
        Maximum number of flights to keep.
    """
    if episodes <= kept:
        return np.arange(1, episodes + 1)
    return np.unique(np.geomspace(1, episodes, kept).round().astype(np.int64))


class LiveTraining(LiveWork):
    """A training in a worker thread that can be watched and stopped.

    Parameters
    ----------
    traced : TracedMap
        Map that the UAV flies in.
    settings : TrainingSettings
    turns : TabTurns, optional
        Turns of its tab; each chunk of episodes takes one.

    Attributes
    ----------
    flights : list of Flight
        Flights of the episodes kept so far, in order; the learned one at the end.
    shortest_steps : int or None
        Fewest steps to the goal; None until known.
    converged_episode : int or None
        Episode of convergence (third equal flight in a row); None before.
    """

    def __init__(
        self, traced: TracedMap, settings: TrainingSettings, turns: TabTurns | None = None
    ) -> None:
        super().__init__("training", turns)
        self.traced, self.settings = traced, settings
        self.flights: list[Flight] = []
        self.shortest_steps: int | None = None
        self.converged_episode: int | None = None
        self._steps = np.empty(settings.episodes, dtype=np.int32)
        self._n_flown = 0
        self._begin_s = 0.0

    @property
    def steps(self) -> NDArray[np.int32]:
        """Steps of each episode flown so far, (n,)."""
        return self._steps[: self._n_flown]

    def _work(self) -> None:
        settings = self.settings
        with self._turns.turn(self._check):
            world = GridWorld.from_map(self.traced.plan, self.traced.radio_map, settings.speed)
            problem = LearningProblem.of(world, settings.agent_itself(), settings.learning)
            self.shortest_steps = shortest_path(world, problem.process.terminal).steps
            learner = problem.learner(generator_states(settings.seed, 0), settings.episodes)
        self._begin_s = time.monotonic()
        learner.trace = np.empty(settings.learning.max_steps, dtype=np.int32)
        for episode in kept_episodes(settings.episodes).tolist():
            self._advance(learner, episode)
            self.flights.append(_latest_flight(learner, problem.process, world))
        best = greedy_path(world, problem.process, learner.state_values())
        position = world.position[best.cells]
        self.flights.append(Flight(settings.episodes, position, best.reached, learned=True))

    def _advance(self, learner: Learner, episode: int) -> None:
        """Train up to an episode and store its steps."""
        counters, pace = learner.run.counters, self.settings.pace
        chunk = int(max(1.0, min(_CHUNK_EPISODES, pace * _CHUNK_S)))
        while (flown := int(counters[common.EPISODE])) < episode:
            with self._turns.turn(self._check):
                learner.advance(min(episode, flown + chunk))
            now = int(counters[common.EPISODE])
            self._steps[flown:now] = learner.run.episodes[flown:now, common.STEPS]
            self._n_flown = now
            if counters[common.CONVERGED_EPISODE] >= 0:
                self.converged_episode = int(counters[common.CONVERGED_EPISODE])
            self._stop.wait(now / pace - (time.monotonic() - self._begin_s))


def _latest_flight(learner: Learner, process: DecisionProcess, world: GridWorld) -> Flight:
    """Flight of a learner's last episode."""
    assert learner.trace is not None
    episode = int(learner.run.counters[common.EPISODE])
    steps, _, truncated = learner.run.episodes[episode - 1]
    cells = process.cell_of_state[np.concatenate(([process.start], learner.trace[:steps]))]
    return Flight(episode, world.position[cells], not truncated)


def suggested_goal_dbm(radio_map: RadioMap, usual_dbm: float) -> float:
    """Goal level [dBm] for a map: the usual one, or one that its strongest cells exceed."""
    covered = radio_map.rss_dbm[np.isfinite(radio_map.rss_dbm)]
    strongest = float(covered.max()) if covered.size else usual_dbm
    return usual_dbm if strongest > usual_dbm else float(np.floor(strongest - 1.0))
