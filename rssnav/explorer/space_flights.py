"""Flights in the view in three dimensions, which the page's script passes on to its frame."""

from __future__ import annotations

from collections.abc import Sequence
from importlib import resources
from typing import Any, NamedTuple

import numpy as np
from bokeh.models import ColumnDataSource, CustomJS
from numpy.typing import NDArray

LINES, STEPS = "flight lines", "flight steps"
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
        self.models = [self._lines, self._steps]
        for model in self.models:
            model.js_on_change("data", CustomJS(code=PASS_ON))
        self._flights: Sequence[FlightLine] = ()
        self._sent: list[NDArray[np.float64]] = []
        self._visible = False

    def show(self, flights: Sequence[FlightLine]) -> None:
        """Show flights, in place of those before."""
        self._flights = flights
        if self._visible:
            self._send()

    def set_visible(self, visible: bool) -> None:
        """Tell whether the view is open."""
        self._visible = visible
        self.show(self._flights)

    def _send(self) -> None:
        positions = [flight.position for flight in self._flights]
        if len(positions) != len(self._sent) or any(
            new is not old for new, old in zip(positions, self._sent, strict=True)
        ):
            self._sent = positions
            self._lines.data = _columns(self._flights)
        self._steps.data = {"step": [flight.step for flight in self._flights]}


def script(height_m: float, radius_m: float) -> str:
    """HTML of the script that draws the flights it is sent, for the end of a page of a scene.

    Parameters
    ----------
    height_m : float
        Height of the flights above the floor [m].
    radius_m : float
        Radius of a line [m].
    """
    code = (resources.files("rssnav.explorer") / "space_flights.js").read_text(encoding="utf-8")
    look = f"const LOOK = {{ height: {height_m:.6g}, radius: {radius_m:.6g} }};"
    return f"<script>{look}\n{code}</script>"


def _columns(flights: Sequence[FlightLine]) -> dict[str, Any]:
    return {
        "x": [flight.position[:, 0] for flight in flights],
        "y": [flight.position[:, 1] for flight in flights],
        "colour": [flight.colour for flight in flights],
    }
