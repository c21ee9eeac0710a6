"""The receiver grid of a map and the limits of a trace."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, eq=False)
class Grid:
    """Receivers at the centres of square cells, all at one height.

    Attributes
    ----------
    x, y
        (n_x,), (n_y,) cell centres [m].
    height_m
        Height of the receivers above the floor [m].
    cell_size_m
        Side of a cell [m].
    """

    x: NDArray[np.float64]
    y: NDArray[np.float64]
    height_m: float
    cell_size_m: float

    @classmethod
    def over(
        cls, bounds: tuple[float, float, float, float], cell_size_m: float, height_m: float
    ) -> "Grid":
        """Cover a rectangle with cells, the first one in its lower left corner.

        Parameters
        ----------
        bounds
            (x_min, y_min, x_max, y_max) [m].
        cell_size_m
            Side of a cell [m]. A last row or column that does not fit whole is kept if its
            centre lies inside.
        height_m
            Height of the receivers [m].
        """
        x_min, y_min, x_max, y_max = bounds
        if not (cell_size_m > 0 and x_max > x_min and y_max > y_min):
            raise ValueError(
                f"no grid over bounds {bounds} with cell_size_m = {cell_size_m}: "
                "expected x_min < x_max, y_min < y_max and a positive cell size"
            )
        half = 0.5 * cell_size_m
        n_x = max(1, int(np.floor((x_max - x_min + half) / cell_size_m - 1e-9)))
        n_y = max(1, int(np.floor((y_max - y_min + half) / cell_size_m - 1e-9)))
        return cls(
            x_min + half + cell_size_m * np.arange(n_x, dtype=np.float64),
            y_min + half + cell_size_m * np.arange(n_y, dtype=np.float64),
            float(height_m),
            float(cell_size_m),
        )

    @property
    def shape(self) -> tuple[int, int]:
        """(n_y, n_x)."""
        return len(self.y), len(self.x)

    def points(self) -> NDArray[np.float64]:
        """Receivers (n_y * n_x, 3) [m], x running fastest."""
        xx, yy = np.meshgrid(self.x, self.y)
        return np.column_stack([xx.ravel(), yy.ravel(), np.full(xx.size, self.height_m)])


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
