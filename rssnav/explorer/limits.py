"""Limits of the explorer, which serves users who may upload anything."""

from dataclasses import dataclass

import numpy as np

from floorplans import FloorPlan, PlanError
from raytrace import Grid


@dataclass(frozen=True)
class Limits:
    """Limits on uploads, plans and maps.

    Attributes
    ----------
    upload_bytes : int
        Maximum size of a file [bytes].
    walls : int
        Maximum number of straight walls of a plan.
    cells : int
        Maximum number of cells of a map.
    work : int
        Maximum of walls times cells; the time of a map is roughly proportional to it.
    map_s : float
        Time limit for tracing a map [s].
    import_s : float
        Time limit for importing an upload [s].
    import_bytes : int
        Memory limit for importing an upload [bytes].
    """

    upload_bytes: int = 8_000_000
    walls: int = 1500
    cells: int = 40_000
    work: int = 15_000_000
    map_s: float = 300.0
    import_s: float = 60.0
    import_bytes: int = 4_000_000_000

    def check_plan(self, plan: FloorPlan) -> None:
        """Raise `PlanError` for a plan with too many walls."""
        self.check_walls(len(plan.walls), plan.name)

    def check_walls(self, n_walls: int, origin: str) -> None:
        """Raise `PlanError` for too many walls."""
        if n_walls > self.walls:
            raise PlanError(
                f"{n_walls} walls; the explorer accepts plans of at most {self.walls}: leave out "
                "details, or use `rssnav map`, which has no limit",
                origin=origin,
            )

    def check_grid(self, plan: FloorPlan, grid: Grid) -> None:
        """Raise `PlanError` for a map with too many cells, or too many for its plan's walls."""
        n_cells = int(np.prod(grid.shape))
        n_allowed = min(self.cells, self.work // max(len(plan.walls), 1))
        if n_cells > n_allowed:
            finer = grid.cell_size_m * float(np.sqrt(n_cells / n_allowed))
            raise PlanError(
                f"{n_cells} cells of {grid.cell_size_m:g} m; the explorer maps at most {n_allowed} "
                f"with {len(plan.walls)} walls: use cells of at least {finer:.2g} m",
                origin=plan.name,
            )
