"""Occupancy grids of ROS map_server, and plain pictures with a scale -> Draft.

Small isolated objects, such as pillars, are kept as the ring around them; everything else becomes
straight walls along the building's directions. Doors are the gaps in the picture.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, sin
from pathlib import Path

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy.ndimage import binary_closing, find_objects, label
from shapely.affinity import scale
from shapely.geometry import LineString, MultiPoint, Polygon

from floorplans.errors import PlanError
from floorplans.importers.centrelines.areas import block_walls, box_sides
from floorplans.importers.draft import Draft, ImportOptions, LayerUse, RawWall
from floorplans.importers.ros_map.occupancy_grid import MapMetadata, Mask, read_grid
from floorplans.importers.ros_map.vectorise import walls_of_picture
from floorplans.importers.units import BUILDING_M

TOLERANCE_PX = 1.5
"""Default largest distance of walls from the middle of their pixels [pixels]."""

MAX_OBSTACLE_M = 1.5
"""Largest length of an isolated object that is an obstacle [m]."""

_CLOSING_M = 0.1  # half the width of gaps in walls that count as noise [m]
_SPECK_M = 0.15  # largest length of an isolated object that is noise [m]
_SQUAT = 0.35  # width over length above which an isolated object is an obstacle, not a wall
_BOXY = 0.9  # fraction of the box around it that a box-shaped obstacle fills
_EVERYWHERE = np.ones((3, 3), dtype=np.bool_)


@dataclass(frozen=True)
class _Sorted:
    """Pixels of walls, shapes of obstacles [pixels], and the number of specks left out."""

    walls: Mask
    obstacles: tuple[Polygon, ...]
    n_specks: int


def read_ros_map(path: Path, options: ImportOptions) -> Draft:
    """Read a YAML file with its picture, or a picture.

    Parameters
    ----------
    path : Path
    options : ImportOptions
        `scale_m` and `tolerance_m` are used.

    Returns
    -------
    Draft

    Raises
    ------
    PlanError
        When a file cannot be read, or contains no wall.
    """
    grid = read_grid(path, options.scale_m)
    pixel_m = grid.metadata.resolution_m
    _check_extent(grid.occupied, pixel_m)
    tolerance_px = options.tolerance_m / pixel_m if options.tolerance_m else TOLERANCE_PX
    sorted_ = _sort(grid.occupied, pixel_m)
    walls = walls_of_picture(sorted_.walls, tolerance_px)
    if not walls:
        raise PlanError("no line of pixels is long enough for a wall; is the scale right?")
    rings = [side for shape in sorted_.obstacles for side in _ring(shape, min(tolerance_px, 1.0))]
    return Draft(
        name=path.stem,
        walls=tuple(_in_metres(wall, grid.metadata) for wall in (*walls, *rings)),
        layers=(
            LayerUse("occupied pixels", int(grid.occupied.sum()), f"{len(walls)} walls"),
            LayerUse("obstacles", len(sorted_.obstacles), "rings of walls"),
            LayerUse("specks", sorted_.n_specks, "left out"),
        ),
        notes=(
            *grid.notes,
            _deviation(sorted_.walls & grid.occupied, walls, tolerance_px, pixel_m),
        ),
    )


def _check_extent(occupied: Mask, pixel_m: float) -> None:
    """Reject a scale at which the drawing is too large or too small for a building."""
    rows, columns = np.nonzero(occupied)
    width_m, depth_m = float(np.ptp(columns) + 1) * pixel_m, float(np.ptp(rows) + 1) * pixel_m
    low_m, high_m = BUILDING_M
    if not low_m <= max(width_m, depth_m) <= high_m:
        raise PlanError(
            f"with pixels of {pixel_m:g} m, the walls cover {width_m:.3g} m x {depth_m:.3g} m, "
            "too large or too small for a building; give the side of a pixel, such as 0.05 m",
            ("resolution",),
            pixel_m,
            remedy="scale_m",
        )


def _sort(occupied: Mask, pixel_m: float) -> _Sorted:
    """Close small gaps, and separate walls, obstacles and specks."""
    reach = max(1, round(_CLOSING_M / pixel_m))
    wide = np.pad(occupied, reach)
    closed = np.array(binary_closing(wide, _EVERYWHERE, iterations=reach), dtype=np.bool_)
    closed = closed[reach:-reach, reach:-reach]
    numbers: NDArray[np.int32] = np.empty(closed.shape, dtype=np.int32)
    label(closed, structure=_EVERYWHERE, output=numbers)
    walls = closed.copy()
    obstacles: list[Polygon] = []
    n_specks = 0
    for number, window in enumerate(find_objects(numbers), 1):
        if max(side.stop - side.start for side in window) * pixel_m > MAX_OBSTACLE_M:
            continue
        alone = numbers[window] == number
        hull = _hull(alone, window[1].start, window[0].start)
        width_px, length_px = box_sides(hull)
        if length_px * pixel_m <= _SPECK_M:
            n_specks += 1
        elif width_px > _SQUAT * length_px:
            obstacles.append(hull)
        else:
            continue
        walls[window] &= ~alone
    return _Sorted(walls, tuple(obstacles), n_specks)


def _hull(alone: Mask, x: int, y: int) -> Polygon:
    """Convex hull of pixels, whose lower left one is (x, y) [pixels]."""
    rows, columns = np.nonzero(alone)
    corners = np.concatenate(
        [np.column_stack([columns + i, rows + j]) for i in (0, 1) for j in (0, 1)]
    )
    hull = MultiPoint(corners + np.array([x, y])).convex_hull
    assert isinstance(hull, Polygon)
    return hull


def _ring(hull: Polygon, tolerance_px: float) -> list[RawWall]:
    """Return the walls around an obstacle: a box, or a polygon of the same area as its hull."""
    box = shapely.oriented_envelope(hull)
    if isinstance(box, Polygon) and hull.area > _BOXY * box.area:
        return block_walls(box)
    simple = hull.simplify(tolerance_px)
    grown = scale(simple, *[float(np.sqrt(hull.area / simple.area))] * 2, origin=hull.centroid)
    return block_walls(Polygon(shapely.get_coordinates(grown)))


def _in_metres(wall: RawWall, metadata: MapMetadata) -> RawWall:
    """Transform a wall from pixels to the map's frame."""
    x0, y0, yaw = metadata.origin
    turn = np.array([[cos(yaw), sin(yaw)], [-sin(yaw), cos(yaw)]]) * metadata.resolution_m
    (a, b), (c, d) = (np.array([wall.start, wall.end]) @ turn + np.array([x0, y0])).tolist()
    return RawWall((a, b), (c, d), (wall.thickness_m or 1.0) * metadata.resolution_m)


def _deviation(
    solid: NDArray[np.bool_], walls: list[RawWall], tolerance_px: float, pixel_m: float
) -> str:
    """Describe how far the walls' pixels lie outside the walls."""
    pixels = shapely.points(np.argwhere(solid)[:, ::-1] + 0.5)
    bodies = [
        LineString([wall.start, wall.end]).buffer((wall.thickness_m or 1.0) / 2) for wall in walls
    ]
    away_px = np.array(shapely.distance(pixels, shapely.union_all(bodies)))
    return (
        f"straightened with a tolerance of {tolerance_px * pixel_m:.3g} m: 99 % of the pixels lie "
        f"within {np.percentile(away_px, 99) * pixel_m:.2f} m of their wall, all within "
        f"{away_px.max() * pixel_m:.2f} m"
    )
