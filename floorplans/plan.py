"""The floor plan of one storey."""

from __future__ import annotations

from dataclasses import dataclass, fields
from functools import cached_property
from hashlib import sha256
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from shapely.geometry import Polygon

from floorplans.checks.plan import check_plan
from floorplans.georeference import GeoOrigin
from floorplans.materials import MATERIAL_COLOURS, OWN_COLOUR, Own, PlanMaterial, by_name
from floorplans.mesh import WallMesh, build_mesh
from floorplans.toml.writer import dumps
from floorplans.walls import Opening, Wall, solid_intervals

__all__ = ["FloorPlan", "Opening", "UncheckedPlan", "Wall"]


@dataclass(frozen=True)
class UncheckedPlan:
    """What a plan's file tells, right or wrong; `FloorPlan` has the same attributes, checked."""

    name: str
    outline: Polygon
    walls: tuple[Wall, ...]
    height_m: float
    floor_material: str
    ceiling_material: str
    source: tuple[float, float, float]
    start: tuple[float, float]
    floor_thickness_m: float = 0.2
    ceiling_thickness_m: float = 0.2
    origin: GeoOrigin | None = None
    materials: tuple[PlanMaterial, ...] = ()
    material_edition: str | None = None

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        """Smallest box around the outline, (x_min, y_min, x_max, y_max) [m]."""
        return self.outline.bounds

    @cached_property
    def own_materials(self) -> Own:
        """The plan's own materials by name."""
        return by_name(self.materials)

    def colour_of(self, material: str) -> str:
        """Colour #rrggbb that a built-in material or one of the plan's own is drawn in."""
        if material in self.own_materials:
            return self.own_materials[material].colour or OWN_COLOUR
        return MATERIAL_COLOURS[material]

    def solid_segments(self, height_m: float) -> NDArray[np.float64]:
        """Plan-view segments in which walls and filled openings are solid at a height.

        Parameters
        ----------
        height_m : float
            Above the floor [m]. At exactly the height of a sill, head or top, what touches that
            height counts as solid.

        Returns
        -------
        (n, 2, 2) float64
            Segment, end, and (x, y) [m].

        Raises
        ------
        ValueError
            When the height is not between floor and ceiling.
        """
        if not 0 <= height_m <= self.height_m:
            raise ValueError(f"height_m = {height_m:g}: expected 0 to {self.height_m:g} [m]")
        segments = [
            (wall.point_at(low), wall.point_at(high))
            for wall in self.walls
            for low, high in solid_intervals(wall, height_m)
        ]
        return np.array(segments, dtype=np.float64).reshape(-1, 2, 2)

    def layer_heights(self) -> tuple[float, ...]:
        """One height [m] in each horizontal layer within which the plan view stays the same."""
        edges = {0.0, self.height_m} | {wall.height_m for wall in self.walls}
        edges |= {z for wall in self.walls for o in wall.openings for z in (o.sill_m, o.head_m)}
        return tuple((low + high) / 2 for low, high in pairwise(sorted(edges)))


@dataclass(frozen=True)
class FloorPlan(UncheckedPlan):
    """One storey with flat floor and ceiling, and everything an experiment on it needs.

    A plan that exists is usable: making one runs all checks of `floorplans.checks`. Two plans are
    equal when all their numbers and names are.

    Attributes
    ----------
    name : str
        One line of text.
    outline : shapely.geometry.Polygon
        What the storey covers [m], with courtyards as holes. It is geometry only: its whole edge
        must be covered by walls from floor to ceiling.
    walls : tuple of Wall
        All walls, exterior ones included.
    height_m : float
        From the floor (z = 0) to the ceiling [m].
    floor_material, ceiling_material : str
        Of `floorplans.MATERIALS`, or a name of `materials`.
    source : (float, float, float)
        Where the radio source lies, (x, y, z) [m].
    start : (float, float)
        The cell centre (x, y) a search begins at [m].
    floor_thickness_m, ceiling_thickness_m : float
        Thickness of the slabs [m].
    origin : GeoOrigin or None
        Where on the Earth the plan lies; None where that is not known.
    materials : tuple of PlanMaterial
        The plan's own, that walls, fillings, floor and ceiling may name beside the built-in ones.
    material_edition : str or None
        Of `floorplans.MATERIAL_EDITIONS`, for the built-in materials; None leaves it to the tracer.

    Raises
    ------
    PlanError
        When a check fails.
    """

    def __post_init__(self) -> None:
        check_plan(self)

    @classmethod
    def of(cls, plan: UncheckedPlan) -> FloorPlan:
        """Check a plan; raise `PlanError` when a check fails."""
        return cls(**{field.name: getattr(plan, field.name) for field in fields(UncheckedPlan)})

    @cached_property
    def sha256(self) -> str:
        """Hex digest of the plan's TOML text; a file's comments and layout do not change it."""
        return sha256(dumps(self).encode()).hexdigest()

    def to_mesh(self) -> WallMesh:
        """Build the sheets of walls, floor and ceiling; see `floorplans.mesh`."""
        return build_mesh(self)
