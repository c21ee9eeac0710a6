"""Figure: deviations from the printed lengths in every plan that meets the conditions."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from rssnav.experiments.paper.data import AGENT_LABELS, AGENTS, Configuration
from rssnav.experiments.paper.scenarios import SPEEDS
from rssnav.experiments.studies.plan_search.fits import BUILT_IN, Fit
from rssnav.pictures.style import FAINT, INK, PAGE_IN, label_panel, new_figure, styled


@styled
def draw(found: Sequence[Fit]) -> Figure:
    """Draw a panel per scenario: a line per plan and agent over the speeds."""
    figure = new_figure(PAGE_IN, 2.9)
    panels = figure.subplots(1, 2, sharey=True)
    for scenario, ax in zip((1, 2), panels, strict=True):
        label_panel(ax, "ab"[scenario - 1], f"Scenario {scenario}")
        for fit in (f for f in found if f.piece.scenario == scenario):
            _draw_plan(ax, fit)
        labels = [
            f"{speed}\n{AGENT_LABELS[agent] if speed == SPEEDS[1] else ''}"
            for agent, speed in product(AGENTS, SPEEDS)
        ]
        ax.set_xticks(range(len(labels)), labels)
        ax.set_xlabel("speed [m/s]")
        ax.axhline(0.0, color=INK, linewidth=0.6, linestyle=":")
    panels[0].set_ylabel("length over the paper's, less 1 [%]")
    if any(fit.piece.block == BUILT_IN for fit in found):
        panels[0].legend()
    return figure


def _draw_plan(ax: Axes, fit: Fit) -> None:
    is_ours = fit.piece.block == BUILT_IN
    for k, agent in enumerate(AGENTS):
        keys = [Configuration(fit.piece.scenario, agent, speed) for speed in SPEEDS]
        ax.plot(
            range(k * len(SPEEDS), (k + 1) * len(SPEEDS)),
            [100.0 * fit.deviation[key] for key in keys],
            marker="o",
            markersize=3.0 if is_ours else 2.0,
            color=INK if is_ours else FAINT,
            linewidth=1.2 if is_ours else 0.5,
            zorder=3 if is_ours else 2,
            label="built-in plan" if is_ours and k == 0 else None,
        )
