"""Figure of the noise study: success, steps, convergence and states against width and sigma."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import product

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from rssnav.experiments.statistics import mean
from rssnav.experiments.studies.noise.measuring import CORRELATIONS, SIGMAS_DB, Outcome, RuleName
from rssnav.pictures.style import INK, PAGE_IN, label_panel, new_figure, styled

Measure = Callable[[Outcome], NDArray[np.float64]]

_MEASURES: dict[str, Measure] = {
    "last 100 episodes: success": lambda outcome: outcome.success,
    "last 100 episodes: steps": lambda outcome: outcome.steps,
    "runs that converge": lambda outcome: outcome.converged.astype(np.float64),
    "states": lambda outcome: outcome.n_states.astype(np.float64),
}
_LOGARITHMIC = ("last 100 episodes: steps", "states")
_RULES: dict[RuleName, str] = {"tolerance": "threshold Th [dB]", "intervals": "interval width [dB]"}
_COLOURS = ("#1a1a1a", "#0072b2", "#009e73", "#e69f00", "#d55e00")
_LINES = dict(zip(CORRELATIONS, ("-", "--"), strict=True))


@styled
def draw(outcomes: Sequence[Outcome]) -> Figure:
    """Draw a column per scenario and rule, a row per measure, a curve per fluctuation."""
    scenarios = sorted({outcome.setting.scenario for outcome in outcomes})
    columns = list(product(scenarios, _RULES))
    figure = new_figure(PAGE_IN, 1.6 * len(_MEASURES))
    panels = figure.subplots(len(_MEASURES), len(columns), sharex="col", sharey="row")
    for row, (name, measure) in enumerate(_MEASURES.items()):
        for column, (scenario, rule) in enumerate(columns):
            ax = panels[row, column]
            of_panel = [
                outcome
                for outcome in outcomes
                if (outcome.setting.scenario, outcome.setting.rule) == (scenario, rule)
            ]
            _draw_curves(ax, of_panel, measure)
            if name in _LOGARITHMIC:
                ax.set_yscale("log")
            if row == 0:
                label_panel(ax, "abcd"[column], f"Scenario {scenario}, {rule}")
        panels[row, 0].set_ylabel(name)
    for column, (_, rule) in enumerate(columns):
        _scale(panels[-1, column], [o for o in outcomes if o.setting.rule == rule])
        panels[-1, column].set_xlabel(_RULES[rule])
    figure.legend(handles=_legend(), loc="outside lower center", ncols=4)
    return figure


def _scale(ax: Axes, outcomes: Sequence[Outcome]) -> None:
    """Set a logarithmic axis with a tick at each measured width."""
    widths = sorted({outcome.setting.width_db for outcome in outcomes})
    ax.set_xscale("log", base=2)
    ax.set_xticks(widths, [f"{width:g}" for width in widths])
    ax.minorticks_off()


def _draw_curves(ax: Axes, outcomes: Sequence[Outcome], measure: Measure) -> None:
    """Draw means with their 95 % bootstrap intervals over the runs."""
    ax.grid(True, axis="y")
    for fluctuation in dict.fromkeys(outcome.setting.fluctuation for outcome in outcomes):
        curve = [o for o in outcomes if o.setting.fluctuation == fluctuation]
        estimates = [mean(measure(outcome)) for outcome in curve]
        widths = [outcome.setting.width_db for outcome in curve]
        colour = _COLOURS[SIGMAS_DB.index(fluctuation.sigma_db)]
        ax.fill_between(
            widths,
            [estimate.low for estimate in estimates],
            [estimate.high for estimate in estimates],
            color=colour,
            alpha=0.15,
            linewidth=0.0,
        )
        ax.plot(
            widths,
            [estimate.value for estimate in estimates],
            color=colour,
            linestyle=_LINES[fluctuation.correlation],
            marker="o",
            markersize=2.5,
        )


def _legend() -> list[Line2D]:
    """Legend entries of colours and lines."""
    colours = [
        Line2D([], [], color=colour, marker="o", markersize=2.5, label=f"σ = {sigma_db:g} dB")
        for sigma_db, colour in zip(SIGMAS_DB, _COLOURS, strict=True)
    ]
    lines = [
        Line2D([], [], color=INK, linestyle=line, label=f"correlation {correlation:g}")
        for correlation, line in _LINES.items()
    ]
    return [*colours, *lines]
