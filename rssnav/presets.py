"""Sets of tracing parameters that belong together."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, Literal

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


RANGE_DB = 15.0
"""Paths further than this below what is reflected and transmitted to a receiver are left out of
maps of buildings, which costs 0.3 to 0.7 dB and saves most of the time (docs/performance.md)."""

BY_LOSS: dict[str, Any] = {"min_power_dbm": SENSITIVITY_DBM, "dynamic_range_db": RANGE_DB}
"""Limits of a trace whose transmissions have no maximum number."""

BY_NUMBER: dict[str, Any] = {"min_power_dbm": -math.inf, "dynamic_range_db": math.inf}
"""The same of one whose transmissions have."""

PRESETS: dict[PresetName, Preset] = {
    "paper": Preset(TraceConfig(6, 1, 0), HalfWaveDipole()),
    "building": Preset(TraceConfig(3, 1, None, **BY_LOSS), Isotropic(polarisation="mean")),
}
"""``paper`` has opaque walls and vertical dipoles, as the reproduced paper has; ``building`` lets
waves through any number of walls, and knows nothing of the antennas."""


def with_limits(config: TraceConfig, given: Mapping[str, Any]) -> TraceConfig:
    """Return limits of a trace with some others.

    A number of transmissions goes with no limit by loss, and no number (None) with one, unless that
    is given too.
    """
    if "max_transmissions" in given:
        limits = BY_LOSS if given["max_transmissions"] is None else BY_NUMBER
        given = {**limits, **given}
    return replace(config, **given)


def default_preset(plan: str) -> PresetName:
    """Return the preset of a plan as commands name it: built-in ones are those of the paper."""
    return "paper" if plan in floorplans.builtin_names() else "building"
