"""Files to download: the map, a figure of it, the plan, the session."""

from collections.abc import Callable
from pathlib import Path
from threading import Lock

import panel as pn

import floorplans
from rssnav.explorer.file_buttons import file_button, written
from rssnav.explorer.file_names import file_name
from rssnav.explorer.import_worker import SESSION
from rssnav.explorer.session import Session
from rssnav.explorer.styles import WIDGETS
from rssnav.explorer.tracing import TracedMap
from rssnav.pictures.radio_map import save_map_picture

_MAP_NOTE = (
    '<p class="quiet">The map opens in h5py, xarray and MATLAB; <code>rssnav train</code> and '
    "<code>rssnav map</code> read map and plan as they are.</p>"
)
_SESSION_NOTE = (
    f'<p class="quiet">A session ({SESSION}) holds plan, settings, cell, survey and the parameters '
    "of the training. Upload it under Setup to go on: the map is traced and the training repeated "
    "with the same seed, which gives the same flights.</p>"
)
_DRAWING = Lock()
"""Held while a figure is drawn: matplotlib's settings and fonts are those of the process."""


def plan_file(session: Session) -> bytes:
    """TOML of the plan with its current source and start."""
    return floorplans.dumps(session.plan).encode()


def session_file(session: Session) -> bytes:
    """File that opens the session again."""
    return session.saved().dumps().encode()


def map_file(traced: TracedMap) -> bytes:
    """HDF5 of a map."""
    return written("map.h5", traced.radio_map.save)


def figure_file(traced: TracedMap, suffix: str) -> bytes:
    """Figure of a map in the format of a suffix, ".png" or ".svg"."""

    def save(path: Path) -> None:
        save_map_picture(traced.plan, traced.radio_map, path)

    with _DRAWING:
        return written(f"map{suffix}", save)


def png_file(traced: TracedMap) -> bytes:
    """Figure of a map, as PNG."""
    return figure_file(traced, ".png")


def svg_file(traced: TracedMap) -> bytes:
    """Figure of a map, as SVG."""
    return figure_file(traced, ".svg")


class Downloads:
    """Download buttons; those of the map are enabled when it is complete.

    Parameters
    ----------
    session : Session

    Attributes
    ----------
    view : panel.Column
    """

    def __init__(self, session: Session) -> None:
        self._session = session
        self._of_map = {
            ".h5": file_button(session, "Map (HDF5)", self._of_complete_map(map_file)),
            ".png": file_button(session, "Figure (PNG)", self._of_complete_map(png_file)),
            ".svg": file_button(session, "Figure (SVG)", self._of_complete_map(svg_file)),
        }
        self._plan = file_button(session, "Plan (TOML)", lambda: plan_file(session))
        self._whole = file_button(session, "Session", lambda: session_file(session))
        self.view = pn.Column(
            *self._of_map.values(),
            self._plan,
            pn.pane.HTML(_MAP_NOTE, stylesheets=WIDGETS, sizing_mode="stretch_width"),
            self._whole,
            pn.pane.HTML(_SESSION_NOTE, stylesheets=WIDGETS, sizing_mode="stretch_width"),
            sizing_mode="stretch_width",
        )
        self.show()

    def show(self) -> None:
        """Name the files after the plan; enable the map's buttons when it is complete."""
        name, complete = self._session.plan.name, self._session.complete_map is not None
        self._plan.filename = file_name(name, ".toml")
        self._whole.filename = file_name(name, SESSION)
        for suffix, button in self._of_map.items():
            button.filename = file_name(name, suffix)
            button.disabled = not complete

    def _of_complete_map(self, make: Callable[[TracedMap], bytes]) -> Callable[[], bytes]:
        """Return what makes a file of the complete map; an empty one while there is none."""

        def content() -> bytes:
            traced = self._session.complete_map
            return b"" if traced is None else make(traced)

        return content
