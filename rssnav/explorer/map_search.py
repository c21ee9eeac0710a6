"""Two searchers' flights over the map, and what one of them believes."""

from __future__ import annotations

from typing import Any

import numpy as np
from bokeh.models import ColumnDataSource, Image, LinearColorMapper
from bokeh.plotting import figure
from numpy.typing import NDArray

from raytrace import Grid
from rssnav.explorer.map_drawing import colour_bar
from rssnav.pictures.style import AGENT_COLOURS

COLOURS = (AGENT_COLOURS["rss"], AGENT_COLOURS["location"])
BELIEF, BELIEF_LABEL = "#d6006c", "Belief: probability in each cell"
WIDTHS, EDGE = (6.0, 2.2), 2.2
"""Widths of the lines [px]; the first is seen on both sides of the second where both flew."""

OPACITY, SHADES = 0.8, 32
LEAST_STRENGTH = 6.0
"""The darkest shade is at least this many times the probability of a cell in an even belief."""

_NO_POINTS: dict[str, list[float]] = {"x": [], "y": []}
_NO_IMAGE: dict[str, list[Any]] = {name: [] for name in ("image", "x", "y", "dw", "dh")}


def darkest(belief: NDArray[np.float32]) -> float:
    """Probability of a cell from which on a belief has its darkest shade."""
    return max(float(belief.max()), LEAST_STRENGTH / belief.size)


class SearchOverlay:
    """Belief and flights, drawn on a figure in two layers.

    Parameters
    ----------
    model : bokeh.plotting.figure
    """

    def __init__(self, model: figure) -> None:
        self._model = model
        shades = [f"{BELIEF}{round(255 * OPACITY * k / (SHADES - 1)):02x}" for k in range(SHADES)]
        self._mapper = LinearColorMapper(palette=shades, low=0.0, high=1.0)
        self._belief = ColumnDataSource(dict(_NO_IMAGE))
        glyph = Image(image="image", x="x", y="y", dw="dw", dh="dh", color_mapper=self._mapper)
        model.add_glyph(self._belief, glyph)
        self._bar = colour_bar(self._mapper, BELIEF_LABEL)
        self._bar.visible = False
        model.add_layout(self._bar, "below")
        self._trails: list[tuple[ColumnDataSource, ColumnDataSource]] = []
        self._shown: NDArray[np.float32] | None = None

    @property
    def has_belief(self) -> bool:
        """Whether a belief is shown."""
        return self._shown is not None

    def draw_flights(self) -> None:
        """Draw what will show the flights, above all that the figure has so far."""
        data = [[ColumnDataSource(dict(_NO_POINTS)) for _ in range(2)] for _ in COLOURS]
        for (trail, _), width in zip(data, WIDTHS, strict=True):
            self._line(trail, "white", width + EDGE)
        for (trail, uav), colour, width in zip(data, COLOURS, WIDTHS, strict=True):
            self._line(trail, colour, width)
            self._model.scatter(
                "x", "y", source=uav, size=15, marker="diamond", fill_color=colour,
                line_color="white", line_width=2,
            )  # fmt: skip
            self._trails.append((trail, uav))

    def _line(self, trail: ColumnDataSource, colour: str, width: float) -> None:
        self._model.line(
            "x", "y", source=trail, line_color=colour, line_width=width, line_join="round"
        )

    def show(
        self,
        positions: tuple[NDArray[np.float64], ...],
        belief: NDArray[np.float32] | None,
        grid: Grid,
    ) -> None:
        """Draw flights up to where they are, and a belief.

        Parameters
        ----------
        positions : two of (n + 1, 2) float64
            Cell centres along each flight [m].
        belief : (n_y, n_x) float32 or None
            Probability of each cell of the grid.
        grid : Grid
        """
        for (trail, uav), position in zip(self._trails, positions, strict=True):
            trail.data = _columns(position)
            uav.data = _columns(position[-1:])
        if belief is self._shown:
            return
        self._shown = belief
        if belief is None:
            self._remove_belief()
            return
        self._bar.visible = True
        half = 0.5 * grid.cell_size_m
        self._mapper.high = darkest(belief)
        self._belief.data = {
            "image": [belief],
            "x": [grid.x[0] - half],
            "y": [grid.y[0] - half],
            "dw": [grid.x[-1] - grid.x[0] + 2.0 * half],
            "dh": [grid.y[-1] - grid.y[0] + 2.0 * half],
        }

    def hide(self) -> None:
        """Remove all of it."""
        for sources in self._trails:
            for source in sources:
                if len(source.data["x"]):
                    source.data = dict(_NO_POINTS)
        if self.has_belief:
            self._remove_belief()

    def _remove_belief(self) -> None:
        self._shown, self._belief.data, self._bar.visible = None, dict(_NO_IMAGE), False


def _columns(position: NDArray[np.float64]) -> dict[str, Any]:
    return {"x": position[:, 0], "y": position[:, 1]}
