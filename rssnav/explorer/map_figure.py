"""The map on the page: RSS in colour, walls, draggable source and start, paths, a flight."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from bokeh.events import Tap
from bokeh.models import (
    ColumnDataSource,
    HoverTool,
    Image,
    LinearColorMapper,
)
from bokeh.palettes import RdBu11, Viridis256
from numpy.typing import NDArray

from floorplans import FloorPlan
from floorplans.pictures.legend import SOURCE
from raytrace import RadioMap
from rssnav.explorer.cell_paths import path_colours
from rssnav.explorer.hover import (
    EMPTY_READINGS,
    READING_ROWS,
    hovered_layers,
    map_rows,
    named,
    reading_columns,
    written_in,
)
from rssnav.explorer.map_drawing import colour_bar, draw_floor, draw_walls, empty_figure
from rssnav.explorer.map_marks import Marks, are_numbers
from rssnav.explorer.map_search import SearchOverlay
from rssnav.explorer.survey_layer import Residuals
from rssnav.explorer.tracing import TracedMap
from rssnav.maps import cells_inside
from rssnav.pictures.radio_map import NO_PATH
from rssnav.pictures.style import AGENT_COLOURS

KEYS = "keys"
"""Name of the data that the page's script fills with the arrow and Enter keys."""

HIDDEN, FADED, PLAIN = 0.0, 0.35, 1.0
TRAIL = 120
"""Latest steps of a flight, drawn in full colour."""

HATCH = "#b5b5b5"
_EMPTY_LINES: dict[str, list[Any]] = {"xs": [], "ys": []}
RESIDUALS_DB = 10.0
"""Measured minus traced RSS that has the darkest colour: red for a stronger reading, or blue."""

_EMPTY_POINTS: dict[str, list[float]] = {"x": [], "y": []}


class MapFigure:
    """A Bokeh figure of one plan.

    Parameters
    ----------
    plan : FloorPlan
    height_m : float
        Height of the receivers above the floor [m]; walls that are solid there are dark.
    on_move : callable
        Called with the mark, "source" or "start", and where it was dropped, x and y [m].
    on_drag : callable
        Called likewise while a mark is dragged.
    on_tap : callable
        Called with x and y [m] of a tap.
    on_step : callable
        Called with the steps (right, up) that an arrow key asks for, each -1, 0 or 1; (0, 0) for
        the Enter key.

    Attributes
    ----------
    model : bokeh.plotting.figure
    search : SearchOverlay
    """

    def __init__(
        self,
        plan: FloorPlan,
        height_m: float,
        *,
        on_move: Callable[[str, float, float], None],
        on_drag: Callable[[str, float, float], None],
        on_tap: Callable[[float, float], None],
        on_step: Callable[[int, int], None],
    ) -> None:
        self._plan = plan
        self.model = empty_figure()
        draw_floor(self.model, plan)
        self._mapper = LinearColorMapper(
            palette=Viridis256, low=-1.0, high=0.0, low_color="#00000000", nan_color="#00000000"
        )
        self._image = ColumnDataSource(
            {name: [] for name in ("rss", "server", "x", "y", "dw", "dh")}
        )
        self._uncovered = ColumnDataSource(dict(_EMPTY_POINTS))
        self._draw_map()
        self.search = SearchOverlay(self.model)
        draw_walls(self.model, plan, height_m)
        self._survey = ColumnDataSource(dict(EMPTY_READINGS))
        self._draw_survey()
        self._cell = ColumnDataSource(dict(_EMPTY_POINTS))
        self._paths = ColumnDataSource({**_EMPTY_LINES, "colour": []})
        self._flown: NDArray[np.float64] = np.empty((0, 2))
        self._flight = ColumnDataSource(dict(_EMPTY_POINTS))
        self._trail = ColumnDataSource(dict(_EMPTY_POINTS))
        self._uav = ColumnDataSource(dict(_EMPTY_POINTS))
        self._draw_overlays()
        self.search.draw_flights()
        self._marks = Marks(self.model, plan, on_move, on_drag)
        self._on_tap = on_tap
        self.model.on_event(Tap, self._tapped)
        self._on_step = on_step
        keys = ColumnDataSource({"right": [], "up": [], "count": []}, name=KEYS)
        keys.on_change("data", self._pressed)
        self.model.tags = [keys]

    def show_map(self, radio_map: RadioMap, traced: TracedMap | None = None) -> None:
        """Show a map's RSS, and its other layers and the best server in the tooltip."""
        best = None if traced is None else traced.best_server
        grid, half = radio_map.grid, 0.5 * radio_map.grid.cell_size_m
        covered = radio_map.rss_dbm[np.isfinite(radio_map.rss_dbm)]
        if covered.size:
            self._mapper.update(low=float(covered.min()), high=float(covered.max()) + 1e-9)
        inside = cells_inside(self._plan, grid)
        self._image.data = {
            **{name: [values] for name, values in hovered_layers(radio_map, inside).items()},
            "server": [np.zeros(radio_map.rss_dbm.shape) if best is None else best],
            "x": [grid.x[0] - half],
            "y": [grid.y[0] - half],
            "dw": [grid.x[-1] - grid.x[0] + 2 * half],
            "dh": [grid.y[-1] - grid.y[0] + 2 * half],
        }
        names = () if traced is None else traced.servers
        self._hover.formatters = {**self._hover.formatters, "@server": named(names)}
        self._hover.tooltips = map_rows(radio_map, names)
        uncovered = ~np.isfinite(radio_map.rss_dbm) & inside
        dark = grid.points()[uncovered.ravel()]
        self._uncovered_cells.glyph.update(width=grid.cell_size_m, height=grid.cell_size_m)
        self._uncovered.data = {"x": dark[:, 0], "y": dark[:, 1]}

    def show_marks(self, plan: FloorPlan) -> None:
        """Move the marks to the plan's source and start."""
        self._plan = plan
        self._marks.show(plan)

    def show_survey(self, found: Residuals | None, server: str) -> None:
        """Draw the readings of a transmitter, or of all, coloured by measured minus traced RSS."""
        self._survey.data = (
            dict(EMPTY_READINGS) if found is None else reading_columns(found, server)
        )

    def show_cell(self, centre: tuple[float, float] | None, side_m: float) -> None:
        """Frame the cell at (x, y) [m], or none."""
        self._frame.glyph.update(width=side_m, height=side_m)
        self._cell.data = _points(np.array([centre]) if centre else np.empty((0, 2)))

    def show_paths(
        self, vertices: list[NDArray[np.float64]], power_dbm: NDArray[np.float64]
    ) -> None:
        """Draw paths, strongest first, coloured by power, over the faded map.

        Parameters
        ----------
        vertices : list of (n_i, 2 or 3) float64
            Vertices of each path [m].
        power_dbm : (n,) float64
            Power of each path [dBm].
        """
        colours = path_colours(power_dbm)
        self._paths.data = {
            "xs": [line[:, 0] for line in vertices[::-1]],
            "ys": [line[:, 1] for line in vertices[::-1]],
            "colour": colours[::-1],
        }
        self.fade()

    def fade(self) -> None:
        """Show the map in pale colours under paths; a belief and its legend take its place."""
        alpha = FADED if len(self._paths.data["xs"]) else PLAIN
        if self.search.has_belief:
            alpha = HIDDEN
        if self._bar.visible == self.search.has_belief:
            self._bar.visible = not self.search.has_belief
        if self._picture.glyph.global_alpha != alpha:
            self._picture.glyph.update(global_alpha=alpha)

    def show_flight(self, position: NDArray[np.float64], step: int, agent: str) -> None:
        """Draw a flight in its agent's colour: all of it lightly, trail and UAV over it.

        Parameters
        ----------
        position : (n + 1, 2) float64
            Cell centres along the flight [m].
        step : int
            Position of the UAV, 0 to n.
        agent : str
            "rss" or "location".
        """
        for line in self._flight_lines:
            line.glyph.update(line_color=AGENT_COLOURS[agent])
        self._body.glyph.update(fill_color=AGENT_COLOURS[agent])
        if position is not self._flown:
            self._flown = position
            self._flight.data = _points(position)
        self._trail.data = _points(position[max(0, step - TRAIL) : step + 1])
        self._uav.data = _points(position[step : step + 1])

    def hide_flight(self) -> None:
        """Remove the flight from the map."""
        self._flown = np.empty((0, 2))
        for source in (self._flight, self._trail, self._uav):
            source.data = _points(self._flown)

    def _draw_map(self) -> None:
        glyph = Image(image="rss", x="x", y="y", dw="dw", dh="dh", color_mapper=self._mapper)
        self._picture = self.model.add_glyph(self._image, glyph)
        self._uncovered_cells = self.model.rect(
            "x", "y", 1.0, 1.0, source=self._uncovered, fill_color=NO_PATH, line_color=None,
            hatch_pattern="cross", hatch_color=HATCH, hatch_scale=7, hatch_weight=0.5,
        )  # fmt: skip
        self._hover = HoverTool(
            renderers=[self._picture],
            tooltips=[],
            formatters={"@rss": written_in("dBm"), "@delay_spread_s": written_in("ns", 1e9)},
            visible=False,
        )
        self.model.add_tools(self._hover)
        self._bar = colour_bar(self._mapper, "RSS [dBm]")
        self.model.add_layout(self._bar, "below")

    def _draw_survey(self) -> None:
        colours = LinearColorMapper(palette=RdBu11, low=-RESIDUALS_DB, high=RESIDUALS_DB)
        readings = self.model.scatter(
            "x", "y", source=self._survey, size=9, line_color="white", line_width=0.8,
            fill_color={"field": "residual", "transform": colours},
        )  # fmt: skip
        hover = HoverTool(renderers=[readings], tooltips=READING_ROWS, visible=False)
        hover.formatters = {"@traced": written_in("dBm"), "@residual": written_in("dB")}
        self.model.add_tools(hover)

    def _draw_overlays(self) -> None:
        self._frame = self.model.rect(
            "x", "y", 1.0, 1.0, source=self._cell, fill_color=None, line_color=SOURCE, line_width=2
        )
        self.model.multi_line("xs", "ys", source=self._paths, line_color="white", line_width=3.6)
        self.model.multi_line("xs", "ys", source=self._paths, line_color="colour", line_width=1.8)
        self.model.line("x", "y", source=self._trail, line_color="white", line_width=5)
        self._flight_lines = [
            self.model.line("x", "y", source=self._flight, line_width=1.2, line_alpha=0.5),
            self.model.line("x", "y", source=self._trail, line_width=2.8, line_join="round"),
        ]
        self._body = self.model.scatter(
            "x", "y", source=self._uav, size=15, marker="diamond", line_color="white", line_width=2
        )

    def _pressed(self, _name: str, _old: object, new: dict[str, Any]) -> None:
        """Report an arrow or Enter key; what the page does not send is ignored."""
        steps = [list(new.get(name, ())) for name in ("right", "up")]
        if all(len(step) == 1 and type(step[0]) is int and -1 <= step[0] <= 1 for step in steps):
            self._on_step(steps[0][0], steps[1][0])

    def _tapped(self, event: Any) -> None:
        if are_numbers(event.x, event.y):
            self._on_tap(event.x, event.y)


def _points(position: NDArray[np.float64]) -> dict[str, Any]:
    return {"x": position[:, 0], "y": position[:, 1]}
