"""Figure of the sensitivity study: the final flights' lengths under every alternative."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from rssnav.experiments.paper.data import AGENT_LABELS, AGENTS
from rssnav.experiments.paper.printed_values import PATH_LENGTH_M
from rssnav.experiments.paper.scenarios import SPEEDS
from rssnav.experiments.studies.sensitivity.alternatives import OURS, Outcome
from rssnav.pictures.style import FAINT, INK, PAGE_IN, label_panel, new_figure, styled

_MARKERS = {1: ("o", "#0072b2"), 2: ("s", "#d55e00"), 4: ("^", "#009e73")}
_SCENARIOS = (1, 2)


@dataclass(frozen=True)
class _Panel:
    """One agent in one scenario."""

    ax: Axes
    rows: dict[str, int]


@styled
def draw(outcomes: Sequence[Outcome]) -> Figure:
    """Draw a panel per scenario and agent, a row per alternative, a marker per speed."""
    labels = list(dict.fromkeys(outcome.alternative.label for outcome in outcomes))
    rows = {label: -k for k, label in enumerate(labels)}
    figure = new_figure(PAGE_IN, 0.9 + 0.36 * len(labels))
    panels = figure.subplots(2, 2, sharex="row", sharey=True)
    for k, (scenario, agent) in enumerate(product(_SCENARIOS, AGENTS)):
        ax = panels[k // 2, k % 2]
        label_panel(ax, "abcd"[k], f"Scenario {scenario}, {AGENT_LABELS[agent]}")
        shown = [o for o in outcomes if (o.key.scenario, o.key.agent) == (scenario, agent)]
        for outcome in shown:
            _draw_outcome(_Panel(ax, rows), outcome)
        ax.set_yticks(list(rows.values()), labels)
        ax.grid(True, axis="x")
    for ax in panels[1]:
        ax.set_xlabel("length of the final flight [m]")
    figure.legend(handles=_legend(), loc="outside lower center", ncols=6)
    return figure


def _draw_outcome(panel: _Panel, outcome: Outcome) -> None:
    """Draw mean and standard deviation; hollow if not every run converged."""
    marker, colour = _MARKERS[outcome.key.speed]
    if outcome.alternative == OURS:
        panel.ax.axvline(
            PATH_LENGTH_M[outcome.key], color=colour, linewidth=0.7, linestyle=":", zorder=1
        )
    if outcome.length_m.size == 0:
        return
    y = panel.rows[outcome.alternative.label] - 0.25 * (SPEEDS.index(outcome.key.speed) - 1)
    complete = outcome.episodes.size == outcome.runs
    panel.ax.errorbar(
        outcome.length_m.mean(),
        y,
        xerr=outcome.length_m.std(),
        marker=marker,
        markersize=3.5,
        color=colour,
        markerfacecolor=colour if complete else "white",
        elinewidth=0.7,
        linestyle="none",
        gid=f"{outcome.alternative.label} {outcome.key.name}",
    )


def _legend() -> list[Line2D]:
    """Legend entries of markers, filling and dotted lines."""
    speeds = [
        Line2D([], [], marker=marker, color=colour, linestyle="none", label=f"{speed} m/s")
        for speed, (marker, colour) in _MARKERS.items()
    ]
    hollow = Line2D(
        [],
        [],
        marker="o",
        color=INK,
        markerfacecolor="white",
        linestyle="none",
        label="not every run converges",
    )
    paper = Line2D([], [], color=FAINT, linestyle=":", label="the paper")
    return [*speeds, hollow, paper]
