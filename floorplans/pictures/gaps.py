"""A plan from above with the gaps in its outline marked."""

from __future__ import annotations

from collections.abc import Sequence
from math import dist
from pathlib import Path

from matplotlib.figure import Figure

from atomicfiles import atomic_write
from floorplans.pictures.plan_view import PAGE_IN, draw_plan
from floorplans.unchecked import UncheckedPlan
from floorplans.walls import Point

GAP = "#e00000"
"""Colour of gaps."""


def save_gap_picture(
    plan: UncheckedPlan, gaps: Sequence[tuple[Point, Point]], path: str | Path
) -> None:
    """Draw a plan with the gaps in its outline into a file, which is written whole or not at all.

    Parameters
    ----------
    plan : UncheckedPlan
        Its numbers are valid.
    gaps : sequence of ((float, float), (float, float))
        From (x, y) to (x, y) [m].
    path : str or Path
        Its suffix names the format: .png, .svg or .pdf.
    """
    x_min, y_min, x_max, y_max = plan.bounds
    longer = max(x_max - x_min, y_max - y_min)
    size = (max(x_max - x_min, 0.2 * longer), max(y_max - y_min, 0.2 * longer))
    figure = Figure(figsize=(size[0] * PAGE_IN / longer + 0.5, size[1] * PAGE_IN / longer + 0.5))
    ax = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    draw_plan(plan, ax)
    for start, end in gaps:
        ax.plot(*zip(start, end, strict=True), "o--", color=GAP, lw=1.5, markersize=4, zorder=6)
        ax.annotate(
            f"{dist(start, end):.2f} m",
            ((start[0] + end[0]) / 2, (start[1] + end[1]) / 2),
            color=GAP,
            ha="center",
            va="bottom",
            zorder=6,
        )
    with atomic_write(path) as beside:
        figure.savefig(beside, dpi=200, bbox_inches="tight", pad_inches=0.1)
