"""A building as the tracer sees it: reflector planes, convex cells, diffracting edges."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import trimesh
from numpy.typing import NDArray
from shapely.geometry.base import BaseGeometry

from raytrace.cells import CellComplex, cut_into_cells
from raytrace.edges import LevelEdge, UprightEdge, find_level_edges, find_upright_edges
from raytrace.errors import SceneError
from raytrace.kernels.plan_view import PlanView
from raytrace.materials import find_material
from raytrace.sheets import read_sheets


@dataclass(frozen=True, eq=False)
class Scene:
    """An extruded building, ready to be traced.

    Attributes
    ----------
    height_m
        From floor to ceiling [m].
    footprint
        What the floor covers (shapely, plan view) [m].
    slabs
        (material name, thickness [m]) of every wall, floor and ceiling.
    floor_material, ceiling_material
        Index into `slabs`.
    cells
        The plan view cut into convex cells.
    upright_edges, level_edges
        Where it diffracts.
    """

    height_m: float
    footprint: BaseGeometry
    slabs: tuple[tuple[str, float], ...]
    floor_material: int
    ceiling_material: int
    cells: CellComplex
    upright_edges: tuple[UprightEdge, ...]
    level_edges: tuple[LevelEdge, ...]

    @property
    def view(self) -> PlanView:
        """The cells as the kernels see them."""
        return self.cells.view

    @classmethod
    def from_mesh(
        cls,
        mesh: trimesh.Trimesh,
        face_material: NDArray[np.int64],
        materials: Sequence[tuple[str, float]],
    ) -> "Scene":
        """Read a mesh of vertical sheets, a floor and a ceiling.

        Parameters
        ----------
        mesh
            Triangles [m]. A wall is one sheet on its centre line, not two faces.
        face_material
            (n_faces,) index of each face's material.
        materials
            (material name, thickness [m]) of each index.

        Raises
        ------
        SceneError
            For a mesh that is not an extruded building, walls that do not enclose the floor,
            and unknown materials.
        """
        slabs = tuple((str(name), float(thickness)) for name, thickness in materials)
        for name, thickness in slabs:
            find_material(name)
            if not 0.0 < thickness < 10.0:
                raise SceneError(f"{name} of thickness {thickness} m: expected 0 to 10 m")
        _check_indices(face_material, len(mesh.faces), len(slabs))
        sheets = read_sheets(mesh, face_material)
        cells = cut_into_cells(sheets)
        return cls(
            sheets.height_m,
            sheets.footprint,
            slabs,
            sheets.floor_material,
            sheets.ceiling_material,
            cells,
            find_upright_edges(cells, sheets.height_m),
            find_level_edges(cells),
        )


def _check_indices(face_material: NDArray[np.int64], n_faces: int, n_slabs: int) -> None:
    """Check that every face has a material, and that it stands in the table."""
    if np.shape(face_material) != (n_faces,):
        raise SceneError(
            f"face_material has shape {np.shape(face_material)}: expected one index for each of "
            f"the {n_faces} faces"
        )
    wrong = np.flatnonzero((face_material < 0) | (face_material >= n_slabs))
    if len(wrong):
        raise SceneError(
            f"face {wrong[0]} refers to material {face_material[wrong[0]]}: expected "
            f"0 to {n_slabs - 1}, an index into the table of materials"
        )
