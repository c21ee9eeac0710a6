"""Bodies of IFC elements in the plan view.

Each body gives its footprint and its lowest and highest point. Extrusions are read directly;
projections of faces are joined; of differences the first operand is used, because what is cut off
walls is openings, which are read separately, and roofs.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import MultiPoint, Polygon
from shapely.geometry.base import BaseGeometry

from floorplans.importers.ifc.curves import (
    MAX_DEPTH,
    Entity,
    UnreadableError,
    curve_points,
    profile_polygon,
    rings,
)

Matrix = NDArray[np.float64]
Floats = NDArray[np.float64]

_FLAT_M2 = 1e-6

_BODY = frozenset({
    "Body", "Facetation", "SweptSolid", "Clipping", "CSG", "Brep", "AdvancedBrep", "SurfaceModel",
    "Tessellation", "MappedRepresentation", "SolidModel",
})  # fmt: skip
"""Identifiers of bodies, and types of bodies without one."""

_AXIS = frozenset({"Axis", "Curve2D"})


@dataclass(frozen=True)
class Scale:
    """Units of the file, and the resolution of arcs.

    Attributes
    ----------
    metre : float
        Length of the file's unit [m].
    radian : float
        The file's unit of angles [rad].
    chord_m : float
        Largest deviation of chords from an arc [m].
    """

    metre: float
    radian: float
    chord_m: float

    @property
    def chord(self) -> float:
        """Largest deviation of chords from an arc, in the file's unit."""
        return self.chord_m / self.metre


class Body(NamedTuple):
    """Footprint and heights of a body in the file's world coordinates [m]."""

    footprint: BaseGeometry
    z_min: float
    z_max: float


def bodies(product: Entity, scale: Scale) -> list[Body]:
    """Readable bodies of an element."""
    found: list[Body] = []
    placement = placement_of(product)
    for item in _items(product, _BODY):
        try:
            found += _bodies_of(item, placement, scale, 0)
        except UnreadableError:
            continue
    return [body for body in found if np.isfinite([*body.footprint.bounds, *body[1:]]).all()]


def axis_points(product: Entity, scale: Scale) -> Floats:
    """Points of an element's axis in the plan view (n, 2) [m]; empty if it has no readable axis."""
    placement = placement_of(product)
    for item in _items(product, _AXIS):
        try:
            points = np.array(curve_points(item, scale.chord, scale.radian), dtype=np.float64)
        except UnreadableError:
            continue
        return scale.metre * _moved(placement, points)[:, :2]
    return np.empty((0, 2))


def placement_of(product: Entity) -> Matrix:
    """Placement in the file's world coordinates (4, 4), in the file's unit."""
    from ifcopenshell.util.placement import get_local_placement

    if product.ObjectPlacement is None:
        return np.eye(4)
    return np.array(get_local_placement(product.ObjectPlacement), dtype=np.float64)


def _items(product: Entity, names: frozenset[str]) -> Iterator[Entity]:
    if product.Representation is None:
        return
    for representation in product.Representation.Representations:
        name = representation.RepresentationIdentifier or representation.RepresentationType
        if name in names:
            yield from representation.Items


def _bodies_of(item: Entity, matrix: Matrix, scale: Scale, depth: int) -> Iterator[Body]:
    if depth > MAX_DEPTH:
        raise UnreadableError(f"{item.is_a()} nested too deep")
    if item.is_a("IfcBooleanResult"):
        yield from _bodies_of(item.FirstOperand, matrix, scale, depth + 1)
    elif item.is_a("IfcMappedItem"):
        from ifcopenshell.util.placement import get_mappeditem_transformation

        inner = matrix @ np.array(get_mappeditem_transformation(item), dtype=np.float64)
        for mapped in item.MappingSource.MappedRepresentation.Items:
            yield from _bodies_of(mapped, inner, scale, depth + 1)
    elif item.is_a("IfcExtrudedAreaSolid"):
        yield _extrusion(item, matrix, scale)
    else:
        yield _of_faces(_faces(item, depth), matrix, scale)


def _extrusion(solid: Entity, matrix: Matrix, scale: Scale) -> Body:
    from ifcopenshell.util.placement import get_axis2placement

    if solid.Position is not None:
        matrix = matrix @ np.array(get_axis2placement(solid.Position), dtype=np.float64)
    along = np.array(solid.ExtrudedDirection.DirectionRatios, dtype=np.float64)
    length = np.linalg.norm(along)
    if not length > 0:
        raise UnreadableError("extrusion without a direction")
    along *= solid.Depth / length
    profile = profile_polygon(solid.SweptArea, scale.chord, scale.radian)
    low = [scale.metre * _moved(matrix, ring) for ring in rings(profile)]
    lift = scale.metre * (matrix[:3, :3] @ along)
    corners = np.concatenate([low[0], low[0] + lift])
    vertical = abs(lift[2]) > 0.999 * np.linalg.norm(lift)
    if vertical and abs(matrix[2, :2]).max() < 1e-3:
        footprint = Polygon(low[0][:, :2], [ring[:, :2] for ring in low[1:]]).buffer(0)
    else:
        footprint = MultiPoint(corners[:, :2]).convex_hull
    return Body(footprint, float(corners[:, 2].min()), float(corners[:, 2].max()))


def _faces(item: Entity, depth: int) -> list[Floats]:
    """Corners (n, 3) of each face of a surface or solid made of faces."""
    if depth > MAX_DEPTH:
        raise UnreadableError(f"{item.is_a()} nested too deep")
    if item.is_a("IfcManifoldSolidBrep"):
        return _faces(item.Outer, depth + 1)
    if item.is_a("IfcConnectedFaceSet"):
        return [_loop(bound.Bound) for face in item.CfsFaces for bound in face.Bounds[:1]]
    if item.is_a("IfcShellBasedSurfaceModel"):
        return [face for shell in item.SbsmBoundary for face in _faces(shell, depth + 1)]
    if item.is_a("IfcFaceBasedSurfaceModel"):
        return [face for shell in item.FbsmFaces for face in _faces(shell, depth + 1)]
    if item.is_a("IfcTessellatedFaceSet"):
        points = np.array(item.Coordinates.CoordList, dtype=np.float64)
        if item.is_a("IfcTriangulatedFaceSet"):
            return [points[np.array(index) - 1] for index in item.CoordIndex]
        return [points[np.array(face.CoordIndex) - 1] for face in item.Faces]
    raise UnreadableError(item.is_a())


def _loop(loop: Entity) -> Floats:
    if not loop.is_a("IfcPolyLoop"):
        raise UnreadableError(loop.is_a())
    return np.array([point.Coordinates for point in loop.Polygon], dtype=np.float64)


def _of_faces(faces: list[Floats], matrix: Matrix, scale: Scale) -> Body:
    if not faces:
        raise UnreadableError("a body without faces")
    placed = [scale.metre * _moved(matrix, face) for face in faces]
    shadows = [Polygon(face[:, :2]).buffer(0) for face in placed if len(face) >= 3]
    footprint = shapely.union_all([shadow for shadow in shadows if shadow.area > _FLAT_M2])
    heights = np.concatenate([face[:, 2] for face in placed])
    if footprint.is_empty:
        footprint = MultiPoint(np.concatenate(placed)[:, :2]).convex_hull
    return Body(footprint, float(heights.min()), float(heights.max()))


def _moved(matrix: Matrix, points: Floats) -> Floats:
    """Points (n, 2) or (n, 3) moved by a matrix; (n, 3)."""
    flat = np.zeros((len(points), 3))
    flat[:, : min(points.shape[1], 3)] = points[:, :3]
    return flat @ matrix[:3, :3].T + matrix[:3, 3]
