"""A plan before its checks, and where its parts stand in its file."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import Polygon

from floorplans.errors import Place
from floorplans.frame import PlanFrame
from floorplans.georeference import GeoOrigin
from floorplans.materials import MATERIAL_COLOURS, OWN_COLOUR, Own, PlanMaterial, by_name
from floorplans.solid_regions import SolidRegion, solid_regions
from floorplans.transmitters import PlanTransmitter
from floorplans.walls import Wall, solid_segments


@dataclass(frozen=True)
class UncheckedPlan:
    """A plan as its file states it, right or wrong; `FloorPlan` has the same attributes."""

    name: str
    outline: Polygon
    walls: tuple[Wall, ...]
    height_m: float
    floor_material: str
    ceiling_material: str
    source: tuple[float, float, float] | None = None
    start: tuple[float, float] | None = None
    floor_thickness_m: float = 0.2
    ceiling_thickness_m: float = 0.2
    origin: GeoOrigin | None = None
    materials: tuple[PlanMaterial, ...] = ()
    material_edition: str | None = None
    transmitters: tuple[PlanTransmitter, ...] = ()
    frame: PlanFrame | None = None
    ground_margin_m: float | None = None

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
            Above the floor [m]. What ends exactly at this height counts as solid.

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
        return solid_segments(self.walls, height_m)

    @cached_property
    def solid_regions(self) -> tuple[SolidRegion, ...]:
        """Columns and shafts, which count as solid; see `floorplans.solid_regions`."""
        return solid_regions(self.walls)

    def contains(self, points: NDArray[np.float64], height_m: float) -> NDArray[np.bool_]:
        """Whether points lie inside the building, and in no column or shaft.

        Parameters
        ----------
        points : (n, 2) float64
            In the plan view, (x, y) [m].
        height_m : float
            Of all points above the floor [m].

        Returns
        -------
        (n,) bool
        """
        shapely.prepare(self.outline)
        inside = np.array(shapely.contains_xy(self.outline, points), dtype=np.bool_)
        for region in self.solid_regions:
            if height_m <= region.top_m:
                inside &= ~np.array(shapely.contains_xy(region.polygon, points), dtype=np.bool_)
        return inside

    def layer_heights(self) -> tuple[float, ...]:
        """One height [m] in each horizontal layer of constant plan view."""
        edges = {0.0, self.height_m} | {wall.height_m for wall in self.walls}
        edges |= {z for wall in self.walls for o in wall.openings for z in (o.sill_m, o.head_m)}
        return tuple((low + high) / 2 for low, high in pairwise(sorted(edges)))


@dataclass(frozen=True)
class PlanFile:
    """An unchecked plan, and how its walls are numbered in its file.

    Attributes
    ----------
    plan : UncheckedPlan
    piece_counts : tuple of int
        Straight walls of each of the file's polylines.
    """

    plan: UncheckedPlan
    piece_counts: tuple[int, ...]

    @classmethod
    def of(cls, plan: UncheckedPlan) -> PlanFile:
        """Number the walls of a plan that has no file."""
        return cls(plan, (1,) * len(plan.walls))

    def place_in_file(self, place: Place) -> Place:
        """Replace the index of a straight wall by that of the polyline it belongs to."""
        if len(place) < 2 or place[0] != "walls":
            return place
        return ("walls", self._tables[int(place[1])], *place[2:])

    @cached_property
    def _tables(self) -> list[int]:
        """Index of the polyline that each straight wall belongs to."""
        return [table for table, count in enumerate(self.piece_counts) for _ in range(count)]
