"""DXF file -> plain lines by layer, and the symbols of doors and windows.

Blocks are exploded recursively, except those of doors and windows, which are symbols: their lines
are kept together. Arcs, circles, bulges, ellipses and splines become chords. Coordinates stay
in the drawing's unit, in the plan view.
"""

from __future__ import annotations

import re
from collections import Counter, defaultdict
from collections.abc import Generator, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from math import hypot, isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Any

from floorplans.errors import PlanError
from floorplans.importers.dxf.curves import CURVE_TYPES, Curve, curves_of, is_finite, moved_curve
from floorplans.importers.layer_names import Kind, Meaning, meaning_of

if TYPE_CHECKING:
    from ezdxf.document import Drawing as Document
    from ezdxf.entities.dxfgfx import DXFGraphic

MAX_BYTES = 200_000_000
MAX_RECORDS = 1_000_000
MAX_ENTITIES = 500_000
"""After blocks are exploded."""

_MAX_DEPTH = 24
_MOST_SHOWN = 100_000  # points of what is left out
_RECORD = re.compile(rb"^[ \t]*0[ \t]*\r?\n", re.MULTILINE)
_FILLED = ("HATCH", "SOLID", "TRACE")


@dataclass(frozen=True)
class Symbol:
    """A door or a window: the curves of its block, and the block's x axis.

    `named` is true if the block's own name, or a layer of windows, gives its kind.
    """

    kind: Kind
    named: bool
    layer: str
    axis: tuple[float, float]
    curves: tuple[Curve, ...]


@dataclass
class Content:
    """Contents of a drawing.

    Attributes
    ----------
    curves : mapping of str to list of Curve
        By layer; only of relevant layers.
    left_out : mapping of str to list of Curve
        By layer, of ignored layers, up to a number of them; only to show them.
    symbols : list of Symbol
    n_objects : Counter of str
        Objects of each layer, after blocks are exploded.
    hidden : set of str
        Layers that are off or frozen.
    missing : set of str
        Inserted blocks whose lines are in other files.
    damaged : Counter of str
        Objects of each layer that matters, of which no line can be read.
    """

    curves: defaultdict[str, list[Curve]] = field(default_factory=lambda: defaultdict(list))
    left_out: defaultdict[str, list[Curve]] = field(default_factory=lambda: defaultdict(list))
    symbols: list[Symbol] = field(default_factory=list[Symbol])
    n_objects: Counter[str] = field(default_factory=Counter[str])
    hidden: set[str] = field(default_factory=set[str])
    missing: set[str] = field(default_factory=set[str])
    damaged: Counter[str] = field(default_factory=Counter[str])


def load_document(path: Path) -> Document:
    """Load a drawing; reject what would take minutes.

    Raises
    ------
    PlanError
        When the file is no DXF file, too large, or its blocks explode into too many objects.
    """
    _check_file(path)
    with _damage_reported():
        document = _load(path)
        _check_model_space(document)
        _check_blocks(document)
    return document


def read_content(document: Document, layers: Mapping[str, str], tolerance: float) -> Content:
    """Read the model space of a drawing.

    Parameters
    ----------
    document : ezdxf.document.Drawing
    layers : mapping of str to str
        Meanings that the user gives; see `layer_names.meaning_of`.
    tolerance : float
        Largest deviation of chords from a curve, in the drawing's unit.

    Returns
    -------
    Content
    """
    with _damage_reported():
        hidden = {layer.dxf.name for layer in document.layers if _is_hidden(layer)}
        content = Content(hidden=hidden)
        _Collector(content, layers, tolerance).collect(document.modelspace(), None, 0)
    return content


def _check_file(path: Path) -> None:
    """Reject a file that would take minutes to load."""
    size = path.stat().st_size
    if size > MAX_BYTES:
        raise PlanError(
            f"the file is {size / 1e6:.0f} MB, more than {MAX_BYTES / 1e6:.0f} MB; {_LESS}"
        )
    records = sum(1 for _ in _RECORD.finditer(path.read_bytes()))
    if records > MAX_RECORDS:
        raise PlanError(f"the file holds about {records} objects, more than {MAX_RECORDS}; {_LESS}")


_LESS = "save one storey, with the layers of its walls, doors and windows only"


@contextmanager
def _damage_reported() -> Generator[None]:
    """Turn the many errors of the library for a damaged file into one."""
    from ezdxf.lldxf.const import DXFError

    try:
        yield
    except (PlanError, MemoryError):
        raise
    except DXFError as error:
        raise PlanError(f"not a DXF file that can be read: {error}") from error
    except Exception as error:
        raise PlanError(
            f"the file is damaged ({type(error).__name__}: {error}); open and save it with a CAD "
            "program"
        ) from error


def _load(path: Path) -> Document:
    """Read a document, recovering damaged ones as far as possible."""
    import ezdxf.filemanagement
    from ezdxf import recover
    from ezdxf.lldxf.const import DXFError

    try:
        return ezdxf.filemanagement.readfile(path)
    except (DXFError, OSError, ValueError):
        document, _ = recover.readfile(path)
        return document


def _is_hidden(layer: Any) -> bool:
    return bool(layer.is_off() or layer.is_frozen())


def _check_model_space(document: Document) -> None:
    """Say where the objects of a drawing with an empty model space are."""
    if len(document.modelspace()):
        return
    empty = "the drawing is empty: nothing is in its model space"
    papers = [name for name in document.layout_names() if _is_used(document, name)]
    if papers:
        raise PlanError(
            f"{empty}; its objects are on the sheet {papers[0]!r}; move them to model space"
        )
    blocks = [b.name for b in document.blocks if not b.name.startswith("*") and len(b)]
    if blocks:
        raise PlanError(
            f"{empty}; it only defines blocks ({', '.join(blocks[:10])}); insert the one of the "
            "storey in model space and save the drawing"
        )
    raise PlanError(empty)


def _is_used(document: Document, layout: str) -> bool:
    """Whether a sheet holds more than viewports."""
    return any(entity.dxftype() != "VIEWPORT" for entity in document.layout(layout))


def _check_blocks(document: Document) -> None:
    """Reject blocks that explode into too many objects, before exploding any."""
    sizes: dict[str, float] = {}
    total = _exploded(document.modelspace(), document, sizes, 0)
    if total > MAX_ENTITIES:
        raise PlanError(
            f"the drawing's blocks explode into {total:.3g} objects, more than {MAX_ENTITIES}; "
            f"{_LESS}"
        )


def _exploded(
    entities: Iterable[DXFGraphic], document: Document, sizes: dict[str, float], depth: int
) -> float:
    """Count the objects of a layout or block, with those of nested blocks."""
    total = 0.0
    for entity in entities:
        if entity.dxftype() != "INSERT":
            total += 1
            continue
        name = str(entity.dxf.name)
        if name not in sizes:
            sizes[name] = 0.0
            if name in document.blocks and depth < _MAX_DEPTH:
                sizes[name] = _exploded(document.blocks[name], document, sizes, depth + 1)
        total += max(sizes[name], 1.0) * max(entity.dxf.row_count * entity.dxf.column_count, 1)
    return total


class _Collector:
    """Traverses a layout and its blocks, and collects what matters in a `Content`."""

    def __init__(self, content: Content, layers: Mapping[str, str], tolerance: float) -> None:
        self._content = content
        self._layers = layers
        self._tolerance = tolerance
        self._meanings: dict[str, Meaning] = {}
        self._blocks: dict[str, tuple[Curve, ...]] = {}
        self._n_shown = 0

    def collect(self, entities: Iterable[DXFGraphic], within: str | None, depth: int) -> None:
        """Collect entities; those of a block on layer 0 are on the layer `within`."""
        for entity in entities:
            if not entity.is_supported_dxf_attrib("layer"):
                continue
            layer = str(entity.dxf.get("layer", "0"))
            layer = within if layer == "0" and within is not None else layer
            if layer in self._content.hidden and layer not in self._layers:
                self._content.n_objects[layer] += 1
            elif entity.dxftype() == "INSERT":
                self._collect_insert(entity, layer, depth)
            else:
                self._collect_curve(entity, layer)

    def _meaning(self, name: str) -> Meaning:
        if name not in self._meanings:
            self._meanings[name] = meaning_of(name, self._layers)
        return self._meanings[name]

    def _collect_curve(self, entity: DXFGraphic, layer: str) -> None:
        self._content.n_objects[layer] += 1
        if entity.dxftype() not in CURVE_TYPES:
            return
        if self._meaning(layer).kind != "ignore":
            found = curves_of(entity, self._tolerance)
            self._content.curves[layer] += found
            self._content.damaged[layer] += not found
        elif self._n_shown < _MOST_SHOWN:
            self._show(layer, curves_of(entity, self._tolerance))

    def _show(self, layer: str, curves: Iterable[Curve]) -> None:
        """Keep what is left out, to show it."""
        kept = [curve for curve in curves if is_finite(curve)]
        self._n_shown += sum(len(curve.points) for curve in kept)
        self._content.left_out[layer] += kept

    def _collect_insert(self, insert: Any, layer: str, depth: int) -> None:
        layer_kind = self._meaning(layer).kind
        name_kind = meaning_of(str(insert.dxf.get("name", ""))).kind
        named = name_kind in ("door", "window")
        block = insert.block()
        if block is not None and block.block.is_xref:
            self._content.missing.add(str(block.name))
        kind = name_kind if named else layer_kind
        if layer_kind == "ignore" or depth >= _MAX_DEPTH:
            self._content.n_objects[layer] += 1
            if self._n_shown < _MOST_SHOWN:
                matrix = insert.matrix44()
                self._show(layer, (moved_curve(c, matrix) for c in self._block(insert, depth)))
        elif kind in ("door", "window"):
            self._content.n_objects[layer] += 1
            for single in _singles(insert):
                self._content.symbols.append(self._symbol(single, kind, named, layer, depth))
        else:
            for single in _singles(insert):
                self.collect(single.virtual_entities(), layer, depth + 1)

    def _symbol(self, insert: Any, kind: Kind, named: bool, layer: str, depth: int) -> Symbol:
        matrix = insert.matrix44()
        x, y, _ = matrix.ux
        usable = isfinite(hypot(x, y)) and hypot(x, y) > 0
        axis = (float(x), float(y)) if usable else (1.0, 0.0)
        whole = self._block(insert, depth)
        curves = tuple(filter(is_finite, (moved_curve(curve, matrix) for curve in whole)))
        self._content.damaged[layer] += not curves
        return Symbol(kind, named or kind == "window", layer, axis, curves)

    def _block(self, insert: Any, depth: int) -> tuple[Curve, ...]:
        """Lines of an insert's block and its nested blocks, in the block's own coordinates."""
        name = str(insert.dxf.get("name", ""))
        if name not in self._blocks:
            self._blocks[name] = ()
            block = insert.block()
            self._blocks[name] = tuple(self._all_curves(block, depth)) if block else ()
        return self._blocks[name]

    def _all_curves(self, entities: Iterable[DXFGraphic], depth: int) -> Iterator[Curve]:
        for entity in entities:
            if entity.dxftype() in CURVE_TYPES and entity.dxftype() not in _FILLED:
                yield from curves_of(entity, self._tolerance)
            elif entity.dxftype() == "INSERT" and depth < _MAX_DEPTH:
                for single in _singles(entity):
                    matrix = single.matrix44()
                    yield from (moved_curve(c, matrix) for c in self._block(single, depth + 1))


def _singles(insert: Any) -> Iterator[Any]:
    """Single inserts of an array of blocks."""
    if insert.mcount > 1:
        yield from insert.multi_insert()
    else:
        yield insert
