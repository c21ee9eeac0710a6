"""Places on a map: source and start of plans that have none, and the cells at points."""

from dataclasses import replace

import numpy as np

from floorplans import FloorPlan
from floorplans.importers.assembly.source_and_start import SOURCE_HEIGHT_M, choose_source_and_start
from raytrace import Grid

Point = tuple[float, float]


def with_source_and_start(plan: FloorPlan) -> FloorPlan:
    """Return a plan with the source and start it lacks.

    The source is the first transmitter; without one it is chosen away from walls, as importers do.
    """
    if plan.source is not None and plan.start is not None:
        return plan
    source = plan.source or next((t.position for t in plan.transmitters), None)
    beside = None if source is None else source[:2]
    places = choose_source_and_start(plan.outline, plan.walls, plan.height_m, beside)
    chosen = source or (*places.source, min(SOURCE_HEIGHT_M, plan.height_m / 2))
    return replace(plan, source=chosen, start=plan.start or places.start)


def nearest_centre(grid: Grid, x: float, y: float) -> Point:
    """Cell centre nearest to a point [m]."""
    i_x, i_y = int(np.argmin(np.abs(grid.x - x))), int(np.argmin(np.abs(grid.y - y)))
    return float(grid.x[i_x]), float(grid.y[i_y])


def cell_at(grid: Grid, x: float, y: float) -> tuple[int, int] | None:
    """Indices (i_y, i_x) of the cell at a point [m]; None outside the grid."""
    i_x, i_y = (
        int(np.floor((at - centres[0]) / grid.cell_size_m + 0.5))
        for at, centres in ((x, grid.x), (y, grid.y))
    )
    return (i_y, i_x) if 0 <= i_x < len(grid.x) and 0 <= i_y < len(grid.y) else None
