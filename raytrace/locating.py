"""Where points lie in the plan view, and which edges need a bounce to be met."""

import numpy as np
from numpy.typing import NDArray

from raytrace.kernels.beams import Targets
from raytrace.kernels.compiling import jit
from raytrace.kernels.plan_view import Floats, Ints, PlanView, cross

ON_EDGE_M2 = 1e-9
"""A point is in a cell if it lies no further than this outside, as a cross product [m2]."""


@jit()
def cells_of(view: PlanView, xy: Floats) -> Ints:
    """Cell of each point (n, 2), -1 outside the building; the first one for a point on an edge."""
    cells = np.full(len(xy), -1, np.int64)
    for k in range(len(xy)):
        for c in range(len(view.cell_edges) - 1):
            inside = True
            for e in range(view.cell_edges[c], view.cell_edges[c + 1]):
                x1, y1, x2, y2 = view.ends[e]
                side = cross(x2 - x1, y2 - y1, xy[k, 0] - x1, xy[k, 1] - y1)
                if side < -ON_EDGE_M2:
                    inside = False
                    break
            if inside:
                cells[k] = c
                break
    return cells


def targets_in(view: PlanView, xy: Floats, wanted: NDArray[np.bool_]) -> Targets:
    """Sort points by cell; those outside the building or not wanted are left out."""
    cells = np.where(wanted, cells_of(view, xy), -1)
    order = np.argsort(cells, kind="stable")
    order = order[cells[order] >= 0]
    per_cell = np.bincount(cells[order], minlength=len(view.cell_edges) - 1)
    return Targets(np.concatenate([[0], np.cumsum(per_cell)]), order, xy)


def bounces_needed(view: PlanView, z_low: float, z_high: float) -> Ints:
    """Floor or ceiling reflections that a path between two heights needs at each edge.

    Parameters
    ----------
    view
        The plan view.
    z_low, z_high
        Lowest and highest of the heights at which paths begin, end and are diffracted [m].

    Returns
    -------
    ndarray
        (n_edges, 2): 1 where the band between the heights has no opening to pass, and where it
        has no wall to be reflected by; else 0.
    """
    if z_high - z_low < 2e-6:
        z_low, z_high = z_low - 1e-6, z_high + 1e-6
    open_between = np.zeros(len(view.profile_bins) - 1, bool)
    wall_between = np.zeros_like(open_between)
    for p in range(len(open_between)):
        bottom = 0.0
        for k in range(view.profile_bins[p], view.profile_bins[p + 1]):
            overlaps = min(view.bin_top[k], z_high) - max(bottom, z_low) > 1e-9
            (open_between if view.bin_material[k] < 0 else wall_between)[p] |= overlaps
            bottom = view.bin_top[k]
    needed = np.zeros((len(view.profile), 2), np.int64)
    on_wall = view.profile >= 0
    needed[on_wall, 0] = ~open_between[view.profile[on_wall]]
    needed[on_wall, 1] = ~wall_between[view.profile[on_wall]]
    return needed
