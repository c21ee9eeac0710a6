"""Readings that fluctuate: which states survive, and how often the source is found.

The RSS agent learns with tolerance and interval states of several widths, while its readings
fluctuate by several sigma, independent or correlated in time. Without fluctuation exact states
stand beside them.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from rssnav.experiments.studies.common import (
    Progress,
    Study,
    load_worlds,
    no_progress,
    write_study,
)
from rssnav.experiments.studies.noise import figure
from rssnav.experiments.studies.noise.measuring import LAST_EPISODES, Outcome, measure, settings
from rssnav.experiments.tables import Cell, Column, Table

RUNS = 10
QUICK_RUNS = 1
SCENARIOS = (1, 2)
SPEED = 2


def run(
    out: str | Path = "results",
    *,
    quick: bool = False,
    seed: int = 0,
    threads: int | None = None,
    progress: Progress | None = None,
) -> Study:
    """Train with every fluctuation and rule; write a table and a figure below ``out``.

    Parameters
    ----------
    out : str or Path
        Folder of the maps, which are traced when missing, and of ``tables/`` and ``figures/``.
    quick : bool
        One realisation in place of ten.
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
    worlds = load_worlds(out, threads, tell)
    runs = QUICK_RUNS if quick else RUNS
    work = [(scenario, setting) for scenario in SCENARIOS for setting in settings()]
    outcomes: list[Outcome] = []
    for done, (scenario, setting) in enumerate(work):
        tell("fluctuations", done, len(work))
        world = worlds[scenario, SPEED]
        outcomes.append(measure(scenario, world, setting, runs=runs, seed=seed, threads=threads))
    tell("fluctuations", len(work), len(work))
    return write_study(out, (noise_table(outcomes),), {"noise": figure.draw(outcomes)})


def noise_table(outcomes: Sequence[Outcome]) -> Table:
    """Make a row per scenario, fluctuation and rule."""
    return Table(
        "noise",
        "Readings that fluctuate",
        f"RSS agent at {SPEED} m/s. Success: share of the last {LAST_EPISODES} episodes in which a "
        "reading exceeded −21 dBm before the cap. Arrive: greedy flights with steady readings.",
        (
            Column("scenario", "Scenario"),
            Column("rule", "States"),
            Column("width_db", "Th or width [dB]", 2),
            Column("sigma_db", "σ [dB]", 1),
            Column("correlation", "Correlation", 1),
            Column("runs", "Runs"),
            Column("n_states", "Number of states", 1),
            Column("converged", "Converge"),
            Column("success", "Success", 3),
            Column("steps", "Steps", 1),
            Column("steps_sd", "± sd", 1),
            Column("arrive", "Arrive"),
        ),
        tuple(_row(outcome) for outcome in outcomes),
    )


def _row(outcome: Outcome) -> tuple[Cell, ...]:
    setting = outcome.setting
    return (
        outcome.scenario,
        setting.rule,
        setting.width_db,
        setting.fluctuation.sigma_db,
        setting.fluctuation.correlation,
        outcome.converged.size,
        float(outcome.n_states.mean()),
        int(outcome.converged.sum()),
        float(outcome.success.mean()),
        float(outcome.steps.mean()),
        float(outcome.steps.std(ddof=1)) if outcome.steps.size > 1 else None,
        int(outcome.arrived.sum()),
    )
