"""A radio map as a picture: RSS in colour over the plan's walls, source and start.

Cells without a path are hatched, so that they cannot be taken for a weak signal. Dark walls are
solid at the receivers' height; light ones, lintels and low walls, leave it free.
"""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure
from matplotlib.image import AxesImage
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from floorplans import FloorPlan
from floorplans.plan_legend import INK, markers
from raytrace import Grid, RadioMap
from rssnav.files import whole_file

COLOUR_MAP = "viridis"
"""Even in lightness, so it reads in grey and with a colour-vision deficiency."""

NO_PATH = "#e3e3e3"
HATCH = "xxxx"
FREE_WALL = "#b9b3a8"
SCALE_M_PER_INCH = 11.0
LEGEND_COLUMN_INCH = 1.8
LENGTH_TOLERANCE_M = 1e-6
SIZE_RANGE_INCH = (4.0, 10.0)


def draw_radio_map(
    plan: FloorPlan,
    radio_map: RadioMap,
    ax: Axes,
    *,
    rss_range_dbm: tuple[float, float] | None = None,
) -> AxesImage:
    """Draw a radio map, its plan's walls, the source and the start.

    Parameters
    ----------
    plan : FloorPlan
        The plan that the map was made for.
    radio_map : RadioMap
        Its power-sum RSS is drawn.
    ax : matplotlib.axes.Axes
        Where; its axes become x and y [m].
    rss_range_dbm : (float, float), optional
        RSS [dBm] of the darkest and of the lightest colour; that of the map by default.

    Returns
    -------
    matplotlib.image.AxesImage
        For ``figure.colorbar(image, label="RSS [dBm]")``.
    """
    dark = ~np.isfinite(radio_map.rss_dbm)
    extent = _extent(radio_map.grid)
    rss_dbm = np.ma.masked_array(radio_map.rss_dbm, dark)
    low, high = rss_range_dbm or _range_of(radio_map.rss_dbm[~dark])
    image = ax.imshow(
        rss_dbm, origin="lower", extent=extent, cmap=COLOUR_MAP, vmin=low, vmax=high, zorder=1
    )
    image.set_gid("rss")
    if dark.any():
        _draw_dark_cells(radio_map.grid, dark, ax)
    _draw_walls(plan, radio_map.grid.height_m, ax)
    for mark, (x, y) in zip(markers(), (plan.source[:2], plan.start), strict=True):
        mark.set_data([x], [y])
        ax.add_line(mark)
    _set_up_axes(plan, ax)
    return image


def save_map_picture(plan: FloorPlan, radio_map: RadioMap, path: str | Path) -> None:
    """Draw a radio map with its scale, legend and parameters into a file.

    Parameters
    ----------
    plan, radio_map
        As for `draw_radio_map`.
    path : str or Path
        Its suffix names the format: .png, .svg or .pdf. Written whole or not at all.
    """
    figure = Figure(figsize=_figure_size(plan), layout="constrained")
    ax = figure.add_subplot()
    image = draw_radio_map(plan, radio_map, ax)
    figure.colorbar(image, ax=ax, label="RSS [dBm]", pad=0.01, aspect=25)
    ax.set_title(_title(plan, radio_map), loc="left", fontsize=10)
    has_dark_cells = not np.isfinite(radio_map.rss_dbm).all()
    figure.legend(
        handles=_legend_handles(plan, radio_map.grid.height_m, has_dark_cells),
        loc="outside lower center",
        ncols=int(figure.get_figwidth() / LEGEND_COLUMN_INCH),
        frameon=False,
        fontsize=9,
    )
    with whole_file(path) as beside:
        figure.savefig(beside, dpi=200)


def _extent(grid: Grid) -> tuple[float, float, float, float]:
    """Left, right, lower and upper edge of the cells [m]."""
    half = 0.5 * grid.cell_size_m
    return grid.x[0] - half, grid.x[-1] + half, grid.y[0] - half, grid.y[-1] + half


def _range_of(rss_dbm: NDArray[np.float64]) -> tuple[float, float]:
    """Range of the readings (n,) [dBm], or one of 1 dB where there is none."""
    if rss_dbm.size == 0:
        return -1.0, 0.0
    return float(rss_dbm.min()), float(rss_dbm.max())


def _draw_dark_cells(grid: Grid, dark: NDArray[np.bool_], ax: Axes) -> None:
    """Hatch the cells (n_y, n_x) without a path."""
    half = 0.5 * grid.cell_size_m
    square = half * np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])
    centres = grid.points()[dark.ravel(), :2]
    cells = PolyCollection(
        [*(centres[:, None] + square)],
        facecolors=NO_PATH,
        edgecolors=INK,
        hatch=HATCH,
        linewidths=0,
        zorder=1,
    )
    cells.set_gid("no path")
    ax.add_collection(cells, autolim=False)


def _draw_walls(plan: FloorPlan, height_m: float, ax: Axes) -> None:
    """Draw all walls lightly, and over them in ink what is solid at a height [m]."""
    whole = np.array([(wall.start, wall.end) for wall in plan.walls])
    layers: Sequence[tuple[str, NDArray[np.float64], str, float]] = (
        ("walls", whole, FREE_WALL, 1.0),
        ("solid walls", plan.solid_segments(height_m), INK, 1.4),
    )
    for order, (gid, segments, colour, width) in enumerate(layers, 2):
        lines = LineCollection(
            [*segments], colors=colour, linewidths=width, zorder=order, capstyle="projecting"
        )
        lines.set_gid(gid)
        ax.add_collection(lines, autolim=False)


def _set_up_axes(plan: FloorPlan, ax: Axes) -> None:
    x_min, y_min, x_max, y_max = plan.bounds
    margin = 0.01 * max(x_max - x_min, y_max - y_min)
    ax.set_xlim(x_min - margin, x_max + margin)
    ax.set_ylim(y_min - margin, y_max + margin)
    ax.set_aspect("equal")
    for axis in (ax.xaxis, ax.yaxis):
        axis.set_major_locator(MaxNLocator("auto", steps=[1, 2, 5, 10], integer=True))
    ax.set_xlabel("x [m]")
    ax.set_ylabel("y [m]")
    ax.spines[:].set_visible(False)


def _figure_size(plan: FloorPlan) -> tuple[float, float]:
    """Width and height of a figure that a plan fills [inch]."""
    x_min, y_min, x_max, y_max = plan.bounds
    longer = max(x_max - x_min, y_max - y_min)
    inch = float(np.clip(longer / SCALE_M_PER_INCH, *SIZE_RANGE_INCH)) / longer
    return (x_max - x_min) * inch + 1.7, (y_max - y_min) * inch + 1.3


def _title(plan: FloorPlan, radio_map: RadioMap) -> str:
    source = radio_map.transmitter
    return (
        f"{plan.name}: {source.power_dbm:g} dBm at {source.frequency_hz * 1e-9:g} GHz, "
        f"received {radio_map.grid.height_m:g} m above the floor"
    )


def _legend_handles(plan: FloorPlan, height_m: float, has_dark_cells: bool) -> list[Line2D | Patch]:
    handles: list[Line2D | Patch] = [
        *markers(),
        Line2D([], [], color=INK, lw=1.4, label=f"wall at {height_m:g} m"),
    ]
    solid_m = np.linalg.norm(np.diff(plan.solid_segments(height_m), axis=1), axis=2).sum()
    if solid_m < sum(wall.length_m for wall in plan.walls) - LENGTH_TOLERANCE_M:
        handles.append(Line2D([], [], color=FREE_WALL, lw=1.0, label="opening or low wall"))
    if has_dark_cells:
        handles.append(Patch(facecolor=NO_PATH, edgecolor=INK, hatch=HATCH, lw=0, label="no path"))
    return handles
