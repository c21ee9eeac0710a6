"""Floor plans in which the printed flights exist, and how long agents fly that are trained there.

Plans are drawn at random from a family per scenario. Those that allow the printed flights, and none
with fewer steps, are traced, and both agents are trained in them at all speeds.
"""

from __future__ import annotations

from rssnav.experiments.studies.plan_search import figure, tables
from rssnav.experiments.studies.plan_search.fits import BUILT_IN, Piece, measure
from rssnav.experiments.studies.study import Study

N_BLOCKS = 16
"""Blocks of plans that are drawn per scenario."""

STUDY = Study(
    name="plans",
    runs=8,
    quick_runs=2,
    pieces=tuple(
        Piece(scenario, block) for scenario in (1, 2) for block in (BUILT_IN, *range(N_BLOCKS))
    ),
    measure=measure,
    tables=lambda found: (tables.held_out(found, N_BLOCKS), tables.fits(found)),
    figures=lambda found: {"plans": figure.draw(found)},
    needs_maps=False,
)
