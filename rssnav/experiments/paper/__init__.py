"""The paper: trainings, figures, tables, claims and the report; :func:`run_paper` makes them."""

from rssnav.experiments.paper.run import Paper, report_again, run_paper

__all__ = ["Paper", "report_again", "run_paper"]
