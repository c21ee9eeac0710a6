"""The paper: data, trainings, figures, tables, claims, report, and the run that makes them."""

from rssnav.experiments.paper.run import Paper, report_again, run_paper

__all__ = ["Paper", "report_again", "run_paper"]
