"""The limits of a trace."""

import math
from dataclasses import dataclass

MAX_POWER_DBM = 1000.0


@dataclass(frozen=True)
class TraceConfig:
    """Limits of a trace.

    Attributes
    ----------
    max_reflections
        Maximum number of reflections on a path: walls, floor and ceiling together, before and
        after a diffraction together.
    max_diffractions
        0 or 1.
    max_transmissions
        Maximum number of walls that a path passes through, each with its transmission
        coefficient; filled doors and windows are walls.
    min_power_dbm
        Paths below it are left out; all are kept by default. The map holds a bound on what was
        left out (`RadioMap.left_out_db`).
    max_paths
        Maximum number of paths of a whole map: `min_power_dbm` is raised in steps of 1 dB until it
        is met. No limit by default.
    """

    max_reflections: int = 6
    max_diffractions: int = 1
    max_transmissions: int = 0
    min_power_dbm: float = -math.inf
    max_paths: int | None = None

    def __post_init__(self) -> None:
        """Check the limits; raise ValueError for one out of range."""
        if not 0 <= self.max_reflections <= 20:
            raise ValueError(f"max_reflections = {self.max_reflections}: expected 0 to 20")
        if self.max_diffractions not in (0, 1):
            raise ValueError(f"max_diffractions = {self.max_diffractions}: expected 0 or 1")
        if not 0 <= self.max_transmissions <= 20:
            raise ValueError(f"max_transmissions = {self.max_transmissions}: expected 0 to 20")
        if not self.min_power_dbm <= MAX_POWER_DBM:
            raise ValueError(
                f"min_power_dbm = {self.min_power_dbm}: expected at most {MAX_POWER_DBM:g} dBm"
            )
        if self.max_paths is not None and self.max_paths < 1:
            raise ValueError(f"max_paths = {self.max_paths}: expected 1 or more, or None")
