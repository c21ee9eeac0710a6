"""What colours, hatching and marks mean, and which keys there are."""

from collections.abc import Sequence
from typing import Any

import panel as pn

from floorplans.pictures.legend import SOURCE, START
from rssnav.explorer.cell_paths import PATH_RANGE_DB, TOP
from rssnav.explorer.map_figure import HATCH, RESIDUALS_DB
from rssnav.explorer.map_search import BELIEF, COLOURS
from rssnav.explorer.styles import WIDGETS
from rssnav.pictures.radio_map import FREE_WALL, NO_PATH
from rssnav.pictures.style import AGENT_COLOURS, INK


def _swatch(style: str) -> str:
    return f'<i class="key" style="{style}"></i>'


def _line(colour: str, width_px: float) -> str:
    return _swatch(f"height:{width_px:g}px;background:{colour}")


def _sign(colour: str, sign: str) -> str:
    return f'<b class="key" style="color:{colour}">{sign}</b>'


_GRID = f"{HATCH} 0 1px, transparent 1px 4px"
NO_PATH_KEY = _swatch(
    f"background:repeating-linear-gradient({_GRID}),repeating-linear-gradient(90deg,{_GRID}),"
    f"{NO_PATH}"
)
WALL_KEY, OPENING_KEY = _line(INK, 3), _line(FREE_WALL, 2)
SOURCE_KEY, START_KEY = _sign(SOURCE, "\u2605"), _sign(START, "\u25cf")

CELL_KEY = _swatch(f"box-sizing:border-box;width:14px;border:2px solid {SOURCE}")
UAV_KEY = _sign(INK, "\u25c6")


def _legend(rows: Sequence[tuple[str, str]], remark: str = "") -> str:
    """HTML of signs and what they mean, on a line."""
    signs = "".join(f"<span>{key} {words}</span>" for key, words in rows)
    return f'<p class="legend">{signs}{remark}</p>'


LEGEND = _legend(
    (
        (SOURCE_KEY, "source"),
        (START_KEY, "start"),
        (UAV_KEY, "UAV"),
        (CELL_KEY, "chosen cell"),
        (WALL_KEY, "wall"),
        (OPENING_KEY, "opening or low wall"),
        (NO_PATH_KEY, "no path"),
    )
)
"""HTML of the line below the map."""

LEGEND_3D = _legend(
    (
        (_sign(SOURCE, "\u25cf"), "source"),
        (START_KEY, "start"),
        (UAV_KEY, "UAV"),
        (_swatch(f"background:{NO_PATH}"), "no path"),
    ),
    "<span>Drag to turn, wheel or two fingers to zoom</span>",
)
"""HTML of the line below the view in three dimensions."""

_RSS_KEY = _swatch("background:linear-gradient(90deg,#440154,#3b528b,#21918c,#5ec962,#fde725)")
_PATHS_KEY = _swatch("height:4px;background:linear-gradient(90deg,#fed976,#fd8d3c,#bd0026)")
_BELIEF_KEY = _swatch(f"background:linear-gradient(90deg,#ffffff,{BELIEF})")
_SURVEY_KEY = _swatch("background:linear-gradient(90deg,#053061,#f7f7f7,#67001f)")

_SECTIONS = (
    (
        "Map",
        (
            (_RSS_KEY, "RSS of each cell: the sum of the powers of all paths. Dark is weak."),
            (NO_PATH_KEY, "Hatched: no path reaches the centre of the cell within the limits on "
             "reflections, transmissions and diffraction. It does not mean that measured RSS would "
             "be zero."),
            (WALL_KEY, "Wall or column that is solid at the receivers' height."),
            (OPENING_KEY, "Door, window or passage that is open there, or a wall that ends below."),
            (SOURCE_KEY, "Source, the phone that the UAV searches. Drag it, or type its place."),
            (START_KEY, "Start of the UAV, always at the centre of a cell."),
            (_SURVEY_KEY, f"Readings of a survey: red where {RESIDUALS_DB:g} dB more is measured "
             "than traced, blue where as much less."),
        ),
    ),
    (
        "Paths",
        (
            (_PATHS_KEY, f"The {TOP} strongest paths to the framed cell: dark for the strongest, "
             f"light for {PATH_RANGE_DB:g} dB less. The delay profile has the same colours; "
             "its thin grey stems are the paths that are not listed."),
        ),
    ),
    (
        "Flights",
        (
            (_line(AGENT_COLOURS["rss"], 4), "Flight of the RSS agent."),
            (_line(AGENT_COLOURS["location"], 4), "Flight of the location agent."),
        ),
    ),
    (
        "Search",
        (
            (_line(COLOURS[0], 4), "Flight of the first searcher."),
            (_line(COLOURS[1], 4), "Flight of the one that it is compared with."),
            (_BELIEF_KEY, "Belief of a searcher, in place of the RSS: how probable the source is "
             "in a cell. The darkest cell is the most probable one."),
        ),
    ),
    (
        "Keyboard",
        (
            ("<kbd>Tab</kbd>", "to the next control; the map is one of them."),
            ("<kbd>\u2190\u2191\u2192\u2193</kbd>", "on the map: choose the next cell. The first "
             "key chooses the cell of the start."),
            ("<kbd>Enter</kbd>", "on the map: show the paths to the chosen cell."),
        ),
    ),
)  # fmt: skip


class HelpPanel:
    """The explanations.

    Attributes
    ----------
    view : panel.Column
    """

    def __init__(self) -> None:
        html = "".join(_section(title, rows) for title, rows in _SECTIONS)
        self.view = pn.Column(
            pn.pane.HTML(html, stylesheets=WIDGETS, sizing_mode="stretch_width"),
            sizing_mode="stretch_width",
        )


def _section(title: str, rows: Any) -> str:
    items = "".join(f"<dt>{key}</dt><dd>{words}</dd>" for key, words in rows)
    return f'<h2>{title}</h2><dl class="keys">{items}</dl>'
