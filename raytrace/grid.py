"""The receiver grid of a map."""

import math
from dataclasses import dataclass

import numpy as np

from raytrace.arrays import Floats
from raytrace.errors import SceneError

_SAME_PLACE_M = 1e-9

MAX_CELLS = 10**8
"""Most cells of a grid; the sums over paths of so many take some 10 GB."""


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

    x: Floats
    y: Floats
    height_m: float
    cell_size_m: float

    def __repr__(self) -> str:
        """Cells and heights in one line."""
        return (
            f"<Grid: {len(self.x)} x {len(self.y)} cells of {self.cell_size_m:g} m, from "
            f"({self.x[0]:g}, {self.y[0]:g}), {self.height_m:g} m above the floor>"
        )

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
            Side of a cell [m]. A last row or column that fits only in part is kept if its centre
            lies inside.
        height_m
            Height of the receivers [m].

        Raises
        ------
        ValueError
            Where the numbers make no grid.
        SceneError
            For one of more than `MAX_CELLS`.
        """
        if np.shape(bounds) != (4,) or not np.isfinite((*bounds, cell_size_m, height_m)).all():
            raise ValueError(
                f"bounds {bounds}, cell_size_m = {cell_size_m}, height_m = {height_m}: "
                "expected finite numbers, four of them bounds"
            )
        x_min, y_min, x_max, y_max = bounds
        if not (cell_size_m > 0 and x_max > x_min and y_max > y_min):
            raise ValueError(
                f"no grid over bounds {bounds} with cell_size_m = {cell_size_m}: "
                "expected x_min < x_max, y_min < y_max and a positive cell size"
            )
        n_cells = (x_max - x_min) / cell_size_m * ((y_max - y_min) / cell_size_m)
        if n_cells > MAX_CELLS:
            least_m = math.sqrt((x_max - x_min) * (y_max - y_min) / MAX_CELLS)
            raise SceneError(
                f"cell_size_m = {cell_size_m:g} makes {n_cells:.3g} cells: expected at most "
                f"{MAX_CELLS}, so cells of {least_m:.2g} m or more"
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

    def points(self) -> Floats:
        """Receivers (n_y * n_x, 3) [m], x running fastest."""
        xx, yy = np.meshgrid(self.x, self.y)
        return np.column_stack([xx.ravel(), yy.ravel(), np.full(xx.size, self.height_m)])

    def same_as(self, other: "Grid") -> bool:
        """Return whether another grid has the same receivers, to a nanometre."""
        return (
            self.shape == other.shape
            and bool(np.allclose(self.x, other.x, rtol=0.0, atol=_SAME_PLACE_M))
            and bool(np.allclose(self.y, other.y, rtol=0.0, atol=_SAME_PLACE_M))
            and (self.height_m, self.cell_size_m) == (other.height_m, other.cell_size_m)
        )
