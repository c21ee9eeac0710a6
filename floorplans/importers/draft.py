"""What an importer reads from a file, before it is a plan.

A reader of a format makes a `Draft` of what the file says and leaves out what it does not know;
`floorplans.importers.assembly.assemble.assemble` makes a plan of it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import hypot, radians, sin

from shapely.geometry import Polygon

from floorplans.georeference import GeoOrigin
from floorplans.walls import OpeningKind, Point

_MAX_SINE = sin(radians(20.0))
"""Sine of the largest angle between an opening and its wall."""


@dataclass(frozen=True)
class ImportOptions:
    """What the user knows better than the file; None leaves it to the file, then to a default.

    Attributes
    ----------
    name : str or None
        Name of the plan; by default the file's name.
    height_m : float or None
        From floor to ceiling [m]; by default the file's, else 3.
    wall_thickness_m : float or None
        Of walls whose thickness the file does not tell [m]; by default 0.1.
    wall_material, floor_material, ceiling_material : str or None
        Of what the file gives no material; by default plasterboard, concrete and concrete.
    source : (float, float, float) or None
        (x, y, z) in the plan [m]; by default well off the walls.
    start : (float, float) or None
        (x, y) in the plan [m]; by default the cell farthest from the source, as one walks.
    unit : str or None
        Of the file's coordinates, one of `floorplans.importers.units.UNITS`.
    level : str or None
        Which storey, where the file holds several.
    scale_m : float or None
        Side of a pixel [m], for pictures.
    tolerance_m : float or None
        How far a wall may be moved to make walls meet [m], and how far chords may leave an arc;
        by default each format's own.
    layers : mapping of str to str
        Layer, class or type of the file -> KIND or KIND:MATERIAL; it goes before the defaults.
    """

    name: str | None = None
    height_m: float | None = None
    wall_thickness_m: float | None = None
    wall_material: str | None = None
    floor_material: str | None = None
    ceiling_material: str | None = None
    source: tuple[float, float, float] | None = None
    start: Point | None = None
    unit: str | None = None
    level: str | None = None
    scale_m: float | None = None
    tolerance_m: float | None = None
    layers: Mapping[str, str] = field(default_factory=dict[str, str])


@dataclass(frozen=True)
class RawWall:
    """A straight wall as a file tells it.

    Attributes
    ----------
    start, end : (float, float)
        Ends (x, y) of its centre line [m].
    thickness_m : float or None
    material : str or None
    height_m : float or None
        Above the floor [m]; None is up to the ceiling.
    """

    start: Point
    end: Point
    thickness_m: float | None = None
    material: str | None = None
    height_m: float | None = None


@dataclass(frozen=True)
class RawOpening:
    """A door, window or passage as a file tells it.

    Attributes
    ----------
    centre : (float, float)
        Of its sill, (x, y) [m]; near the centre line of its wall.
    width_m : float
        Along the wall [m].
    kind : {"door", "window", "passage"}
    direction : (float, float) or None
        Along its wall, of any length but 0 and either sense; None where the file does not tell.
    sill_m, head_m : float or None
        Heights above the floor [m].
    material : str or None
        What fills it. None is a default: a window has glass, a passage is open, and a door is open
        inside the building and of wood in the outline.
    thickness_m : float or None
        Of the filling [m].
    """

    centre: Point
    width_m: float
    kind: OpeningKind
    direction: Point | None = None
    sill_m: float | None = None
    head_m: float | None = None
    material: str | None = None
    thickness_m: float | None = None

    @classmethod
    def between(
        cls,
        start: Point,
        end: Point,
        kind: OpeningKind,
        *,
        sill_m: float | None = None,
        head_m: float | None = None,
        material: str | None = None,
    ) -> RawOpening:
        """Make an opening from its two ends on the floor (x, y) [m]."""
        (x0, y0), (x1, y1) = start, end
        return cls(
            centre=((x0 + x1) / 2, (y0 + y1) / 2),
            width_m=hypot(x1 - x0, y1 - y0),
            kind=kind,
            direction=(x1 - x0, y1 - y0),
            sill_m=sill_m,
            head_m=head_m,
            material=material,
        )

    def is_along(self, direction: Point) -> bool:
        """Whether it runs along a unit vector; one of unknown direction runs along any."""
        if self.direction is None:
            return True
        (ux, uy), (vx, vy) = direction, self.direction
        return abs(ux * vy - uy * vx) <= _MAX_SINE * hypot(vx, vy)


@dataclass(frozen=True)
class LayerUse:
    """What became of a layer, class or type of the file: a line of the report.

    `is_unknown` is true where its name says nothing of walls, doors or windows.
    """

    name: str
    n_objects: int
    became: str
    is_unknown: bool = False


@dataclass(frozen=True)
class Origin:
    """Where the plan's (0, 0) lies in the file's coordinates, and what those are."""

    x: float
    y: float
    frame: str


@dataclass(frozen=True)
class Draft:
    """Everything a reader took out of a file, in metres.

    Attributes
    ----------
    name : str
        What the file calls the building or storey, else the file's name.
    walls : tuple of RawWall
    openings : tuple of RawOpening
    outline : shapely.geometry.Polygon or None
        What the storey covers [m]; None where the walls must tell.
    height_m : float or None
        From floor to ceiling [m].
    floor_material, ceiling_material : str or None
    origin : Origin or None
        None where coordinates are the file's own: the plan is then moved to (0, 0), and told.
    georeference : GeoOrigin or None
        Where on the Earth the draft's (0, 0) lies; None where that is not known.
    layers : tuple of LayerUse
    notes : tuple of str
        What else the user should hear, one sentence each.
    """

    name: str
    walls: tuple[RawWall, ...]
    openings: tuple[RawOpening, ...] = ()
    outline: Polygon | None = None
    height_m: float | None = None
    floor_material: str | None = None
    ceiling_material: str | None = None
    origin: Origin | None = None
    georeference: GeoOrigin | None = None
    layers: tuple[LayerUse, ...] = ()
    notes: tuple[str, ...] = ()
