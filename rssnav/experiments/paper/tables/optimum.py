"""Table: learned flights and the optimum of the agent's rewards."""

from __future__ import annotations

from rssnav.experiments.paper.data import Configuration, PaperData, flights
from rssnav.experiments.paper.tables.configuration import (
    CONFIGURATION_COLUMNS,
    configuration_cells,
)
from rssnav.experiments.tables import Cell, Column, Table, mean_cell
from rssnav.optimal_flights import discounted_return, greedy_path, value_iteration
from rssnav.results import TrainingResult

_TOLERANCE = 1e-6


def table(data: PaperData) -> Table:
    """Make a row per configuration."""
    return Table(
        "optimum",
        "Learned flights against the optimum",
        "Value iteration solves each agent's decision process; Q-learning would converge to its "
        "greedy flight. The return is the discounted sum of rewards from "
        "the start, mean over the flights that arrive.",
        (
            *CONFIGURATION_COLUMNS,
            Column("mean_m", "Learned [m]", 2),
            Column("optimal_m", "Optimal [m]", 2),
            Column("mean_steps", "Learned [steps]", 1),
            Column("optimal_steps", "Optimal [steps]"),
            Column("mean_return", "Learned return", 2),
            Column("optimal_return", "Optimal return", 2),
            Column("return_share", "Fraction of the optimum", 4),
        ),
        tuple(_row(key, result) for key, result in data.results.items()),
    )


def _row(key: Configuration, result: TrainingResult) -> tuple[Cell, ...]:
    process = result.agent.decision_process(result.world, result.learning)
    gamma = result.learning.gamma
    solution = value_iteration(process, gamma, tolerance=_TOLERANCE)
    best = greedy_path(result.world, process, solution.q)
    learned = mean_cell([discounted_return(process, flight, gamma) for flight in flights(result)])
    optimal = discounted_return(process, best.states, gamma) if best.reached else None
    return (
        *configuration_cells(key),
        mean_cell(result.path_length_m[result.reached]),
        best.length_m if best.reached else None,
        mean_cell(result.path_steps[result.reached]),
        best.steps if best.reached else None,
        learned,
        optimal,
        learned / optimal if learned is not None and optimal else None,
    )
