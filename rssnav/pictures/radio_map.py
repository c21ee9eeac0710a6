"""A radio map as a picture: RSS in colour over the plan's walls, transmitter and start.

Cells of the building without a path are hatched, so that they are not mistaken for a weak signal;
what is outside is blank. Walls and columns that are solid at the receivers' height are dark;
openings and low walls are light.
"""

import textwrap
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.image import AxesImage
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from numpy.typing import NDArray
from shapely import get_coordinates

from floorplans import FloorPlan
from raytrace import Grid, RadioMap, Transmitter
from rssnav.maps import cells_inside
from rssnav.pictures.style import (
    COLUMN_IN,
    INK,
    PAGE_IN,
    draw_cells,
    draw_start,
    draw_transmitter,
    save_picture,
    styled,
)

NO_PATH = "#e3e3e3"
HATCH = "xxxx"
HATCH_COLOUR = "#a6a6a6"
"""Lighter than any wall, so that walls between rooms without a path stay visible."""

FREE_WALL = "#b9b3a8"
LONG_M = 40.0
"""A longer plan is drawn over both columns of a page."""

_BESIDE_IN, _BELOW_IN, _LINE_IN, _PAD_IN = 0.98, 0.66, 0.16, 0.05
_CHARACTER_IN, _KEY_IN = 0.057, 1.15
_LENGTH_TOLERANCE_M = 1e-6


def draw_radio_map(
    plan: FloorPlan,
    radio_map: RadioMap,
    ax: Axes,
    *,
    rss_range_dbm: tuple[float, float] | None = None,
    transmitters: Sequence[Transmitter] = (),
) -> AxesImage:
    """Draw a radio map, its plan's walls, its transmitter and the start.

    Parameters
    ----------
    plan : FloorPlan
        The map's plan.
    radio_map : RadioMap
        Map whose power-sum RSS is drawn.
    ax : matplotlib.axes.Axes
        Axes of the drawing, which become x and y [m].
    rss_range_dbm : (float, float), optional
        RSS [dBm] of the darkest and the lightest colour; the map's range by default.
    transmitters : sequence of Transmitter, optional
        What is marked; the map's own transmitter by default.

    Returns
    -------
    matplotlib.image.AxesImage
        For ``figure.colorbar(image, label="RSS [dBm]")``.
    """
    uncovered = ~np.isfinite(radio_map.rss_dbm)
    low, high = rss_range_dbm or _range_of(radio_map.rss_dbm[~uncovered])
    rss_dbm = np.ma.masked_array(radio_map.rss_dbm, uncovered)
    image = draw_cells(ax, radio_map.grid, rss_dbm, norm=Normalize(low, high))
    image.set_gid("rss")
    dark = uncovered & cells_inside(plan, radio_map.grid)
    if dark.any():
        _hatch_cells(radio_map.grid, dark, ax)
    draw_walls(plan, radio_map.grid.height_m, ax)
    for position in [t.position for t in transmitters or [radio_map.transmitter]]:
        draw_transmitter(ax, position, "source" if position == plan.source else "transmitter")
    if plan.start is not None:
        draw_start(ax, plan)
    set_limits(plan, ax)
    return image


@styled
def map_figure(
    plan: FloorPlan,
    radio_map: RadioMap,
    *,
    width_in: float | None = None,
    transmitters: Sequence[Transmitter] = (),
) -> Figure:
    """Draw a radio map with its scale, legend and parameters.

    Parameters
    ----------
    plan, radio_map, transmitters
        As for `draw_radio_map`.
    width_in : float, optional
        Width of the figure [inch]: by default one column of a two-column page, or both for a plan
        longer than 40 m.
    """
    width_in = width_in or plan_width_in(plan)
    keys = _keys(plan, radio_map)
    columns = max(1, int(width_in / _KEY_IN))
    title = textwrap.wrap(_title(plan, radio_map, len(transmitters)), int(width_in / _CHARACTER_IN))
    lines = len(title) + -(-(len(keys) + 2) // columns)
    layout = ConstrainedLayoutEngine(w_pad=_PAD_IN, h_pad=_PAD_IN)
    figure = Figure((width_in, plan_height_in(plan, width_in, lines)), layout=layout)
    ax = figure.add_subplot()
    image = draw_radio_map(plan, radio_map, ax, transmitters=transmitters)
    figure.colorbar(image, ax=ax, label="RSS [dBm]", pad=0.02, aspect=25)
    figure.suptitle("\n".join(title), x=0.01, ha="left", fontsize="medium", parse_math=False)
    marks = list(dict(zip(*ax.get_legend_handles_labels()[::-1], strict=True)).values())
    figure.legend(handles=[*marks, *keys], loc="outside lower center", ncols=columns)
    return figure


def save_map_picture(
    plan: FloorPlan,
    radio_map: RadioMap,
    path: str | Path,
    *,
    width_in: float | None = None,
    transmitters: Sequence[Transmitter] = (),
) -> None:
    """Draw a radio map into a file.

    Parameters
    ----------
    plan, radio_map, width_in, transmitters
        As for `map_figure`.
    path : str or Path
        Its suffix names the format: .png, .svg or .pdf. Written atomically.
    """
    figure = map_figure(plan, radio_map, width_in=width_in, transmitters=transmitters)
    save_picture(figure, path)


def _range_of(rss_dbm: NDArray[np.float64]) -> tuple[float, float]:
    """Range of RSS values (n,) [dBm]; one of 1 dB if there are none."""
    if rss_dbm.size == 0:
        return -1.0, 0.0
    return float(rss_dbm.min()), float(rss_dbm.max())


def _hatch_cells(grid: Grid, dark: NDArray[np.bool_], ax: Axes) -> None:
    """Hatch the cells (n_y, n_x) without a path."""
    half = 0.5 * grid.cell_size_m
    square = half * np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])
    centres = grid.points()[dark.ravel(), :2]
    cells = PolyCollection(
        [*(centres[:, None] + square)],
        facecolors=NO_PATH,
        edgecolors=HATCH_COLOUR,
        hatch=HATCH,
        linewidths=0,
        zorder=1,
    )
    cells.set_gid("no path")
    ax.add_collection(cells, autolim=False)


def draw_walls(plan: FloorPlan, height_m: float, ax: Axes) -> None:
    """Draw all walls lightly, and walls and columns that are solid at a height [m] in black."""
    columns = [
        get_coordinates(r.polygon.exterior) for r in plan.solid_regions if height_m <= r.top_m
    ]
    if columns:
        filled = PolyCollection(columns, facecolors=INK, linewidths=0, zorder=2)
        filled.set_gid("columns")
        ax.add_collection(filled, autolim=False)
    whole = np.array([(wall.start, wall.end) for wall in plan.walls])
    layers: Sequence[tuple[str, NDArray[np.float64], str, float]] = (
        ("walls", whole, FREE_WALL, 0.7),
        ("solid walls", plan.solid_segments(height_m), INK, 0.9),
    )
    for order, (gid, segments, colour, width) in enumerate(layers, 2):
        lines = LineCollection(
            [*segments], colors=colour, linewidths=width, zorder=order, capstyle="projecting"
        )
        lines.set_gid(gid)
        ax.add_collection(lines, autolim=False)


def set_limits(plan: FloorPlan, ax: Axes) -> None:
    """Set the limits to the plan with a narrow margin, and remove the frame."""
    x_min, y_min, x_max, y_max = plan.bounds
    margin = 0.01 * max(x_max - x_min, y_max - y_min)
    ax.set_xlim(x_min - margin, x_max + margin)
    ax.set_ylim(y_min - margin, y_max + margin)
    ax.spines[:].set_visible(False)


def plan_width_in(plan: FloorPlan) -> float:
    """Width of a plan's picture [inch]."""
    x_min, y_min, x_max, y_max = plan.bounds
    return PAGE_IN if max(x_max - x_min, y_max - y_min) > LONG_M else COLUMN_IN


def plan_height_in(plan: FloorPlan, width_in: float, lines: int) -> float:
    """Height of a figure [inch] with a plan and some lines of text."""
    x_min, y_min, x_max, y_max = plan.bounds
    drawn_in = (width_in - _BESIDE_IN) * (y_max - y_min) / (x_max - x_min)
    return drawn_in + _BELOW_IN + lines * _LINE_IN


def _title(plan: FloorPlan, radio_map: RadioMap, n_transmitters: int) -> str:
    if n_transmitters > 1:
        return (
            f"{plan.name}: strongest of {n_transmitters} transmitters, "
            f"received {radio_map.grid.height_m:g} m above the floor"
        )
    transmitter = radio_map.transmitter
    return (
        f"{plan.name}: {transmitter.power_dbm:g} dBm at {transmitter.frequency_hz * 1e-9:g} GHz, "
        f"received {radio_map.grid.height_m:g} m above the floor"
    )


def _keys(plan: FloorPlan, radio_map: RadioMap) -> list[Line2D | Patch]:
    """Legend entries of walls and hatching."""
    height_m = radio_map.grid.height_m
    keys: list[Line2D | Patch] = [
        Line2D([], [], color=INK, lw=0.9, label=f"wall at {height_m:g} m")
    ]
    solid_m = np.linalg.norm(np.diff(plan.solid_segments(height_m), axis=1), axis=2).sum()
    if solid_m < sum(wall.length_m for wall in plan.walls) - _LENGTH_TOLERANCE_M:
        keys.append(Line2D([], [], color=FREE_WALL, lw=0.9, label="opening or low wall"))
    if (~np.isfinite(radio_map.rss_dbm) & cells_inside(plan, radio_map.grid)).any():
        hatched = Patch(facecolor=NO_PATH, edgecolor=HATCH_COLOUR, hatch=HATCH, lw=0)
        hatched.set_label("no path")
        keys.append(hatched)
    return keys
