"""Figures of a validation: residuals over the plan, against prediction, distance and walls."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from floorplans import FloorPlan
from raytrace.arrays import Bools, Floats
from rssnav.measurements.survey import Survey
from rssnav.measurements.validation import Validation
from rssnav.pictures.radio_map import draw_walls, set_limits
from rssnav.pictures.style import FAINT, INK, PAGE_IN, SOURCE, styled

RESIDUAL_COLOURS = "RdBu_r"
POINT = "#0072b2"


@styled
def residual_map(plan: FloorPlan, survey: Survey, validation: Validation) -> Figure:
    """Draw the mean residual over transmitters at each place, and the transmitters."""
    shown = _shown(survey, validation)
    places, at = np.unique(survey.points[shown], axis=0, return_inverse=True)
    residual = np.bincount(at, validation.residual_db[shown]) / np.bincount(at)
    x_min, y_min, x_max, y_max = plan.bounds
    width_in = PAGE_IN * 0.7
    height_in = min(width_in * (y_max - y_min) / (x_max - x_min), 8.0) + 0.6
    figure = Figure((width_in, height_in), layout="constrained")
    ax = figure.add_subplot()
    limit = max(float(np.quantile(np.abs(residual), 0.95)), 1.0)
    marks = ax.scatter(
        places[:, 0],
        places[:, 1],
        c=residual,
        s=22,
        cmap=RESIDUAL_COLOURS,
        norm=Normalize(-limit, limit),
        edgecolors=INK,
        linewidths=0.3,
        zorder=4,
    )
    draw_walls(plan, float(np.median(survey.points[:, 2])), ax)
    for transmitter in survey.transmitters:
        x, y, _ = transmitter.position
        ax.plot(x, y, "*", color=SOURCE, markersize=9, markeredgecolor=INK, zorder=5)
        ax.annotate(
            transmitter.name, (x, y), (4, 4), textcoords="offset points", parse_math=False, zorder=6
        )
    ax.set_aspect("equal")
    set_limits(plan, ax)
    ax.set_xlabel("x [m]")
    ax.set_ylabel("y [m]")
    figure.colorbar(
        marks, ax=ax, label="measured − traced [dB]", pad=0.02, shrink=0.8, extend="both"
    )
    return figure


@styled
def residual_plots(survey: Survey, validation: Validation) -> Figure:
    """Plot measured against traced RSS, and residuals against distance and walls crossed."""
    figure = Figure((PAGE_IN, 2.5), layout="constrained")
    scatter, distance, walls = figure.subplots(1, 3)
    shown = _shown(survey, validation)
    _plot_scatter(scatter, validation.predicted_dbm[shown], survey.rss_dbm[shown])
    residual = validation.residual_db[shown]
    _plot_residuals(distance, survey.distance_m[shown], residual, "distance [m]")
    counts = validation.walls[shown].astype(np.float64)
    _plot_residuals(walls, counts, residual, "walls crossed")
    walls.set_xticks(np.arange(counts.max() + 1.0))
    return figure


def _shown(survey: Survey, validation: Validation) -> Bools:
    return np.isfinite(validation.residual_db) & ~survey.is_censored


def _plot_scatter(ax: Axes, traced: Floats, measured: Floats) -> None:
    ax.scatter(traced, measured, s=4, color=POINT, alpha=0.5, linewidths=0)
    low = min(traced.min(), measured.min()) - 1.0
    high = max(traced.max(), measured.max()) + 1.0
    ax.plot([low, high], [low, high], color=INK, linewidth=0.8)
    ax.set(xlabel="traced [dBm]", ylabel="measured [dBm]", xlim=(low, high), ylim=(low, high))


def _plot_residuals(ax: Axes, along: Floats, residual: Floats, label: str) -> None:
    """Plot residuals with their mean in eight bins, or at each of a few values."""
    ax.scatter(along, residual, s=4, color=POINT, alpha=0.5, linewidths=0)
    ax.axhline(0.0, color=FAINT, linewidth=0.8)
    values = np.unique(along)
    edges = np.quantile(along, np.linspace(0.0, 1.0, 9)) if len(values) > 8 else values
    bins = np.clip(np.searchsorted(edges, along, side="right") - 1, 0, len(edges) - 1)
    n = np.bincount(bins)
    middle, mean = np.bincount(bins, along)[n > 0], np.bincount(bins, residual)[n > 0]
    ax.plot(middle / n[n > 0], mean / n[n > 0], "o-", color=SOURCE, markersize=3)
    ax.set(xlabel=label, ylabel="measured − traced [dB]")
