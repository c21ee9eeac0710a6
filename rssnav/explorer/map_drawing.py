"""What the map on the page is drawn on: an empty figure, floor and walls."""

from __future__ import annotations

import numpy as np
from bokeh.models import DataRange1d, PanTool, ResetTool, WheelZoomTool
from bokeh.plotting import figure
from shapely import get_coordinates

from floorplans import FloorPlan
from rssnav.pictures.radio_map import FREE_WALL
from rssnav.pictures.style import INK

FONT = "Inter, system-ui, -apple-system, 'Segoe UI', Roboto, 'Helvetica Neue', Arial, sans-serif"
FLOOR = "#fbfaf7"
AXIS = "#b0aca2"


def empty_figure() -> figure:
    """Return a figure true to scale, without frame lines and without the library's logo."""
    model = figure(
        sizing_mode="stretch_both",
        min_height=280,
        match_aspect=True,
        tools=[PanTool(), WheelZoomTool(), ResetTool()],
        toolbar_location="right",
        x_range=DataRange1d(range_padding=0.02),
        y_range=DataRange1d(range_padding=0.02),
        outline_line_color=None,
        background_fill_color=None,
        border_fill_color=None,
    )
    model.toolbar.logo = None
    model.grid.visible = False
    for axis, name in ((model.xaxis, "x [m]"), (model.yaxis, "y [m]")):
        axis.update(
            axis_label=name, axis_line_color=AXIS, major_tick_in=0, minor_tick_line_color=None,
            major_tick_line_color=AXIS,
        )  # fmt: skip
    style_axes(model)
    return model


def style_axes(model: figure) -> None:
    """Give the axes the page's fonts and colours."""
    for axis in (*model.xaxis, *model.yaxis):
        axis.update(
            axis_label_text_font=FONT, major_label_text_font=FONT, axis_label_text_color=INK,
            axis_label_text_font_style="normal", major_label_text_color=INK,
        )  # fmt: skip


def draw_floor(model: figure, plan: FloorPlan) -> None:
    """Draw the outline and courtyards, which the axes are fitted to."""
    rings = [get_coordinates(r) for r in (plan.outline.exterior, *plan.outline.interiors)]
    floor = model.multi_polygons(
        xs=[[[ring[:, 0].tolist() for ring in rings]]],
        ys=[[[ring[:, 1].tolist() for ring in rings]]],
        fill_color=FLOOR,
        line_color=None,
    )
    for axis in (model.x_range, model.y_range):
        axis.update(renderers=[floor])
    x_min, y_min, x_max, y_max = plan.bounds
    model.xaxis.bounds, model.yaxis.bounds = (x_min, x_max), (y_min, y_max)


def draw_walls(model: figure, plan: FloorPlan, height_m: float) -> None:
    """Draw walls and columns, dark where they are solid at a height [m]."""
    whole = np.array([(wall.start, wall.end) for wall in plan.walls])
    for lines, colour, width in (
        (whole, FREE_WALL, 1.5),
        (plan.solid_segments(height_m), INK, 2.4),
    ):
        xs, ys = ([*lines[:, :, axis]] for axis in (0, 1))
        model.multi_line(xs, ys, line_color=colour, line_width=width, line_cap="square")
    columns = [
        get_coordinates(r.polygon.exterior) for r in plan.solid_regions if height_m <= r.top_m
    ]
    model.multi_polygons(
        xs=[[[ring[:, 0].tolist()]] for ring in columns],
        ys=[[[ring[:, 1].tolist()]] for ring in columns],
        fill_color=INK,
        line_color=None,
    )
