"""The limits of a trace."""

import math
from dataclasses import dataclass

MAX_POWER_DBM = 1000.0
MOST_PATHS = 2**63 - 1
SENSITIVITY_DBM = -120.0
"""A receiver's sensitivity [dBm]."""

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
        coefficient; filled doors and windows are walls. None: as many as `min_power_dbm` allows.
    min_power_dbm
        Paths that are known to be below it are left out, and beams that hold no others are not
        grown; all are kept by default. No path above it is missing, and the map holds a bound on
        the power of all that was left out (`RadioMap.left_out_db`).
    dynamic_range_db
        Beams more than this below the power that is reflected and transmitted to a part of the plan
        anyway, without a diffraction, are not grown into it [dB]; they are by default.
    max_paths
        Maximum number of paths of a whole map: `min_power_dbm` is raised in steps of 1 dB until it
        is met. No limit by default.

    Raises
    ------
    ValueError
        For a limit out of range, and for any number of transmissions without a least power.
    """

    max_reflections: int = 6
    max_diffractions: int = 1
    max_transmissions: int | None = 0
    min_power_dbm: float = -math.inf
    max_paths: int | None = None
    dynamic_range_db: float = math.inf

    def __post_init__(self) -> None:
        """Check the limits; raise ValueError for one out of range."""
        for name, most in _MOST.items():
            if name != "max_transmissions" or self.max_transmissions is not None:
                self._check_integer(name, 0, most)
        if not self.min_power_dbm <= MAX_POWER_DBM:
            raise ValueError(
                f"min_power_dbm = {self.min_power_dbm}: expected at most {MAX_POWER_DBM:g} dBm"
            )
        if not self.dynamic_range_db > 0.0:
            raise ValueError(
                f"dynamic_range_db = {self.dynamic_range_db}: expected a positive number of dB"
            )
        for name in ("min_power_dbm", "dynamic_range_db"):
            object.__setattr__(self, name, float(getattr(self, name)))
        if self.max_transmissions is None and math.isinf(self.min_power_dbm):
            raise ValueError(
                "max_transmissions = None, but min_power_dbm = -inf: expected a power that ends "
                f"the paths, such as {SENSITIVITY_DBM:g} dBm, or a number of transmissions"
            )
        if self.max_paths is not None:
            self._check_integer("max_paths", 1, MOST_PATHS)

    @property
    def is_limited(self) -> bool:
        """Whether a power or a loss limits paths, which then depend on the materials too."""
        return max(self.min_power_dbm, -self.dynamic_range_db) > -math.inf

    @property
    def leaves_out_weak_paths(self) -> bool:
        """Whether paths are left out because of their power, be it to limit their number."""
        return self.is_limited or self.max_paths is not None

    def _check_integer(self, name: str, least: int, most: int) -> None:
        """Check a whole number, and keep it as int: kernels are compiled for each type."""
        value = getattr(self, name)
        if not (least <= value <= most and value % 1 == 0):
            raise ValueError(f"{name} = {value}: expected an integer from {least} to {most}")
        object.__setattr__(self, name, int(value))
