"""The walls between a transmitter and a receiver."""

import numpy as np

from floorplans import FloorPlan
from floorplans.walls import panels
from raytrace.arrays import Floats, Ints


def walls_crossed(plan: FloorPlan, start: Floats, end: Floats) -> Ints:
    """Count the walls that straight lines cross; open doors and what is above a wall are none.

    Parameters
    ----------
    plan
        The walls.
    start, end
        (n, 3) ends of the lines [m].

    Returns
    -------
    ndarray
        (n,) int64 number of walls and of filled doors and windows.
    """
    count = np.zeros(len(start), dtype=np.int64)
    along = end - start
    for wall in plan.walls:
        (x0, y0), (x1, y1) = wall.start, wall.end
        dx, dy = x1 - x0, y1 - y0
        turn = along[:, 0] * dy - along[:, 1] * dx
        is_parallel = turn == 0.0
        scale = 1.0 / np.where(is_parallel, 1.0, turn)
        t = ((x0 - start[:, 0]) * dy - (y0 - start[:, 1]) * dx) * scale
        s = ((x0 - start[:, 0]) * along[:, 1] - (y0 - start[:, 1]) * along[:, 0]) * scale
        meets = ~is_parallel & (t > 0.0) & (t < 1.0) & (s >= 0.0) & (s < 1.0)
        at, z = s * wall.length_m, start[:, 2] + t * along[:, 2]
        for panel in panels(wall):
            inside = (at >= panel.s_min) & (at < panel.s_max) & (z >= panel.z_min)
            count += meets & inside & (z < panel.z_max)
    return count
