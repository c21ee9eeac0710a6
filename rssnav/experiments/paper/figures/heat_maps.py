"""Figure: received signal strength over both floor plans."""

from __future__ import annotations

import math

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.image import AxesImage

from rssnav.experiments.paper.data import PaperData
from rssnav.experiments.paper.figures.paper_figure import PaperFigure
from rssnav.experiments.paper.scenarios import Scenario
from rssnav.pictures.style import (
    MAP_COLOURS,
    PAGE_IN,
    draw_cells,
    draw_solid_walls,
    draw_source,
    draw_start,
    label_panel,
    styled,
)

_WEAKEST_FRACTION = 0.01
_LEFT_IN, _GAP_IN, _RIGHT_IN, _TOP_IN, _FOOT_IN = 0.42, 0.45, 0.1, 0.22, 0.38
_BAR_IN, _BELOW_MAP_IN, _LEGEND_IN = 0.11, 0.62, 0.55


@styled
def draw(data: PaperData) -> Figure:
    """Draw the maps on one scale of length and colour; the colour bar is below the first map."""
    bounds = [scenario.plan.bounds for scenario in data.scenarios.values()]
    gaps_in = _LEFT_IN + _RIGHT_IN + _GAP_IN * (len(bounds) - 1)
    scale = (PAGE_IN - gaps_in) / sum(x1 - x0 for x0, _, x1, _ in bounds)  # inch per metre
    heights_in = [scale * (y1 - y0) for _, y0, _, y1 in bounds]
    below_first_in = heights_in[0] + _BELOW_MAP_IN + _BAR_IN + _LEGEND_IN
    figure = Figure((PAGE_IN, _TOP_IN + max(below_first_in, max(heights_in) + _FOOT_IN)))
    norm = colour_scale(data)
    left_in = _LEFT_IN
    panels: list[Axes] = []
    for k, (number, scenario) in enumerate(data.scenarios.items()):
        width_in = scale * (bounds[k][2] - bounds[k][0])
        panels.append(_axes(figure, left_in, _TOP_IN, width_in, heights_in[k]))
        draw_map(panels[k], scenario, norm)
        label_panel(panels[k], "ab"[k], f"Scenario {number}")
        left_in += width_in + _GAP_IN
    _draw_keys(figure, panels[0], norm)
    return figure


def _axes(figure: Figure, left: float, top: float, width: float, height: float) -> Axes:
    """Add axes whose upper left corner lies (left, top) inches from the figure's."""
    total_width, total_height = figure.get_size_inches()
    return figure.add_axes(
        (
            left / total_width,
            1.0 - (top + height) / total_height,
            width / total_width,
            height / total_height,
        )
    )


def _draw_keys(figure: Figure, ax: Axes, norm: Normalize) -> None:
    """Draw colour bar and legend below the first map."""
    width_in, height_in = figure.get_size_inches()
    position = ax.get_position()
    top_in = height_in * (1.0 - position.y0) + _BELOW_MAP_IN
    bar_axes = _axes(figure, width_in * position.x0, top_in, width_in * position.width, _BAR_IN)
    bar = figure.colorbar(
        ScalarMappable(norm, MAP_COLOURS), cax=bar_axes, orientation="horizontal", extend="min"
    )
    bar.set_label("RSS [dBm]")
    marks, _ = ax.get_legend_handles_labels()
    bar_axes.legend(handles=marks, loc="upper center", bbox_to_anchor=(0.5, -2.6), ncols=2)


def draw_map(ax: Axes, scenario: Scenario, norm: Normalize) -> AxesImage:
    """Draw one map with walls, source and start."""
    radio_map, plan = scenario.radio_map, scenario.plan
    covered = np.ma.masked_invalid(radio_map.rss_dbm)
    image = draw_cells(ax, radio_map.grid, covered, norm=norm)
    draw_solid_walls(ax, plan, radio_map.grid.height_m)
    draw_source(ax, plan)
    draw_start(ax, plan)
    return image


def colour_scale(data: PaperData) -> Normalize:
    """Return the scale [dBm] of all maps; the weakest cells lie below it."""
    values = np.concatenate([s.radio_map.rss_dbm.ravel() for s in data.scenarios.values()])
    finite = values[np.isfinite(values)]
    weakest = float(np.quantile(finite, _WEAKEST_FRACTION))
    return Normalize(10.0 * math.floor(weakest / 10.0), 10.0 * math.ceil(finite.max() / 10.0))


def caption(data: PaperData) -> str:
    """Return the caption."""
    ranges = "; ".join(
        f"Scenario {number}: {_dbm(s.radio_map.rss_dbm[np.isfinite(s.radio_map.rss_dbm)].min())} "
        f"to {_dbm(s.radio_map.rss_dbm.max())} dBm in {s.radio_map.rss_dbm.size:,} cells"
        for number, s in data.scenarios.items()
    )
    grid = next(iter(data.scenarios.values())).radio_map.grid
    return (
        f"Received signal strength {grid.height_m:g} m above the floor, the sum of the powers of "
        f"all paths in each {grid.cell_size_m:g} m cell ({ranges}). Black lines are walls at that "
        "height; hallways in line with the source guide the signal, and the RSS in rooms "
        "off them is low."
    )


def _dbm(value: float) -> str:
    return f"{value:.1f}".replace("-", "−")


FIGURE = PaperFigure(
    "heat_maps", "Received signal strength", "the background of the paper's Fig. 4", draw, caption
)
