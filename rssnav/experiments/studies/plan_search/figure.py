"""Figure: deviations from the printed lengths in every plan that allows the printed flights."""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.figure import Figure

from rssnav.experiments.paper.data import CONFIGURATIONS
from rssnav.experiments.studies.plan_search.fits import BUILT_IN, Fit
from rssnav.pictures.style import FAINT, INK


def draw(found: Sequence[Fit]) -> Figure:
    """Draw a panel per scenario: a line per plan over the six configurations."""
    figure = Figure(figsize=(7.2, 3.2), layout="constrained")
    panels = figure.subplots(1, 2, sharey=True)
    for scenario, ax in zip((1, 2), panels, strict=True):
        keys = [key for key in CONFIGURATIONS if key.scenario == scenario]
        for fit in (f for f in found if f.piece.scenario == scenario):
            is_ours = fit.piece.block == BUILT_IN
            ax.plot(
                [f"{key.agent}\n{key.speed} m/s" for key in keys],
                [100.0 * fit.deviation[key] for key in keys],
                marker="o",
                markersize=3.0 if is_ours else 2.0,
                color=INK if is_ours else FAINT,
                linewidth=1.2 if is_ours else 0.5,
                zorder=3 if is_ours else 2,
                label="built-in plan" if is_ours else None,
            )
        ax.axhline(0.0, color=INK, linewidth=0.6, linestyle=":")
        ax.set_title(f"Scenario {scenario}")
    panels[0].set_ylabel("length over the paper's, less 1 [%]")
    panels[0].legend()
    return figure
