"""Figure: the two floor plans in 3D."""

from __future__ import annotations

from matplotlib.figure import Figure
from mpl_toolkits.mplot3d import Axes3D

from floorplans.pictures.axonometric import draw_plan_3d
from rssnav.experiments.paper.data import PaperData
from rssnav.experiments.paper.figures.paper_figure import PaperFigure
from rssnav.pictures.style import PAGE_IN, styled

_HEIGHT_IN = 2.6
_FOOT = 0.1
_MARKER_SIZES = {"source": 9, "start": 6}


@styled
def draw(data: PaperData) -> Figure:
    """Draw each scenario's walls in parallel projection, side by side, with one legend."""
    figure = Figure(figsize=(PAGE_IN, _HEIGHT_IN))
    width = 1.0 / len(data.scenarios)
    for k, (number, scenario) in enumerate(data.scenarios.items()):
        ax = figure.add_axes((k * width, _FOOT, width, 0.97 - _FOOT), projection="3d")
        assert isinstance(ax, Axes3D)
        draw_plan_3d(scenario.plan, ax)
        figure.text(k * width + 0.01, 0.98, f"({'ab'[k]}) Scenario {number}", va="top")
    _share_legend(figure)
    return figure


def _share_legend(figure: Figure) -> None:
    """Replace the panels' legends by one below them."""
    handles = {}
    for ax in figure.axes:
        legend = ax.get_legend()
        assert legend is not None
        handles |= {handle.get_label(): handle for handle in legend.legend_handles if handle}
        legend.remove()
    shared = figure.legend(handles=list(handles.values()), loc="lower center", ncols=len(handles))
    for handle in shared.legend_handles:
        assert handle is not None
        if (size := _MARKER_SIZES.get(str(handle.get_gid()))) is not None:
            handle.set(markersize=size)


def caption(data: PaperData) -> str:
    """Return the caption."""
    sizes = " and ".join(
        f"{x1 - x0:g} m × {y1 - y0:g} m"
        for x0, y0, x1, y1 in (scenario.plan.bounds for scenario in data.scenarios.values())
    )
    height_m = max(scenario.plan.height_m for scenario in data.scenarios.values())
    return (
        f"The two buildings, {sizes}, with walls {height_m:g} m high; the ceiling is omitted. "
        "The paper gives their sizes, the source and the start, but not their walls: these plans "
        "are reconstructed under the constraints it states."
    )


FIGURE = PaperFigure("floor_plans", "Floor plans", "the paper's Fig. 3", draw, caption)
