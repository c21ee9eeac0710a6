"""The figures of the paper, a module each. To add one, write a module and list it here."""

from rssnav.experiments.paper.figures import (
    agent_loop,
    convergence_time,
    floor_plans,
    heat_maps,
    steps_per_episode,
    trajectories,
    visits,
)
from rssnav.experiments.paper.figures.paper_figure import PaperFigure

FIGURES: tuple[PaperFigure, ...] = (
    agent_loop.FIGURE,
    floor_plans.FIGURE,
    heat_maps.FIGURE,
    trajectories.FIGURE,
    visits.FIGURE,
    steps_per_episode.FIGURE,
    convergence_time.FIGURE,
)
"""All figures, in the paper's order."""

__all__ = ["FIGURES", "PaperFigure"]
