"""What a figure of the paper is."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from matplotlib.figure import Figure

from rssnav.experiments.paper.data import PaperData


@dataclass(frozen=True)
class PaperFigure:
    """A figure of the paper.

    Attributes
    ----------
    key : str
        Name of its files.
    title : str
        Title in the report.
    of_paper : str
        The figure of the paper that it reproduces.
    draw : callable
        From the data to the figure.
    caption : callable
        From the data to the text below the figure.
    """

    key: str
    title: str
    of_paper: str
    draw: Callable[[PaperData], Figure]
    caption: Callable[[PaperData], str]
