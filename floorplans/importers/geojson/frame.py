"""GeoJSON coordinates -> metres in a local frame with a known place on the Earth."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, cast

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.errors import ShapelyError
from shapely.geometry import shape
from shapely.geometry.base import BaseGeometry

from floorplans.errors import PlanError
from floorplans.georeference import GeoOrigin
from floorplans.importers.units import check_size, unit_length

MAX_SIZE_M = 3000.0
"""Largest extent of a building [m]."""

MAX_POINTS = 1_000_000

Points = NDArray[np.float64]


def geometry_of(feature: Mapping[str, Any], index: int) -> BaseGeometry:
    """Return a feature's geometry in the file's coordinates, empty if it has none.

    Raises
    ------
    PlanError
        When it is not a GeoJSON geometry, or a coordinate is missing or not finite.
    """
    place = ("features", index, "geometry")
    geometry = feature.get("geometry")
    if geometry is None:
        return shapely.GeometryCollection()
    try:
        with np.errstate(invalid="ignore"):
            made = shapely.force_2d(shape(cast("dict[str, Any]", geometry)))
    except RecursionError as error:
        raise PlanError("collections are nested too deep", place) from error
    except (KeyError, TypeError, ValueError, AttributeError, IndexError, ShapelyError) as error:
        raise PlanError(f"not a geometry of GeoJSON ({error})", place) from error
    if not np.isfinite(shapely.get_coordinates(made)).all():
        raise PlanError("a coordinate is not a finite number", place)
    return made if made.is_valid else shapely.make_valid(made)


def to_metres(
    geometries: Sequence[BaseGeometry],
    crs: str | None,
    unit: str | None,
    beside: Sequence[BaseGeometry] = (),
) -> tuple[list[BaseGeometry], GeoOrigin | None]:
    """Transform geometries to a local frame in metres.

    Parameters
    ----------
    geometries : sequence of shapely geometries
        In the file's coordinates.
    crs : str or None
        Name of their reference system, "" for none on the Earth, None if the file names none: then
        they are degrees, or metres if they cannot be degrees.
    unit : str or None
        One of `units.UNITS`, for coordinates that are lengths in a plane; overrides `crs`.
    beside : sequence of shapely geometries
        Transformed like the others, without influence on the frame.

    Returns
    -------
    (list of shapely geometry, GeoOrigin or None)
        All in metres, and the place of (0, 0); None if the coordinates were lengths already.
    """
    n_points = sum(shapely.get_num_coordinates(geometry) for geometry in geometries)
    if n_points == 0:
        raise PlanError("no feature has coordinates", ("features",))
    if n_points > MAX_POINTS:
        raise PlanError(f"{n_points} points, at most {MAX_POINTS} are read; cut out one building")
    if unit is not None or crs == "" or (crs is None and not _may_be_degrees(geometries)):
        return _scaled(geometries, unit or "m", beside), None
    degrees = geometries if crs is None else _degrees(geometries, crs)
    _check_degrees(degrees)
    around = beside if crs is None else _degrees(beside, crs)
    x_min, y_min, _, _ = shapely.total_bounds(list(degrees))
    origin = GeoOrigin(round(float(x_min), 9), round(float(y_min), 9))
    return [shapely.transform(g, origin.to_plan) for g in (*degrees, *around)], origin


def _scaled(
    geometries: Sequence[BaseGeometry], unit: str, beside: Sequence[BaseGeometry]
) -> list[BaseGeometry]:
    unit_m = unit_length(unit)
    width, depth = _size(geometries).tolist()
    check_size((width, depth), unit, "coordinates are taken")
    return [shapely.transform(g, lambda points: points * unit_m) for g in (*geometries, *beside)]


def _may_be_degrees(geometries: Sequence[BaseGeometry]) -> bool:
    x_min, y_min, x_max, y_max = shapely.total_bounds(list(geometries))
    return bool(max(-x_min, x_max) <= 180.0 and max(-y_min, y_max) <= 90.0)


def _check_degrees(degrees: Sequence[BaseGeometry]) -> None:
    if not _may_be_degrees(degrees):
        raise PlanError("longitudes lie in -180 to 180, latitudes in -90 to 90 [degrees]", ("crs",))
    latitude = shapely.total_bounds(list(degrees))[1]
    size = _size(degrees) * 111_320.0 * np.array([np.cos(np.radians(latitude)), 1.0])
    if size.max() > MAX_SIZE_M:
        raise PlanError(
            f"the features span {_shown(size)}, taken as longitude and latitude; a building spans "
            f"at most {MAX_SIZE_M / 1000:g} km: if coordinates are metres, give the unit m, "
            "otherwise cut out one building",
            ("unit",),
            remedy="unit",
        )


def _degrees(geometries: Sequence[BaseGeometry], crs: str) -> Sequence[BaseGeometry]:
    """Convert coordinates of a named reference system to longitude and latitude."""
    from pyproj import Transformer
    from pyproj.exceptions import ProjError

    try:
        to_wgs = Transformer.from_crs(crs, "OGC:CRS84", always_xy=True)
    except ProjError as error:
        raise PlanError(f"unknown reference system; {error}", ("crs",), crs) from error
    converted = [
        shapely.transform(g, lambda p: np.column_stack(to_wgs.transform(p[:, 0], p[:, 1])))
        for g in geometries
    ]
    if not all(np.isfinite(shapely.get_coordinates(geometry)).all() for geometry in converted):
        raise PlanError("coordinates lie outside this reference system", ("crs",), crs)
    return converted


def _size(geometries: Sequence[BaseGeometry]) -> Points:
    x_min, y_min, x_max, y_max = shapely.total_bounds(list(geometries))
    return np.array([x_max - x_min, y_max - y_min])


def _shown(size_m: Points) -> str:
    return f"{size_m[0] / 1000:.3g} km x {size_m[1] / 1000:.3g} km"
