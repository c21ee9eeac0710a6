"""One flat of 8 m x 6 m in the ways people draw it.

Outer faces at 0 and 8, 0 and 6; outer walls 0.3 m, a partition of 0.1 m at x = 5 (centre line), a
door of 0.9 m in the partition from y = 2 to 2.9, one of 1 m in the south wall from x = 1 to 2, and
a window of 1.5 m in the north wall from x = 2 to 3.5.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path

import ezdxf
from ezdxf.document import Drawing
from ezdxf.layouts import BlockLayout, Modelspace

Point = tuple[float, float]
Ring = Sequence[Point]

OUTER: Ring = [(0, 0), (8, 0), (8, 6), (0, 6)]
INNER: Ring = [(0.3, 0.3), (7.7, 0.3), (7.7, 5.7), (0.3, 5.7)]
MM = 1000.0


def new(insunits: int = 4) -> Drawing:
    doc = ezdxf.new("R2010")
    doc.header["$INSUNITS"] = insunits
    return doc


def save(doc: Drawing, folder: Path, name: str = "flat.dxf") -> Path:
    path = folder / name
    doc.saveas(path)
    return path


def rectangle(x0: float, y0: float, x1: float, y1: float) -> Ring:
    return [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]


def bodies() -> list[Ring]:
    """Closed outlines of every piece of wall between openings."""
    return [
        rectangle(0, 0, 1, 0.3),
        rectangle(2, 0, 8, 0.3),
        rectangle(7.7, 0.3, 8, 5.7),
        rectangle(3.5, 5.7, 8, 6),
        rectangle(0, 5.7, 2, 6),
        rectangle(0, 0.3, 0.3, 5.7),
        rectangle(4.95, 0.3, 5.05, 2),
        rectangle(4.95, 2.9, 5.05, 5.7),
    ]


def add_rings(
    space: Modelspace | BlockLayout, rings: Sequence[Ring], layer: str, k: float = MM
) -> None:
    for ring in rings:
        points = [(x * k, y * k) for x, y in ring]
        space.add_lwpolyline(points, close=True, dxfattribs={"layer": layer})


def add_lines(
    space: Modelspace | BlockLayout, lines: Sequence[tuple[Point, Point]], layer: str, k: float = MM
) -> None:
    for (x0, y0), (x1, y1) in lines:
        space.add_line((x0 * k, y0 * k), (x1 * k, y1 * k), dxfattribs={"layer": layer})


def face_lines() -> list[tuple[Point, Point]]:
    """Both faces of all walls as lines that stop at the openings, with jambs."""
    pairs: list[tuple[Point, Point]] = []
    for ring in bodies():
        pairs += list(pairwise([*ring, ring[0]]))
    shared = {frozenset(pair) for pair in pairs if _between_bodies(pair)}
    return [pair for pair in pairs if frozenset(pair) not in shared]


def _between_bodies(pair: tuple[Point, Point]) -> bool:
    """Ends of bodies that touch another body: no line is drawn there."""
    (x0, y0), (x1, y1) = pair
    across_y = y0 == y1 and y0 in (0.3, 5.7) and abs(x1 - x0) <= 0.3 + 1e-9
    return across_y


def door_block(doc: Drawing, width: float, name: str = "DOOR") -> None:
    """Hinge at the origin, shut along x, open along y, in the drawing's unit."""
    block = doc.blocks.new(name)
    block.add_line((0, 0), (0, width))
    block.add_arc((0, 0), width, 0, 90)


def window_block(doc: Drawing, width: float, depth: float, name: str = "WINDOW") -> None:
    """Around the origin, along x."""
    block = doc.blocks.new(name)
    block.add_lwpolyline(
        [(-width / 2, -depth / 2), (width / 2, -depth / 2), (width / 2, depth / 2),
         (-width / 2, depth / 2)], close=True,
    )  # fmt: skip
    block.add_line((-width / 2, 0), (width / 2, 0))


def add_openings(doc: Drawing, k: float = MM) -> None:
    """Blocks of the flat's two doors and its window."""
    door_block(doc, 900 / MM * k, "DOOR90")
    door_block(doc, k, "DOOR100")
    window_block(doc, 1.5 * k, 0.1 * k)
    space = doc.modelspace()
    attributes = {"layer": "A-DOOR"}
    inner = space.add_blockref("DOOR90", (4.95 * k, 2 * k), dxfattribs=attributes)
    inner.dxf.rotation = 90
    space.add_blockref("DOOR100", (k, 0.3 * k), dxfattribs=attributes)
    space.add_blockref("WINDOW", (2.75 * k, 5.85 * k), dxfattribs={"layer": "A-GLAZ-WINDOW"})


def flat_of_bodies(insunits: int = 4, k: float = MM) -> Drawing:
    """The habit of the sample: every piece of wall is a closed outline."""
    doc = new(insunits)
    add_rings(doc.modelspace(), bodies(), "A-WALL", k)
    add_openings(doc, k)
    return doc


def flat_of_line_pairs() -> Drawing:
    """Both faces of each wall as single lines."""
    doc = new()
    add_lines(doc.modelspace(), face_lines(), "Wände")
    add_openings(doc)
    return doc


def flat_of_single_lines() -> Drawing:
    """Centre lines only, broken at the partition's door."""
    doc = new()
    lines = [
        ((0.15, 0.15), (7.85, 0.15)), ((7.85, 0.15), (7.85, 5.85)), ((7.85, 5.85), (0.15, 5.85)),
        ((0.15, 5.85), (0.15, 0.15)), ((5, 0.15), (5, 2)), ((5, 2.9), (5, 5.85)),
    ]  # fmt: skip
    add_lines(doc.modelspace(), lines, "MURS")
    add_openings(doc)
    return doc


def flat_of_two_rings() -> Drawing:
    """Outer and inner face of the outer walls as two closed polylines, doors drawn over them."""
    doc = new()
    space = doc.modelspace()
    add_rings(space, [OUTER, INNER], "muro")
    add_rings(space, bodies()[-2:], "muro")
    add_openings(doc)
    return doc


def flat_in_nested_blocks() -> Drawing:
    """The flat as a block in a block, drawn in centimetres, turned by 90 degrees, scaled by 10."""
    doc = flat_of_bodies()
    storey = doc.blocks.new("STOREY")
    for entity in list(doc.modelspace()):
        doc.modelspace().move_to_layout(entity, storey)
    outer = doc.blocks.new("BUILDING")
    outer.add_blockref("STOREY", (100, 50), dxfattribs={"xscale": 0.1, "yscale": 0.1})
    turned = doc.modelspace().add_blockref("BUILDING", (0, 0), dxfattribs={"rotation": 90})
    turned.dxf.xscale = turned.dxf.yscale = turned.dxf.zscale = 10
    return doc
