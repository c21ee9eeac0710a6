"""Figure: final flights of both agents over the RSS maps, at 1 m/s."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from rssnav.experiments.paper.data import AGENT_LABELS, AgentName, PaperData
from rssnav.experiments.paper.figures.heat_maps import colour_scale, draw_map
from rssnav.experiments.paper.figures.paper_figure import PaperFigure
from rssnav.pictures.style import (
    INK,
    PAGE_IN,
    draw_colour_bar,
    draw_flight,
    label_panel,
    new_figure,
    styled,
)
from rssnav.results import median_run
from rssnav.world import GOAL_DISTANCE_M

SPEED = 1
_PALE = 0.75
_ORDER: tuple[AgentName, ...] = ("rss", "location")


@styled
def draw(data: PaperData) -> Figure:
    """Draw a column of panels per agent, a row per scenario."""
    plans = [scenario.plan for scenario in data.scenarios.values()]
    shapes = [(p.bounds[3] - p.bounds[1]) / (p.bounds[2] - p.bounds[0]) for p in plans]
    figure = new_figure(PAGE_IN, 1.35 + 0.5 * (PAGE_IN - 1.3) * sum(shapes), maps=True)
    panels = figure.subplots(len(plans), len(_ORDER), height_ratios=shapes, squeeze=False)
    norm = colour_scale(data)
    for column, agent in enumerate(_ORDER):
        for row, number in enumerate(data.scenarios):
            ax: Axes = panels[row, column]
            draw_map(ax, data.scenarios[number], norm).set_alpha(_PALE)
            _draw_median_flight(ax, data, number, agent)
            letter = "abcd"[column * len(plans) + row]
            label_panel(ax, letter, f"{AGENT_LABELS[agent]}, Scenario {number}")
            if column:
                ax.tick_params(labelleft=False)
                ax.set_ylabel("")
    _legend(figure, panels.T.ravel().tolist())
    draw_colour_bar(figure, panels.ravel().tolist(), norm, "RSS [dBm]", alpha=_PALE)
    return figure


def _draw_median_flight(ax: Axes, data: PaperData, scenario: int, agent: AgentName) -> None:
    """Draw the median run's flight and the target zone."""
    result = data.result(scenario, agent, SPEED)
    x, y, _ = data.scenarios[scenario].plan.require_source()
    angle = np.linspace(0.0, 2.0 * np.pi, 73)
    ax.plot(
        x + GOAL_DISTANCE_M * np.cos(angle),
        y + GOAL_DISTANCE_M * np.sin(angle),
        ":",
        color=INK,
        linewidth=0.9,
        label=f"target zone, $D$ < {GOAL_DISTANCE_M:g} m",
        gid="target zone",
    )
    median = median_run(result)
    if median is not None:
        line = draw_flight(ax, result.trajectory_m(median), agent)
        line.set_label(f"{AGENT_LABELS[agent]} agent")


def _legend(figure: Figure, panels: Sequence[Axes]) -> None:
    """Draw one legend for all panels."""
    labelled: dict[str, Artist] = {}
    for ax in panels:
        handles, labels = ax.get_legend_handles_labels()
        labelled |= dict(zip(labels, handles, strict=True))
    figure.legend(handles=list(labelled.values()), loc="outside lower center", ncols=len(labelled))


def caption(data: PaperData) -> str:
    """Return the caption."""
    lengths = "; ".join(
        f"{AGENT_LABELS[agent]} {result.path_length_m[median]:.1f} m with all "
        f"{result.path_steps[median]} steps counted (Scenario {number})"
        for agent in _ORDER
        for number in data.scenarios
        if (median := median_run(result := data.result(number, agent, SPEED))) is not None
    )
    return (
        f"Final greedy flight at {SPEED} m/s of the realisation with the median length: {lengths}. "
        "An episode ends inside the dotted circle, closer than 2 m to the source."
    )


FIGURE = PaperFigure(
    "trajectories", "Final trajectories at 1 m/s", "the paper's Fig. 4", draw, caption
)
