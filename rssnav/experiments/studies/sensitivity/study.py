"""Sensitivity of the results to each choice that the paper does not specify.

Every alternative changes one parameter of our interpretation and trains all twelve configurations
with it. A run stops without convergence after 20 000 episodes or 25 million steps.
"""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.figure import Figure

from rssnav.experiments.studies.sensitivity import figure
from rssnav.experiments.studies.sensitivity.alternatives import (
    ALTERNATIVES,
    FLOWN,
    OURS,
    Outcome,
    measure,
    trials,
)
from rssnav.experiments.studies.sensitivity.claims import claims_table
from rssnav.experiments.studies.sensitivity.tables import outcome_table, summary_table
from rssnav.experiments.studies.study import Study
from rssnav.experiments.tables import Table

_ROWS = {choice: row for row, choice in enumerate((OURS, FLOWN, *ALTERNATIVES))}


def make_tables(outcomes: Sequence[Outcome]) -> tuple[Table, ...]:
    """Make the summary, the table of all outcomes and that of the paper's claims."""
    ordered = _in_order(outcomes)
    return summary_table(ordered), outcome_table(ordered), claims_table(ordered)


def draw_figures(outcomes: Sequence[Outcome]) -> dict[str, Figure]:
    """Draw the final flights' lengths under every alternative."""
    return {"sensitivity": figure.draw(_in_order(outcomes))}


def _in_order(outcomes: Sequence[Outcome]) -> list[Outcome]:
    """Sort outcomes by alternative: ours, ours as flown, the others."""
    return sorted(outcomes, key=lambda outcome: _ROWS[outcome.alternative])


STUDY = Study(
    name="sensitivity",
    runs=20,
    quick_runs=2,
    pieces=trials(),
    measure=measure,
    tables=make_tables,
    figures=draw_figures,
)
