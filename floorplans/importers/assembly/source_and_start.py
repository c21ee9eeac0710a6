"""Default positions of source and start."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components, dijkstra
from shapely.geometry import Polygon

from floorplans.walls import Wall, solid_segments

CELL_M = 1.0
FLYING_HEIGHT_M = 2.0
SOURCE_HEIGHT_M = 1.5

_STEPS = ((1, 0), (0, 1), (1, 1), (1, -1))
_START_CLEAR_M = 0.6
"""Least distance of a start from walls [m], where some cell has it."""
_AS_CLEAR_M = 0.15
_OFF_CENTRE_M = 0.3
"""How far a source is from the centre of its cell [m], where a receiver may be: 5 cm or more from
the centres of cells of 0.1, 0.25, 0.5 and 1 m."""
_SOURCE_CLEAR_M = 0.15
"""A source is moved no nearer to a wall than this [m]."""


@dataclass(frozen=True)
class SourceAndStart:
    """Source (x, y) and start (x, y) [m], and the walking distance between them [m]."""

    source: tuple[float, float]
    start: tuple[float, float]
    distance_m: float


def choose_source_and_start(
    outline: Polygon,
    walls: Sequence[Wall],
    height_m: float,
    source: tuple[float, float] | None = None,
) -> SourceAndStart:
    """Choose a source away from walls, and as start the cell with the longest walk to it.

    A chosen source is beside the centre of its cell: a receiver there may be at its height.

    Cells are squares of 1 m that begin at the outline's lower left corner. Walks go in 8 directions
    over the largest connected set of cells, at the height of flights.

    Parameters
    ----------
    outline : shapely.geometry.Polygon
    walls : sequence of Wall
        With their openings.
    height_m : float
        Of the ceiling [m].
    source : (float, float), optional
        A given source [m].

    Returns
    -------
    SourceAndStart
        The start is the centre of a cell.
    """
    solid = solid_segments(walls, min(FLYING_HEIGHT_M, height_m / 2))
    cells, steps = _cells(outline, solid)
    if not len(cells):
        inside = outline.representative_point()
        return SourceAndStart(source or (inside.x, inside.y), (inside.x, inside.y), 0.0)
    clear_m = _clearances(cells, solid)
    _, labels = connected_components(steps, directed=False)
    if source is None:
        among = labels == np.bincount(labels).argmax()
        at = int(np.where(among, clear_m, -1.0).argmax())
        aside = min(_OFF_CENTRE_M, max(float(clear_m[at]) - _SOURCE_CLEAR_M, 0.0))
        source = (float(cells[at][0]) + aside, float(cells[at][1]))
    else:
        at = int(np.hypot(*(cells - np.array(source)).T).argmin())
    distance_m = dijkstra(steps, directed=False, indices=at)
    clearances = np.minimum(clear_m, _START_CLEAR_M)
    away = np.isfinite(distance_m) & (distance_m > 0)
    usable = away & (clearances >= clearances[away].max(initial=0.0) - _AS_CLEAR_M)
    far = int(np.where(usable, distance_m, -1.0).argmax()) if usable.any() else at
    return SourceAndStart(
        source, (float(cells[far][0]), float(cells[far][1])), float(distance_m[far])
    )


def _clearances(cells: NDArray[np.float64], solid: NDArray[np.float64]) -> NDArray[np.float64]:
    """Distance of each cell's centre from the nearest wall [m], (n,); inf without walls."""
    clear_m = np.full(len(cells), np.inf)
    walls = shapely.STRtree(np.array(shapely.linestrings(solid), dtype=np.object_))
    nearest, distance_m = walls.query_nearest(
        shapely.points(cells), return_distance=True, all_matches=False
    )
    clear_m[nearest[0]] = distance_m
    return clear_m


def _cells(outline: Polygon, solid: NDArray[np.float64]) -> tuple[NDArray[np.float64], csr_array]:
    """Centres (n, 2) of the cells inside, and the lengths of the steps between them."""
    x_min, y_min, x_max, y_max = outline.bounds
    x = np.arange(x_min + CELL_M / 2, x_max, CELL_M)
    y = np.arange(y_min + CELL_M / 2, y_max, CELL_M)
    grid = np.stack(np.meshgrid(x, y), axis=-1)
    shapely.prepare(outline)
    inside = np.array(shapely.contains_properly(outline, shapely.points(grid)))
    centres = grid[inside]
    number = np.full(inside.shape, -1)
    number[inside] = np.arange(len(centres))
    pairs = np.concatenate([_neighbours(number, d_x, d_y) for d_x, d_y in _STEPS])
    pairs = pairs[_open(centres[pairs], outline, solid)]
    lengths = np.hypot(*(centres[pairs[:, 0]] - centres[pairs[:, 1]]).T)
    return centres, csr_array((lengths, (pairs[:, 0], pairs[:, 1])), shape=(len(centres),) * 2)


def _open(
    segments: NDArray[np.float64], outline: Polygon, solid: NDArray[np.float64]
) -> NDArray[np.bool_]:
    """Which segments (n, 2, 2) stay in the outline and touch no wall."""
    steps = np.array(shapely.linestrings(segments), dtype=np.object_)
    walls = shapely.STRtree(np.array(shapely.linestrings(solid), dtype=np.object_))
    open_ = np.array(shapely.contains_properly(outline, steps))
    open_[walls.query(steps, predicate="intersects")[0]] = False
    return open_


def _neighbours(number: NDArray[np.int64], d_x: int, d_y: int) -> NDArray[np.int64]:
    """Numbers (n, 2) of the cells of all pairs that lie (d_x, d_y) apart."""
    n_y, n_x = number.shape
    low, high = max(0, -d_y), n_y - max(0, d_y)
    here = number[low:high, : n_x - d_x].ravel()
    there = number[low + d_y : high + d_y, d_x:].ravel()
    both = (here >= 0) & (there >= 0)
    return np.column_stack([here[both], there[both]])
