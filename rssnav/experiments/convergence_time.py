"""Figure: time to convergence against speed, as episodes, flight time and CPU time."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from rssnav.experiments.data import AGENT_LABELS, AGENTS, AgentName, PaperData
from rssnav.experiments.statistics import mean
from rssnav.figures import AGENT_COLOURS, PAGE_IN, label_panel, new_figure, styled
from rssnav.results import TrainingResult

STEP_S = 1.0
"""Duration of a step [s]."""

MEASURES: dict[str, Callable[[TrainingResult], NDArray[np.float64]]] = {
    "episodes": lambda result: result.converged_episode[converged(result)].astype(np.float64),
    "flight time [h]": lambda result: result.converged_steps[converged(result)] * STEP_S / 3600,
    "CPU time [s]": lambda result: result.converged_cpu_s[converged(result)],
}
"""Each realisation's time to convergence, of those that converged, in each unit."""

_STYLES = {1: ("-", "o", 1.0), 2: ("--", "s", 0.0)}


def converged(result: TrainingResult) -> NDArray[np.bool_]:
    """Tell which realisations (R,) converged."""
    return result.converged_episode >= 0


@styled
def draw(data: PaperData) -> Figure:
    """Draw a panel per measure of time, a curve per agent and scenario."""
    figure = new_figure(PAGE_IN, 2.5)
    panels = figure.subplots(1, len(MEASURES))
    for k, name in enumerate(MEASURES):
        _draw_measure(panels[k], data, name)
        label_panel(panels[k], "abc"[k])
    handles, labels = panels[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=4)
    return figure


def _draw_measure(ax: Axes, data: PaperData, name: str) -> None:
    for number in data.scenarios:
        for agent in AGENTS:
            _draw_curve(ax, data, name, number, agent)
    ax.set_xscale("log", base=2)
    ax.set_xticks(data.speeds, [str(speed) for speed in data.speeds])
    ax.set_xlabel("speed [m/s]")
    ax.set_ylabel(f"to convergence: {name}")
    ax.set_ylim(bottom=0.0)
    ax.grid(True, axis="y")


def _draw_curve(ax: Axes, data: PaperData, name: str, scenario: int, agent: AgentName) -> None:
    """Draw means with their 95 % bootstrap intervals; speeds without convergence are left out."""
    times = {speed: MEASURES[name](data.result(scenario, agent, speed)) for speed in data.speeds}
    estimates = {speed: mean(values) for speed, values in times.items() if values.size}
    line, marker, filled = _STYLES[scenario]
    colour = AGENT_COLOURS[agent]
    values = [estimate.value for estimate in estimates.values()]
    below = [estimate.value - estimate.low for estimate in estimates.values()]
    above = [estimate.high - estimate.value for estimate in estimates.values()]
    ax.errorbar(
        list(estimates),
        values,
        yerr=(below, above),
        color=colour,
        linestyle=line,
        marker=marker,
        markersize=4,
        markerfacecolor=colour if filled else "white",
        capsize=2,
        elinewidth=0.8,
        label=f"{AGENT_LABELS[agent]}, Scenario {scenario}",
        gid=f"{agent} scenario{scenario}",
    )


def caption(data: PaperData) -> str:
    """Say what the figure shows."""
    return ""
