"""Figure: time to convergence against speed, as episodes, flight time and CPU time."""

from __future__ import annotations

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import NullLocator

from rssnav.experiments.paper.convergence_measures import MEASURES, Measure
from rssnav.experiments.paper.data import AGENT_LABELS, AGENTS, AgentName, PaperData
from rssnav.experiments.paper.figures.paper_figure import PaperFigure
from rssnav.experiments.statistics import mean
from rssnav.pictures.style import AGENT_COLOURS, PAGE_IN, label_panel, new_figure, styled

_LINES = {1: ("-", "o", True), 2: ("--", "s", False)}


@styled
def draw(data: PaperData) -> Figure:
    """Draw a panel per measure of time, a curve per agent and scenario."""
    figure = new_figure(PAGE_IN, 2.5)
    panels = figure.subplots(1, len(MEASURES))
    for k, measure in enumerate(MEASURES):
        _draw_measure(panels[k], data, measure)
        label_panel(panels[k], "abc"[k], measure.title)
    handles, labels = panels[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=4)
    return figure


def _draw_measure(ax: Axes, data: PaperData, measure: Measure) -> None:
    for number in data.scenarios:
        for agent in AGENTS:
            _draw_curve(ax, data, measure, number, agent)
    ax.set_xscale("log", base=2)
    ax.set_yscale(measure.scale)
    if measure.scale == "linear":
        ax.set_ylim(bottom=0.0)
    ax.set_xticks(data.speeds, [str(speed) for speed in data.speeds])
    ax.xaxis.set_minor_locator(NullLocator())
    ax.set_xlabel("speed [m/s]")
    ax.set_ylabel(f"{measure.heading} to convergence")
    ax.grid(True, axis="y")


def _draw_curve(
    ax: Axes, data: PaperData, measure: Measure, scenario: int, agent: AgentName
) -> None:
    """Draw means with their 95 % bootstrap intervals; omit speeds without convergence."""
    times = {speed: measure.of(data.result(scenario, agent, speed)) for speed in data.speeds}
    estimates = {speed: mean(values) for speed, values in times.items() if values.size}
    line, marker, filled = _LINES[scenario]
    colour = AGENT_COLOURS[agent]
    ax.errorbar(
        list(estimates),
        [each.value for each in estimates.values()],
        yerr=(
            [each.value - each.low for each in estimates.values()],
            [each.high - each.value for each in estimates.values()],
        ),
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
    """Return the caption."""
    return (
        "Time until a run flies the same path in three consecutive episodes: mean over the "
        f"{data.n_runs} realisations with its 95 % bootstrap interval (mostly smaller than the "
        "marker). The paper does not specify the time, so all three are shown: (a) episodes, "
        "(b) simulated flight time at one second per step, (c) CPU time of the learning loop. "
        "Flight time falls with speed; the number of episodes need not, because exploration decays "
        "per step and a faster flight takes fewer steps per episode."
    )


FIGURE = PaperFigure(
    "convergence_time", "Convergence time against speed", "the paper's Fig. 7", draw, caption
)
