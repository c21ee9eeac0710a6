"""A plan as a mesh of sheets with a material per face.

One wall is one double-sided sheet on its centre line; its thickness is in its material. A pair of
faces a wall's thickness apart would trap rays between them. Sheets are cut around openings. No two
triangles share a vertex, so that a vertex has one colour and one normal in every format.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import shapely
import trimesh
from numpy.typing import NDArray
from shapely.geometry import Polygon

from floorplans.unchecked import UncheckedPlan
from floorplans.walls import Panel, Wall, panels

Triangles = NDArray[np.float64]
"""(n, 3, 3): triangle, corner, (x, y, z) [m]."""


class SheetMaterial(NamedTuple):
    """What a sheet is made of: the material's name and its thickness [m]."""

    name: str
    thickness_m: float


@dataclass(frozen=True)
class WallMesh:
    """The sheets of a storey.

    Attributes
    ----------
    mesh : trimesh.Trimesh
        Walls in the plan's order, then floor and ceiling; coordinates in metres, z up. Floor and
        ceiling face the room; the front side of a wall has no meaning.
    face_material : (n_faces,) int64
        Index into `materials`.
    materials : tuple of SheetMaterial
        Those of walls and those of clutter, each once, in order of first use.
    clutter : (n_materials,) bool
        Whether it is the material of clutter, whose edges do not diffract.
    """

    mesh: trimesh.Trimesh
    face_material: NDArray[np.int64]
    materials: tuple[SheetMaterial, ...]
    clutter: NDArray[np.bool_]

    def __repr__(self) -> str:
        """Numbers of triangles and materials in one line."""
        return f"<WallMesh: {len(self.face_material)} triangles, {len(self.materials)} materials>"


def build_mesh(plan: UncheckedPlan) -> WallMesh:
    """Build the sheets of a plan's walls, floor and ceiling.

    Parameters
    ----------
    plan : UncheckedPlan

    Returns
    -------
    WallMesh
    """
    sheets = list(_sheets(plan))
    kinds = {kind: number for number, kind in enumerate(dict.fromkeys(s[:2] for s in sheets))}
    materials = tuple(material for material, _ in kinds)
    indices = np.array([kinds[sheet[:2]] for sheet in sheets], dtype=np.int64)
    face_material = np.repeat(indices, [len(triangles) for _, _, triangles in sheets])
    vertices = np.concatenate([triangles for _, _, triangles in sheets]).reshape(-1, 3)
    mesh = trimesh.Trimesh(
        vertices=vertices,
        faces=np.arange(len(vertices)).reshape(-1, 3),
        face_colors=_colours(plan, materials)[face_material],
        process=False,
    )
    return WallMesh(mesh, face_material, materials, np.array([clutter for _, clutter in kinds]))


def _sheets(plan: UncheckedPlan) -> Iterator[tuple[SheetMaterial, bool, Triangles]]:
    """Material of each sheet, whether it is clutter, and its triangles."""
    for wall in plan.walls:
        for panel in panels(wall):
            material = SheetMaterial(panel.material, panel.thickness_m)
            yield material, wall.kind == "clutter", _panel_triangles(wall, panel)
    floor = slab_triangles(plan.outline, 0.0)
    yield SheetMaterial(plan.floor_material, plan.floor_thickness_m), False, floor
    ceiling = slab_triangles(plan.outline, plan.height_m)[:, ::-1]
    yield SheetMaterial(plan.ceiling_material, plan.ceiling_thickness_m), False, ceiling


def panel_corners(wall: Wall, panel: Panel) -> NDArray[np.float64]:
    """Corners of a wall's panel, in order from the lower corner nearest to the wall's start.

    Returns
    -------
    (4, 3) float64
        (x, y, z) [m].
    """
    near, far = wall.point_at(panel.s_min), wall.point_at(panel.s_max)
    return np.array(
        [(*near, panel.z_min), (*far, panel.z_min), (*far, panel.z_max), (*near, panel.z_max)]
    )


def _panel_triangles(wall: Wall, panel: Panel) -> Triangles:
    return panel_corners(wall, panel)[[[0, 1, 2], [0, 2, 3]]]


def slab_triangles(outline: Polygon, z: float) -> Triangles:
    """Triangles of a floor slab that face upwards; their vertices are the outline's corners."""
    distinct = shapely.remove_repeated_points(outline)  # GEOS fails for corners given many times
    parts = shapely.get_parts(shapely.constrained_delaunay_triangles(distinct))
    rings = [shapely.get_coordinates(shapely.orient_polygons(part))[:3] for part in parts]
    plan_view = np.stack(rings)
    return np.concatenate([plan_view, np.full((*plan_view.shape[:2], 1), z)], axis=2)


def mesh_of(triangles: Triangles) -> trimesh.Trimesh:
    """Mesh of triangles (n, 3, 3) that share no vertex."""
    vertices = triangles.reshape(-1, 3)
    faces = np.arange(len(vertices)).reshape(-1, 3)
    return trimesh.Trimesh(vertices, faces, process=False)


def _colours(plan: UncheckedPlan, materials: tuple[SheetMaterial, ...]) -> NDArray[np.uint8]:
    colours = [bytes.fromhex(plan.colour_of(material.name)[1:]) for material in materials]
    return np.array([(*colour, 255) for colour in colours], dtype=np.uint8)
