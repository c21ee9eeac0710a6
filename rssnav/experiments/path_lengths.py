"""Table: lengths and steps of the final flights, beside the paper's and the best possible."""

from __future__ import annotations

import numpy as np

from rssnav.experiments.data import AGENT_LABELS, Configuration, PaperData, flights
from rssnav.experiments.paper_values import PATH_LENGTH_M
from rssnav.experiments.tables import Cell, Column, Table
from rssnav.planning import discounted_return, greedy_path, value_iteration
from rssnav.results import TrainingResult

_TOLERANCE = 1e-6

_COLUMNS = (
    Column("scenario", "Scenario"),
    Column("agent", "Agent"),
    Column("speed_mps", "Speed [m/s]"),
    Column("arrived", "Flights that arrive"),
    Column("mean_m", "Length: mean [m]", 2),
    Column("sd_m", "± sd [m]", 2),
    Column("median_m", "median [m]", 2),
    Column("paper_m", "Paper [m]", 2),
    Column("ratio_to_paper", "Ours / paper", 3),
    Column("shortest_m", "Shortest possible [m]", 2),
    Column("mean_steps", "Steps: mean", 1),
    Column("sd_steps", "± sd", 1),
    Column("fewest_steps", "Fewest possible"),
    Column("optimal_m", "Value iteration [m]", 2),
    Column("optimal_steps", "Value iteration [steps]"),
    Column("return_share", "Return / optimal", 4),
)


def table(data: PaperData) -> Table:
    """Make a row per configuration."""
    return Table(
        "path_lengths",
        "Final flights (the paper's Table IV)",
        "Greedy flights after training, over the realisations whose flight arrives; one that runs "
        "in circles is left out and counted. Shortest possible, fewest possible: Dijkstra over the "
        "possible steps. Value iteration: the flight that is optimal for the agent's own rewards, "
        "and the learned flights' mean discounted return as a share of the optimum. Agents pay per "
        "step, straight or diagonal, so they learn few steps rather than few metres.",
        _COLUMNS,
        tuple(_row(data, key, result) for key, result in data.results.items()),
    )


def _row(data: PaperData, key: Configuration, result: TrainingResult) -> tuple[Cell, ...]:
    place = (key.scenario, key.speed)
    return (
        key.scenario,
        AGENT_LABELS[key.agent],
        key.speed,
        int(result.reached.sum()),
        *_lengths(result, PATH_LENGTH_M.get(key)),
        data.shortest_in_metres[place].length_m,
        *_steps(result),
        data.shortest_in_steps[place].steps,
        *_optimum(result),
    )


def _lengths(result: TrainingResult, paper_m: float | None) -> tuple[Cell, ...]:
    lengths_m = result.path_length_m[result.reached]
    if lengths_m.size == 0:
        return None, None, None, paper_m, None
    mean_m = float(lengths_m.mean())
    ratio = None if paper_m is None else mean_m / paper_m
    return mean_m, float(lengths_m.std()), float(np.median(lengths_m)), paper_m, ratio


def _steps(result: TrainingResult) -> tuple[Cell, ...]:
    steps = result.path_steps[result.reached]
    return (float(steps.mean()), float(steps.std())) if steps.size else (None, None)


def _optimum(result: TrainingResult) -> tuple[Cell, ...]:
    """Length and steps of the optimal flight, and the learned flights' share of its return."""
    process = result.agent.decision_process(result.world, result.learning)
    gamma = result.learning.gamma
    solution = value_iteration(process, gamma, tolerance=_TOLERANCE)
    best = greedy_path(result.world, process, solution.q)
    if not best.reached:
        return None, None, None
    returns = [discounted_return(process, flight, gamma) for flight in flights(result)]
    share = float(np.mean(returns)) / discounted_return(process, best.states, gamma)
    return best.length_m, best.steps, share if returns else None
