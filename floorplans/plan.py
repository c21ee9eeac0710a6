"""The floor plan of one storey."""

from __future__ import annotations

from dataclasses import dataclass, fields
from functools import cached_property
from hashlib import sha256

from floorplans.checks.plan import check_plan
from floorplans.errors import PlanError
from floorplans.mesh import WallMesh, build_mesh
from floorplans.toml.writer import dumps
from floorplans.unchecked import UncheckedPlan


@dataclass(frozen=True)
class FloorPlan(UncheckedPlan):
    """One storey with flat floor and ceiling, and everything an experiment on it needs.

    A plan that exists is usable: creating one runs all checks of `floorplans.checks`. Two plans are
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
    source : (float, float, float) or None
        Where the transmitter is that a flight searches for, (x, y, z) [m]; None in a plan that
        nobody flies in.
    start : (float, float) or None
        The cell centre (x, y) a search begins at [m].
    floor_thickness_m, ceiling_thickness_m : float
        Of the floor slabs [m].
    origin : GeoOrigin or None
        Where on the Earth the plan lies; None if unknown.
    materials : tuple of PlanMaterial
        The plan's own, which walls, fillings, floor and ceiling may name besides the built-in ones.
    material_edition : str or None
        Of `floorplans.MATERIAL_EDITIONS`, for the built-in materials; by default the
        tracer's choice.
    transmitters : tuple of PlanTransmitter
        Access points and the like, each with an id; the source is not one of them.
    frame : PlanFrame or None
        Where the plan lies in the drawing it was imported from, if it was turned.
    ground_margin_m : float or None
        How far the ground around the building reaches beyond the rectangle around its outline [m];
        None if no path leaves the building.

    Raises
    ------
    PlanError
        When a check fails.
    """

    def __post_init__(self) -> None:
        check_plan(self)

    def __repr__(self) -> str:
        """Name and size in one line."""
        x_min, y_min, x_max, y_max = self.bounds
        return (
            f"<FloorPlan {self.name!r}: {x_max - x_min:g} x {y_max - y_min:g} x "
            f"{self.height_m:g} m, {len(self.walls)} walls>"
        )

    @classmethod
    def of(cls, plan: UncheckedPlan) -> FloorPlan:
        """Check a plan; raise `PlanError` when a check fails."""
        return cls(**{field.name: getattr(plan, field.name) for field in fields(UncheckedPlan)})

    @cached_property
    def sha256(self) -> str:
        """Hex digest of the plan's TOML text; a file's comments and layout do not change it."""
        return sha256(dumps(self).encode()).hexdigest()

    def require_source(self) -> tuple[float, float, float]:
        """Return the source [m]; raise `PlanError` for a plan without one."""
        if self.source is None:
            raise PlanError(
                f"plan {self.name!r} has no source, which a flight needs: expected [x, y, z] [m]",
                ("source",),
            )
        return self.source

    def require_start(self) -> tuple[float, float]:
        """Return the start [m]; raise `PlanError` for a plan without one."""
        if self.start is None:
            raise PlanError(
                f"plan {self.name!r} has no start, which a flight needs: expected [x, y] [m]",
                ("start",),
            )
        return self.start

    def to_mesh(self) -> WallMesh:
        """Build the sheets of walls, floor and ceiling; see `floorplans.mesh`."""
        return build_mesh(self)
