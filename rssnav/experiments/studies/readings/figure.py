"""Figure of the interpretations: how many of the twelve flights each of them allows."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from numpy.typing import NDArray

from rssnav.experiments.paper.counting import Count
from rssnav.experiments.studies.readings.interpretations import GOALS, OFFSETS_M, STARTS
from rssnav.experiments.studies.readings.outcome import Outcome
from rssnav.pictures.style import PAGE_IN, label_panel, new_figure, styled

SHOWN = (Count.ALL, Count.WITHOUT_LAST)
COLOURS = "viridis"
FEWEST, ALL = 4.5, 12.5
"""Ends of the colour scale: half a flight beyond whole numbers of flights."""


@styled
def draw(outcomes: Sequence[Outcome], shifted: Sequence[Outcome]) -> Figure:
    """Draw a column per count: goals and starts above, positions of the source below."""
    figure = new_figure(PAGE_IN, 5.4)
    panels = figure.subplots(2, len(SHOWN), height_ratios=(1, 2))
    colours = ScalarMappable(Normalize(FEWEST, ALL), COLOURS)
    as_stated = [o for o in outcomes if o.geometry.source_offset_m == (0.0, 0.0)]
    for column, count in enumerate(SHOWN):
        _draw_goals(panels[0, column], _values(as_stated, count, (len(STARTS), len(GOALS))))
        label_panel(panels[0, column], "ab"[column], str(count))
        size = (OFFSETS_M.size, OFFSETS_M.size)
        _draw_offsets(panels[1, column], _values(shifted, count, size).T)
        label_panel(panels[1, column], "cd"[column], str(count))
    panels[0, 0].set_yticks(range(len(STARTS)), list(STARTS.values()))
    panels[0, 1].set_yticks([])
    panels[1, 0].set_ylabel("source shifted in y [m]")
    figure.colorbar(
        colours, ax=panels, label="flights of 12 that exist", shrink=0.6, ticks=range(5, 13)
    )
    return figure


def _values(outcomes: Sequence[Outcome], count: Count, shape: tuple[int, int]) -> NDArray[np.int64]:
    """Numbers of flights that exist, in an array of this shape."""
    return np.array([outcome.n_possible(count) for outcome in outcomes]).reshape(shape)


def _draw_goals(ax: Axes, values: NDArray[np.int64]) -> None:
    """Draw the numbers for each start (rows) and goal (columns)."""
    ax.imshow(values, vmin=FEWEST, vmax=ALL, aspect="auto", cmap=COLOURS)
    for (row, column), value in np.ndenumerate(values):
        ax.text(column, row, str(value), ha="center", va="center", size=7, color=_ink(int(value)))
    ax.set_xticks(range(len(GOALS)), [str(goal) for goal in GOALS], rotation=90)


def _draw_offsets(ax: Axes, values: NDArray[np.int64]) -> None:
    """Draw the numbers for each position of the source: rows y, columns x."""
    half = (OFFSETS_M[1] - OFFSETS_M[0]) / 2
    ends = (OFFSETS_M[0] - half, OFFSETS_M[-1] + half)
    ax.set_xlabel("source shifted in x [m]")
    ax.imshow(values, vmin=FEWEST, vmax=ALL, origin="lower", extent=(*ends, *ends), cmap=COLOURS)


def _ink(value: int) -> str:
    """Colour of a number on its cell."""
    return "white" if value < 11 else "black"
