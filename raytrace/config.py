"""The limits of a trace."""

import math
from dataclasses import dataclass

MAX_POWER_DBM = 1000.0
MOST_PATHS = 2**63 - 1
_MOST = {"max_reflections": 20, "max_diffractions": 1, "max_transmissions": 20}


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
        for name, most in _MOST.items():
            self._check_integer(name, 0, most)
        if not self.min_power_dbm <= MAX_POWER_DBM:
            raise ValueError(
                f"min_power_dbm = {self.min_power_dbm}: expected at most {MAX_POWER_DBM:g} dBm"
            )
        object.__setattr__(self, "min_power_dbm", float(self.min_power_dbm))
        if self.max_paths is not None:
            self._check_integer("max_paths", 1, MOST_PATHS)

    def _check_integer(self, name: str, least: int, most: int) -> None:
        """Check a whole number, and keep it as int: kernels are compiled for each type."""
        value = getattr(self, name)
        if not (least <= value <= most and value % 1 == 0):
            raise ValueError(f"{name} = {value}: expected an integer from {least} to {most}")
        object.__setattr__(self, name, int(value))
