"""FloorPlan -> DXF drawing in metres.

Layers: WALL-MATERIAL holds the outlines of wall bodies, interrupted at openings, with the wall's
height as their thickness; DOOR and WINDOW hold a block for each opening; AXIS the centre lines.
Importing the drawing restores the walls and openings, source, start and transmitters' places, but
not the heights of walls and openings.
"""

from __future__ import annotations

from collections.abc import Sequence
from io import StringIO
from math import atan2, degrees
from pathlib import Path

import ezdxf
import numpy as np
import shapely
from ezdxf import units
from ezdxf.document import Drawing
from ezdxf.layouts.layout import Modelspace
from ezdxf.math import Matrix44

from floorplans.exporters.formats import ExportOptions, Files
from floorplans.pictures.symbols import DOUBLE_DOOR_M, WallStrips
from floorplans.plan import FloorPlan
from floorplans.walls import TOLERANCE_M, Opening, OpeningKind, Wall, centre_lines

LAYERS: dict[OpeningKind, str] = {"door": "DOOR", "window": "WINDOW", "passage": "DOOR-PASSAGE"}

_WIDEST_SWING_M = 3.6
_MIN_THICKNESS_M = 0.001
_SAME_DIRECTION = 0.1
"""Walls are across each other beyond this sine of the angle between them."""
_RED, _BLUE, _GREEN, _GREY, _MAGENTA = 1, 5, 3, 8, 6


def render_dxf(plan: FloorPlan, path: Path, _options: ExportOptions) -> Files:
    """Render a plan as one DXF drawing."""
    document = ezdxf.new("R2010", setup=True)  # pyright: ignore[reportPrivateImportUsage]
    document.units = units.M
    _add_layers(document, plan)
    _add_blocks(document)
    space = document.modelspace()
    strips, across = WallStrips(plan, _MIN_THICKNESS_M), _WallsAcross(plan.walls)
    for wall in plan.walls:
        _draw_wall(space, wall, strips)
        for opening in wall.openings:
            _insert(space, wall, opening, _block(opening, across.meets(wall, opening)))
    if plan.source is not None:
        space.add_point(plan.source, dxfattribs={"layer": "SOURCE"})
    for transmitter in plan.transmitters:
        space.add_point(transmitter.position, dxfattribs={"layer": "TRANSMITTER"})
    if plan.start is not None:
        space.add_point(plan.start, dxfattribs={"layer": "START"})
    if plan.frame is not None:
        to_drawing = Matrix44(plan.frame.matrix().T.ravel().tolist())
        for entity in space:
            entity.transform(to_drawing)
    text = StringIO()
    document.write(text)
    return {path.name: text.getvalue().encode(document.output_encoding, "dxfreplace")}


def wall_layer(material: str) -> str:
    """Return the layer of walls of a material."""
    return f"WALL-{material.upper()}"


def _add_layers(document: Drawing, plan: FloorPlan) -> None:
    materials = dict.fromkeys(wall.material for wall in plan.walls)
    names = {wall_layer(material): 7 for material in materials}
    names |= {"DOOR": _RED, "DOOR-PASSAGE": _GREEN, "WINDOW": _BLUE, "AXIS": _GREY}
    names |= dict.fromkeys(("SOURCE", "TRANSMITTER", "START"), _MAGENTA)
    for name, colour in names.items():
        document.layers.add(name, color=colour)


def _add_blocks(document: Drawing) -> None:
    """Create blocks of 1 m x 1 m that an insert scales: x along the wall, y across it."""
    door = document.blocks.new("DOOR")
    door.add_line((0, 0), (0, 1))
    door.add_arc((0, 0), 1, 0, 90)
    double = document.blocks.new("DOOR-DOUBLE")
    for hinge, shut_deg in ((0, 0), (1, 90)):
        double.add_line((hinge, 0), (hinge, 0.5))
        double.add_arc((hinge, 0), 0.5, shut_deg, shut_deg + 90)
    box = [(0, -0.5), (1, -0.5), (1, 0.5), (0, 0.5)]
    window = document.blocks.new("WINDOW")
    window.add_lwpolyline(box, close=True)
    window.add_line((0, 0), (1, 0))
    for name in ("DOOR-WIDE", "DOOR-PASSAGE"):
        document.blocks.new(name).add_lwpolyline(box, close=True)


def _draw_wall(space: Modelspace, wall: Wall, strips: WallStrips) -> None:
    for corners in strips.strips(wall):
        space.add_lwpolyline(
            corners.tolist(),
            close=True,
            dxfattribs={"layer": wall_layer(wall.material), "thickness": wall.height_m},
        )
    space.add_line(wall.start, wall.end, dxfattribs={"layer": "AXIS"})


def _insert(space: Modelspace, wall: Wall, opening: Opening, block: str) -> None:
    """Insert an opening's block: a swing as wide as it is, or a box that fills the wall."""
    (x0, y0), (x1, y1) = wall.start, wall.end
    swings = block in ("DOOR", "DOOR-DOUBLE")
    space.add_blockref(
        block,
        wall.point_at(opening.offset_m),
        dxfattribs={
            "layer": LAYERS[opening.kind],
            "xscale": opening.width_m,
            "yscale": opening.width_m if swings else wall.thickness_m,
            "rotation": degrees(atan2(y1 - y0, x1 - x0)),
        },
    )


def _block(opening: Opening, meets_wall: bool) -> str:
    """Name of an opening's block; no leaf swings into a wall across, which would hide it."""
    if opening.kind != "door":
        return LAYERS[opening.kind]
    if opening.width_m > _WIDEST_SWING_M or meets_wall:
        return "DOOR-WIDE"
    return "DOOR-DOUBLE" if opening.width_m > DOUBLE_DOOR_M else LAYERS["door"]


class _WallsAcross:
    """Finds whether openings reach to a wall across their own."""

    def __init__(self, walls: Sequence[Wall]) -> None:
        self._walls = walls
        self._tree = shapely.STRtree(centre_lines(walls))
        self._reach_m = max((wall.thickness_m for wall in walls), default=0.0) / 2 + TOLERANCE_M

    def meets(self, wall: Wall, opening: Opening) -> bool:
        """Whether a jamb of a wall's opening stands in the body of a wall across."""
        ends_m = opening.offset_m, opening.offset_m + opening.width_m
        jambs = shapely.points([wall.point_at(end_m) for end_m in ends_m])
        return any(
            _cross(wall, self._walls[i])
            and float(shapely.distance(jambs[k], self._tree.geometries[i]))
            <= self._walls[i].thickness_m / 2 + TOLERANCE_M
            for k, i in self._tree.query(jambs, "dwithin", distance=self._reach_m).T
        )


def _cross(wall: Wall, other: Wall) -> bool:
    """Whether walls run in clearly different directions."""
    (ax, ay), (bx, by) = (np.subtract(w.end, w.start) / w.length_m for w in (wall, other))
    return bool(abs(ax * by - ay * bx) > _SAME_DIRECTION)
