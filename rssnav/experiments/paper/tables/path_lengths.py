"""Table: lengths and steps of the final flights, beside the paper's and the best possible."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from rssnav.experiments.paper.data import AGENT_LABELS, Configuration, PaperData, flights
from rssnav.experiments.paper.printed_values import PATH_LENGTH_M
from rssnav.experiments.tables import Cell, Column, Table
from rssnav.planning import discounted_return, greedy_path, value_iteration
from rssnav.results import TrainingResult

_TOLERANCE = 1e-6

_PLACE = (
    Column("scenario", "Scenario"),
    Column("agent", "Agent"),
    Column("speed_mps", "Speed [m/s]"),
)


def table(data: PaperData) -> Table:
    """Make a row per configuration: metres and steps, beside the paper's and the least possible."""
    return Table(
        "path_lengths",
        "Length of the final trajectories (the paper's Table IV)",
        "Greedy flights after training, over the realisations whose flight arrives; one that runs "
        "in circles is left out and counted. Shortest and fewest possible: Dijkstra over the "
        "possible steps. Agents pay per step, straight or diagonal alike, so they learn few steps "
        "rather than few metres.",
        (
            *_PLACE,
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
        tuple(_flown(data, key, result) for key, result in data.results.items()),
    )


def optimum_table(data: PaperData) -> Table:
    """Make a row per configuration: learned flights beside the optimum of the agent's rewards."""
    return Table(
        "optimum",
        "Learned flights against the optimum",
        "Value iteration solves the decision process that each agent learns in; its greedy flight "
        "is what Q-learning would converge to. The return is the discounted sum of rewards from "
        "the start, mean over the flights that arrive.",
        (
            *_PLACE,
            Column("mean_m", "Learned [m]", 2),
            Column("optimal_m", "Optimal [m]", 2),
            Column("mean_steps", "Learned [steps]", 1),
            Column("optimal_steps", "Optimal [steps]"),
            Column("mean_return", "Learned return", 2),
            Column("optimal_return", "Optimal return", 2),
            Column("return_share", "Share of the optimum", 4),
        ),
        tuple(_optimum(key, result) for key, result in data.results.items()),
    )


def _flown(data: PaperData, key: Configuration, result: TrainingResult) -> tuple[Cell, ...]:
    place = (key.scenario, key.speed)
    steps = result.path_steps[result.reached]
    return (
        *_place(key),
        int(result.reached.sum()),
        *_lengths(result, PATH_LENGTH_M.get(key)),
        data.shortest_in_metres[place].length_m,
        _mean(steps),
        float(steps.std()) if steps.size else None,
        data.shortest_in_steps[place].steps,
    )


def _place(key: Configuration) -> tuple[Cell, ...]:
    return key.scenario, AGENT_LABELS[key.agent], key.speed


def _lengths(result: TrainingResult, paper_m: float | None) -> tuple[Cell, ...]:
    lengths_m = result.path_length_m[result.reached]
    if lengths_m.size == 0:
        return None, None, None, paper_m, None
    mean_m = float(lengths_m.mean())
    ratio = None if paper_m is None else mean_m / paper_m
    return mean_m, float(lengths_m.std()), float(np.median(lengths_m)), paper_m, ratio


def _optimum(key: Configuration, result: TrainingResult) -> tuple[Cell, ...]:
    process = result.agent.decision_process(result.world, result.learning)
    gamma = result.learning.gamma
    solution = value_iteration(process, gamma, tolerance=_TOLERANCE)
    best = greedy_path(result.world, process, solution.q)
    learned = _mean([discounted_return(process, flight, gamma) for flight in flights(result)])
    optimal = discounted_return(process, best.states, gamma) if best.reached else None
    return (
        *_place(key),
        _mean(result.path_length_m[result.reached]),
        best.length_m if best.reached else None,
        _mean(result.path_steps[result.reached]),
        best.steps if best.reached else None,
        learned,
        optimal,
        learned / optimal if learned is not None and optimal else None,
    )


def _mean(values: Sequence[float] | NDArray[np.float64] | NDArray[np.int64]) -> float | None:
    return float(np.mean(values)) if len(values) else None
