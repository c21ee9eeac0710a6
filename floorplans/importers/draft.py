"""What a reader finds in a file, before it is a plan.

The reader of a format returns a `Draft` that leaves out what the file does not state;
`floorplans.importers.assembly.assemble.assemble` turns it into a plan.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import pairwise
from math import cos, hypot, radians, sin

from shapely.geometry import LineString, Polygon

from floorplans.georeference import GeoOrigin
from floorplans.importers.known_pixels import KnownPixels
from floorplans.importers.marks import Marks
from floorplans.importers.original import Original
from floorplans.materials import PlanMaterial
from floorplans.walls import OpeningKind, Point

_MAX_SINE = sin(radians(20.0))
"""Sine of the largest angle between an opening and its wall."""

CURVE_COSINE = cos(radians(40.0))
"""Cosine of the largest bend between two chords of a curve."""

Box = tuple[float, float, float, float]
"""(x_min, y_min, x_max, y_max)."""


@dataclass(frozen=True)
class ImportOptions:
    """What the user specifies; None uses the file's value or, without one, a default.

    Attributes
    ----------
    name : str or None
        Name of the plan; by default the file's name.
    height_m : float or None
        From floor to ceiling [m]; by default the file's, or 3.
    wall_thickness_m : float or None
        Of walls whose thickness the file does not state [m]; by default 0.1.
    wall_material, floor_material, ceiling_material : str or None
        Where the file gives no material; by default plasterboard, concrete and concrete.
    source : (float, float, float) or None
        (x, y, z) of the transmitter in the plan [m]; by default away from walls.
    start : (float, float) or None
        (x, y) in the plan [m]; by default the cell with the longest walk from the source.
    unit : str or None
        Of the file's coordinates, one of `floorplans.importers.units.UNITS`.
    level : str or None
        Which storey, if the file holds several.
    scale_m : float or None
        Side of a pixel [m], for pictures.
    tolerance_m : float or None
        How far a wall may be moved to make walls meet, and chords may deviate from an arc [m]; by
        default depends on the format.
    keep_axes : bool
        Keep the drawing's axes where most walls stand at an angle to them.
    close_gaps_m : float or None
        Gaps in the outline up to this width are closed [m]; by default 8.
    region : (float, float, float, float) or None
        Only what lies in it is imported: (x_min, y_min, x_max, y_max) in the file's coordinates
        and unit; in metres from the origin, where the file's are longitude and latitude.
    layers : mapping of str to str
        Layer, class or type of the file -> KIND or KIND:MATERIAL; overrides the defaults.
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
    keep_axes: bool = False
    close_gaps_m: float | None = None
    region: Box | None = None
    layers: Mapping[str, str] = field(default_factory=dict[str, str])


@dataclass(frozen=True)
class RawWall:
    """A straight wall as a file states it.

    Attributes
    ----------
    start, end : (float, float)
        Ends (x, y) of its centre line [m].
    thickness_m : float or None
    material : str or None
    height_m : float or None
        Above the floor [m]; None reaches the ceiling.
    """

    start: Point
    end: Point
    thickness_m: float | None = None
    material: str | None = None
    height_m: float | None = None


def walls_along(line: LineString) -> list[RawWall]:
    """Walls of unknown thickness on the straight pieces of a line [m]."""
    points = [(float(x), float(y)) for x, y in line.coords]
    return [RawWall(a, b) for a, b in pairwise(points) if a != b]


@dataclass(frozen=True)
class RawOpening:
    """A door, window or passage as a file states it.

    Attributes
    ----------
    centre : (float, float)
        Of its sill, (x, y) [m]; near the centre line of its wall.
    width_m : float
        Along the wall [m].
    kind : {"door", "window", "passage"}
    direction : (float, float) or None
        Along its wall, of any non-zero length and either sign; None if unknown.
    sill_m, head_m : float or None
        Heights above the floor [m].
    material : str or None
        What fills it. None is the default: a window has glass, a passage is open, and a door is
        open inside the building and of wood in the outline.
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
        """Create an opening from its two ends on the floor (x, y) [m]."""
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
        """Whether it is nearly parallel to a unit vector; true for an unknown direction."""
        if self.direction is None:
            return True
        (ux, uy), (vx, vy) = direction, self.direction
        return abs(ux * vy - uy * vx) <= _MAX_SINE * hypot(vx, vy)


@dataclass(frozen=True)
class LayerUse:
    """What became of a layer, class or type of the file.

    `is_unknown` is true if its name is not known to mean anything.
    """

    name: str
    n_objects: int
    became: str
    is_unknown: bool = False


@dataclass(frozen=True)
class Assumption:
    """A value that the file did not give: its key, the value as text, and the reason."""

    key: str
    value: str
    why: str


@dataclass(frozen=True)
class Origin:
    """Position of the plan's (0, 0) in the file's coordinates, and what those are."""

    x: float
    y: float
    frame: str


@dataclass(frozen=True)
class Draft:
    """All that a reader found in a file, in metres.

    Attributes
    ----------
    name : str
        The file's name for the building or storey, or the name of the file.
    walls : tuple of RawWall
    openings : tuple of RawOpening
    outline : shapely.geometry.Polygon or None
        What the storey covers [m]; None derives it from the walls.
    height_m : float or None
        From floor to ceiling [m].
    floor_material, ceiling_material : str or None
    origin : Origin or None
        None if coordinates are the file's own: the plan is then moved to (0, 0).
    georeference : GeoOrigin or None
        Where on the Earth the draft's (0, 0) lies; None if unknown.
    layers : tuple of LayerUse
    materials : tuple of PlanMaterial
        Materials that walls may name besides the built-in ones.
    assumed : tuple of Assumption
        What the reader took for granted.
    notes : tuple of str
        Further information for the user, one sentence each.
    warnings : tuple of str
        What the user should look at, one sentence each.
    closed : tuple of shapely.geometry.LineString
        Sections of the outline where the file has no wall and the reader has added walls [m].
    known : KnownPixels or None
        Of a robot's map.
    original : Original or None
        What the file shows, in the coordinates of the walls.
    marks : Marks
        Places of source, start and transmitters, in the coordinates of the walls.
    unit_name, unit_m : str, float
        Unit of the file's coordinates, where those are the draft's, and its length [m].
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
    materials: tuple[PlanMaterial, ...] = ()
    assumed: tuple[Assumption, ...] = ()
    notes: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()
    closed: tuple[LineString, ...] = ()
    known: KnownPixels | None = None
    original: Original | None = None
    marks: Marks = field(default_factory=Marks)
    unit_name: str = "m"
    unit_m: float = 1.0
