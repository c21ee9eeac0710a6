"""The limits of a trace."""

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class TraceConfig:
    """How far the tracer goes.

    Attributes
    ----------
    max_reflections
        Most reflections on a path, walls, floor and ceiling together, also on a path with a
        diffraction (there on both sides of the edge together).
    max_diffractions
        0 or 1.
    max_transmissions
        Most walls that a path goes through, straight on, with the slabs' transmission; doors and
        windows that are filled are walls.
    min_power_dbm
        Paths that are known to arrive with less are left out; all are kept by default. The map
        then holds a bound on what was left out (`RadioMap.left_out_db`).
    max_paths
        The most paths that are looked at for a whole map: `min_power_dbm` is raised, 1 dB at a
        time, until it is kept. No limit by default.
    """

    max_reflections: int = 6
    max_diffractions: int = 1
    max_transmissions: int = 0
    min_power_dbm: float = -math.inf
    max_paths: int | None = None

    def __post_init__(self) -> None:
        """Check the limits; raise ValueError where one cannot be."""
        if not 0 <= self.max_reflections <= 20:
            raise ValueError(f"max_reflections = {self.max_reflections}: expected 0 to 20")
        if self.max_diffractions not in (0, 1):
            raise ValueError(f"max_diffractions = {self.max_diffractions}: expected 0 or 1")
        if not 0 <= self.max_transmissions <= 20:
            raise ValueError(f"max_transmissions = {self.max_transmissions}: expected 0 to 20")
        if math.isnan(self.min_power_dbm):
            raise ValueError("min_power_dbm is not a number: expected a level in dBm")
        if self.max_paths is not None and self.max_paths < 1:
            raise ValueError(f"max_paths = {self.max_paths}: expected 1 or more, or None")
