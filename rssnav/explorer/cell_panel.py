"""The strongest paths to the selected cell: a table, and lines in the plan and in 3D."""

from html import escape

import numpy as np
import panel as pn
from numpy.typing import NDArray

from floorplans import FloorPlan
from floorplans.pictures.viewer_3d import add_lines, add_points, plan_scene, scene_html
from rssnav.explorer.map_figure import path_colours
from rssnav.explorer.session import Session
from rssnav.explorer.styles import WIDGETS, decibels, pairs, problem, thousands
from rssnav.explorer.tracing import CellPaths
from rssnav.pictures.paths import path_lines

TOP = 12
LINE_RADIUS = 0.002
"""Radius of a path in 3D, as a fraction of the plan's diagonal."""

_INVITATION = '<p class="quiet">Click a cell of the map to see its strongest paths.</p>'


class CellPanel:
    """Table of the strongest paths.

    Parameters
    ----------
    session : Session

    Attributes
    ----------
    view : panel.Column
    """

    def __init__(self, session: Session) -> None:
        self._session = session
        self._table = pn.pane.HTML(_INVITATION, stylesheets=WIDGETS, sizing_mode="stretch_width")
        self.view = pn.Column(self._table, sizing_mode="stretch_width")

    def show(self) -> None:
        """Show the session's newest paths."""
        finder = self._session.paths
        if finder.problem:
            self._table.object = problem(finder.problem)
        elif finder.latest is not None:
            self._table.object = _summary(finder.latest) + _rows(finder.latest)
        else:
            self._table.object = "<p>Tracing the paths ...</p>" if finder.busy else _INVITATION


def strongest(found: CellPaths) -> list[NDArray[np.float64]]:
    """Vertices (n_i, 3) [m] of the strongest paths, both ends included."""
    return path_lines(found.paths)[:TOP]


def page_3d(plan: FloorPlan, found: CellPaths | None) -> str:
    """HTML of a frame with the plan and the strongest paths to the selected cell, if any."""
    scene = plan_scene(plan, opacity=0.55)
    title = plan.name
    if found is not None:
        lines = strongest(found)
        x_min, y_min, x_max, y_max = plan.bounds
        radius_m = LINE_RADIUS * float(np.hypot(x_max - x_min, y_max - y_min))
        add_lines(scene, "paths", lines, path_colours(found.power_dbm[: len(lines)]), radius_m)
        add_points(scene, "receiver", [found.receiver], "#1a1a1a")
        x, y, z = found.receiver
        title = f"{plan.name}: paths to ({x:g}, {y:g}, {z:g}) m"
    page = escape(scene_html(scene, title))
    style = "width:100%;height:100%;border:0;border-radius:8px"
    return f'<iframe title="3D" sandbox="allow-scripts" srcdoc="{page}" style="{style}"></iframe>'


def _summary(found: CellPaths) -> str:
    x, y, z = found.receiver
    spread_s = float(found.statistics.delay_spread_s[0])
    return pairs(
        [
            ("cell", f"({x:g}, {y:g}, {z:g}) m"),
            ("RSS", decibels(float(found.statistics.rss_dbm[0]))),
            ("paths", thousands(int(found.statistics.path_count[0]))),
            ("delay spread", f"{1e9 * spread_s:.1f} ns"),
        ]
    )


def _rows(found: CellPaths) -> str:
    """HTML of the table, strongest path first."""
    paths, top = found.paths, min(TOP, len(found.paths))
    colours = path_colours(found.power_dbm[:top])
    rows = [
        f'<tr><td><i class="swatch" style="background:{colours[k]}"></i>{k + 1}</td>'
        f"<td>{decibels(found.power_dbm[k], '')}</td><td>{paths.length_m[k]:.2f}</td>"
        f"<td>{1e9 * paths.delay_s[k]:.1f}</td><td>{paths.sequence(k)}</td></tr>"
        for k in range(top)
    ]
    heads = ("path", "power [dBm]", "length [m]", "delay [ns]", "interactions")
    head = "".join(f"<th>{name}</th>" for name in heads)
    note = "R reflection, D diffraction, LOS line of sight"
    return (
        f'<table class="paths"><thead><tr>{head}</tr></thead><tbody>{"".join(rows)}</tbody></table>'
        f'<p class="quiet">{note}</p>'
    )
