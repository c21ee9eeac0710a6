"""Files to download: the map, a figure of it, the plan."""

from collections.abc import Callable
from io import BytesIO
from pathlib import Path
from tempfile import TemporaryDirectory
from threading import Lock
from typing import Any

import panel as pn

import floorplans
from rssnav.explorer.background import SupersededError, TooManyError
from rssnav.explorer.file_names import file_name
from rssnav.explorer.session import Session
from rssnav.explorer.styles import WIDGETS
from rssnav.explorer.tracing import TracedMap
from rssnav.pictures.radio_map import save_map_picture

_DRAWING = Lock()
"""Held while a figure is drawn: matplotlib's settings and fonts are those of the process."""


def plan_file(session: Session) -> bytes:
    """TOML of the plan with its current source and start."""
    return floorplans.dumps(session.plan).encode()


def map_file(traced: TracedMap) -> bytes:
    """HDF5 of a map."""
    return _written("map.h5", traced.radio_map.save)


def figure_file(traced: TracedMap, suffix: str) -> bytes:
    """Figure of a map in the format of a suffix, ".png" or ".svg"."""

    def save(path: Path) -> None:
        save_map_picture(traced.plan, traced.radio_map, path)

    with _DRAWING:
        return _written(f"map{suffix}", save)


def png_file(traced: TracedMap) -> bytes:
    """Figure of a map, as PNG."""
    return figure_file(traced, ".png")


def svg_file(traced: TracedMap) -> bytes:
    """Figure of a map, as SVG."""
    return figure_file(traced, ".svg")


def _written(name: str, save: Callable[[Path], None]) -> bytes:
    """Return the content of a file that a function writes."""
    with TemporaryDirectory(prefix="rssnav-") as folder:
        path = Path(folder) / name
        save(path)
        return path.read_bytes()


class FileButton(pn.widgets.FileDownload):
    """A download button whose callback may return None, which downloads nothing."""

    def _sync_data(self, fileobj: Any) -> None:
        if fileobj is not None:
            super()._sync_data(fileobj)


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
            ".h5": self._button("Map (HDF5)", self._of_complete_map(map_file)),
            ".png": self._button("Figure (PNG)", self._of_complete_map(png_file)),
            ".svg": self._button("Figure (SVG)", self._of_complete_map(svg_file)),
        }
        self._plan = self._button("Plan (TOML)", lambda: plan_file(session))
        note = (
            '<p class="quiet">The map opens in h5py, xarray and MATLAB; <code>rssnav train</code> '
            "and <code>rssnav map</code> read map and plan as they are.</p>"
        )
        self.view = pn.Column(
            *self._of_map.values(),
            self._plan,
            pn.pane.HTML(note, stylesheets=WIDGETS),
            sizing_mode="stretch_width",
        )
        self.show()

    def show(self) -> None:
        """Name the files after the plan; enable the map's buttons when it is complete."""
        name, complete = self._session.plan.name, self._session.complete_map is not None
        self._plan.filename = file_name(name, ".toml")
        for suffix, button in self._of_map.items():
            button.filename = file_name(name, suffix)
            button.disabled = not complete

    def _button(self, label: str, content: Callable[[], bytes]) -> Any:
        session = self._session

        async def made() -> BytesIO | None:
            try:
                return BytesIO(await session.files.make(content))
            except TooManyError as error:
                session.problem = str(error)
            except SupersededError:  # the tab was closed
                pass
            return None

        return FileButton(
            callback=made,
            filename="plan",
            label=label,
            button_type="default",
            stylesheets=WIDGETS,
            sizing_mode="stretch_width",
        )

    def _of_complete_map(self, make: Callable[[TracedMap], bytes]) -> Callable[[], bytes]:
        """Return what makes a file of the complete map; an empty one while there is none."""

        def content() -> bytes:
            traced = self._session.complete_map
            return b"" if traced is None else make(traced)

        return content
