"""Table: realisations that converge, and their time to convergence."""

from __future__ import annotations

from rssnav.experiments.paper.convergence_measures import MEASURES, converged
from rssnav.experiments.paper.data import Configuration, PaperData
from rssnav.experiments.paper.tables.configuration import (
    CONFIGURATION_COLUMNS,
    configuration_cells,
)
from rssnav.experiments.statistics import mean
from rssnav.experiments.tables import Cell, Column, Table
from rssnav.results import TrainingResult


def _columns() -> tuple[Column, ...]:
    times = [
        Column(
            f"{part}{measure.name}", f"{heading}{measure.heading}", measure.digits, shown=not part
        )
        for measure in MEASURES
        for part, heading in (("", "Mean "), ("low_", "2.5 % "), ("high_", "97.5 % "))
    ]
    return (
        *CONFIGURATION_COLUMNS,
        Column("runs", "Runs"),
        Column("converged", "Converged"),
        *times,
        Column("longest_run_episodes", "Longest run [episodes]", shown=False),
        Column("episodes", "Episodes flown"),
        Column("truncated", "Truncated episodes"),
        Column("truncated_share", "Truncated [%]", 2),
        Column("cpu_s", "CPU time, all runs [s]", 1, shown=False),
    )


def table(data: PaperData) -> Table:
    """Make a row per configuration."""
    limit = max(result.learning.max_steps for result in data.results.values())
    return Table(
        "convergence",
        "Convergence and truncated episodes",
        "A run has converged when it flies the same path in three consecutive episodes. Means over "
        "the runs that converged; their 95 % bootstrap intervals are in the figure above and in "
        "convergence.csv. An episode is "
        f"truncated after {limit:,} steps; it does not count as an arrival.",
        _columns(),
        tuple(_row(key, result) for key, result in data.results.items()),
    )


def _row(key: Configuration, result: TrainingResult) -> tuple[Cell, ...]:
    episodes, truncated = int(result.episodes_flown.sum()), int(result.truncated.sum())
    return (
        *configuration_cells(key),
        result.run_ids.size,
        int(converged(result).sum()),
        *_times(result),
        int(result.episodes_flown.max()),
        episodes,
        truncated,
        100.0 * truncated / episodes,
        float(result.cpu_s.sum()),
    )


def _times(result: TrainingResult) -> tuple[Cell, ...]:
    """Return mean and interval of each measure of time."""
    if not converged(result).any():
        return (None,) * (3 * len(MEASURES))
    estimates = [mean(measure.of(result)) for measure in MEASURES]
    return tuple(x for each in estimates for x in (each.value, each.low, each.high))
