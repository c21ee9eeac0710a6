"""The paths to a cell: their powers, phases and angles, and a table of them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.colors import to_hex
from numpy.typing import NDArray

from floorplans import FloorPlan
from raytrace import Paths, PathStatistics
from rssnav.explorer.map_settings import MapSettings
from rssnav.pictures.paths import path_lines

Position = tuple[float, float, float]
TOP = 12
"""Number of paths that are listed and drawn."""
PATH_COLOURS = "YlOrRd"
PATH_RANGE_DB = 30.0
"""Paths this much weaker than the strongest have the lightest colour."""


@dataclass(frozen=True, eq=False)
class CellPaths:
    """Every path to the centre of a cell.

    Attributes
    ----------
    plan : FloorPlan
    settings : MapSettings
    receiver : (float, float, float)
        Centre of the cell [m].
    paths : Paths
        n of them, strongest first.
    """

    plan: FloorPlan
    settings: MapSettings
    receiver: Position
    paths: Paths

    @property
    def power_dbm(self) -> NDArray[np.float64]:
        """(n,) power of each path [dBm]."""
        return self.sent_dbm + self.paths.gain_db

    @property
    def sent_dbm(self) -> float:
        """Power of the transmitter [dBm]."""
        return self.settings.transmitter(self.plan).power_dbm

    @property
    def phase_deg(self) -> NDArray[np.float64] | None:
        """(n,) phase of each gain [deg], -180 to 180; None where a polarisation is unknown."""
        if self.paths.pair_gains is not None:
            return None
        return np.degrees(np.angle(self.paths.gain))

    @property
    def departure_deg(self) -> NDArray[np.float64]:
        """(n, 2) azimuth and elevation in which each path leaves the transmitter [deg]."""
        return _azimuth_and_elevation(self.paths.departure)

    @property
    def arrival_deg(self) -> NDArray[np.float64]:
        """(n, 2) azimuth and elevation from which each path reaches the receiver [deg]."""
        return _azimuth_and_elevation(self.paths.arrival)

    @cached_property
    def statistics(self) -> PathStatistics:
        """Statistics of the paths at the receiver."""
        return PathStatistics.of(self.paths, self.sent_dbm, 1)

    def columns(self, most: int) -> dict[str, NDArray[Any] | list[str]]:
        """Table of the strongest paths, at most so many: power, phase, `Paths.columns`."""
        chosen = CellPaths(self.plan, self.settings, self.receiver, self.paths.strongest(most))
        phase = chosen.phase_deg
        return {
            "power_dbm": chosen.power_dbm,
            **({} if phase is None else {"phase_deg": phase}),
            **chosen.paths.columns(),
        }


def strongest(found: CellPaths) -> list[NDArray[np.float64]]:
    """Vertices (n_i, 3) [m] of the strongest paths, both ends included."""
    return path_lines(found.paths.strongest(TOP))


def path_colours(power_dbm: NDArray[np.float64]) -> list[str]:
    """Colour of each path (n,), dark for the strongest, light 30 dB below it."""
    if not power_dbm.size:
        return []
    weakness = np.clip((power_dbm.max() - power_dbm) / PATH_RANGE_DB, 0.0, 1.0)
    return [to_hex(colour) for colour in colormaps[PATH_COLOURS](0.95 - 0.7 * weakness)]


def _azimuth_and_elevation(angles: NDArray[np.float64]) -> NDArray[np.float64]:
    """Azimuth and elevation (n, 2) [deg] of azimuth and zenith angle (n, 2) [rad]."""
    return np.column_stack([np.degrees(angles[:, 0]), 90.0 - np.degrees(angles[:, 1])])
