"""What is traced in each plan of a data set: its maps, and what is kept of them."""

from __future__ import annotations

import hashlib
import json
import math
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from raytrace import Antenna, TraceConfig
from raytrace.radio.itu import DEFAULT_EDITION
from raytrace.trace import TRACER_VERSION
from rssnav.transmitters import antenna_of

CONTAINER_VERSION = 1
"""Grows whenever the same maps would be stored in another way."""

Position = tuple[float, float, float]


@dataclass(frozen=True)
class NamedAntenna:
    """An antenna of a spec.

    Attributes
    ----------
    name
        One of `floorplans.transmitters.ANTENNAS`, or the name of a CSV file.
    file
        The CSV file, if it is one, and its hash.
    sha256
        Of the file's content; empty for an antenna with a name.
    """

    name: str
    file: Path | None = None
    sha256: str = ""

    def antenna(self, direction: Position | None = None) -> Antenna:
        """Return the antenna, turned where the plan says so."""
        return antenna_of(self.name if self.file is None else str(self.file), direction)


@dataclass(frozen=True)
class Configuration:
    """What is traced in each plan, and what is kept.

    Attributes
    ----------
    which
        Ids of transmitters; empty for all of a plan.
    power_dbm
        Of every transmitter [dBm].
    frequencies_hz
        Carrier frequencies [Hz].
    antennas
        Of the transmitters.
    receive_antenna
        Of the receivers.
    heights_m
        Of the receivers [m].
    cell_size_m
        Side of a cell [m].
    presets
        Limits of a trace, by name.
    layers
        Names of `raytrace.results.layers.LAYERS` that are kept.
    strongest_paths
        How many paths of each cell are kept.
    edition
        Of ITU-R P.2040.
    """

    which: tuple[str, ...]
    power_dbm: float
    frequencies_hz: tuple[float, ...]
    antennas: tuple[NamedAntenna, ...]
    receive_antenna: NamedAntenna
    heights_m: tuple[float, ...]
    cell_size_m: float
    presets: dict[str, TraceConfig]
    layers: tuple[str, ...]
    strongest_paths: int = 0
    edition: str = DEFAULT_EDITION

    @property
    def maps_a_transmitter(self) -> int:
        """Number of maps of each transmitter."""
        kinds = (self.frequencies_hz, self.antennas, self.heights_m, self.presets)
        return math.prod(map(len, kinds))

    @property
    def key(self) -> str:
        """Hash of all that maps depend on besides the plan, and of the versions that made them."""
        return hash_of({**self.described(), "tracer": TRACER_VERSION, "file": CONTAINER_VERSION})

    def described(self) -> dict[str, Any]:
        """Return all fields as plain values; a pattern file stands for its content."""

        def plain(antenna: NamedAntenna) -> dict[str, str]:
            return {"name": antenna.name, "sha256": antenna.sha256}

        values = asdict(replace(self, presets={}))
        return values | {
            "antennas": [plain(antenna) for antenna in self.antennas],
            "receive_antenna": plain(self.receive_antenna),
            "presets": {name: asdict(config) for name, config in self.presets.items()},
        }


def hash_of(values: Any) -> str:
    """Return the hash of plain values, the same on any machine."""
    text = json.dumps(values, sort_keys=True, ensure_ascii=True)
    return hashlib.sha256(text.encode()).hexdigest()
