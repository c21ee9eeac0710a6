"""Location of points in the plan view."""

import numpy as np

from raytrace.arrays import Bools, Floats, Ints
from raytrace.kernels.beam_hits import Targets, edge_side, most_edges, weight_within
from raytrace.kernels.compiling import jit
from raytrace.kernels.lanes import WIDTH
from raytrace.kernels.plan_view import GRAZING_M, PlanView, slab_at
from raytrace.kernels.rows import enlarged, resized


@jit()
def cells_around(view: PlanView, xy: Floats) -> tuple[Ints, Floats]:
    """Cells that hold points or have them on their border.

    Parameters
    ----------
    view
        The plan view.
    xy
        (n, 2) [m].

    Returns
    -------
    places
        (m, 2) point and cell; a point outside the building is in none, one on a border in all
        around it.
    weight
        (m,) fraction of the point's neighbourhood that is in the cell.
    """
    places, weight = np.empty((1024, 2), np.int64), np.empty((1024, 1))
    normals = np.empty((most_edges(view), 2))
    n = 0
    for k in range(len(xy)):
        for c in range(len(view.cell_edges) - 1):
            touched = 0
            for e in range(view.cell_edges[c], view.cell_edges[c + 1]):
                inside, nx, ny = edge_side(view, e, xy[k, 0], xy[k, 1])
                if inside <= -GRAZING_M:
                    touched = -1
                    break
                if inside < GRAZING_M:
                    normals[touched, 0], normals[touched, 1] = nx, ny
                    touched += 1
            if touched < 0:
                continue
            if n == len(places):
                places, weight = enlarged(places), enlarged(weight)
            places[n, 0], places[n, 1] = k, c
            weight[n, 0] = weight_within(normals, touched)
            n += 1
            if touched == 0:
                break
    return resized(places, n), resized(weight, n)[:, 0]


@jit()
def wall_around(view: PlanView, cells: Ints, place: tuple[float, float, float]) -> int:
    """Edge of one of the cells around a place whose wall the place lies in; -1 for none."""
    x, y, z = place
    for cell in cells:
        for e in range(view.cell_edges[cell], view.cell_edges[cell + 1]):
            inside, _, _ = edge_side(view, e, x, y)
            on_wall = view.profile[e] >= 0 and inside < GRAZING_M
            if on_wall and slab_at(view, view.profile[e], z) >= 0:
                return e
    return -1


def targets_in(view: PlanView, xy: Floats, wanted: Bools) -> Targets:
    """Sort points by cell; those outside the building or not wanted are left out."""
    places, weight = cells_around(view, xy)
    kept = np.flatnonzero(wanted[places[:, 0]] & (weight > 0.0))
    kept = kept[np.argsort(places[kept, 1], kind="stable")]
    per_cell = np.bincount(places[kept, 1], minlength=len(view.cell_edges) - 1)
    number = places[kept, 0]
    x, y = (np.append(column[number], np.zeros(WIDTH)) for column in xy.T)
    return Targets(np.concatenate([[0], np.cumsum(per_cell)]), number, weight[kept], x, y)
