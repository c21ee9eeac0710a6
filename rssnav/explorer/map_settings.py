"""Parameters of a map other than its plan."""

from __future__ import annotations

from dataclasses import dataclass, replace

import floorplans
from floorplans import FloorPlan, PlanError
from raytrace import Grid, TraceConfig, Transmitter
from rssnav.explorer.antenna_choice import AntennaChoice
from rssnav.explorer.transmitters import without_file
from rssnav.maps import CELL_SIZE_M, HEIGHT_M
from rssnav.presets import PRESETS, PresetName, default_preset, with_limits
from rssnav.transmitters import FREQUENCY_HZ, POWER_DBM, SOURCE, Sending

ANTENNA_OF_PRESET: dict[PresetName, str] = {"paper": "dipole", "building": "unpolarised"}
"""Names of the presets' antennas."""
UPRIGHT_DIPOLE = AntennaChoice.of("dipole")


@dataclass(frozen=True)
class MapSettings:
    """Parameters of a map other than its plan.

    Attributes
    ----------
    cell_size_m, height_m : float
        Side of a cell, and height of the receivers above the floor [m].
    max_reflections : int
        Maximum number of reflections on a path.
    max_transmissions : int or None
        Maximum number of walls that a path passes through; None limits paths by their loss.
    power_dbm, frequency_hz : float
        Power [dBm] and carrier frequency [Hz] of transmitters that state none.
    transmit_antenna, receive_antenna : AntennaChoice
        Antenna of transmitters that state none, and of receivers.
    server : str
        The transmitter: "source", the id of one of the plan's, or "all" for the best in each cell.
    """

    cell_size_m: float = CELL_SIZE_M
    height_m: float = HEIGHT_M
    max_reflections: int = TraceConfig.max_reflections
    max_transmissions: int | None = TraceConfig.max_transmissions
    power_dbm: float = POWER_DBM
    frequency_hz: float = FREQUENCY_HZ
    transmit_antenna: AntennaChoice = UPRIGHT_DIPOLE
    receive_antenna: AntennaChoice = UPRIGHT_DIPOLE
    server: str = SOURCE

    def with_preset(self, name: PresetName) -> MapSettings:
        """Return the same settings with the limits and antennas of a preset."""
        config = PRESETS[name].config
        antenna = AntennaChoice.of(ANTENNA_OF_PRESET[name])
        return replace(
            self,
            max_reflections=config.max_reflections,
            max_transmissions=config.max_transmissions,
            transmit_antenna=antenna,
            receive_antenna=antenna,
        )

    @property
    def preset(self) -> PresetName | None:
        """The preset whose limits and antennas these are; None for others."""
        return next((name for name in PRESETS if self.with_preset(name) == self), None)

    def config(self, *, complete: bool) -> TraceConfig:
        """Return the limits of a trace, with or without diffraction."""
        config = TraceConfig(self.max_reflections, int(complete))
        return with_limits(config, {"max_transmissions": self.max_transmissions})

    def check_height(self, plan: FloorPlan) -> None:
        """Raise `PlanError` if the receivers are not between floor and ceiling."""
        if not 0.0 < self.height_m < plan.height_m:
            raise PlanError(
                f"receivers {self.height_m:g} m above the floor: choose a height above 0 and below "
                f"{plan.height_m:g} m, the ceiling's",
                origin=plan.name,
            )

    def grid(self, plan: FloorPlan) -> Grid:
        """Cells over a plan; raise `PlanError` if they are not between floor and ceiling."""
        self.check_height(plan)
        return Grid.over(plan.bounds, self.cell_size_m, self.height_m)

    def transmitter(self, plan: FloorPlan) -> Transmitter:
        """Transmitter at the plan's source, or that of the plan which is chosen."""
        antenna = self.transmit_antenna.antenna
        chosen = next((t for t in plan.transmitters if t.id == self.server), None)
        if chosen is None:
            return Transmitter(plan.require_source(), self.power_dbm, self.frequency_hz, antenna)
        power_dbm, frequency_hz = chosen.power_dbm, chosen.frequency_hz
        return Sending(default_antenna=antenna).transmitter(
            replace(
                without_file(chosen),
                power_dbm=self.power_dbm if power_dbm is None else power_dbm,
                frequency_hz=self.frequency_hz if frequency_hz is None else frequency_hz,
            )
        )

    def transmitters(self, plan: FloorPlan) -> dict[str, Transmitter]:
        """All transmitters of a plan by name."""
        return {t.id: replace(self, server=t.id).transmitter(plan) for t in plan.transmitters}


def preset_of(plan: FloorPlan) -> PresetName:
    """Preset of a plan: built-in ones have opaque walls, as the reproduced paper has."""
    is_builtin = plan.name in floorplans.builtin_names()
    is_own = not is_builtin or floorplans.load(plan.name).walls != plan.walls
    return default_preset("" if is_own else plan.name)
