"""Tables of the search for plans: all plans that remained, and what the best of them predict."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rssnav.experiments.paper.data import CONFIGURATIONS, Configuration
from rssnav.experiments.studies.plan_search.fits import BLOCK, BUILT_IN, Fit
from rssnav.experiments.tables import Cell, Column, Table

AS_GOOD = 0.01
"""A plan fits as well as the best one if its largest deviation is larger by no more than this."""


def fits(found: Sequence[Fit]) -> Table:
    """Make a row per plan, the built-in one first, then by the largest deviation."""
    ordered = sorted(found, key=lambda f: (f.piece.scenario, f.piece.block != BUILT_IN, f.worst()))
    shown = [key for key in CONFIGURATIONS if key.scenario == 1]
    return Table(
        "plans",
        "Floor plans that allow the printed flights",
        "Mean length of the learned flights over the paper's, less 1, with the last step left out. "
        "Claims: at how many speeds the RSS-based agent flies farther, and with more turns.",
        (
            Column("scenario", "Scenario"),
            Column("block", "Block"),
            Column("number", "Number"),
            Column("worst_percent", "Largest deviation [%]", 1),
            *(
                Column(f"{key.agent}_{key.speed}_percent", f"{key.agent}, {key.speed} m/s [%]", 1)
                for key in shown
            ),
            Column("claims", "Claims of 6"),
        ),
        tuple(_row(fit) for fit in ordered),
    )


def _row(fit: Fit) -> tuple[Cell, ...]:
    return (
        fit.piece.scenario,
        fit.piece.label,
        fit.number,
        _percent(fit.worst()),
        *(_percent(value) for value in fit.deviation.values()),
        fit.claims(),
    )


def held_out(found: Sequence[Fit], n_blocks: int) -> Table:
    """Make a row per scenario: the plan that fits some lengths best, and what it predicts."""
    return Table(
        "plans_held_out",
        "What the lengths determine",
        "The drawn plan whose lengths at all speeds, or at 1 and 2 m/s, are nearest to the "
        "paper's, and what it predicts: the lengths at 4 m/s, and the claims. As good: drawn plans "
        f"whose largest deviation is within {100 * AS_GOOD:g} percentage points of the best one's.",
        (
            Column("scenario", "Scenario"),
            Column("drawn", "Drawn"),
            Column("allowed", "Allow the flights"),
            Column("best_percent", "Best: largest deviation [%]", 1),
            Column("as_good", "As good"),
            Column("claims", "Its claims of 6"),
            Column("slow_percent", "Best at 1 and 2 m/s [%]", 1),
            Column("predicted_percent", "its deviation at 4 m/s [%]", 1),
            Column("median_percent", "median of all at 4 m/s [%]", 1),
        ),
        tuple(_prediction(scenario, found, n_blocks) for scenario in (1, 2)),
    )


def _prediction(scenario: int, found: Sequence[Fit], n_blocks: int) -> tuple[Cell, ...]:
    drawn = [f for f in found if f.piece.scenario == scenario and f.piece.block != BUILT_IN]
    counts = (scenario, n_blocks * BLOCK, len(drawn))
    if not drawn:
        return (*counts, None, 0, None, None, None, None)
    best = min(drawn, key=Fit.worst)
    as_good = sum(fit.worst() <= best.worst() + AS_GOOD for fit in drawn)
    slow = min(drawn, key=lambda fit: fit.worst(_is_slow))
    fast = [fit.worst(lambda key: not _is_slow(key)) for fit in drawn]
    return (
        *counts,
        _percent(best.worst()),
        as_good,
        best.claims(),
        _percent(slow.worst(_is_slow)),
        _percent(slow.worst(lambda key: not _is_slow(key))),
        _percent(float(np.median(fast))),
    )


def _is_slow(key: Configuration) -> bool:
    return key.speed < 4


def _percent(value: float) -> float | None:
    return 100.0 * value if np.isfinite(value) else None
