"""Trainings with RSS readings that fluctuate, and their outcomes."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from rssnav.agents import RssAgent
from rssnav.discrete_states import (
    ExactStates,
    Fluctuation,
    IntervalStates,
    StateRule,
    ToleranceStates,
)
from rssnav.experiments.studies.study import Conditions
from rssnav.results import TrainingResult
from rssnav.world import GridWorld

SCENARIOS = (1, 2)
SPEED = 2
SIGMAS_DB = (0.0, 0.5, 1.0, 2.0, 4.0)
CORRELATIONS = (0.0, 0.9)
THRESHOLDS_DB = (0.1, 0.25, 0.5, 1.0, 2.0, 4.0)
WIDTHS_DB = (0.5, 1.0, 2.0, 4.0)
EPISODES = 5000
STEP_LIMIT = 1_000_000
LAST_EPISODES = 100

RuleName = Literal["exact", "tolerance", "intervals"]


@dataclass(frozen=True)
class Setting:
    """A scenario, how RSS readings fluctuate in it, and how they become states.

    Attributes
    ----------
    scenario : int
        1 or 2.
    rule : {"exact", "tolerance", "intervals"}
        How a reading becomes a state.
    width_db : float
        Threshold Th of tolerance states, width of intervals, 0 for exact states [dB].
    fluctuation : Fluctuation
        How readings differ from the map.
    """

    scenario: int
    rule: RuleName
    width_db: float
    fluctuation: Fluctuation

    @property
    def name(self) -> str:
        """Name of its training."""
        fluctuation = self.fluctuation
        return (
            f"scenario{self.scenario} {self.rule} {self.width_db:g}dB "
            f"sigma {fluctuation.sigma_db:g}dB correlation {fluctuation.correlation:g}"
        )

    def states(self, world: GridWorld) -> StateRule:
        """State rule for a world: intervals cover the readings of its cells."""
        if self.rule == "exact":
            return ExactStates()
        if self.rule == "tolerance":
            return ToleranceStates(self.width_db)
        low_dbm, high_dbm = float(world.rss_dbm.min()), float(world.rss_dbm.max())
        return IntervalStates.uniform(low_dbm, high_dbm, self.width_db)


def settings() -> tuple[Setting, ...]:
    """List exact states without fluctuation, then all rules with every fluctuation."""
    rules: list[tuple[RuleName, float]] = [
        *(("tolerance", threshold_db) for threshold_db in THRESHOLDS_DB),
        *(("intervals", width_db) for width_db in WIDTHS_DB),
    ]
    fluctuations = [
        Fluctuation(sigma_db, correlation)
        for sigma_db, correlation in product(SIGMAS_DB, CORRELATIONS)
        if sigma_db > 0.0 or correlation == 0.0
    ]
    choices: list[tuple[RuleName, float, Fluctuation]] = [
        ("exact", 0.0, Fluctuation()),
        *(
            (rule, width_db, fluctuation)
            for fluctuation in fluctuations
            for rule, width_db in rules
        ),
    ]
    return tuple(Setting(scenario, *choice) for scenario in SCENARIOS for choice in choices)


@dataclass(frozen=True, eq=False)
class Outcome:
    """Outcome of a setting over R runs.

    Attributes
    ----------
    setting : Setting
    converged : (R,) bool
        Whether the run flew the same path three times in a row.
    arrived : (R,) bool
        Whether the greedy flight, without fluctuation, reaches the source.
    n_states : (R,) int64
        Discrete states of the agent at the end.
    success : (R,) float64
        Fraction of the last episodes that a reading above the goal's level ended.
    steps : (R,) float64
        Mean steps of the last episodes, truncated ones included.
    """

    setting: Setting
    converged: NDArray[np.bool_]
    arrived: NDArray[np.bool_]
    n_states: NDArray[np.int64]
    success: NDArray[np.float64]
    steps: NDArray[np.float64]


def measure(setting: Setting, conditions: Conditions) -> list[Outcome]:
    """Train the RSS agent for 5000 episodes or a million steps, whichever ends first.

    Raises
    ------
    TrainingInterrupted
        On Ctrl-C.
    """
    world = conditions.worlds[setting.scenario, SPEED]
    agent = RssAgent(setting.states(world), fluctuation=setting.fluctuation)
    result = conditions.train(setting.name, world, agent, EPISODES, max_total_steps=STEP_LIMIT)
    last = _last_episodes(result)
    outcome = Outcome(
        setting=setting,
        converged=result.converged_episode >= 0,
        arrived=result.reached,
        n_states=result.n_discrete_states,
        success=_mean_of(~result.truncated, last),
        steps=_mean_of(result.steps, last),
    )
    return [outcome]


def _last_episodes(result: TrainingResult) -> NDArray[np.bool_]:
    """Mark the last episodes of each run, shape (R, E)."""
    episode = np.arange(result.steps.shape[1])
    flown = result.episodes_flown[:, None]
    return (episode < flown) & (episode >= flown - LAST_EPISODES)


def _mean_of(values: NDArray[np.generic], where: NDArray[np.bool_]) -> NDArray[np.float64]:
    """Mean of each row's (R, E) marked values, shape (R,)."""
    return np.mean(values.astype(np.float64), axis=1, where=where)
