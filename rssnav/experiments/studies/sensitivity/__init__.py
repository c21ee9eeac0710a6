"""What each choice that the paper leaves open does to the result.

Every alternative changes one parameter of our reading and trains all twelve configurations with
it. A run that converges neither within 20 000 episodes nor within 25 million steps is given up.
"""

from __future__ import annotations

import dataclasses
from pathlib import Path

from rssnav.experiments.paper import trainings
from rssnav.experiments.paper.data import SPEEDS, Scenario
from rssnav.experiments.studies.common import (
    Progress,
    Study,
    Worlds,
    load_scenarios,
    no_progress,
    write_study,
)
from rssnav.experiments.studies.sensitivity import figure
from rssnav.experiments.studies.sensitivity.alternatives import (
    ALTERNATIVES,
    FLOWN,
    OURS,
    Outcome,
    outcomes_of,
)
from rssnav.experiments.studies.sensitivity.tables import outcome_table, summary_table

RUNS = 20
QUICK_RUNS = 2


def run(
    out: str | Path = "results",
    *,
    quick: bool = False,
    seed: int = 0,
    threads: int | None = None,
    progress: Progress | None = None,
) -> Study:
    """Train every alternative; write tables (CSV, Markdown) and a figure below ``out``.

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
    coherent = _coherent_worlds(scenarios, power)
    keys = trainings.configurations(scenarios, SPEEDS)
    work = [(choice, key) for choice in (OURS, *ALTERNATIVES) for key in keys]
    work = [(choice, key) for choice, key in work if choice.concerns(key)]
    outcomes: list[Outcome] = []
    for done, (choice, key) in enumerate(work):
        tell("alternatives", done, len(work))
        world = (coherent if choice.coherent else power)[key.scenario, key.speed]
        runs = QUICK_RUNS if quick else RUNS
        outcomes += outcomes_of(choice, key, world, runs=runs, seed=seed, threads=threads)
    tell("alternatives", len(work), len(work))
    outcomes.sort(key=lambda outcome: _ORDER.index(outcome.alternative))
    tables = (summary_table(outcomes), outcome_table(outcomes))
    return write_study(out, tables, {"sensitivity": figure.draw(outcomes)})


_ORDER = (OURS, FLOWN, *ALTERNATIVES)


def _coherent_worlds(scenarios: dict[int, Scenario], power: Worlds) -> Worlds:
    """The same worlds with the coherent sum for a map."""
    return {
        (number, speed): dataclasses.replace(
            world, rss_dbm=scenarios[number].radio_map.rss_coherent_dbm[tuple(world.cell.T)]
        )
        for (number, speed), world in power.items()
    }
