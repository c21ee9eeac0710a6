"""What the map on the page says of the cell or reading under the pointer."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
from bokeh.models import CustomJSHover
from numpy.typing import NDArray

from raytrace import RadioMap
from rssnav.explorer.survey_layer import Residuals

EMPTY_READINGS: dict[str, list[float]] = {
    name: [] for name in ("x", "y", "tx", "measured", "traced", "residual")
}
READING_ROWS = [
    ("measured", "@measured{0.0} dBm"),
    ("traced", "@traced{custom}"),
    ("difference", "@residual{custom}"),
    ("transmitter", "@tx"),
]


def hovered_layers(radio_map: RadioMap, inside: NDArray[np.bool_]) -> dict[str, NDArray[Any]]:
    """Layers (n_y, n_x) of a map that the tooltip shows, by name.

    NaN, which no map holds, tells the tooltip that a cell is outside the building or in a column.
    """
    layers = {"rss": np.where(inside, radio_map.rss_dbm, np.nan)}
    if radio_map.delay_spread_s is not None:
        layers["delay_spread_s"] = np.where(inside, radio_map.delay_spread_s, np.nan)
    return {**layers, "path_count": radio_map.path_count}


def named(names: tuple[str, ...]) -> CustomJSHover:
    """Return a tooltip format that names an index; -1 is none."""
    return CustomJSHover(code=f"return {json.dumps(names)}[value] ?? 'none'")


def reading_columns(found: Residuals, server: str) -> dict[str, Any]:
    """Data columns of the readings of a transmitter; of all, if there are none of that name."""
    survey = found.survey
    names = np.array([t.name for t in survey.transmitters])[survey.transmitter]
    mine = names == server
    shown = mine if mine.any() else np.ones(len(survey), dtype=bool)
    return {
        "x": survey.points[shown, 0],
        "y": survey.points[shown, 1],
        "tx": names[shown],
        "measured": survey.rss_dbm[shown],
        "traced": found.predicted_dbm[shown],
        "residual": found.residual_db[shown],
    }


def written_in(unit: str, factor: float = 1.0) -> CustomJSHover:
    """Return a tooltip format with a unit; an infinite number means no path, NaN outside."""
    return CustomJSHover(
        code="if (Number.isNaN(value)) return 'outside'; "
        f"return isFinite(value) ? ({factor!r} * value).toFixed(1) + ' {unit}' : 'no path'"
    )


def map_rows(radio_map: RadioMap, servers: tuple[str, ...] = ()) -> list[tuple[str, str]]:
    """Rows of the tooltip."""
    rows = [("RSS", "@rss{custom}"), ("paths", "@path_count{0,0}")]
    if radio_map.delay_spread_s is not None:
        rows.append(("delay spread", "@delay_spread_s{custom}"))
    if servers:
        rows.append(("transmitter", "@server{custom}"))
    return [*rows, ("at", "($x{0.0}, $y{0.0}) m")]
