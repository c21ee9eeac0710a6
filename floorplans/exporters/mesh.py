"""A plan's sheets as GLB, PLY, STL or OBJ, for Blender, MeshLab or another ray tracer."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
import trimesh
from trimesh.exchange.gltf import export_glb
from trimesh.exchange.ply import export_ply
from trimesh.exchange.stl import export_stl_ascii

from floorplans.exporters.formats import ExportOptions, Files
from floorplans.mesh import SheetMaterial, Triangles, WallMesh, mesh_of
from floorplans.pictures.viewer_3d import add_triangles
from floorplans.plan import FloorPlan


class Sheet(NamedTuple):
    """All sheets of one part of the building and one material.

    Attributes
    ----------
    part : str
        "walls", "floor" or "ceiling".
    material : SheetMaterial
    triangles : (n, 3, 3) float64
        Triangle, corner, (x, y, z) [m], z up.
    """

    part: str
    material: SheetMaterial
    triangles: Triangles

    @property
    def name(self) -> str:
        """Part, material and thickness: "walls brick 300 mm"."""
        return f"{self.part} {self.material.name} {1000 * self.material.thickness_m:.4g} mm"


def mesh_in_drawing(plan: FloorPlan, *, single_precision: bool) -> WallMesh:
    """Mesh of a plan in the coordinates of the drawing it was imported from, if any.

    Single precision leaves out a position that it could not hold to the millimetre.
    """
    walls = plan.to_mesh()
    if plan.frame is not None:
        walls.mesh.apply_transform(plan.frame.matrix(single_precision=single_precision))
    return walls


def sheets(plan: FloorPlan, *, single_precision: bool = True) -> Iterator[Sheet]:
    """Yield the sheets of a plan: walls by material and thickness, then floor and ceiling."""
    walls = mesh_in_drawing(plan, single_precision=single_precision)
    triangles = np.asarray(walls.mesh.triangles, dtype=np.float64)
    is_wall = np.ptp(triangles[:, :, 2], axis=1) > 0.0
    for index, material in enumerate(walls.materials):
        mine = is_wall & (walls.face_material == index)
        if mine.any():
            yield Sheet("walls", material, triangles[mine])
    heights = triangles[:, :, 2].max(axis=1)
    for part, height_m in (("floor", 0.0), ("ceiling", plan.height_m)):
        mine = ~is_wall & (heights == height_m)
        material = walls.materials[int(walls.face_material[mine][0])]
        yield Sheet(part, material, triangles[mine])


def render_glb(plan: FloorPlan, path: Path, _options: ExportOptions) -> Files:
    """Render a plan as GLB: a node and a material for each kind of sheet, y up as in glTF."""
    scene = trimesh.Scene()
    for sheet in sheets(plan):
        colour = plan.colour_of(sheet.material.name)
        add_triangles(scene, sheet.name, sheet.triangles, colour)
    return {path.name: export_glb(scene)}


def render_ply(plan: FloorPlan, path: Path, _options: ExportOptions) -> Files:
    """Render a plan as binary PLY: colours, and a `material` per face that the header explains."""
    walls = mesh_in_drawing(plan, single_precision=True)
    mesh = walls.mesh.copy()
    mesh.face_attributes["material"] = walls.face_material.astype(np.int32)
    content = export_ply(mesh, include_attributes=True)
    comments = [
        f"comment material {index} = {material.name}, {material.thickness_m:g} m thick"
        for index, material in enumerate(walls.materials)
    ]
    first, _, rest = content.partition(b"element vertex")
    return {path.name: first + "\n".join([*comments, ""]).encode() + b"element vertex" + rest}


def render_stl(plan: FloorPlan, path: Path, _options: ExportOptions) -> Files:
    """Render a plan as STL in text: a solid for each kind of sheet, named after its material."""
    solids: list[str] = []
    for sheet in sheets(plan, single_precision=False):
        mesh = mesh_of(sheet.triangles)
        mesh.metadata["name"] = sheet.name.replace(" ", "_")
        solids.append(export_stl_ascii(mesh))
    return {path.name: "\n".join([*solids, ""]).encode()}


def render_obj(plan: FloorPlan, path: Path, _options: ExportOptions) -> Files:
    """Render a plan as OBJ, one object in the materials' colours."""
    mesh = mesh_in_drawing(plan, single_precision=False).mesh
    return {path.name: str(mesh.export(file_type="obj")).encode()}
