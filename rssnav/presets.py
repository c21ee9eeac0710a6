"""Sets of tracing parameters that belong together."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import floorplans
from raytrace import Antenna, HalfWaveDipole, Isotropic, TraceConfig
from raytrace.config import SENSITIVITY_DBM

PresetName = Literal["paper", "building"]


@dataclass(frozen=True)
class Preset:
    """Limits of a trace, and the antennas at both ends.

    Attributes
    ----------
    config : TraceConfig
    antenna : Antenna
        Of transmitters without one of their own, and of receivers.
    """

    config: TraceConfig
    antenna: Antenna


PRESETS: dict[PresetName, Preset] = {
    "paper": Preset(TraceConfig(6, 1, 0), HalfWaveDipole()),
    "building": Preset(TraceConfig(3, 1, 3), Isotropic(polarisation="mean")),
}
"""``paper`` has opaque walls and vertical dipoles, as the reproduced paper has; ``building`` lets
waves through walls, and knows nothing of the antennas."""


BY_LOSS = {"min_power_dbm": SENSITIVITY_DBM, "dynamic_range_db": 25.0}
"""Limits of a trace whose transmissions have no maximum number."""


def default_preset(plan: str) -> PresetName:
    """Return the preset of a plan as commands name it: built-in ones are those of the paper."""
    return "paper" if plan in floorplans.builtin_names() else "building"
