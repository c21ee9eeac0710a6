"""RSS readings that fluctuate: which states still work, and how often the source is found.

The RSS agent learns with tolerance and interval states of several widths, while its readings
fluctuate by several sigma, independent or correlated in time. Exact states without fluctuation are
the reference.
"""

from __future__ import annotations

from collections.abc import Sequence

from rssnav.experiments.studies.noise import figure
from rssnav.experiments.studies.noise.measuring import (
    LAST_EPISODES,
    SPEED,
    Outcome,
    measure,
    settings,
)
from rssnav.experiments.studies.study import Study
from rssnav.experiments.tables import Cell, Column, Table, sd_cell


def noise_table(outcomes: Sequence[Outcome]) -> Table:
    """Make a row per scenario, fluctuation and rule."""
    return Table(
        "noise",
        "RSS readings that fluctuate",
        f"RSS agent at {SPEED} m/s. Success: fraction of the last {LAST_EPISODES} episodes in "
        "which a reading exceeded −21 dBm before the step limit. Arrive: greedy flights without "
        "fluctuation.",
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
        setting.scenario,
        setting.rule,
        setting.width_db,
        setting.fluctuation.sigma_db,
        setting.fluctuation.correlation,
        outcome.converged.size,
        float(outcome.n_states.mean()),
        int(outcome.converged.sum()),
        float(outcome.success.mean()),
        float(outcome.steps.mean()),
        sd_cell(outcome.steps),
        int(outcome.arrived.sum()),
    )


STUDY = Study(
    name="noise",
    runs=10,
    quick_runs=1,
    pieces=settings(),
    measure=measure,
    tables=lambda outcomes: (noise_table(outcomes),),
    figures=lambda outcomes: {"noise": figure.draw(outcomes)},
)
