"""TOML <-> FloorPlan: the file format that docs/plan_format.md describes."""

from __future__ import annotations

import re
import tomllib
from bisect import bisect_right
from collections.abc import Mapping, Sequence
from dataclasses import replace
from importlib import resources
from itertools import accumulate, pairwise
from math import dist
from pathlib import Path

from shapely.geometry import Polygon

from atomicfiles import atomic_write
from floorplans.checks.materials import check_materials
from floorplans.checks.walls import check_openings, opening_kind, wall_kind
from floorplans.errors import Place, PlanError, format_place
from floorplans.frame import PlanFrame
from floorplans.georeference import GeoOrigin
from floorplans.materials import Own, by_name
from floorplans.plan import FloorPlan
from floorplans.toml.arcs import along_arcs, chords_of_arc
from floorplans.toml.materials import read_materials
from floorplans.toml.table import Table, as_points
from floorplans.toml.transmitters import read_transmitters
from floorplans.toml.writer import FORMAT_VERSION, dumps
from floorplans.unchecked import PlanFile, UncheckedPlan
from floorplans.values import LENGTH, check_number
from floorplans.walls import TOLERANCE_M, Opening, Point, Wall

PLAN_KEYS = (
    "name", "format", "height_m", "floor_material", "floor_thickness_m", "ceiling_material",
    "ceiling_thickness_m", "source", "start", "outline", "holes", "material_edition", "materials",
    "origin", "frame", "ground_margin_m", "transmitters", "defaults", "walls",
)  # fmt: skip
ORIGIN_KEYS = ("longitude_deg", "latitude_deg", "rotation_deg")
FRAME_KEYS = ("x_m", "y_m", "rotation_deg")
DEFAULTS_KEYS = ("material", "thickness_m")
WALL_KEYS = ("kind", "points", "arc", "material", "thickness_m", "height_m", "openings")
OPENING_KEYS = ("kind", "offset_m", "width_m", "sill_m", "head_m", "material", "thickness_m")

MAX_CHARACTERS = 4_000_000

_NESTED_KEY = re.compile(
    r"""(?:(?:"[^"\n]*"|'[^'\n]*'|(?<![\w-])[\w-]++)[ \t]*+\.[ \t]*+){99}""", re.ASCII
)

Corners = list[tuple[float, float]]


def builtin_names() -> tuple[str, ...]:
    """Names of the plans that come with the package, sorted."""
    files = (resources.files("floorplans") / "plans").iterdir()
    return tuple(sorted(f.name.removesuffix(".toml") for f in files if f.name.endswith(".toml")))


def load(plan: str | Path) -> FloorPlan:
    """Read a plan.

    Parameters
    ----------
    plan : str or Path
        A built-in name (`builtin_names`) or the path of a TOML file.

    Returns
    -------
    FloorPlan

    Raises
    ------
    PlanError
        When there is no such plan, or it is wrong.
    """
    text, origin = read_text(plan)
    return loads(text, origin=origin)


def read_text(plan: str | Path) -> tuple[str, str]:
    """Return the text of a built-in plan or a file, and its name in messages; see `load`."""
    if plan in builtin_names():
        file = resources.files("floorplans") / "plans" / f"{plan}.toml"
        return file.read_text(encoding="utf-8"), file.name
    try:
        with Path(plan).open(encoding="utf-8-sig") as file:
            return file.read(MAX_CHARACTERS + 1), str(plan)
    except UnicodeDecodeError as error:
        raise PlanError(f"not UTF-8 text: {error.reason}", origin=str(plan)) from error
    except (OSError, ValueError) as error:  # ValueError: a path with a NUL character
        raise PlanError(
            f"the file cannot be read: {getattr(error, 'strerror', None) or error}; give the path "
            f"of a TOML file or one of the built-in plans {', '.join(builtin_names())}",
            origin=str(plan),
        ) from error


def loads(text: str, *, origin: str = "<text>") -> FloorPlan:
    """Read a plan from TOML text.

    Parameters
    ----------
    text : str
    origin : str
        Name of the text in messages, such as its file's.

    Returns
    -------
    FloorPlan

    Raises
    ------
    PlanError
        When the text is not TOML, or the plan is wrong.
    """
    return from_data(parse_toml(text, origin), origin=origin)


def loads_unchecked(text: str, *, origin: str = "<text>") -> PlanFile:
    """Read a plan from TOML text without checking the building it describes.

    Raises
    ------
    PlanError
        When the text is not TOML, or not of this format: a key missing, a value of a wrong type.
    """
    try:
        return _read_unchecked(Table(parse_toml(text, origin), PLAN_KEYS))
    except PlanError as error:
        raise error.located(origin) from None


def parse_toml(text: str, origin: str) -> dict[str, object]:
    """Parse TOML whose size and nesting are limited: the parser takes quadratic time over keys."""
    if len(text) > MAX_CHARACTERS:
        raise PlanError(f"a plan has at most {MAX_CHARACTERS} characters", origin=origin)
    if _NESTED_KEY.search(text):
        raise PlanError("a key of 100 parts; a plan needs 3, as in a.b.c", origin=origin)
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise PlanError(f"not valid TOML: {error}", origin=origin) from error
    except RecursionError as error:
        raise PlanError(
            "lists or tables are nested too deeply; a plan needs 5 levels", origin=origin
        ) from error
    except ValueError as error:  # Python's limit for the digits of an integer
        raise PlanError(f"a number is too long: {error}", origin=origin) from error


def from_data(data: Mapping[str, object], *, origin: str = "<data>") -> FloorPlan:
    """Create a plan from the keys and values of its TOML file; see `loads` for errors."""
    try:
        return _read_plan(Table(data, PLAN_KEYS))
    except PlanError as error:
        raise error.located(origin) from None


def save(plan: FloorPlan, path: str | Path) -> None:
    """Write a plan to a TOML file, whole or not at all.

    Parameters
    ----------
    plan : FloorPlan
    path : str or Path
        A file that is there is replaced.

    Raises
    ------
    OSError
        When the file cannot be written.
    """
    with atomic_write(path) as temporary:
        temporary.write_text(dumps(plan), encoding="utf-8", newline="\n")


def _read_plan(table: Table) -> FloorPlan:
    unchecked = _read_unchecked(table)
    try:
        return FloorPlan.of(unchecked.plan)
    except PlanError as error:
        raise error.located(place=unchecked.place_in_file(error.place)) from None


def _read_unchecked(table: Table) -> PlanFile:
    _check_version(table)
    height_m = table.number("height_m")
    check_number(height_m, LENGTH, ("height_m",))
    defaults = table.table("defaults", DEFAULTS_KEYS)
    materials = read_materials(table)
    check_materials(materials, None)
    own = by_name(materials)
    walls = table.tables("walls", WALL_KEYS)
    pieces = [_read_wall(wall, defaults, height_m, own) for wall in walls]
    floor, ceiling = table.text("floor_material"), table.text("ceiling_material")
    plan = UncheckedPlan(
        name=table.text("name"),
        outline=_read_outline(table, [_points_of(row) for row in walls if "arc" in row.data]),
        walls=tuple(wall for walls in pieces for wall in walls),
        height_m=height_m,
        floor_material=floor,
        ceiling_material=ceiling,
        source=table.optional_xyz("source"),
        start=table.optional_xy("start"),
        floor_thickness_m=table.number("floor_thickness_m", _layers_m(floor, own, 0.2)),
        ceiling_thickness_m=table.number("ceiling_thickness_m", _layers_m(ceiling, own, 0.2)),
        origin=_read_origin(table),
        frame=_read_frame(table),
        materials=materials,
        material_edition=table.optional_text("material_edition"),
        transmitters=read_transmitters(table),
        ground_margin_m=table.optional_number("ground_margin_m"),
    )
    return PlanFile(plan, tuple(len(walls) for walls in pieces))


def _check_version(table: Table) -> None:
    version = table.number("format")
    if version != FORMAT_VERSION:
        raise PlanError(
            f"expected {FORMAT_VERSION}, the only format there is", ("format",), version
        )


def _read_outline(table: Table, arcs: Sequence[Corners]) -> Polygon:
    shell = along_arcs(_ring(table.points("outline"), ("outline",)), arcs)
    holes = [
        along_arcs(_ring(as_points(hole, ("holes", index)), ("holes", index)), arcs)
        for index, hole in enumerate(table.items("holes"))
    ]
    return Polygon(shell, holes)


def _read_origin(table: Table) -> GeoOrigin | None:
    if "origin" not in table.data:
        return None
    origin = table.table("origin", ORIGIN_KEYS)
    return GeoOrigin(
        origin.number("longitude_deg"),
        origin.number("latitude_deg"),
        origin.number("rotation_deg", 0.0),
    )


def _read_frame(table: Table) -> PlanFrame | None:
    if "frame" not in table.data:
        return None
    frame = table.table("frame", FRAME_KEYS)
    return PlanFrame(*(frame.number(key, 0.0) for key in FRAME_KEYS))


def _ring(points: Corners, place: Place) -> Corners:
    if len(points) < 4:
        raise PlanError("expected at least three corners and the first one again", place, points)
    if points[0] != points[-1]:
        raise PlanError(
            f"{format_place(place)} is not closed; repeat the first point {list(points[0])}",
            (*place, len(points) - 1),
            points[-1],
        )
    return points


def _layers_m(material: str | None, own: Own, otherwise: float | None) -> float | None:
    """Thickness of a plan's own layered material [m]; `otherwise` for any other material."""
    if material is None or material not in own:
        return otherwise
    layers_m = own[material].thickness_m
    return otherwise if layers_m is None else layers_m


def _read_wall(table: Table, defaults: Table, ceiling_m: float, own: Own) -> list[Wall]:
    """Return one wall for each straight piece of the polyline or arc."""
    points = _points_of(table)
    material = table.text("material", defaults.optional_text("material"))
    default_m = _layers_m(material, own, defaults.optional_number("thickness_m"))
    thickness_m = table.number("thickness_m", default_m)
    height_m = table.number("height_m", ceiling_m)
    openings = [_read_opening(row, own) for row in table.tables("openings", OPENING_KEYS)]
    lengths = [dist(start, end) for start, end in pairwise(points)]
    kind = wall_kind(table.text("kind", "wall"), (*table.place, "kind"))
    whole = Wall((0.0, 0.0), (sum(lengths), 0.0), material, thickness_m, height_m, tuple(openings))
    check_openings(whole, own, table.place)
    if "arc" in table.data:
        begins = list(accumulate(lengths, initial=0.0))
        openings = [part for opening in openings for part in _split_at(begins[1:-1], opening)]
    by_piece = _distribute_openings(openings, lengths, points, table.place)
    return [
        Wall(start, end, material, thickness_m, height_m, own_openings, kind)
        for (start, end), own_openings in zip(pairwise(points), by_piece, strict=True)
    ]


def _points_of(table: Table) -> Corners:
    """Points of a wall's polyline; those of an arc lie on it."""
    points = table.points("points")
    if len(points) < 2:
        raise PlanError("expected at least two points", (*table.place, "points"), points)
    if "arc" not in table.data:
        return points
    if len(points) > 2:
        raise PlanError(
            "expected two points, the start and the end of the arc",
            (*table.place, "points"),
            points,
        )
    x, y = table.coordinates("arc", "xy")
    return chords_of_arc(points[0], (x, y), points[1], (*table.place, "arc"))


def _split_at(corners: Sequence[float], opening: Opening) -> list[Opening]:
    """Parts of an opening between the corners of a wall, at distances from its start [m]."""
    inside = [
        s for s in corners if opening.offset_m + TOLERANCE_M < s < opening.end_m - TOLERANCE_M
    ]
    stops = [opening.offset_m, *inside, opening.end_m]
    return [replace(opening, offset_m=a, width_m=b - a) for a, b in pairwise(stops)]


def _read_opening(table: Table, own: Own) -> Opening:
    material = table.optional_text("material")
    thickness_m = table.optional_number("thickness_m")
    return Opening(
        offset_m=table.number("offset_m"),
        width_m=table.number("width_m"),
        sill_m=table.number("sill_m", 0.0),
        head_m=table.number("head_m"),
        kind=opening_kind(table.text("kind"), (*table.place, "kind")),
        material=material,
        thickness_m=_layers_m(material, own, None) if thickness_m is None else thickness_m,
    )


def _distribute_openings(
    openings: list[Opening], lengths: list[float], points: list[Point], place: Place
) -> list[tuple[Opening, ...]]:
    """Assign openings to the pieces of a polyline, with offsets from each piece's start."""
    begins = list(accumulate(lengths, initial=0.0))
    by_piece: list[list[Opening]] = [[] for _ in lengths]
    for index, opening in enumerate(openings):
        middle = opening.offset_m + opening.width_m / 2
        piece = bisect_right(begins[:-1], middle) - 1
        for corner in (piece, piece + 1):
            inside = opening.offset_m + TOLERANCE_M < begins[corner] < opening.end_m - TOLERANCE_M
            if inside:
                x, y = points[corner]
                raise PlanError(
                    f"the opening goes around the corner at ({x:g}, {y:g}), {begins[corner]:g} m "
                    "along the wall; move it to one side or split it",
                    (*place, "openings", index, "offset_m"),
                    opening.offset_m,
                )
        by_piece[piece].append(_moved(opening, begins[piece]))
    return [tuple(openings) for openings in by_piece]


def _moved(opening: Opening, begin_m: float) -> Opening:
    offset_m = max(opening.offset_m - begin_m, 0.0)
    return Opening(
        offset_m, opening.width_m, opening.sill_m, opening.head_m, opening.kind,
        opening.material, opening.thickness_m,
    )  # fmt: skip
