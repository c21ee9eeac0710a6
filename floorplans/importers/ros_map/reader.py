"""Occupancy grids of ROS map_server, and plain pictures with a scale -> Draft.

Small isolated objects, such as pillars, are kept as the ring around them; everything else becomes
straight walls along the building's directions. Doors are the gaps in the picture.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from io import BytesIO
from math import cos, dist, inf, sin
from pathlib import Path
from typing import TypeVar

import numpy as np
import shapely
from numpy.typing import NDArray
from PIL import Image
from scipy.ndimage import binary_closing, find_objects, label
from shapely.affinity import scale
from shapely.geometry import LineString, MultiPoint, Polygon

from floorplans.errors import PlanError
from floorplans.importers.centrelines.areas import block_walls, box_sides
from floorplans.importers.draft import Draft, ImportOptions, LayerUse, RawWall, walls_along
from floorplans.importers.known_pixels import KnownPixels
from floorplans.importers.original import Affine, DrawnPicture, Original
from floorplans.importers.progress import Report, Step, no_report
from floorplans.importers.ros_map.bridging import bridged
from floorplans.importers.ros_map.known_space import known_region, openings_in_border
from floorplans.importers.ros_map.occupancy_grid import MapMetadata, Mask, OccupancyGrid, read_grid
from floorplans.importers.ros_map.vectorise import walls_of_picture
from floorplans.importers.units import BUILDING_M

TOLERANCE_PX = 1.5
"""Default largest distance of walls from the middle of their pixels [pixels]."""

MAX_OBSTACLE_M = 1.5
"""Largest length of an isolated object that is an obstacle [m]."""

_CLOSING_M = 0.1  # half the width of gaps in walls that count as noise [m]
_SPECK_M, _SPECK_PX = 0.15, 2.0  # largest length of an isolated object that is noise
_PILLAR_M, _PILLAR_PX = 0.2, 4.0  # least width of a pillar, which is no wall however near one is
_SQUAT = 0.35  # width over length above which an isolated object is an obstacle, not a wall
_FILLED, _SMALL_M = 0.6, 0.4  # least filled fraction of an obstacle's hull, from a length on [m]
_BOXY = 0.9  # fraction of the box around it that a box-shaped obstacle fills
_UNSTEADY = 0.4  # fraction of neighbouring pixels of different kinds that is noise
_MANY_PIECES, _PIECES_PER_M = 50, 2.0  # isolated pieces, also per metre of wall, that are noise
_UNKNOWN = 205
"""Grey of unknown space on the page of an import."""
_MOST_MEASURED = 200_000  # pixels that the plan is compared with
_EVERYWHERE = np.ones((3, 3), dtype=np.bool_)
_Shape = TypeVar("_Shape", Polygon, LineString)


@dataclass(frozen=True)
class _Sorted:
    """Pixels of walls, all solid pixels, obstacles [pixels], and the number of specks left out."""

    walls: Mask
    solid: Mask
    obstacles: tuple[Polygon, ...]
    n_specks: int


def read_ros_map(path: Path, options: ImportOptions, report: Report = no_report) -> Draft:
    """Read a YAML file with its picture, or a picture.

    Parameters
    ----------
    path : Path
    options : ImportOptions
        `scale_m` and `tolerance_m` are used.
    report : callable
        Called with finished steps.

    Returns
    -------
    Draft

    Raises
    ------
    PlanError
        When a file cannot be read, or contains no wall.
    """
    grid = read_grid(path, options.scale_m)
    report(Step.FILE_LOADED)
    pixel_m = grid.metadata.resolution_m
    _check_extent(grid.occupied, pixel_m)
    _check_steady(grid)
    tolerance_px = options.tolerance_m / pixel_m if options.tolerance_m else TOLERANCE_PX
    sorted_ = _sort(grid, pixel_m)
    walls = walls_of_picture(sorted_.walls, tolerance_px)
    if not walls:
        raise PlanError("no line of pixels is long enough for a wall; is the scale right?")
    _check_noise(grid, sorted_, walls)
    rings = [side for shape in sorted_.obstacles for side in _ring(shape, min(tolerance_px, 1.0))]
    region = known_region(grid.free, sorted_.solid, pixel_m)
    openings = [] if region is None else list(openings_in_border(region, walls, pixel_m))
    closed = [line for line in openings if _span_m(line, pixel_m) <= _limit_m(options)]
    closing = [wall for line in closed for wall in walls_along(line)]
    frame = grid.metadata
    return Draft(
        name=path.stem,
        walls=tuple(_in_metres(wall, frame) for wall in (*walls, *rings, *closing)),
        outline=None if region is None else _shape_in_metres(region, frame),
        layers=(
            LayerUse("occupied pixels", int(grid.occupied.sum()), f"{len(walls)} walls"),
            LayerUse("obstacles", len(sorted_.obstacles), "rings of walls"),
            LayerUse("specks", sorted_.n_specks, "left out"),
        ),
        closed=tuple(_shape_in_metres(line, frame) for line in closed),
        notes=(*grid.notes, f"straightened with a tolerance of {tolerance_px * pixel_m:.3g} m"),
        known=_known_pixels(grid, region is not None),
        original=Original(picture=_picture(grid)),
    )


def _check_steady(grid: OccupancyGrid) -> None:
    """Reject a picture whose pixels mostly differ from their neighbours."""
    kind = grid.occupied.astype(np.int8) + 2 * grid.free
    changes = [np.diff(kind, axis=axis) != 0 for axis in (0, 1)]
    differ = sum(map(np.count_nonzero, changes)) / max(1, sum(change.size for change in changes))
    if differ > _UNSTEADY:
        raise PlanError(
            f"{100 * differ:.0f} % of the map's pixels differ from the one beside them (occupied, "
            "free or unknown): noise; clean the picture, or look at its thresholds"
        )


def _check_noise(grid: OccupancyGrid, sorted_: _Sorted, walls: list[RawWall]) -> None:
    """Reject a picture of many small pieces that hold most of its occupied pixels."""
    n_pieces = sorted_.n_specks + len(sorted_.obstacles)
    length_m = sum(dist(wall.start, wall.end) for wall in walls) * grid.metadata.resolution_m
    loose = np.count_nonzero(grid.occupied & ~sorted_.walls) > grid.occupied.sum() / 2
    if n_pieces > _MANY_PIECES and n_pieces > _PIECES_PER_M * length_m and loose:
        raise PlanError(
            f"the map shows {n_pieces} isolated small pieces and only {length_m:.3g} m of walls: "
            "noise, or another scale; clean the picture, or give the side of a pixel"
        )


def _limit_m(options: ImportOptions) -> float:
    """Widest opening in the border of known space that is closed: by default any [m]."""
    return inf if options.close_gaps_m is None else options.close_gaps_m


def _span_m(line: LineString, pixel_m: float) -> float:
    return dist(line.coords[0], line.coords[-1]) * pixel_m


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


def _sort(grid: OccupancyGrid, pixel_m: float) -> _Sorted:
    """Separate pillars, close small gaps, and separate walls, other obstacles and specks."""
    pillar_m, speck_m = max(_PILLAR_M, _PILLAR_PX * pixel_m), max(_SPECK_M, _SPECK_PX * pixel_m)
    pieces = _pieces(grid, grid.occupied, pixel_m)
    pillars = [piece for piece in pieces if piece.width_m >= pillar_m and piece.is_obstacle]
    occupied = _without(grid.occupied, pillars)
    reach = max(1, round(_CLOSING_M / pixel_m))
    wide = np.pad(bridged(occupied, pixel_m), reach)
    closed = np.array(binary_closing(wide, _EVERYWHERE, iterations=reach), dtype=np.bool_)
    closed = closed[reach:-reach, reach:-reach]
    pieces = _pieces(grid, closed, pixel_m)
    specks = [piece for piece in pieces if piece.length_m <= speck_m]
    obstacles = [piece for piece in pieces if piece.length_m > speck_m and piece.is_obstacle]
    return _Sorted(
        _without(closed, [*specks, *obstacles]),
        closed | grid.occupied,
        tuple(piece.hull for piece in (*pillars, *obstacles)),
        len(specks),
    )


@dataclass(frozen=True)
class _Piece:
    """An isolated object: where it is, its convex hull [pixels], and the sides of its box."""

    window: tuple[slice, slice]
    pixels: Mask
    hull: Polygon
    width_m: float
    length_m: float

    @property
    def is_obstacle(self) -> bool:
        """Whether it is no piece of wall, which is slender or, as a corner, fills no hull."""
        filled = self.length_m < _SMALL_M or self.pixels.sum() > _FILLED * self.hull.area
        return filled and self.width_m > _SQUAT * self.length_m


def _pieces(grid: OccupancyGrid, solid: Mask, pixel_m: float) -> list[_Piece]:
    """Isolated small objects, with the unknown pixels they enclose."""
    filled = solid | _enclosed(~(solid | grid.free), pixel_m)
    numbers: NDArray[np.int32] = np.empty(filled.shape, dtype=np.int32)
    label(filled, structure=_EVERYWHERE, output=numbers)
    found: list[_Piece] = []
    for number, window in enumerate(find_objects(numbers), 1):
        if max(side.stop - side.start for side in window) * pixel_m > MAX_OBSTACLE_M:
            continue
        pixels = numbers[window] == number
        if (pixels & solid[window]).any():
            hull = _hull(pixels, window[1].start, window[0].start)
            width_m, length_m = (side * pixel_m for side in box_sides(hull))
            found.append(_Piece(window, pixels, hull, width_m, length_m))
    return found


def _without(solid: Mask, pieces: Sequence[_Piece]) -> Mask:
    left = solid.copy()
    for piece in pieces:
        left[piece.window] &= ~piece.pixels
    return left


def _enclosed(unknown: Mask, pixel_m: float) -> Mask:
    """Small unknown areas: the inside of pillars, and what is hidden right behind them."""
    numbers: NDArray[np.int32] = np.empty(unknown.shape, dtype=np.int32)
    label(unknown, output=numbers)
    small = np.zeros_like(unknown)
    for number, window in enumerate(find_objects(numbers), 1):
        if max(side.stop - side.start for side in window) * pixel_m <= MAX_OBSTACLE_M:
            small[window] |= numbers[window] == number
    return small


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


def _matrix(metadata: MapMetadata) -> Affine:
    """From pixels, up from the lower left corner, to the map's frame [m]."""
    x0, y0, yaw = metadata.origin
    a, b = cos(yaw) * metadata.resolution_m, sin(yaw) * metadata.resolution_m
    return ((a, -b, x0), (b, a, y0))


def _points_in_metres(points: NDArray[np.float64], metadata: MapMetadata) -> NDArray[np.float64]:
    matrix = np.array(_matrix(metadata))
    return points @ matrix[:, :2].T + matrix[:, 2]


def _in_metres(wall: RawWall, metadata: MapMetadata) -> RawWall:
    """Transform a wall from pixels to the map's frame."""
    (a, b), (c, d) = _points_in_metres(np.array([wall.start, wall.end]), metadata).tolist()
    thickness_px = wall.thickness_m
    return RawWall(
        (a, b), (c, d), None if thickness_px is None else thickness_px * metadata.resolution_m
    )


def _shape_in_metres(shape: _Shape, metadata: MapMetadata) -> _Shape:
    return shapely.transform(shape, lambda points: _points_in_metres(points, metadata))


def _known_pixels(grid: OccupancyGrid, knows_free: bool) -> KnownPixels:
    """Pixels to measure the plan against; without the free ones of a drawing on white paper."""
    masks = (grid.free if knows_free else np.zeros_like(grid.free), grid.occupied)
    free, occupied = (np.argwhere(mask)[:, ::-1].astype(np.float64) + 0.5 for mask in masks)
    some = [pixels[:: len(pixels) // _MOST_MEASURED + 1] for pixels in (free, occupied)]
    metres = [_points_in_metres(pixels, grid.metadata) for pixels in some]
    pixel_m = grid.metadata.resolution_m
    return KnownPixels(metres[0], metres[1], pixel_m, len(free) * pixel_m**2)


def _picture(grid: OccupancyGrid) -> DrawnPicture:
    """The map as it was classified: black walls on white free and grey unknown space.

    Without the margins of unknown space, which are often most of the picture.
    """
    values = np.where(grid.occupied, 0, np.where(grid.free, 255, _UNKNOWN)).astype(np.uint8)
    rows, columns = (np.flatnonzero((values != _UNKNOWN).any(axis=axis)) for axis in (1, 0))
    first_y, first_x = rows[0], columns[0]
    values = values[first_y : rows[-1] + 1, first_x : columns[-1] + 1][::-1]
    file = BytesIO()
    Image.fromarray(values).save(file, "PNG", optimize=True)
    (a, b, c), (d, e, f) = _matrix(grid.metadata)
    n_y, n_x = values.shape
    x, top = float(first_x), float(first_y + n_y)
    to_m = ((a, -b, c + a * x + b * top), (d, -e, f + d * x + e * top))
    return DrawnPicture(file.getvalue(), (n_x, n_y), to_m)
