"""IFC files: opening, units, storeys."""

from __future__ import annotations

import re
import zlib
from codecs import BOM_UTF8
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from shutil import copyfileobj
from tempfile import TemporaryDirectory
from typing import Any
from zipfile import BadZipFile, ZipFile, is_zipfile

from floorplans.errors import PlanError
from floorplans.importers.draft import ImportOptions
from floorplans.importers.ifc.curves import Entity
from floorplans.importers.ifc.parts import parts_of
from floorplans.importers.ifc.shapes import Scale, placement_of
from floorplans.importers.units import unit_length

MAX_BYTES = 1_000_000_000
CHORD_M = 0.02
"""Default largest deviation of chords from an arc [m]."""

_END = b"END-ISO-10303-21;"
_TAIL_BYTES = 4096
_HEAD_BYTES = 1 << 20
_COMMENT = rb"(?>/\*.*?(?:\*/|\Z))"  # atomic and possessive: no backtracking in hostile headers
_SPACE = rb"(?:\s|" + _COMMENT + rb")*+"
_NAME = rb"'[^']*+'" + _SPACE
_LIST = _NAME + rb"(?:," + _SPACE + _NAME + rb")*+"
_NAMES = _SPACE.join((b"", rb"\(", rb"\(", _LIST + rb"\)", rb"\)", b";"))
_SCHEMA = re.compile(  # outside comments and strings
    _COMMENT + rb"|'[^']*(?:'|\Z)|FILE_SCHEMA(?:" + _NAMES + rb")?",
    re.DOTALL,
)
_PIECE_BYTES = 1 << 20

Model = Any
"""An ifcopenshell.file; the library gives no types."""


@dataclass(frozen=True)
class Storey:
    """A storey of a model: its entity, name, elevation in the file's world [m], and elements."""

    entity: Entity
    name: str
    elevation_m: float
    elements: tuple[Entity, ...]

    @property
    def walls(self) -> tuple[Entity, ...]:
        """Its walls and curtain walls."""
        kinds = ("IfcWall", "IfcCurtainWall")
        return tuple(e for e in self.elements if any(e.is_a(kind) for kind in kinds))


def open_model(path: Path) -> Model:
    """Read an IFC file, zipped or not; raise `PlanError` if that fails."""
    if find_spec("ifcopenshell") is None:
        raise PlanError("IFC files need the library ifcopenshell", remedy="install_ifc")
    _check_bytes(path.stat().st_size)
    with TemporaryDirectory() as folder:
        return _parse(_without_mark(path, Path(folder)))


def _without_mark(path: Path, folder: Path) -> Path:
    """Model as plain text without a byte order mark, which the library refuses.

    In the folder, where the file is not such text already.
    """
    text = _unzipped(path, folder) if is_zipfile(path) else path
    with text.open("rb") as file:
        if file.read(len(BOM_UTF8)) != BOM_UTF8:
            return text
        unmarked = folder / "unmarked.ifc"
        with unmarked.open("wb") as copy:
            copyfileobj(file, copy)
    return unmarked


def _parse(path: Path) -> Model:
    import ifcopenshell

    with path.open("rb") as file:
        _check_schema(file.read(_HEAD_BYTES))
        file.seek(max(0, path.stat().st_size - _TAIL_BYTES))
        if _END not in file.read():
            raise PlanError("the file is cut off: it does not end with END-ISO-10303-21")
    try:
        return ifcopenshell.open(str(path))
    except ifcopenshell.SchemaError as error:
        raise PlanError(
            f"{error}; save the model as IFC2x3 or IFC4 from the program it was made with"
        ) from error
    except Exception as error:  # the library raises errors of many types
        raise PlanError(f"not a readable IFC model: {error}") from error


def _check_schema(head: bytes) -> None:
    """Check that the header names schemas: ifcopenshell crashes where something else is there."""
    found = (match[0] for match in _SCHEMA.finditer(head) if match[0].startswith(b"FILE_SCHEMA"))
    if not next(found, b"").endswith(b";"):
        raise PlanError(
            "not a readable IFC model: expected FILE_SCHEMA with a name in its header, such as "
            "FILE_SCHEMA(('IFC4'))"
        )


def _check_bytes(size: int) -> None:
    if size > MAX_BYTES:
        raise PlanError(
            f"{size / 1e9:.3g} GB, more than the {MAX_BYTES / 1e9:.3g} GB that are read; export "
            "one storey, or walls, slabs, doors and windows only"
        )


def _unzipped(path: Path, folder: Path) -> Path:
    """Write the model in an archive to a folder; its stated size is not trusted."""
    model = folder / "model.ifc"
    try:
        with ZipFile(path) as archive:
            names = [name for name in archive.namelist() if name.lower().endswith(".ifc")]
            if len(names) != 1:
                raise PlanError(f"the archive holds {len(names)} files *.ifc, expected one")
            with archive.open(names[0]) as packed, model.open("wb") as unpacked:
                size = 0
                while piece := packed.read(_PIECE_BYTES):
                    size += len(piece)
                    _check_bytes(size)
                    unpacked.write(piece)
    except (BadZipFile, EOFError, NotImplementedError, RuntimeError, zlib.error) as error:
        raise PlanError(f"the archive cannot be unpacked: {error}") from error
    return model


def scale_of(model: Model, options: ImportOptions) -> Scale:
    """Find the units of a model; raise `PlanError` if it states no unit of length."""
    from ifcopenshell.util.unit import calculate_unit_scale

    chord_m = options.tolerance_m or CHORD_M
    radian = float(calculate_unit_scale(model, "PLANEANGLEUNIT"))
    if options.unit is not None:
        return Scale(unit_length(options.unit), radian, chord_m)
    units = [unit for them in model.by_type("IfcUnitAssignment") for unit in them.Units]
    if not any(getattr(unit, "UnitType", None) == "LENGTHUNIT" for unit in units):
        raise PlanError(
            "the model does not state its unit of length; give it: mm, cm, m, in or ft",
            ("unit",),
            remedy="unit",
        )
    return Scale(float(calculate_unit_scale(model)), radian, chord_m)


def storey_of(model: Model, level: str | None, metre: float) -> Storey:
    """Select a storey by name, number or elevation; by default the only one with walls.

    Raises
    ------
    PlanError
        When there is none, or the choice is ambiguous; the message lists them.
    """
    storeys = storeys_of(model, metre)
    if not storeys:
        n_walls = len(model.by_type("IfcWall"))
        raise PlanError(
            f"the model has no IfcBuildingStorey, so its {n_walls} walls belong to no storey; "
            "export it with its storeys from the building program"
        )
    if level is None:
        with_walls = [storey for storey in storeys if storey.walls]
        if len(with_walls) == 1:
            return with_walls[0]
        if not with_walls:
            raise PlanError(f"no storey of the model has walls; {_listed(storeys)}")
        raise PlanError(f"choose a storey; {_listed(storeys)}", ("level",), remedy="level")
    matching = [storey for k, storey in enumerate(storeys) if _matches(storey, k, level)]
    named = [storey for storey in matching if storey.name.casefold() == level.casefold()]
    matching = named or matching
    if len(matching) != 1:
        found = "no storey" if not matching else f"{len(matching)} storeys"
        raise PlanError(f"{found} of that name, number or elevation; {_listed(storeys)}",
                        ("level",), level)  # fmt: skip
    return matching[0]


def storeys_of(model: Model, metre: float) -> list[Storey]:
    """All storeys, lowest first."""
    found = [
        Storey(
            entity,
            entity.Name or entity.LongName or "",
            metre * float(placement_of(entity)[2, 3]),
            parts_of(entity),
        )
        for entity in model.by_type("IfcBuildingStorey")
    ]
    return sorted(found, key=lambda storey: storey.elevation_m)


def _matches(storey: Storey, number: int, level: str) -> bool:
    names = {str(name).casefold() for name in (storey.entity.Name, storey.entity.LongName) if name}
    if level.casefold() in names or level == str(number):
        return True
    try:
        return "." in level and abs(float(level) - storey.elevation_m) < 0.005
    except ValueError:
        return False


def _listed(storeys: list[Storey]) -> str:
    rows = (
        f"{number}: {storey.name!r} at {storey.elevation_m:.2f} m with {len(storey.walls)} walls"
        for number, storey in enumerate(storeys)
    )
    return f"there are {'; '.join(rows)}"
