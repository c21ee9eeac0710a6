"""The paper's experiments: a module for each figure and table, and the run that makes them all."""

from rssnav.experiments.paper import Paper, report_again, run_paper

__all__ = ["Paper", "report_again", "run_paper"]
