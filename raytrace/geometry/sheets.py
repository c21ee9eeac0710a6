"""A wall mesh read as an extruded building: floor, ceiling, and vertical panels.

The tracer works on plans that are extruded: a floor, a ceiling and vertical sheets between
them. Triangles in one plane are joined, so any triangulation of a building gives the same panels;
another kind of mesh is refused, and the message names the faces at fault.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import shapely
import trimesh
from shapely.geometry.base import BaseGeometry

from raytrace.arrays import Bools, Floats, Ints
from raytrace.errors import SceneError

COINCIDENT_M = 1e-6
"""Points and lines of the plan view this close to each other are one [m]. Plans rounded to six
decimals, and walls that leave the outline by no more, are read as they were meant."""

OPEN = -1
"""Material of a height interval without a wall."""

SAME_M2 = 1e-6
"""Areas that differ by less are the same [m2]."""


class Profile(NamedTuple):
    """The materials of a wall over its height, from the floor to the ceiling.

    `tops` are the upper heights [m] of the intervals, `materials` their material or `OPEN`.
    """

    tops: tuple[float, ...]
    materials: tuple[int, ...]

    @property
    def is_full(self) -> bool:
        """Whether one material fills the whole height."""
        return len(self.materials) == 1 and self.materials[0] != OPEN

    @property
    def is_solid(self) -> bool:
        """Whether there is a wall at every height, of one material or several."""
        return OPEN not in self.materials

    def at(self, z: float) -> int:
        """Material at height z [m], or `OPEN`."""
        return self.materials[min(int(np.searchsorted(self.tops, z)), len(self.tops) - 1)]


class Panel(NamedTuple):
    """A vertical sheet over one straight section of the plan: `start`, `end` (2,) [m]."""

    start: Floats
    end: Floats
    plane: int
    profile: Profile


@dataclass(frozen=True)
class Sheets:
    """An extruded building.

    Attributes
    ----------
    panels
        Its walls; panels of one plane do not overlap.
    planes
        (n, 3) plan-view lines of the walls' planes: unit normal and offset, n . p = d [m].
    footprint
        What the floor covers (shapely, plan view) [m].
    floor_z
        Height of the floor in the mesh [m]; all other heights are above it.
    height_m
        From floor to ceiling [m].
    floor_material, ceiling_material
        Index into the material table.
    """

    panels: tuple[Panel, ...]
    planes: Floats
    footprint: BaseGeometry
    floor_z: float
    height_m: float
    floor_material: int
    ceiling_material: int


def read_sheets(mesh: trimesh.Trimesh, face_material: Ints) -> Sheets:
    """Read a mesh as floor, ceiling and panels.

    Parameters
    ----------
    mesh
        Vertical and horizontal triangles [m].
    face_material
        (n_faces,) index of each face's material.

    Raises
    ------
    SceneError
        For sloped faces, partial floors or ceilings, and sheets that are not made of rectangles.
    """
    triangles = np.asarray(mesh.triangles, dtype=np.float64)
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    area2 = np.linalg.norm(normals, axis=1)
    real = area2 > 1e-14
    triangles, face_material = triangles[real], np.asarray(face_material)[real]
    normals = normals[real] / area2[real, None]
    vertical = np.abs(normals[:, 2]) < 1e-9
    horizontal = np.abs(normals[:, 2]) > 1.0 - 1e-9
    _refuse_sloped(~(vertical | horizontal), np.flatnonzero(real))
    if not horizontal.any():
        raise SceneError("the mesh has no floor and no ceiling: expected two horizontal slabs")
    floor_z, ceiling_z = triangles[horizontal, :, 2].min(), triangles[horizontal, :, 2].max()
    footprint, floor = _floor_or_ceiling(triangles, face_material, horizontal, floor_z, "floor")
    roof, ceiling = _floor_or_ceiling(triangles, face_material, horizontal, ceiling_z, "ceiling")
    _refuse_partial_slabs(triangles, horizontal, (floor_z, ceiling_z), np.flatnonzero(real))
    if footprint.symmetric_difference(roof).area > SAME_M2:
        raise SceneError("floor and ceiling do not cover the same ground: not an extruded plan")
    walls = triangles[vertical] - np.array([0.0, 0.0, floor_z])
    height = float(ceiling_z - floor_z)
    if len(walls) and (walls[:, :, 2].min() < -1e-9 or walls[:, :, 2].max() > height + 1e-9):
        raise SceneError("walls reach below the floor or above the ceiling")
    planes, plane_of = _group_planes(walls, normals[vertical][:, :2])
    panels = tuple(
        panel
        for k in range(len(planes))
        for panel in _panels_of_plane(
            walls[plane_of == k], face_material[vertical][plane_of == k], planes[k], k, height
        )
    )
    return Sheets(panels, planes, footprint, float(floor_z), height, floor, ceiling)


def _refuse_sloped(sloped: Bools, index: Ints) -> None:
    if sloped.any():
        faces = ", ".join(map(str, index[sloped][:5]))
        raise SceneError(
            f"{sloped.sum()} faces are neither vertical nor horizontal (faces {faces}, ...): "
            "the tracer works on extruded plans"
        )


def _refuse_partial_slabs(
    triangles: Floats, horizontal: Bools, slabs_z: tuple[float, float], index: Ints
) -> None:
    off = np.min([np.abs(triangles[:, 0, 2] - z) for z in slabs_z], axis=0)
    between = horizontal & (off > 1e-9)
    if between.any():
        x, y, z = triangles[between][0].mean(axis=0)
        raise SceneError(
            f"{between.sum()} horizontal faces lie between floor and ceiling (first: face "
            f"{index[between][0]} at ({x:.3g}, {y:.3g}, {z:.3g})): partial slabs are not "
            "supported, so no ceiling lower than the neighbour's, no platform and no table top; "
            "waves are followed in plan view, between one floor and one ceiling"
        )


def _floor_or_ceiling(
    triangles: Floats, face_material: Ints, horizontal: Bools, z: float, what: str
) -> tuple[BaseGeometry, int]:
    """Footprint and material of the floor or ceiling at height z."""
    mine = horizontal & (np.abs(triangles[:, :, 2] - z).max(axis=1) < 1e-9)
    materials = np.unique(face_material[mine])
    if len(materials) != 1:
        raise SceneError(f"the {what} has {len(materials)} materials: expected one")
    return shapely.union_all(shapely.polygons(triangles[mine][:, :, :2])), int(materials[0])


def _group_planes(walls: Floats, normals: Floats) -> tuple[Floats, Ints]:
    """Planes (n, 3) of the wall triangles, and which plane each lies in.

    Longer triangles define planes first: their directions are the least affected by rounding.
    """
    length = np.hypot(*np.ptp(walls[:, :, :2], axis=1).T)
    plane_of = np.full(len(walls), -1, dtype=np.int64)
    planes: list[tuple[float, float, float]] = []
    for k in np.argsort(-length, kind="stable"):
        if plane_of[k] >= 0:
            continue
        n = normals[k] if (normals[k, 0], normals[k, 1]) > (1e-12, 0.0) else -normals[k]
        if abs(n[0]) <= 1e-12:
            n = np.array([0.0, 1.0])
        elif abs(n[1]) <= 1e-12:
            n = np.array([1.0, 0.0])
        offset = float(n @ walls[k, 0, :2])
        off = np.abs(walls[:, :, :2] @ n - offset).max(axis=1)
        plane_of[(off < COINCIDENT_M) & (plane_of < 0)] = len(planes)
        planes.append((float(n[0]), float(n[1]), offset))
    first_seen = list(dict.fromkeys(plane_of.tolist()))
    return np.array(planes).reshape(-1, 3)[first_seen], np.argsort(first_seen)[plane_of]


def _panels_of_plane(
    walls: Floats, materials: Ints, plane: Floats, index: int, height: float
) -> Iterator[Panel]:
    """Panels of the triangles of one plane: maximal sections of one profile."""
    along = walls[:, :, :2] @ np.array([-plane[1], plane[0]])
    s, where, number = _distinct(along.ravel(), COINCIDENT_M)
    along = s[number].reshape(along.shape)
    corners = walls[:, :, :2].reshape(-1, 2)[where]
    z, _, _ = _distinct(np.concatenate([walls[:, :, 2].ravel(), [0.0, height]]), 1e-9)
    long = np.ptp(along, axis=1) > 0.0
    triangles = np.stack([along, walls[:, :, 2]], axis=2)[long]
    filled = _fill(triangles, materials[long], s, z, corners)
    profiles = [_profile(z[1:], column) for column in filled]
    start = 0
    for k in range(1, len(profiles) + 1):
        if k < len(profiles) and profiles[k] == profiles[start]:
            continue
        if profiles[start].materials != (OPEN,):
            yield Panel(corners[start], corners[k], index, profiles[start])
        start = k


def _fill(triangles: Floats, materials: Ints, s: Floats, z: Floats, corners: Floats) -> Ints:
    """Material (len(s) - 1, len(z) - 1) of each rectangle of a plane, or `OPEN`."""
    middle_s, middle_z = 0.5 * (s[1:] + s[:-1]), 0.5 * (z[1:] + z[:-1])
    grid_s, grid_z = np.meshgrid(middle_s, middle_z, indexing="ij")
    centres = np.array(shapely.points(grid_s.ravel(), grid_z.ravel()), dtype=np.object_)
    cell_area = np.outer(np.diff(s), np.diff(z))
    filled = np.full(cell_area.shape, OPEN, dtype=np.int64)
    for material in dict.fromkeys(materials.tolist()):
        sheet = np.array(shapely.polygons(triangles[materials == material]), dtype=np.object_)
        within, _ = shapely.STRtree(sheet).query(centres, "intersects")
        inside = np.bincount(within, minlength=grid_s.size).reshape(grid_s.shape) > 0
        covered = float(np.sum(shapely.area(sheet)))
        if abs(cell_area[inside].sum() - covered) > SAME_M2:  # triangles may overlap
            covered = shapely.union_all(sheet).area
        if abs(cell_area[inside].sum() - covered) > SAME_M2:
            (x1, y1), (x2, y2) = corners[0], corners[-1]
            raise SceneError(
                f"the wall from ({x1:g}, {y1:g}) to ({x2:g}, {y2:g}) is not made of vertical "
                f"rectangles: its triangles cover {covered:.6f} m2, the rectangles "
                f"{cell_area[inside].sum():.6f} m2"
            )
        filled[inside & (filled == OPEN)] = material
    return filled


def _profile(tops: Floats, materials: Ints) -> Profile:
    last = [k for k in range(len(tops)) if k + 1 == len(tops) or materials[k + 1] != materials[k]]
    return Profile(tuple(float(tops[k]) for k in last), tuple(int(materials[k]) for k in last))


def _distinct(values: Floats, apart: float) -> tuple[Floats, Ints, Ints]:
    """Sorted values farther apart than that, where each is in the input, and which one each is."""
    order = np.argsort(values, kind="stable")
    new = np.concatenate([[True], np.diff(values[order]) > apart])
    number = np.empty(len(values), dtype=np.int64)
    number[order] = np.cumsum(new) - 1
    return values[order][new], order[new], number
