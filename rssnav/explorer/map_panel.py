"""Set source, start and the parameters of the map."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import panel as pn

from floorplans import FloorPlan
from floorplans.transmitters import ALL, ANTENNAS
from rssnav.explorer.antenna_choice import AntennaChoice
from rssnav.explorer.inputs import NARROW, checked_values, flow, heading, number_input, select
from rssnav.explorer.map_settings import MapSettings
from rssnav.explorer.session import Session
from rssnav.explorer.setting_ranges import DIRECTIONS, MAP_NUMBERS, MOST_TRANSMISSIONS, PLACES
from rssnav.presets import PRESETS
from rssnav.transmitters import SOURCE

GIGA = 1e9
BY_LOSS, OWN = "by loss", "own"
"""Values of the selects that no number and no preset stands for."""

TRANSMISSIONS = {str(n): str(n) for n in range(MOST_TRANSMISSIONS + 1)} | {BY_LOSS: BY_LOSS}
MARKED = (("source", "xyz"), ("start", "xy"))
ENDS = {"transmit": "transmit_antenna", "receive": "receive_antenna"}


class MapPanel:
    """Widgets for source, start and the settings of the map.

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
        self._places = {name: number_input(of, NARROW) for name, of in PLACES.items()}
        self._numbers = {name: number_input(of) for name, of in (MAP_NUMBERS | DIRECTIONS).items()}
        self._server, self._preset = select("Transmitter"), select("Preset")
        self._selects = {
            "transmissions": select("Transmissions", TRANSMISSIONS),
            **{
                end: select(f"{end.title()} antenna", {name: name for name in ANTENNAS})
                for end in ENDS
            },
        }
        self._watch()
        self.view = self._laid_out()
        self.show()

    def show(self) -> None:
        """Show the session's source, start and settings."""
        self._showing = True
        plan, settings = self._session.plan, self._session.settings
        self._show_choices(plan, settings)
        for name, value in (_places(plan) | _numbers(settings)).items():
            (self._places | self._numbers)[name].value = value
        self._show_what_applies(plan, settings)
        self._showing = False

    def _show_choices(self, plan: FloorPlan, settings: MapSettings) -> None:
        self._server.options = _servers(plan)
        self._server.value = settings.server
        self._server.visible = bool(plan.transmitters)
        preset = settings.preset or OWN
        self._preset.options = [*PRESETS, *([OWN] if preset == OWN else [])]
        self._preset.value = preset
        most = settings.max_transmissions
        self._selects["transmissions"].value = BY_LOSS if most is None else str(most)
        for end, field in ENDS.items():
            self._selects[end].value = getattr(settings, field).name

    def _show_what_applies(self, plan: FloorPlan, settings: MapSettings) -> None:
        """Disable what the chosen transmitter states itself; hide directions without a use."""
        chosen = next((t for t in plan.transmitters if t.id == settings.server), None)
        for name in ("power_dbm", "frequency_hz", "antenna"):
            stated = chosen is not None and getattr(chosen, name) is not None
            for widget in self._stated_by(name):
                widget.disabled = stated
        for end, field in ENDS.items():
            for name in _directions(end):
                self._numbers[name].visible = getattr(settings, field).has_direction

    def _stated_by(self, field: str) -> list[Any]:
        """Widgets of what a field of a transmitter states."""
        if field == "antenna":
            return [self._selects["transmit"], *map(self._numbers.get, _directions("transmit"))]
        return [self._numbers["power_dbm" if field == "power_dbm" else "frequency_ghz"]]

    def _laid_out(self) -> Any:
        places, numbers, selects = self._places, self._numbers, self._selects
        pairs = (
            (self._server, self._preset),
            (numbers["cell_size_m"], numbers["height_m"]),
            (numbers["max_reflections"], selects["transmissions"]),
            (numbers["power_dbm"], numbers["frequency_ghz"]),
            (selects["transmit"], selects["receive"]),
            *([numbers[name] for name in _directions(end)] for end in ENDS),
        )
        return pn.Column(
            heading("Source and start"),
            *(flow(*(places[f"{mark}_{axis}_m"] for axis in axes)) for mark, axes in MARKED),
            heading("Radio map"),
            *(flow(*pair) for pair in pairs),
            sizing_mode="stretch_width",
        )

    def _watch(self) -> None:
        for widget in (self._places | self._numbers | self._selects).values():
            widget.param.watch(self._change, "value")
        self._server.param.watch(self._choose_server, "value")
        self._preset.param.watch(self._choose_preset, "value")

    def _choose_server(self, event: Any) -> None:
        if not self._showing and event.new in _servers(self._session.plan).values():
            self._session.choose_server(event.new)

    def _choose_preset(self, event: Any) -> None:
        if not self._showing and event.new in PRESETS:
            session = self._session
            session.change_settings(session.settings.with_preset(event.new))

    def _change(self, _event: Any) -> None:
        """Apply the values of all widgets, if all are valid."""
        if self._showing or not self._are_complete():
            return
        try:
            places = checked_values(self._places, PLACES)
            numbers = checked_values(self._numbers, MAP_NUMBERS | DIRECTIONS)
        except ValueError as error:
            self._session.problem = str(error)
            return
        self._session.change(
            self._settings(numbers),
            (places["source_x_m"], places["source_y_m"], places["source_z_m"]),
            (places["start_x_m"], places["start_y_m"]),
        )

    def _are_complete(self) -> bool:
        """Whether every widget has a value that can be chosen."""
        if any(widget.value is None for widget in (self._places | self._numbers).values()):
            return False
        return all(widget.value in widget.options.values() for widget in self._selects.values())

    def _settings(self, numbers: Mapping[str, Any]) -> MapSettings:
        """Return the settings that the widgets state."""
        before, most = self._session.settings, self._selects["transmissions"].value
        own = {name: numbers[name] for name in MAP_NUMBERS if name != "frequency_ghz"}
        antennas = {
            field: _antenna(
                getattr(before, field),
                self._selects[end].value,
                *(numbers[name] for name in _directions(end)),
            )
            for end, field in ENDS.items()
        }
        return replace(
            before,
            frequency_hz=numbers["frequency_ghz"] * GIGA,
            max_transmissions=None if most == BY_LOSS else int(most),
            **own,
            **antennas,
        )


def _antenna(
    before: AntennaChoice, name: str, azimuth_deg: float, elevation_deg: float
) -> AntennaChoice:
    """Return an antenna; another kind points in its usual direction."""
    if name != before.name:
        return AntennaChoice.of(name)
    return AntennaChoice(name, azimuth_deg, elevation_deg)


def _directions(end: str) -> tuple[str, str]:
    """Names of the widgets of an antenna's direction."""
    return f"{end}_azimuth_deg", f"{end}_elevation_deg"


def _servers(plan: FloorPlan) -> dict[str, str]:
    """Choices of a transmitter: what is shown, and its name."""
    own = {t.id: t.id for t in plan.transmitters}
    return {"source (star)": SOURCE, **own, **({"best of all": ALL} if len(own) > 1 else {})}


def _places(plan: FloorPlan) -> dict[str, float]:
    """Values of the coordinates, by name."""
    return dict(zip(PLACES, (*plan.require_source(), *plan.require_start()), strict=True))


def _numbers(settings: MapSettings) -> dict[str, float]:
    """Values of the other numbers, by name."""
    values: dict[str, float] = {
        "cell_size_m": settings.cell_size_m,
        "height_m": settings.height_m,
        "max_reflections": settings.max_reflections,
        "power_dbm": settings.power_dbm,
        "frequency_ghz": settings.frequency_hz / GIGA,
    }
    for end, field in ENDS.items():
        antenna: AntennaChoice = getattr(settings, field)
        angles = antenna.azimuth_deg, antenna.elevation_deg
        values |= zip(_directions(end), angles, strict=True)
    return values
