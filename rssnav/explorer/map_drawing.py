"""What the map on the page is drawn on: an empty figure, floor and walls."""

from __future__ import annotations

import numpy as np
from bokeh.models import (
    ColorBar,
    CustomJS,
    DataRange1d,
    LinearColorMapper,
    PanTool,
    ResetTool,
    WheelZoomTool,
)
from bokeh.plotting import figure
from shapely import get_coordinates

from floorplans import FloorPlan
from rssnav.pictures.radio_map import FREE_WALL
from rssnav.pictures.style import INK

FONT = "Inter, system-ui, -apple-system, 'Segoe UI', Roboto, 'Helvetica Neue', Arial, sans-serif"
FLOOR = "#fbfaf7"
AXIS = "#b0aca2"
PADDING = 0.006
"""Free space between the plan and its axes, as a fraction of the plan's sides."""

BORDERS_PX = {"left": 46, "right": 38, "top": 8, "bottom": 94}
"""Room for the axes, the tools and the colour bar around the plan."""

LEAST_SIDE_PX = 60
_FIT = """
    document.querySelector(".view")?.style.setProperty("--aspect", aspect);
    const wide = Math.max(plot.outer_width - left - right, least);
    const high = Math.max(plot.outer_height - top - bottom, least);
    const width = Math.max(Math.min(wide, high * aspect), least);
    const height = Math.max(Math.min(high, wide / aspect), least);
    const spare = (wide - width) / 2;
    plot.setv({
        min_border_left: left + spare, min_border_right: right + spare,
        min_border_top: top, min_border_bottom: bottom + high - height,
    }, {sync: false});
"""
"""Gives the frame the plan's shape, so that the axes are at the plan in a page of any size."""


def empty_figure() -> figure:
    """Return a figure true to scale, without frame lines and without the library's logo."""
    model = figure(
        sizing_mode="stretch_both",
        min_height=200,
        match_aspect=True,
        tools=[PanTool(), WheelZoomTool(), ResetTool()],
        toolbar_location="right",
        x_range=DataRange1d(range_padding=PADDING),
        y_range=DataRange1d(range_padding=PADDING),
        outline_line_color=None,
        background_fill_color=None,
        border_fill_color=None,
    )
    model.toolbar.logo = None
    model.grid.visible = False
    for axis, name in ((model.xaxis, "x [m]"), (model.yaxis, "y [m]")):
        axis.update(
            axis_label=name, axis_line_color=None, major_tick_in=2, major_tick_out=4,
            major_tick_line_color=AXIS, minor_tick_line_color=None,
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


def colour_bar(mapper: LinearColorMapper, title: str) -> ColorBar:
    """Return the legend of a colour mapper, for the room below the map."""
    return ColorBar(
        color_mapper=mapper, title=title, height=10, padding=4,
        title_text_font=FONT, title_text_font_style="normal", title_text_font_size="12px",
        title_text_color=INK, major_label_text_color=INK,
        major_label_text_font=FONT, major_label_text_font_size="11px", bar_line_color=None,
        major_tick_line_color=None, background_fill_color=None,
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
    _fit_frame(model, (x_max - x_min) / (y_max - y_min))


def _fit_frame(model: figure, aspect: float) -> None:
    """Give the frame of a figure the width over height of a plan, whatever the figure's size."""
    args = {"plot": model, "aspect": aspect, "least": LEAST_SIDE_PX, **BORDERS_PX}
    fit = CustomJS(args=args, code=_FIT)
    for side in ("outer_width", "outer_height"):
        model.js_on_change(side, fit)


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
