"""Choose or upload a plan, and set the parameters of its map."""

from dataclasses import replace
from typing import Any

import panel as pn

import floorplans
from floorplans import FloorPlan
from floorplans.transmitters import ALL
from rssnav.explorer.inputs import checked_values, number_input
from rssnav.explorer.ranges import Range
from rssnav.explorer.session import Session
from rssnav.explorer.styles import WIDGETS, details
from rssnav.explorer.survey_layer import CSV, EXAMPLE
from rssnav.explorer.tracing import MapSettings
from rssnav.explorer.uploads import ACCEPTED
from rssnav.presets import PRESETS
from rssnav.transmitters import SOURCE

GIGA = 1e9
RANGES = {
    "cell_size_m": Range("Cell [m]", 0.05, 1000.0, 0.25),
    "height_m": Range("UAV's height [m]", 0.01, 1000.0, 0.1),
    "source_z_m": Range("Source's height [m]", 0.01, 1000.0, 0.1),
    "max_reflections": Range("Reflections", 0, 8, whole=True),
    "power_dbm": Range("Power [dBm]", -50.0, 60.0),
    "frequency_ghz": Range("Frequency [GHz]", 1.0, 100.0),
}


WALLS = {"opaque": "paper", "transmitting": "building"}
"""What is shown for each preset."""


class PlanDropper(pn.widgets.FileDropper):
    """A drop area that keeps the newest file only, and none that comes in several messages."""

    def _process_event(self, event: Any) -> None:
        self.value.clear()
        self.mime_type.clear()
        if event.event_name == "delete_event" or event.data["total_chunks"] == 1:
            super()._process_event(event)


class PlanPanel:
    """Widgets for the plan and the settings of its map.

    Parameters
    ----------
    session : Session

    Attributes
    ----------
    view : panel.Column
    """

    def __init__(self, session: Session) -> None:
        self._session = session
        self._showing = False
        self._plan = pn.widgets.Select(
            label="Plan", options=self._names(), stylesheets=WIDGETS, sizing_mode="stretch_width"
        )
        self._upload = pn.Column(self._dropper(), sizing_mode="stretch_width", margin=0)
        self._report = pn.pane.HTML("", stylesheets=WIDGETS, sizing_mode="stretch_width")
        self._server, self._preset = (
            pn.widgets.Select(label=label, stylesheets=WIDGETS, width=152, margin=(3, 5))
            for label in ("Transmitter", "Walls")
        )
        self._preset.options = WALLS
        self._make_settings()
        self._plan.param.watch(self._choose, "value")
        self.view = pn.Column(
            self._plan,
            self._upload,
            self._report,
            pn.pane.HTML("<h2>Map</h2>", stylesheets=WIDGETS, margin=(0, 10)),
            pn.FlexBox(self._server, self._preset, *self._inputs.values(), gap="0px 8px"),
            pn.pane.HTML(
                '<p class="quiet">Drag the star (source) and the dot (start) on the floor. Hover '
                "for a cell's RSS, click it for its paths.</p>",
                stylesheets=WIDGETS,
            ),
            sizing_mode="stretch_width",
        )
        self.show()

    def show(self) -> None:
        """Show the session's plan and settings."""
        self._showing = True
        plan = self._session.plan
        self._plan.options = self._names()
        self._plan.value = plan.name
        settings = self._session.settings
        self._server.options = _servers(plan)
        self._server.value = settings.server
        self._server.visible = bool(plan.transmitters)
        self._preset.value = settings.preset
        chosen = next((t for t in plan.transmitters if t.id == settings.server), None)
        stated = (None, None) if chosen is None else (chosen.power_dbm, chosen.frequency_hz)
        for name, value in zip(("power_dbm", "frequency_ghz"), stated, strict=True):
            self._inputs[name].disabled = value is not None
        self._report.object = details("Import report", self._session.import_report)
        for name, value in _values(plan, self._session.settings).items():
            self._inputs[name].value = value
        self._showing = False

    def empty_upload(self) -> None:
        """Show an empty dropper: only a new one forgets the last file in the browser."""
        self._upload[:] = [self._dropper()]

    def _dropper(self) -> PlanDropper:
        limits = self._session.limits
        dropper = PlanDropper(
            label=f"Or upload {', '.join((*ACCEPTED, CSV))}",
            multiple=False,
            max_file_size=f"{limits.upload_bytes // 1000}KB",
            chunk_size=2 * limits.upload_bytes,
            previews=[],
            stylesheets=WIDGETS,
            sizing_mode="stretch_width",
        )
        dropper.param.watch(self._take, "value")
        return dropper

    def _names(self) -> list[str]:
        """Built-in plans, the example and the open plan."""
        known = (*floorplans.builtin_names(), EXAMPLE, self._session.plan.name)
        return list(dict.fromkeys(known))

    def _make_settings(self) -> None:
        self._inputs = {name: number_input(allowed) for name, allowed in RANGES.items()}
        for widget in self._inputs.values():
            widget.param.watch(self._change, "value")
        self._server.param.watch(self._choose_server, "value")
        self._preset.param.watch(self._choose_preset, "value")

    def _choose_server(self, event: Any) -> None:
        if not self._showing and event.new in _servers(self._session.plan).values():
            self._session.choose_server(event.new)

    def _choose_preset(self, event: Any) -> None:
        if not self._showing and event.new in PRESETS:
            session, config = self._session, PRESETS[event.new].config
            session.change_settings(
                replace(session.settings, preset=event.new, max_reflections=config.max_reflections)
            )

    def _choose(self, event: Any) -> None:
        if not self._showing and event.new in floorplans.builtin_names():
            self._session.open_builtin(event.new)
        elif not self._showing and event.new == EXAMPLE:
            self._session.open_example()

    def _take(self, event: Any) -> None:
        """Hand an uploaded file to the session."""
        for name, content in event.new.items():
            data = content.encode() if isinstance(content, str) else content
            self._session.upload(name, data)

    def _change(self, _event: Any) -> None:
        if self._showing or any(widget.value is None for widget in self._inputs.values()):
            return
        try:
            values = checked_values(self._inputs, RANGES)
        except ValueError as error:
            self._session.problem = str(error)
            return
        source_z_m, frequency_ghz = values.pop("source_z_m"), values.pop("frequency_ghz")
        session = self._session
        x, y, z = session.plan.require_source()
        if source_z_m != z:
            session.move_source(x, y, source_z_m)
        session.change_settings(
            replace(session.settings, frequency_hz=frequency_ghz * GIGA, **values)
        )


def _servers(plan: FloorPlan) -> dict[str, str]:
    """Choices of a transmitter: what is shown, and its name."""
    own = {t.id: t.id for t in plan.transmitters}
    return {"source (star)": SOURCE, **own, **({"best of all": ALL} if len(own) > 1 else {})}


def _values(plan: FloorPlan, settings: MapSettings) -> dict[str, float]:
    """Values of the inputs, by name."""
    return {
        "cell_size_m": settings.cell_size_m,
        "height_m": settings.height_m,
        "source_z_m": plan.require_source()[2],
        "max_reflections": settings.max_reflections,
        "power_dbm": settings.power_dbm,
        "frequency_ghz": settings.frequency_hz / GIGA,
    }
