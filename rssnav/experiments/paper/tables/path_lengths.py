"""Table: lengths and steps of the final flights, the paper's, and the shortest possible."""

from __future__ import annotations

import numpy as np

from rssnav.experiments.paper.counting import COMPARED_COUNTS, Count, counted_lengths_m
from rssnav.experiments.paper.data import Configuration, PaperData
from rssnav.experiments.paper.printed_values import PATH_LENGTH_M
from rssnav.experiments.paper.tables.configuration import (
    CONFIGURATION_COLUMNS,
    configuration_cells,
)
from rssnav.experiments.tables import Cell, Column, Table, mean_cell
from rssnav.results import TrainingResult


def table(data: PaperData) -> Table:
    """Make a row per configuration."""
    other = _other(data.count)
    name = other.capitalize()
    return Table(
        "path_lengths",
        "Length of the final trajectories (the paper's Table IV)",
        "Greedy flights after training, over the realisations whose flight arrives; the others "
        f"end in a cycle. Their lengths have {_in_words(data.count)}; the mean is also given with "
        f"{_in_words(other)}. Shortest and fewest: Dijkstra over the possible steps. Straight "
        "and diagonal steps cost the agents the same, so they minimise steps rather than metres.",
        (
            *CONFIGURATION_COLUMNS,
            Column("arrived", "Arrive"),
            Column("mean_m", "Mean [m]", 2),
            Column("sd_m", "± sd", 2),
            Column("median_m", "Median [m]", 2, shown=False),
            Column("paper_m", "Paper [m]", 2),
            Column("ratio_to_paper", "Mean / paper", 3),
            Column("other_mean_m", f"{name} [m]", 2),
            Column("other_ratio_to_paper", f"{name} / paper", 3),
            Column("shortest_m", "Shortest [m]", 2),
            Column("mean_steps", "Steps", 1),
            Column("sd_steps", "± sd", 1),
            Column("fewest_steps", "Fewest"),
        ),
        tuple(_row(data, key, result) for key, result in data.results.items()),
    )


def _row(data: PaperData, key: Configuration, result: TrainingResult) -> tuple[Cell, ...]:
    place = (key.scenario, key.speed)
    steps = result.path_steps[result.reached]
    return (
        *configuration_cells(key),
        int(result.reached.sum()),
        *_lengths(data.count, result, PATH_LENGTH_M.get(key)),
        data.shortest_in_metres[place].length_m,
        mean_cell(steps),
        float(steps.std()) if steps.size else None,
        data.shortest_in_steps[place].steps,
    )


def _other(count: Count) -> Count:
    """Return the count that lengths are shown under beside the chosen one."""
    return next(each for each in COMPARED_COUNTS if each is not count)


def _in_words(count: Count) -> str:
    return "all steps counted" if count is Count.ALL else f"the {count}"


def _lengths(count: Count, result: TrainingResult, paper_m: float | None) -> tuple[Cell, ...]:
    lengths_m = counted_lengths_m(result, count)
    if lengths_m.size == 0:
        return None, None, None, paper_m, None, None, None
    mean_m = float(lengths_m.mean())
    other_m = float(counted_lengths_m(result, _other(count)).mean())
    spread = float(lengths_m.std()), float(np.median(lengths_m))
    return mean_m, *spread, paper_m, _ratio(mean_m, paper_m), other_m, _ratio(other_m, paper_m)


def _ratio(mean_m: float, paper_m: float | None) -> float | None:
    return None if paper_m is None else mean_m / paper_m
