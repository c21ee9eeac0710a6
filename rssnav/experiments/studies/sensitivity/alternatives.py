"""The alternatives to our interpretation of the paper, and the outcome of each."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from rssnav.experiments.paper.claims.flights import turns
from rssnav.experiments.paper.counting import SUPPORTED_COUNT, counted_lengths_m
from rssnav.experiments.paper.data import (
    AGENTS,
    CONFIGURATIONS,
    SHOWN_EPISODES,
    Configuration,
    flights,
    terminal_states,
)
from rssnav.experiments.paper.trainings import EPISODE_LIMIT, STEP_LIMIT
from rssnav.experiments.studies.study import Conditions
from rssnav.learning_parameters import QLearning
from rssnav.optimal_flights import shortest_path
from rssnav.results import TrainingResult
from rssnav.world import GridWorld, WorldError


@dataclass(frozen=True)
class Alternative:
    """Another choice of one parameter.

    Attributes
    ----------
    parameter, choice : str
        The parameter and its value, in words.
    learning : QLearning
        Learning parameters with this choice.
    coherent : bool
        Whether the map sums the paths' fields instead of their powers.
    episodes : int or None
        Train exactly this many episodes instead of until convergence.
    """

    parameter: str
    choice: str
    learning: QLearning = field(default_factory=QLearning)
    coherent: bool = False
    episodes: int | None = None

    @property
    def label(self) -> str:
        """Text in the figure."""
        return f"{self.parameter}: {self.choice}"

    def concerns(self, key: Configuration) -> bool:
        """Whether it can make a difference: the location agent does not use the RSS."""
        return not self.coherent or key.agent == "rss"


OURS = Alternative("our interpretation", "defaults")
FLOWN = Alternative("final trajectory", "flown three times")
"""No training of its own: the flights in which the defaults converged, not the greedy ones."""

ALTERNATIVES: tuple[Alternative, ...] = (
    *(Alternative("initial Q", f"{q:g}", QLearning(initial_q=q)) for q in (0.0, 20.0, 50.0)),
    *(Alternative("initial Q", f"{q:g}", QLearning(initial_q=q)) for q in (200.0, 500.0)),
    Alternative("maximum over", "all actions", QLearning(maximum_over="all")),
    Alternative("step limit", "2 000 steps", QLearning(max_steps=2_000)),
    Alternative("step limit", "200 000 steps", QLearning(max_steps=200_000)),
    Alternative("map", "coherent sum", coherent=True),
    Alternative("decay", "per episode, η 1e-5", QLearning(decay="episode")),
    Alternative("decay", "per episode, η 1e-3", QLearning(decay="episode", eta=1e-3)),
    Alternative("tie-break", "random", QLearning(tie_break="random")),
    Alternative("goal reward", "instead", QLearning(goal_reward_is="instead")),
    *(
        Alternative(
            "training", f"{SHOWN_EPISODES} episodes{change}", learning, False, SHOWN_EPISODES
        )
        for change, learning in (
            ("", QLearning()),
            (", decay per episode, η 1e-3", QLearning(decay="episode", eta=1e-3)),
            (", α 0.5", QLearning(alpha_min=0.5)),
        )
    ),
)


@dataclass(frozen=True)
class Trial:
    """An alternative in one configuration."""

    alternative: Alternative
    key: Configuration


def trials() -> tuple[Trial, ...]:
    """List every alternative in the configurations it concerns, ours first."""
    return tuple(
        Trial(alternative, key)
        for alternative in (OURS, *ALTERNATIVES)
        for key in CONFIGURATIONS
        if alternative.concerns(key)
    )


@dataclass(frozen=True, eq=False)
class Outcome:
    """Outcome of an alternative in one configuration.

    Attributes
    ----------
    alternative : Alternative
    key : Configuration
    runs : int
        Realisations.
    episodes, steps : (C,) float64
        Episodes and steps until convergence, of the C runs that converged.
    length_m, path_steps : (A,) float64
        Length [m], all steps counted, and steps of the A final flights that reach the source.
    counted_m : (A,) float64 or None
        Length [m] with :data:`~rssnav.experiments.paper.counting.SUPPORTED_COUNT`; None where the
        flights themselves were not stored.
    turns : (A,) float64 or None
        Changes of heading of the A flights; None where the flights were not stored.
    fewest_steps : int
        Of any flight; 0 where none was looked for.
    obstacle : str
        Why it could not be trained; empty if it could.
    """

    alternative: Alternative
    key: Configuration
    runs: int
    episodes: NDArray[np.float64]
    steps: NDArray[np.float64]
    length_m: NDArray[np.float64]
    path_steps: NDArray[np.float64]
    counted_m: NDArray[np.float64] | None = None
    turns: NDArray[np.float64] | None = None
    fewest_steps: int = 0
    obstacle: str = ""


def measure(trial: Trial, conditions: Conditions) -> list[Outcome]:
    """Train an alternative in a configuration; :data:`OURS` also gives :data:`FLOWN`.

    Raises
    ------
    TrainingInterrupted
        On Ctrl-C.
    """
    alternative, key = trial.alternative, trial.key
    try:
        result = conditions.train(
            f"{alternative.label} {key.name}",
            _world(trial, conditions),
            AGENTS[key.agent],
            alternative.episodes or EPISODE_LIMIT,
            learning=alternative.learning,
            until_converged=alternative.episodes is None,
            max_total_steps=STEP_LIMIT,
        )
    except WorldError as error:
        none = np.empty(0)
        return [
            Outcome(alternative, key, conditions.runs, none, none, none, none, obstacle=str(error))
        ]
    outcome = _greedy(alternative, key, result)
    return [outcome, _flown(outcome, result)] if alternative == OURS else [outcome]


def _world(trial: Trial, conditions: Conditions) -> GridWorld:
    """World of a trial; for a coherent sum the same world with that RSS."""
    key = trial.key
    world = conditions.worlds[key.scenario, key.speed]
    if not trial.alternative.coherent:
        return world
    radio_map = conditions.scenarios[key.scenario].radio_map
    return dataclasses.replace(world, rss_dbm=radio_map.rss_coherent_dbm[tuple(world.cell.T)])


def _greedy(alternative: Alternative, key: Configuration, result: TrainingResult) -> Outcome:
    """Outcome from the greedy flights after training."""
    converged = result.converged_episode >= 0
    return Outcome(
        alternative,
        key,
        result.run_ids.size,
        result.converged_episode[converged].astype(np.float64),
        result.converged_steps[converged].astype(np.float64),
        result.path_length_m[result.reached],
        result.path_steps[result.reached].astype(np.float64),
        counted_lengths_m(result, SUPPORTED_COUNT),
        np.array([turns(result.world, flight) for flight in flights(result)]),
        shortest_path(result.world, terminal_states(result), "steps").steps,
    )


def _flown(outcome: Outcome, result: TrainingResult) -> Outcome:
    """Outcome from the flights of the episodes in which the runs converged."""
    runs = np.flatnonzero(result.converged_episode >= 0)
    last = result.converged_episode[runs] - 1
    return dataclasses.replace(
        outcome,
        alternative=FLOWN,
        length_m=result.episode_length_m[runs, last],
        path_steps=result.steps[runs, last].astype(np.float64),
        counted_m=None,
        turns=None,
    )
