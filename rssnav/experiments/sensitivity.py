"""What each choice that the paper leaves open does to the result.

Every alternative changes one parameter of our reading and trains all twelve configurations with
it. A run that has neither converged after :data:`~rssnav.experiments.paper_values.EPISODE_LIMIT`
episodes nor after :data:`STEP_LIMIT` steps counts as one that does not converge.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from rssnav.agents import QLearning
from rssnav.experiments import sensitivity_figure, trainings
from rssnav.experiments.data import AGENT_LABELS, AGENTS, SHOWN_EPISODES, SPEEDS, Configuration
from rssnav.experiments.paper_values import EPISODE_LIMIT
from rssnav.experiments.statistics import difference
from rssnav.experiments.studies import (
    Progress,
    Study,
    Worlds,
    load_scenarios,
    no_progress,
    write_study,
)
from rssnav.experiments.tables import Cell, Column, Table
from rssnav.results import TrainingResult
from rssnav.training import train
from rssnav.world import GridWorld, WorldError

STEP_LIMIT = 40_000_000
"""Steps after which a run is given up; our reading needs up to 10 million to converge."""

RUNS = 20
QUICK_RUNS = 2


@dataclass(frozen=True)
class Alternative:
    """Another choice of one parameter.

    Attributes
    ----------
    parameter, choice : str
        What is chosen, and how.
    learning : QLearning
        Parameters with this choice.
    coherent : bool
        Whether the map sums the paths' fields instead of their powers.
    episodes : int or None
        Train as many episodes and no more, not until convergence.
    """

    parameter: str
    choice: str
    learning: QLearning = QLearning()
    coherent: bool = False
    episodes: int | None = None

    @property
    def label(self) -> str:
        """Name for people."""
        return f"{self.parameter}: {self.choice}"


OURS = Alternative("our reading", "all defaults")
FLOWN = Alternative("final trajectory", "the one flown three times")
"""Not a training of its own: the default's, with the flights that converged in place of greedy."""

ALTERNATIVES: tuple[Alternative, ...] = (
    *(Alternative("initial Q", f"{q:g}", QLearning(initial_q=q)) for q in (0.0, 20.0, 50.0)),
    *(Alternative("initial Q", f"{q:g}", QLearning(initial_q=q)) for q in (200.0, 500.0)),
    Alternative("maximum over", "all actions", QLearning(maximum_over="all")),
    Alternative("episode cap", "2 000 steps", QLearning(max_steps=2_000)),
    Alternative("episode cap", "200 000 steps", QLearning(max_steps=200_000)),
    Alternative("map", "coherent sum", coherent=True),
    Alternative("decay", "per episode, eta = 1e-5", QLearning(decay="episode")),
    Alternative("decay", "per episode, eta = 1e-3", QLearning(decay="episode", eta=1e-3)),
    Alternative("tie-break", "random", QLearning(tie_break="random")),
    Alternative("goal reward", "instead", QLearning(goal_reward_is="instead")),
    Alternative("training", f"{SHOWN_EPISODES} episodes", episodes=SHOWN_EPISODES),
)


@dataclass(frozen=True, eq=False)
class Outcome:
    """What came of an alternative in one configuration.

    Attributes
    ----------
    alternative : Alternative
    key : Configuration
    converged, arrived : (R,) bool
        Which runs converged, and whose final flight reaches the source.
    episodes, steps : (R,) float64
        Flown at convergence, of the runs that converged.
    length_m : (R,) float64
        Lengths of the final flights that arrive [m].
    obstacle : str
        Why nothing could be trained; empty where it could.
    """

    alternative: Alternative
    key: Configuration
    converged: NDArray[np.bool_]
    arrived: NDArray[np.bool_]
    episodes: NDArray[np.float64]
    steps: NDArray[np.float64]
    length_m: NDArray[np.float64]
    obstacle: str = ""


def run(
    out: str | Path = "results",
    *,
    quick: bool = False,
    seed: int = 0,
    threads: int | None = None,
    progress: Progress | None = None,
) -> Study:
    """Train every alternative, and write tables (CSV, Markdown) and a figure below ``out``.

    Parameters
    ----------
    out : str or Path
        Folder of the maps, which are traced when missing, and of ``tables/`` and ``figures/``.
    quick : bool
        Two realisations in place of twenty.
    seed : int
        Same seed, same results, for any number of threads.
    threads : int, optional
        Threads; all cores by default.
    progress : callable, optional
        Called as ``progress(stage, done, total)``.

    Raises
    ------
    TrainingInterrupted
        On Ctrl-C.
    """
    out, tell = Path(out), progress or no_progress
    scenarios = load_scenarios(out, threads, tell)
    power = trainings.worlds(scenarios, SPEEDS)
    keys = trainings.configurations(scenarios, SPEEDS)
    coherent = {
        place: _coherent(power[place], scenarios[place[0]].radio_map.rss_coherent_dbm)
        for place in power
    }
    outcomes: list[Outcome] = []
    work = list(_work(keys))
    runs = QUICK_RUNS if quick else RUNS
    for done, (alternative, key) in enumerate(work):
        tell("alternatives", done, len(work))
        worlds = coherent if alternative.coherent else power
        outcomes += study(alternative, key, worlds[key.scenario, key.speed], runs, seed, threads)
    tell("alternatives", len(work), len(work))
    tables = (table(outcomes), summary_table(outcomes))
    return write_study(out, tables, {"sensitivity": sensitivity_figure.draw(outcomes)})
