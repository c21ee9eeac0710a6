"""A building as the tracer sees it: reflector planes, convex cells, diffracting edges."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import trimesh
from numpy.typing import NDArray
from shapely.geometry.base import BaseGeometry

from raytrace.arrays import Floats
from raytrace.errors import SceneError
from raytrace.geometry.cells import CellComplex, cut_into_cells
from raytrace.geometry.edges import (
    HorizontalEdge,
    VerticalEdge,
    find_horizontal_edges,
    find_vertical_edges,
)
from raytrace.geometry.sheets import read_sheets
from raytrace.kernels.plan_view import PlanView
from raytrace.radio.itu import DEFAULT_EDITION
from raytrace.radio.materials import Material, Slab

MOST_GROUND_M = 1000.0
"""Largest margin of ground around a building [m]."""


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
        What walls, floor and ceiling are made of.
    floor_slab, ceiling_slab
        Index into `slabs`.
    cells
        The plan view cut into convex cells.
    vertical_edges, horizontal_edges
        Where it diffracts.
    material_edition
        The edition of ITU-R P.2040 that built-in materials were taken from.
    """

    height_m: float
    footprint: BaseGeometry
    slabs: tuple[Slab, ...]
    floor_slab: int
    ceiling_slab: int
    cells: CellComplex
    vertical_edges: tuple[VerticalEdge, ...]
    horizontal_edges: tuple[HorizontalEdge, ...]
    material_edition: str = DEFAULT_EDITION

    def __repr__(self) -> str:
        """Size in one line."""
        x_min, y_min, x_max, y_max = self.footprint.bounds
        return (
            f"<Scene: {x_max - x_min:g} x {y_max - y_min:g} x {self.height_m:g} m, "
            f"{len(self.walls)} pieces of wall>"
        )

    @property
    def view(self) -> PlanView:
        """The cells as the kernels see them."""
        return self.cells.view

    @property
    def walls(self) -> Floats:
        """(n, 2, 2) ends of walls in the plan view [m], in pieces from corner to corner."""
        return self.view.ends[self.view.profile >= 0].reshape(-1, 2, 2)

    @classmethod
    def from_mesh(
        cls,
        mesh: trimesh.Trimesh,
        face_material: NDArray[np.int64],
        materials: Sequence[tuple[str | Material, float]],
        *,
        edition: str = DEFAULT_EDITION,
        edgeless: Sequence[int] | NDArray[np.int64] = (),
        ground_margin_m: float | None = None,
    ) -> "Scene":
        """Read a mesh of vertical sheets, a floor and a ceiling.

        Parameters
        ----------
        mesh
            Triangles [m]. A wall is one sheet on its centre line, not two faces.
        face_material
            (n_faces,) index of each face's material.
        materials
            (material, thickness [m]) of each index; a name means the built-in material. A layered
            one reflects in a wall as the mean of its two sides (`Layered.coefficients`); in a floor
            or ceiling its first layer is the one the room sees.
        edition
            Of ITU-R P.2040, for materials given by name.
        edgeless
            (k,) indices of materials of clutter: edges between two faces of them do not diffract.
        ground_margin_m
            How far the ground reaches beyond the rectangle around the footprint [m]; by default
            there is none, and no path leaves the building. It lies as high as the floor, and
            reflects like it. Above it is no ceiling; paths over the roof are not found.

        Raises
        ------
        SceneError
            For a mesh that is not an extruded building, walls that do not enclose the floor, and
            unknown materials.
        """
        slabs = tuple(Slab.of(material, thickness, edition) for material, thickness in materials)
        _check_indices(face_material, len(mesh.faces), len(slabs))
        clutter: set[int] = set(np.asarray(edgeless).tolist())
        face_material, slabs, copied = _with_slabs_of_walls(mesh, face_material, slabs)
        clutter |= {copy for copy, original in copied.items() if original in clutter}
        sheets = read_sheets(mesh, face_material)
        if ground_margin_m is not None and not 0.0 < ground_margin_m <= MOST_GROUND_M:
            raise SceneError(
                f"ground_margin_m = {ground_margin_m:g}: expected more than 0, at most "
                f"{MOST_GROUND_M:g} m"
            )
        cells = cut_into_cells(sheets, ground_margin_m)
        return cls(
            sheets.height_m,
            sheets.footprint,
            slabs,
            sheets.floor_material,
            sheets.ceiling_material,
            cells,
            tuple(
                edge
                for edge in find_vertical_edges(cells, sheets.height_m)
                if not {edge.o_slab, edge.n_slab} <= clutter
            ),
            tuple(e for e in find_horizontal_edges(cells) if e.material not in clutter),
            edition,
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


def _with_slabs_of_walls(
    mesh: trimesh.Trimesh, face_material: NDArray[np.int64], slabs: tuple[Slab, ...]
) -> tuple[NDArray[np.int64], tuple[Slab, ...], dict[int, int]]:
    """Append slabs for walls whose sides differ: one sheet has one reflection coefficient.

    Also returns the number of the original of each appended slab.
    """
    vertical = np.abs(mesh.face_normals[:, 2]) < 0.5
    found, copied = np.array(face_material), dict[int, int]()
    for index in np.unique(found[vertical]):
        wall = slabs[index].as_wall()
        if wall is not slabs[index]:
            found[vertical & (found == index)] = len(slabs)
            copied[len(slabs)] = int(index)
            slabs = (*slabs, wall)
    return found, slabs, copied
