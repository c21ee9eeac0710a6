"""All figures and tables, in the paper's order. To add one, write a module and list it here."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from matplotlib.figure import Figure

from rssnav.experiments.paper.data import PaperData
from rssnav.experiments.paper.figures import (
    agent_loop,
    convergence_time,
    floor_plans,
    heat_maps,
    steps_per_episode,
    trajectories,
    visits,
)
from rssnav.experiments.paper.tables import convergence as convergence_table
from rssnav.experiments.paper.tables import path_lengths
from rssnav.experiments.tables import Table


@dataclass(frozen=True)
class PaperFigure:
    """A figure of the paper.

    Attributes
    ----------
    key : str
        Name for files.
    title : str
        What it is.
    of_paper : str
        Where the paper has it.
    draw : callable
        From the data to the figure.
    caption : callable
        From the data to what one sees.
    """

    key: str
    title: str
    of_paper: str
    draw: Callable[[PaperData], Figure]
    caption: Callable[[PaperData], str]


FIGURES: tuple[PaperFigure, ...] = (
    PaperFigure(
        "agent_loop",
        "Agent and environment",
        "the paper's Fig. 2",
        agent_loop.draw,
        agent_loop.caption,
    ),
    PaperFigure(
        "floor_plans", "Floor plans", "the paper's Fig. 3", floor_plans.draw, floor_plans.caption
    ),
    PaperFigure(
        "heat_maps",
        "Received signal strength",
        "the background of the paper's Fig. 4",
        heat_maps.draw,
        heat_maps.caption,
    ),
    PaperFigure(
        "trajectories",
        "Final trajectories at 1 m/s",
        "the paper's Fig. 4",
        trajectories.draw,
        trajectories.caption,
    ),
    PaperFigure("visits", "Visits of each cell", "the paper's Fig. 5", visits.draw, visits.caption),
    PaperFigure(
        "steps_per_episode",
        "Steps per episode",
        "the paper's Fig. 6",
        steps_per_episode.draw,
        steps_per_episode.caption,
    ),
    PaperFigure(
        "convergence_time",
        "Convergence time against speed",
        "the paper's Fig. 7",
        convergence_time.draw,
        convergence_time.caption,
    ),
)

TABLES: tuple[Callable[[PaperData], Table], ...] = (
    convergence_table.table,
    path_lengths.table,
    path_lengths.optimum_table,
)
