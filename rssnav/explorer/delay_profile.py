"""The delay profile of a cell: the power of each path over its delay."""

from __future__ import annotations

import numpy as np
from bokeh.models import ColumnDataSource, HoverTool, Range1d
from bokeh.plotting import figure

from rssnav.explorer.cell_paths import TOP, CellPaths, path_colours
from rssnav.explorer.map_drawing import style_axes

SHOWN_DB = 60.0
"""Paths this much weaker than the strongest are left out."""
MOST = 1000
FAINT_PATH = "#9b968a"
_EMPTY = {name: [] for name in ("delay", "power", "foot", "colour", "width", "what")}


class DelayProfile:
    """A stem for each path, in its colour on the map if it is listed.

    Attributes
    ----------
    model : bokeh.plotting.figure
    """

    def __init__(self) -> None:
        self._delays, self._powers = Range1d(start=0, end=1), Range1d(start=-SHOWN_DB, end=0)
        self.model = figure(
            height=190,
            sizing_mode="stretch_width",
            x_range=self._delays,
            y_range=self._powers,
            tools="",
            toolbar_location=None,
            outline_line_color=None,
            x_axis_label="delay [ns]",
            y_axis_label="power [dBm]",
            visible=False,
        )
        self.model.grid.grid_line_color = "#eeeae1"
        for axis in (*self.model.xaxis, *self.model.yaxis):
            axis.update(minor_tick_line_color=None)
        style_axes(self.model)
        self._stems = ColumnDataSource(dict(_EMPTY))
        stems = self.model.segment(
            "delay", "foot", "delay", "power", source=self._stems, line_color="colour",
            line_width="width",
        )  # fmt: skip
        rows = [("path", "@what"), ("delay", "@delay{0.0} ns"), ("power", "@power{0.0} dBm")]
        self.model.add_tools(HoverTool(renderers=[stems], tooltips=rows, visible=False))

    def show(self, found: CellPaths | None) -> int:
        """Show the profile of a cell, or nothing; return the number of stems."""
        n = 0 if found is None else _n_shown(found)
        self.model.visible = n > 0
        if found is None or not n:
            self._stems.data = dict(_EMPTY)
            return 0
        paths, power_dbm = found.paths.strongest(n), found.power_dbm[:n]
        foot, delay_ns = float(power_dbm[0]) - SHOWN_DB, 1e9 * paths.delay_s
        self._powers.update(start=foot, end=float(power_dbm[0]) + 4.0)
        self._delays.update(start=0.95 * delay_ns.min() - 1.0, end=1.05 * delay_ns.max() + 1.0)
        listed = path_colours(power_dbm[:TOP])
        weakest_first = slice(None, None, -1)
        self._stems.data = {
            "delay": delay_ns[weakest_first],
            "power": power_dbm[weakest_first],
            "foot": np.full(n, foot),
            "colour": (listed + [FAINT_PATH] * (n - len(listed)))[weakest_first],
            "width": ([2.5] * len(listed) + [1.0] * (n - len(listed)))[weakest_first],
            "what": [f"{k + 1}: {paths.sequence(k)}" for k in range(n)][weakest_first],
        }
        return n


def _n_shown(found: CellPaths) -> int:
    """Number of paths with a stem, the strongest."""
    power_dbm = found.power_dbm
    if not power_dbm.size or not np.isfinite(power_dbm[0]):
        return 0
    return min(MOST, int(np.count_nonzero(power_dbm > power_dbm[0] - SHOWN_DB)))
