"""Tables of the sensitivity study: all outcomes, and a row per alternative."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from rssnav.experiments.paper.counting import SUPPORTED_COUNT
from rssnav.experiments.paper.data import Configuration
from rssnav.experiments.paper.printed_values import PATH_LENGTH_M
from rssnav.experiments.paper.tables.configuration import (
    CONFIGURATION_COLUMNS,
    configuration_cells,
)
from rssnav.experiments.statistics import difference
from rssnav.experiments.studies.sensitivity.alternatives import OURS, Alternative, Outcome
from rssnav.experiments.tables import Cell, Column, Table, mean_cell, sd_cell

TOLERANCE = 0.10
"""Deviation from the paper's length that counts as agreement."""


def outcome_table(outcomes: Sequence[Outcome]) -> Table:
    """Make a row per alternative and configuration."""
    ours = {outcome.key: outcome for outcome in outcomes if outcome.alternative == OURS}
    return Table(
        "sensitivity",
        "Choices that the paper does not specify, one by one",
        "Each row changes one parameter of our interpretation. Episodes and flown steps to "
        "convergence: means over the runs that converge. Lengths: means over the final flights "
        "that arrive; their difference from our interpretation with its 95 % bootstrap interval.",
        (
            Column("parameter", "Parameter"),
            Column("choice", "Choice"),
            *CONFIGURATION_COLUMNS,
            Column("runs", "Runs"),
            Column("converged", "Converge"),
            Column("episodes", "Episodes"),
            Column("flown_steps", "Flown steps"),
            Column("arrive", "Arrive"),
            Column("mean_steps", "Final flight [steps]", 1),
            Column("mean_m", "Length [m]", 2),
            Column("sd_m", "± sd [m]", 2),
            Column("difference_m", "Difference [m]", 2),
            Column("difference_low_m", "from [m]", 2),
            Column("difference_high_m", "to [m]", 2),
            Column("paper_m", "Paper [m]", 2),
            Column("obstacle", "Obstacle"),
        ),
        tuple(_row(outcome, ours[outcome.key]) for outcome in outcomes),
    )


def summary_table(outcomes: Sequence[Outcome]) -> Table:
    """Make a row per alternative, over all configurations it concerns."""
    ours = {outcome.key: outcome for outcome in outcomes if outcome.alternative == OURS}
    alternatives = dict.fromkeys(outcome.alternative for outcome in outcomes)
    return Table(
        "sensitivity_summary",
        "Choices that the paper does not specify, in short",
        "Converge and arrive: runs of all configurations. Ratios to our interpretation: means over "
        "the configurations in which every run converges, or for lengths in which every final "
        "flight arrives, and the extremes. Agree: configurations in which every final flight "
        f"arrives and the mean length is within {TOLERANCE:.0%} of the paper's, with the "
        f"{SUPPORTED_COUNT} or all steps counted.",
        (
            Column("parameter", "Parameter"),
            Column("choice", "Choice"),
            Column("runs", "Runs"),
            Column("converged", "Converge"),
            Column("arrive", "Arrive"),
            Column("episode_ratio", "Episodes / ours", 2),
            Column("step_ratio", "Flown steps / ours", 2),
            Column("length_ratio", "Length / ours", 3),
            Column("least_length_ratio", "least", 3),
            Column("greatest_length_ratio", "greatest", 3),
            Column("agree", "Agree"),
            Column("agree_all_steps", "Agree, all steps"),
            Column("configurations", "of"),
        ),
        tuple(
            _summary(choice, [o for o in outcomes if o.alternative == choice], ours)
            for choice in alternatives
        ),
    )


def _row(outcome: Outcome, ours: Outcome) -> tuple[Cell, ...]:
    key, length_m = outcome.key, outcome.length_m
    compared: tuple[Cell, ...] = (None, None, None)
    if length_m.size and ours.length_m.size:
        estimate = difference(length_m, ours.length_m)
        compared = (estimate.value, estimate.low, estimate.high)
    return (
        outcome.alternative.parameter,
        outcome.alternative.choice,
        *configuration_cells(key),
        outcome.runs,
        outcome.episodes.size,
        mean_cell(outcome.episodes),
        mean_cell(outcome.steps),
        length_m.size,
        mean_cell(outcome.path_steps),
        mean_cell(length_m),
        sd_cell(length_m),
        *compared,
        PATH_LENGTH_M[key],
        outcome.obstacle,
    )


def _summary(
    choice: Alternative, outcomes: list[Outcome], ours: dict[Configuration, Outcome]
) -> tuple[Cell, ...]:
    whole = [outcome for outcome in outcomes if outcome.episodes.size == outcome.runs]
    arriving = [outcome for outcome in outcomes if outcome.length_m.size == outcome.runs]
    lengths = [_ratio(outcome.length_m, ours[outcome.key].length_m) for outcome in arriving]
    return (
        choice.parameter,
        choice.choice,
        sum(outcome.runs for outcome in outcomes),
        sum(outcome.episodes.size for outcome in outcomes),
        sum(outcome.length_m.size for outcome in outcomes),
        mean_cell([_ratio(outcome.episodes, ours[outcome.key].episodes) for outcome in whole]),
        mean_cell([_ratio(outcome.steps, ours[outcome.key].steps) for outcome in whole]),
        mean_cell(lengths),
        min(lengths, default=None),
        max(lengths, default=None),
        _agreeing([(outcome.key, outcome.counted_m) for outcome in arriving]),
        _agreeing([(outcome.key, outcome.length_m) for outcome in arriving]),
        len(outcomes),
    )


def _agreeing(lengths: Sequence[tuple[Configuration, NDArray[np.float64] | None]]) -> int | None:
    """Count mean lengths [m] within :data:`TOLERANCE` of the paper's; None where one is unknown."""
    known = [(PATH_LENGTH_M[key], length_m) for key, length_m in lengths if length_m is not None]
    if len(known) < len(lengths):
        return None
    return sum(abs(float(m.mean()) - paper_m) <= TOLERANCE * paper_m for paper_m, m in known)


def _ratio(values: NDArray[np.float64], of: NDArray[np.float64]) -> float:
    """Ratio of the means; 0 where there is nothing to compare."""
    return float(values.mean() / of.mean()) if values.size and of.size else 0.0
