"""Figure: steps per episode of both agents at all speeds, Scenario 1."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from rssnav.experiments.paper.data import (
    AGENT_LABELS,
    AGENTS,
    SHOWN_EPISODES,
    AgentName,
    PaperData,
)
from rssnav.experiments.paper.figures.paper_figure import PaperFigure
from rssnav.pictures.style import AGENT_COLOURS, PAGE_IN, label_panel, new_figure, shade, styled

SCENARIO = 1
BAND = (0.1, 0.9)
_SHADES = (-0.45, 0.0, 0.5)


@styled
def draw(data: PaperData) -> Figure:
    """Draw a panel per agent, a curve per speed."""
    figure = new_figure(PAGE_IN, 2.6)
    panels = figure.subplots(1, 2, sharex=True, sharey=True)
    for k, agent in enumerate(AGENTS):
        _draw_agent(panels[k], data, agent)
        label_panel(panels[k], "ab"[k], f"{AGENT_LABELS[agent]}, Scenario {SCENARIO}")
        panels[k].legend(ncols=len(data.speeds), loc="upper right")
    panels[0].set_ylabel("steps per episode")
    _, most = panels[0].get_ylim()
    panels[0].set_ylim(top=2.0 * most)
    return figure


def _draw_agent(ax: Axes, data: PaperData, agent: AgentName) -> None:
    for tone, speed in zip(_SHADES, data.speeds, strict=False):
        steps = shown_steps(data, agent, speed)
        episode = np.arange(1, steps.shape[1] + 1)
        colour = shade(AGENT_COLOURS[agent], tone)
        low, high = np.quantile(steps, BAND, axis=0)
        ax.fill_between(episode, low, high, color=colour, alpha=0.18, linewidth=0)
        ax.plot(episode, steps.mean(axis=0), color=colour, label=f"{speed} m/s", lw=0.8)
    ax.set_yscale("log")
    ax.set_xlim(0, SHOWN_EPISODES)
    ax.set_xlabel("episode")
    ax.grid(True, which="major")


def shown_steps(data: PaperData, agent: AgentName, speed: int) -> NDArray[np.int32]:
    """Steps (R, E) of the episodes that the figure shows."""
    return data.result(SCENARIO, agent, speed).steps[:, :SHOWN_EPISODES]


def caption(data: PaperData) -> str:
    """Return the caption."""
    low, high = (f"{100 * share:g}" for share in BAND)
    return (
        f"Steps of each episode in Scenario {SCENARIO}: mean over {data.n_runs} realisations, not "
        f"smoothed, and the band from the {low} % to the {high} % quantile. The paper shows only "
        "the means."
    )


FIGURE = PaperFigure("steps_per_episode", "Steps per episode", "the paper's Fig. 6", draw, caption)
