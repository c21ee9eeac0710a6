"""FloorPlan -> occupancy grid of ROS map_server: a PGM picture and its YAML file."""

from __future__ import annotations

from collections import Counter
from math import inf
from pathlib import Path

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import LineString
from shapely.geometry.base import BaseGeometry

from floorplans.errors import PlanError
from floorplans.exporters.formats import ExportOptions, Files
from floorplans.plan import FloorPlan
from floorplans.walls import solid_intervals

MAX_PIXELS = 100_000_000
OCCUPIED, UNKNOWN, FREE = 0, 205, 254
"""Pixel values, as map_server's map_saver writes them."""

_MARGIN_M = 0.5
_SLICE_M = 1.0


def render_ros_map(plan: FloorPlan, path: Path, options: ExportOptions) -> Files:
    """Render a horizontal section of a plan, walls with their thickness.

    Parameters
    ----------
    plan : FloorPlan
    path : Path
        Of the YAML file or of the picture; the other gets the same name.
    options : ExportOptions
        `resolution_m` and `slice_height_m` are used.

    Returns
    -------
    Files

    Raises
    ------
    PlanError
        When the resolution or the height is invalid, or the picture would be too large.
    """
    slice_m = options.slice_height_m
    height_m = min(_SLICE_M, plan.height_m / 2) if slice_m is None else slice_m
    if not 0 <= height_m <= plan.height_m:
        raise PlanError(f"expected 0 to {plan.height_m:g} [m]", ("slice_height_m",), slice_m)
    if not 0 < options.resolution_m < inf:
        raise PlanError("expected a length above 0 [m]", ("resolution_m",), options.resolution_m)
    values, corner = _pixels(plan, height_m, options.resolution_m)
    header = f"P5\n# {path.stem}, section {height_m:g} m above the floor\n"
    header += f"{values.shape[1]} {values.shape[0]}\n255\n"
    names = [path.with_suffix(ending).name for ending in (".yaml", ".pgm")]
    contents = [
        _yaml(names[1], options.resolution_m, corner).encode(),
        header.encode("ascii", "replace") + values[::-1].tobytes(),
    ]
    files = dict(zip(names, contents, strict=True))
    return {path.name: files[path.name], **files}


def _pixels(
    plan: FloorPlan, height_m: float, pixel_m: float
) -> tuple[NDArray[np.uint8], tuple[float, float]]:
    """Return the picture's values (n_y, n_x), bottom row first, and its lower left corner [m]."""
    bodies = _in_drawing(plan, shapely.union_all(_bodies(plan, height_m, pixel_m)))
    outline = _in_drawing(plan, plan.outline)
    x_min, y_min, x_max, y_max = shapely.total_bounds([outline, bodies])
    corner = (float(x_min) - _MARGIN_M, float(y_min) - _MARGIN_M)
    sides_m = np.array([x_max - x_min, y_max - y_min]) + 2 * _MARGIN_M
    n_x, n_y = np.ceil(sides_m / pixel_m).tolist()
    if not n_x * n_y <= MAX_PIXELS:
        raise PlanError(
            f"a picture of {n_x:.3g} x {n_y:.3g} pixels is larger than {MAX_PIXELS:.3g} pixels; "
            "use larger pixels",
            ("resolution_m",),
            pixel_m,
        )
    x, y = (
        np.array(low + (np.arange(int(n)) + 0.5) * pixel_m, dtype=np.float64)
        for low, n in zip(corner, (n_x, n_y), strict=True)
    )
    values = np.where(_covered(outline, x, y), FREE, UNKNOWN).astype(np.uint8)
    values[_covered(bodies, x, y)] = OCCUPIED
    return values, corner


def _in_drawing(plan: FloorPlan, geometry: BaseGeometry) -> BaseGeometry:
    """Turn a geometry back to the drawing that the plan was imported from."""
    return geometry if plan.frame is None else shapely.transform(geometry, plan.frame.to_drawing)


def _bodies(plan: FloorPlan, height_m: float, pixel_m: float) -> list[BaseGeometry]:
    """Solid sections of walls, at least as thick as a pixel's diagonal, and columns."""
    n_ends = Counter(end for wall in plan.walls for end in (wall.start, wall.end))
    bodies: list[BaseGeometry] = []
    for wall in plan.walls:
        half_m = max(wall.thickness_m, 1.5 * pixel_m) / 2
        for low, high in solid_intervals(wall, height_m):
            first = low - half_m if low == 0 and n_ends[wall.start] > 1 else low
            at_end = high >= wall.length_m and n_ends[wall.end] > 1
            last = wall.length_m + half_m if at_end else high
            line = LineString([wall.point_at(first), wall.point_at(last)])
            bodies.append(line.buffer(half_m, cap_style="flat"))
    return bodies + [region.polygon for region in plan.solid_regions if height_m <= region.top_m]


def _covered(
    area: BaseGeometry, x: NDArray[np.float64], y: NDArray[np.float64]
) -> NDArray[np.bool_]:
    """Which points of a grid lie in an area, (n_y, n_x)."""
    shapely.prepare(area)
    return np.array([shapely.contains_xy(area, x, row) for row in y], dtype=np.bool_)


def _yaml(image: str, resolution_m: float, corner: tuple[float, float]) -> str:
    x, y = (round(c, 9) for c in corner)
    return (
        f"image: {image}\nresolution: {resolution_m!r}\norigin: [{x!r}, {y!r}, 0.0]\nnegate: 0\n"
        "occupied_thresh: 0.65\nfree_thresh: 0.196\nmode: trinary\n"
    )
