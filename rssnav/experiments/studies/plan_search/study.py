"""Floor plans in which the printed flights exist, and how long agents fly that are trained there.

Plans are drawn at random from a family per scenario. Those that allow the printed flights, and none
with fewer steps, are traced. In those in which every cell has a path both agents are trained at all
speeds. A plan's score is the number of printed lengths and claims that it meets.
"""

from __future__ import annotations

from rssnav.experiments.studies.plan_search import figure, tables
from rssnav.experiments.studies.plan_search.fits import BUILT_IN, Piece, measure
from rssnav.experiments.studies.study import Study

N_BLOCKS = {1: 48, 2: 24}
"""Blocks of plans that are drawn, by scenario."""

STUDY = Study(
    name="plans",
    runs=8,
    quick_runs=2,
    pieces=tuple(
        Piece(scenario, block)
        for scenario, n_blocks in N_BLOCKS.items()
        for block in (BUILT_IN, *range(n_blocks))
    ),
    measure=measure,
    tables=lambda found: (
        tables.summary(found, N_BLOCKS),
        tables.held_out(found),
        tables.fits(found),
    ),
    figures=lambda found: {"plans": figure.draw(found)},
    texts=tables.best_plans,
    needs_maps=False,
)
