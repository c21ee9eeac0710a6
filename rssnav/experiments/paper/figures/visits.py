"""Figure: visits of each cell in the first 200, 500 and 1000 episodes, Scenario 1, 1 m/s."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from rssnav.experiments.paper.data import AGENT_LABELS, AgentName, PaperData
from rssnav.experiments.paper.figures.paper_figure import PaperFigure
from rssnav.pictures.style import (
    PAGE_IN,
    draw_cells,
    draw_colour_bar,
    draw_solid_walls,
    draw_source,
    draw_start,
    label_panel,
    new_figure,
    styled,
)

SCENARIO, SPEED = 1, 1
_ORDER: tuple[AgentName, ...] = ("location", "rss")
_UNVISITED = "#e4e4e4"
_FEWEST = 1.0


@styled
def draw(data: PaperData) -> Figure:
    """Draw a row of panels per interval of episodes, a column per agent, all on one scale."""
    results = [data.result(SCENARIO, agent, SPEED) for agent in _ORDER]
    episodes = result_episodes(data)
    scenario = data.scenarios[SCENARIO]
    x_min, y_min, x_max, y_max = scenario.plan.bounds
    panel_in = 0.5 * (PAGE_IN - 1.1) * (y_max - y_min) / (x_max - x_min)
    figure = new_figure(PAGE_IN, 0.5 + len(episodes) * (panel_in + 0.24), maps=True)
    panels = figure.subplots(len(episodes), len(_ORDER), sharex=True, sharey=True, squeeze=False)
    most = max(result.visits.max() for result in results)
    norm = LogNorm(_FEWEST, most)
    for column, (agent, result) in enumerate(zip(_ORDER, results, strict=True)):
        for row, (shown, count) in enumerate(zip(result.visits, episodes, strict=True)):
            ax: Axes = panels[row, column]
            visited = np.ma.masked_equal(shown, 0.0)
            draw_cells(ax, scenario.radio_map.grid, visited, norm=norm)
            ax.set_facecolor(_UNVISITED)
            draw_solid_walls(ax, scenario.plan, scenario.radio_map.grid.height_m)
            draw_source(ax, scenario.plan)
            draw_start(ax, scenario.plan)
            letter = "abcdef"[row * len(_ORDER) + column]
            label_panel(ax, letter, f"{AGENT_LABELS[agent]}, first {count} episodes")
            ax.label_outer()
    draw_colour_bar(figure, panels.ravel().tolist(), norm, "visits of a cell, mean over runs")
    return figure


def caption(data: PaperData) -> str:
    """Return the caption."""
    totals = "; ".join(
        f"{AGENT_LABELS[agent]} {result.visits[0].sum():,.0f}"
        for agent in _ORDER
        for result in [data.result(SCENARIO, agent, SPEED)]
    )
    return (
        f"Visits of each cell, counted from the first episode, Scenario {SCENARIO}, {SPEED} m/s, "
        f"mean over {data.n_runs} realisations, on one logarithmic scale; grey cells were never "
        "visited. "
        f"In the first {result_episodes(data)[0]} episodes: {totals} visits in all. The RSS-based "
        "agent stays in cells that the source covers through the hallway; the location-based agent "
        "first searches the rooms too."
    )


def result_episodes(data: PaperData) -> tuple[int, ...]:
    """Episodes after which the visits were stored."""
    return data.result(SCENARIO, _ORDER[0], SPEED).schedule.snapshot_episodes


FIGURE = PaperFigure("visits", "Visits of each cell", "the paper's Fig. 5", draw, caption)
