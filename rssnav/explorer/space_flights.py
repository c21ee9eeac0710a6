"""Flights in the view in three dimensions, which the page's script passes on to its frame."""

from __future__ import annotations

import json
from collections.abc import Sequence
from importlib import resources
from typing import Any, NamedTuple

import numpy as np
from bokeh.models import ColumnDataSource, CustomJS
from matplotlib.colors import to_rgb
from numpy.typing import NDArray

from floorplans.pictures.viewer_3d import FLOOR_COLOUR, ColourBar
from rssnav.explorer.map_search import BELIEF as BELIEF_COLOUR
from rssnav.explorer.map_search import BELIEF_LABEL, OPACITY, darkest

LINES, STEPS, BELIEF = "flight lines", "flight steps", "flight belief"
"""Names of the data that the page's script reads."""

PASS_ON = "window.passOnFlights?.(cb_obj.name)"


class FlightLine(NamedTuple):
    """A flight as it is drawn.

    Attributes
    ----------
    position : (n + 1, 2) float64
        Cell centres along it [m].
    step : int
        Position of the UAV, 0 to n.
    colour : str
    """

    position: NDArray[np.float64]
    step: int
    colour: str


class SpaceFlights:
    """Flights that the view in three dimensions shows; nothing is sent while it is hidden.

    Attributes
    ----------
    models : list of bokeh.models.ColumnDataSource
        They have to be in the page's document.
    """

    def __init__(self) -> None:
        self._lines = ColumnDataSource({"x": [], "y": [], "colour": []}, name=LINES)
        self._steps = ColumnDataSource({"step": []}, name=STEPS)
        self._belief = ColumnDataSource(_cells(None), name=BELIEF)
        self.models = [self._lines, self._steps, self._belief]
        for model in self.models:
            model.js_on_change("data", CustomJS(code=PASS_ON))
        self._flights: Sequence[FlightLine] = ()
        self._sent: list[NDArray[np.float64]] = []
        self._believed: NDArray[np.float32] | None = None
        self._belief_sent: NDArray[np.float32] | None = None
        self._visible = False

    def show(
        self, flights: Sequence[FlightLine], belief: NDArray[np.float32] | None = None
    ) -> None:
        """Show flights, and a belief in place of the map, instead of those before.

        Parameters
        ----------
        flights : sequence of FlightLine
        belief : (n_y, n_x) float32, optional
            Probability of each cell of the map.
        """
        self._flights, self._believed = flights, belief
        if self._visible:
            self._send()

    def set_visible(self, visible: bool) -> None:
        """Tell whether the view is open."""
        self._visible = visible
        self.show(self._flights, self._believed)

    def _send(self) -> None:
        positions = [flight.position for flight in self._flights]
        if len(positions) != len(self._sent) or any(
            new is not old for new, old in zip(positions, self._sent, strict=True)
        ):
            self._sent = positions
            self._lines.data = _columns(self._flights)
        self._steps.data = {"step": [flight.step for flight in self._flights]}
        if self._believed is not self._belief_sent:
            self._belief_sent = self._believed
            self._belief.data = _cells(self._believed)


def script(height_m: float, radius_m: float, corners: tuple[float, float, float, float]) -> str:
    """HTML of the script that draws what it is sent, for the end of a page of a scene.

    Parameters
    ----------
    height_m : float
        Height of the flights above the floor [m].
    radius_m : float
        Radius of a line [m].
    corners : (float, float, float, float)
        x_min, y_min, x_max, y_max of the map [m].
    """
    code = (resources.files("rssnav.explorer") / "space_flights.js").read_text(encoding="utf-8")
    look = {
        "height": height_m,
        "radius": radius_m,
        "corners": corners,
        "belief": [round(255 * part) for part in to_rgb(BELIEF_COLOUR)],
        "opacity": OPACITY,
    }
    bar = ColourBar(_shades(), "0", "", BELIEF_LABEL).html()
    hidden = bar.replace('id="colour-bar"', 'id="belief-bar" hidden', 1)
    return f"{hidden}<script>const LOOK = {json.dumps(look)};\n{code}</script>"


def _shades() -> list[tuple[float, float, float]]:
    """Colours of beliefs from none to the darkest, over the floor."""
    floor, colour = np.array(to_rgb(FLOOR_COLOUR)), np.array(to_rgb(BELIEF_COLOUR))
    shares = OPACITY * np.linspace(0.0, 1.0, 9)[:, None]
    return [to_rgb(shade) for shade in (1.0 - shares) * floor + shares * colour]


def _columns(flights: Sequence[FlightLine]) -> dict[str, Any]:
    return {
        "x": [flight.position[:, 0] for flight in flights],
        "y": [flight.position[:, 1] for flight in flights],
        "colour": [flight.colour for flight in flights],
    }


def _cells(belief: NDArray[np.float32] | None) -> dict[str, Any]:
    if belief is None:
        return {"probability": [], "columns": [], "darkest": []}
    columns = belief.shape[1]
    return {"probability": [belief.ravel()], "columns": [columns], "darkest": [darkest(belief)]}
