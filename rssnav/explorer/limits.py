"""How much the explorer takes on: it serves people who may upload anything."""

from dataclasses import dataclass

import numpy as np

from floorplans import FloorPlan, PlanError
from raytrace import Grid


@dataclass(frozen=True)
class Limits:
    """What a plan may ask of the server.

    Attributes
    ----------
    upload_bytes : int
        Size of a file.
    walls : int
        Straight walls of a plan.
    cells : int
        Cells of a map.
    work : int
        Walls times cells, to which the time of a map is about proportional.
    map_s : float
        Time after which the tracing of a map is given up [s].
    reading_s : float
        Time after which the reading of an upload is given up [s].
    reading_bytes : int
        Memory that the reading of an upload may take.
    """

    upload_bytes: int = 8_000_000
    walls: int = 1500
    cells: int = 40_000
    work: int = 15_000_000
    map_s: float = 300.0
    reading_s: float = 60.0
    reading_bytes: int = 4_000_000_000

    def check_plan(self, plan: FloorPlan) -> None:
        """Raise `PlanError` for a plan with too many walls."""
        self.check_walls(len(plan.walls), plan.name)

    def check_walls(self, n_walls: int, origin: str) -> None:
        """Raise `PlanError` for too many walls."""
        if n_walls > self.walls:
            raise PlanError(
                f"{n_walls} walls; the explorer takes plans of at most {self.walls}: leave out "
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
