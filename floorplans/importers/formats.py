"""The reader for a file, chosen by its suffix and its first bytes."""

from __future__ import annotations

import gc
from codecs import BOM_UTF8
from collections.abc import Callable, Generator
from contextlib import contextmanager
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path

from shapely.errors import GEOSException

from floorplans.errors import PlanError
from floorplans.importers.assembly.assemble import assemble
from floorplans.importers.draft import Draft, ImportOptions
from floorplans.importers.imported import Imported, UnusablePlanError
from floorplans.importers.own_axes import frame_in, oblique_deg, placed, turned
from floorplans.importers.parts import Made, with_parts, within
from floorplans.importers.progress import Progress, Report, Step, no_report, reporter
from floorplans.plan import FloorPlan

Reader = Callable[[Path, ImportOptions, Report], Draft | FloorPlan]
"""Returns a whole plan only for a file that holds one, as `floorplans.exporters` writes it."""

_HEAD_BYTES = 4096
_FOLDER_AS = ".imdf"
_ZIP = b"PK\x03\x04"
_PNG = b"\x89PNG\r\n\x1a\n"


@dataclass(frozen=True)
class Format:
    """A file format that can be imported.

    Attributes
    ----------
    title : str
    suffixes : tuple of str
        In lower case, with the dot.
    module, function : str
        The reader; its module is imported on first use.
    looks_right : callable
        Whether the first bytes of a file match this format.
    text_suffixes : tuple of str
        Of files that are plain text and complete by themselves.
    entity : bytes
        Regular expression of what each entity in such a text begins with.
    """

    title: str
    suffixes: tuple[str, ...]
    module: str
    function: str
    looks_right: Callable[[bytes], bool]
    text_suffixes: tuple[str, ...] = ()
    entity: bytes = b""

    def reader(self) -> Reader:
        """Load the reader."""
        return getattr(import_module(f"floorplans.importers.{self.module}"), self.function)


def _is_dxf(head: bytes) -> bool:
    binary = head.startswith(b"AutoCAD Binary DXF")
    return binary or head.split(None, 1)[:1] in ([b"0"], [b"999"])


def _is_json(head: bytes) -> bool:
    return head.lstrip()[:1] == b"{" or head.startswith(_ZIP)


def _is_ros_map(head: bytes) -> bool:
    return head[:2] in (b"P2", b"P5") or head.startswith(_PNG) or b"image:" in head


def _is_ifc(head: bytes) -> bool:
    return head.lstrip()[:13].upper() == b"ISO-10303-21;"


FORMATS = (
    Format(
        "DXF drawing", (".dxf",), "dxf.reader", "read_dxf", _is_dxf,
        (".dxf",), rb"(?m)^\s*0\s*$",
    ),
    Format(
        "GeoJSON or IMDF", (".geojson", ".json", ".zip", ".imdf"), "geojson.reader", "read_geojson",
        _is_json, (".geojson", ".json"), rb'"coordinates"',
    ),
    Format(
        "ROS map_server map", (".yaml", ".yml", ".pgm", ".png"), "ros_map.reader", "read_ros_map",
        _is_ros_map,
    ),
    Format(
        "IFC model", (".ifc",), "ifc.reader", "read_ifc", _is_ifc,
        (".ifc",), rb"(?m)^\s*#\d+\s*=",
    ),
    Format(
        "zipped IFC model", (".ifczip",), "ifc.reader", "read_ifc", lambda h: h.startswith(_ZIP)
    ),
)  # fmt: skip
"""All formats that can be imported."""

SAVE_AS = {
    ".dwg": "a DWG drawing; save it as DXF",
    ".dgn": "a DGN drawing; save it as DXF",
    ".ifcxml": "an ifcXML model; save it as IFC (STEP)",
    ".rvt": "a Revit model; export it as IFC, one storey as DXF",
    ".pln": "an Archicad model; export it as IFC, one storey as DXF",
    ".skp": "a SketchUp model; export it as IFC",
    ".shp": "a shapefile; convert it to GeoJSON",
    ".gpkg": "a GeoPackage; export its layer as GeoJSON",
    ".svg": "an SVG drawing; save it as DXF, or as a PNG picture with a known scale",
    ".pdf": "a PDF file; save the drawing as DXF, or as a PNG picture with a known scale",
    ".jpg": "a JPEG picture; save it as PNG",
    ".jpeg": "a JPEG picture; save it as PNG",
}
"""What is not read, by its suffix, and what to do."""

_MAGIC = {b"AC10": ".dwg", b"%PDF": ".pdf", b"\xff\xd8\xff": ".jpg"}


def import_plan(
    path: str | Path,
    options: ImportOptions | None = None,
    *,
    progress: Progress | None = None,
) -> Imported:
    """Create a plan from another program's file.

    Parameters
    ----------
    path : str or Path
        Its ending names the format; see `FORMATS`. A folder is read as an IMDF venue.
    options : ImportOptions, optional
        What the user specifies.
    progress : callable, optional
        Called as ``progress(done, total)`` with the numbers of finished and of all steps; see
        `floorplans.importers.progress.Step`.

    Returns
    -------
    Imported

    Raises
    ------
    PlanError
        When the file cannot be read, is of another format, or holds no building.
    """
    options = options or ImportOptions()
    path = Path(path)
    report = reporter(progress)
    try:
        return _imported(path, options, report)
    except PlanError as error:
        raise error.located(str(path)) from error
    except GEOSException as error:
        raise PlanError(f"its geometry makes no plan: {error}", origin=str(path)) from error


@contextmanager
def _without_collections() -> Generator[None]:
    """Let no collector of cycles run: it takes a sixth of an import, and would find little."""
    was_on = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_on:
            gc.enable()


def _imported(path: Path, options: ImportOptions, report: Report) -> Imported:
    with _without_collections():
        report(Step.BEGUN)
        drafted = read_draft(path, options, report)
        report(Step.DRAFT_READ)
        if isinstance(drafted, FloorPlan):
            return Imported.from_plan(drafted, options, path.name)
        if options.region is not None:
            drafted = within(drafted, options.region)
        turn_deg = 0.0 if options.keep_axes else oblique_deg(drafted.walls)
        own = turned(drafted, turn_deg) if turn_deg else drafted
        try:
            return _in_drawing(assemble(own, options, path.name, report), drafted, turn_deg)
        except UnusablePlanError as error:
            raise error.with_draft(_in_drawing(error.draft, drafted, turn_deg)) from None


def _in_drawing(imported: Made, draft: Draft, turn_deg: float) -> Made:
    """Add to a plan its place in the drawing, and what else is drawn there."""
    frame = frame_in(imported, draft, turn_deg)
    return with_parts(placed(imported, draft, turn_deg), draft, frame)


def _a(title: str) -> str:
    """Title of a format with its article."""
    return f"an {title}" if title.startswith("IFC") else f"a {title}"


def read_draft(path: Path, options: ImportOptions, report: Report = no_report) -> Draft | FloorPlan:
    """Read a file with the reader of its format.

    Parameters
    ----------
    path : Path
        Its suffix tells the format.
    options : ImportOptions
    report : callable
        Called with each step that is done.

    Raises
    ------
    PlanError
        When the file cannot be read, is empty or of another format than its suffix tells, or holds
        no building.
    """
    kind = _format_of(path)
    if path.is_dir():
        return kind.reader()(path, options, report)
    try:
        with path.open("rb") as file:
            head = file.read(_HEAD_BYTES).removeprefix(BOM_UTF8)
    except OSError as error:
        raise PlanError(f"the file cannot be read: {error.strerror}", origin=str(path)) from error
    if not head:
        raise PlanError("the file is empty", origin=str(path))
    if not kind.looks_right(head):
        likely = [other.title for other in FORMATS if other.looks_right(head)]
        known = [SAVE_AS[suffix] for magic, suffix in _MAGIC.items() if head.startswith(magic)]
        hint = f"; it looks like {_a(likely[0])}" if likely else ""
        hint = f"; it is {known[0]}" if known else hint
        raise PlanError(
            f"the file ends in {path.suffix} but does not begin like {_a(kind.title)}{hint}",
            origin=str(path),
        )
    return kind.reader()(path, options, report)


def _format_of(path: Path) -> Format:
    suffix = _FOLDER_AS if path.is_dir() else path.suffix.lower()
    for kind in FORMATS:
        if suffix in kind.suffixes:
            return kind
    if suffix in SAVE_AS:
        raise PlanError(f"this is {SAVE_AS[suffix]}", origin=str(path))
    known = ", ".join(suffix for kind in FORMATS for suffix in kind.suffixes)
    found = f"the ending {path.suffix}" if path.suffix else "no ending"
    raise PlanError(f"a file with {found} cannot be imported; known: {known}", origin=str(path))
