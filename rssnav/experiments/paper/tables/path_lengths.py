"""Table: lengths and steps of the final flights, the paper's, and the shortest possible."""

from __future__ import annotations

import numpy as np

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
    return Table(
        "path_lengths",
        "Length of the final trajectories (the paper's Table IV)",
        "Greedy flights after training, over the realisations whose flight arrives; the others "
        "end in a cycle. Shortest and fewest possible: Dijkstra over the possible steps. Straight "
        "and diagonal steps cost the agents the same, so they minimise steps rather than metres.",
        (
            *CONFIGURATION_COLUMNS,
            Column("arrived", "Flights that arrive"),
            Column("mean_m", "Mean [m]", 2),
            Column("sd_m", "± sd [m]", 2),
            Column("median_m", "Median [m]", 2),
            Column("paper_m", "Paper [m]", 2),
            Column("ratio_to_paper", "Mean / paper", 3),
            Column("shortest_m", "Shortest possible [m]", 2),
            Column("mean_steps", "Mean [steps]", 1),
            Column("sd_steps", "± sd [steps]", 1),
            Column("fewest_steps", "Fewest possible [steps]"),
        ),
        tuple(_row(data, key, result) for key, result in data.results.items()),
    )


def _row(data: PaperData, key: Configuration, result: TrainingResult) -> tuple[Cell, ...]:
    place = (key.scenario, key.speed)
    steps = result.path_steps[result.reached]
    return (
        *configuration_cells(key),
        int(result.reached.sum()),
        *_lengths(result, PATH_LENGTH_M.get(key)),
        data.shortest_in_metres[place].length_m,
        mean_cell(steps),
        float(steps.std()) if steps.size else None,
        data.shortest_in_steps[place].steps,
    )


def _lengths(result: TrainingResult, paper_m: float | None) -> tuple[Cell, ...]:
    lengths_m = result.path_length_m[result.reached]
    if lengths_m.size == 0:
        return None, None, None, paper_m, None
    mean_m = float(lengths_m.mean())
    ratio = None if paper_m is None else mean_m / paper_m
    return mean_m, float(lengths_m.std()), float(np.median(lengths_m)), paper_m, ratio
