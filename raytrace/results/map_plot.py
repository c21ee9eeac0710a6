"""A layer of a radio map as a picture; matplotlib is imported when called."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from raytrace.arrays import Floats
from raytrace.grid import Grid

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def plot_layer(
    grid: Grid, values: Floats, label: str, *, ax: Axes | None, walls: Floats | None
) -> Axes:
    """Draw values of a grid's cells in colour.

    Parameters
    ----------
    grid, values
        The cells, and (n_y, n_x) what they hold; what is not finite is left blank.
    label
        Of the colours.
    ax
        Where to draw; a new figure by default.
    walls
        (n, 2, 2) ends of lines to draw [m].
    """
    import matplotlib.pyplot as plt
    from matplotlib.collections import LineCollection

    axes = ax if ax is not None else plt.subplots(layout="constrained")[1]
    half = 0.5 * grid.cell_size_m
    image = axes.imshow(
        np.ma.masked_invalid(values),
        origin="lower",
        extent=(grid.x[0] - half, grid.x[-1] + half, grid.y[0] - half, grid.y[-1] + half),
    )
    axes.figure.colorbar(image, ax=axes, label=label, shrink=0.8)
    if walls is not None:
        axes.add_collection(LineCollection(list(walls), colors="black", linewidths=1.0))
    axes.set(xlabel="x [m]", ylabel="y [m]", aspect="equal")
    return axes
