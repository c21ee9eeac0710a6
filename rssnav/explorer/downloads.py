"""Files to download: the map, a figure of it, the plan."""

from collections.abc import Callable
from io import BytesIO
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import panel as pn

import floorplans
from rssnav.explorer.file_names import file_name
from rssnav.explorer.session import Session
from rssnav.explorer.styles import WIDGETS
from rssnav.explorer.tracing import TracedMap
from rssnav.pictures.radio_map import save_map_picture


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

    return _written(f"map{suffix}", save)


def _written(name: str, save: Callable[[Path], None]) -> bytes:
    """Return the content of a file that a function writes."""
    with TemporaryDirectory(prefix="rssnav-") as folder:
        path = Path(folder) / name
        save(path)
        return path.read_bytes()


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
            ".h5": self._button("Map (HDF5)", lambda: self._map_bytes(map_file)),
            ".png": self._button("Figure (PNG)", lambda: self._figure_bytes(".png")),
            ".svg": self._button("Figure (SVG)", lambda: self._figure_bytes(".svg")),
        }
        self._plan = self._button("Plan (TOML)", lambda: BytesIO(plan_file(session)))
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

    def _button(self, label: str, content: Callable[[], BytesIO]) -> Any:
        return pn.widgets.FileDownload(
            callback=content,
            filename="plan",
            label=label,
            button_type="default",
            stylesheets=WIDGETS,
            sizing_mode="stretch_width",
        )

    def _map_bytes(self, make: Callable[[TracedMap], bytes]) -> BytesIO:
        traced = self._session.complete_map
        return BytesIO(b"" if traced is None else make(traced))

    def _figure_bytes(self, suffix: str) -> BytesIO:
        return self._map_bytes(lambda traced: figure_file(traced, suffix))
