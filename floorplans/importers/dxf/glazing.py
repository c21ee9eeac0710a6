"""Windows and doors drawn as plain lines, and walls of glass."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely
from shapely.geometry import LineString, Point
from shapely.geometry.base import BaseGeometry

from floorplans.importers.centrelines.areas import walls_of_area
from floorplans.importers.centrelines.gaps import fill_gaps
from floorplans.importers.centrelines.parallel_lines import strips_of_lines
from floorplans.importers.defaults import WINDOW_MATERIAL, WINDOW_THICKNESS_M
from floorplans.importers.draft import RawOpening, RawWall
from floorplans.importers.dxf.curved_glazing import (
    IN_WALL_M,
    PAIR_M,
    along_curve,
    between_others,
    is_bent,
    is_curve_in_wall,
    smooth_pieces,
    without_caps,
)
from floorplans.importers.dxf.curves import Swing
from floorplans.importers.dxf.drawing import Content
from floorplans.importers.dxf.layers import Layers
from floorplans.importers.dxf.openings import door_swings, loose_lines

CLOSE_M = 0.02
"""Gaps between wall areas up to this are closed [m]."""
MIN_SINGLE_M = 0.3
"""Shorter single lines are no walls [m]."""
_CROSSING_M = 1.0


def loose_openings(
    content: Content, layers: Layers, area: BaseGeometry
) -> tuple[list[RawOpening], list[RawOpening], list[LineString]]:
    """Openings of lines in a wall or its gap, those on chords of a curved wall, and other lines."""
    openings: list[RawOpening] = []
    bent: list[RawOpening] = []
    glass: list[LineString] = []
    for layer in layers.of("passage"):
        found = [cluster.opening for cluster in loose_lines(content.curves[layer], "door")]
        openings += [o for o in found if o is not None and _is_in_wall(o, area)]
    for layer in (*layers.of("window"), *layers.of("door")):
        curves = content.curves[layer]
        leaves = door_swings(curves)
        others = [curve for curve in curves if curve.swing not in leaves]
        for cluster in loose_lines(others, "window"):
            if _has_leaf(cluster.lines, leaves):
                continue
            lines = [piece for line in cluster.lines for piece in smooth_pieces(line)]
            straight = None if is_bent(lines) else cluster.opening
            if straight is not None and _is_in_wall(straight, area):
                openings.append(straight)
            elif is_curve_in_wall(lines, area):
                bent += along_curve(lines)
            else:
                glass += without_caps(lines)
    return openings, bent, glass


def _has_leaf(lines: Sequence[LineString], leaves: Sequence[Swing]) -> bool:
    """Whether lines belong to a door's leaf."""
    joined = shapely.union_all(list(lines))
    return any(Point(p).distance(joined) < IN_WALL_M for s in leaves for p in (s.hinge, *s.ends))


def _is_in_wall(opening: RawOpening, area: BaseGeometry) -> bool:
    """Whether an opening lies in a wall, or in a gap of one."""
    in_wall = Point(opening.centre).distance(area) < IN_WALL_M
    return in_wall or bool(fill_gaps(area, [opening]))


def _outside(line: LineString, area: BaseGeometry) -> BaseGeometry:
    """Line without the sections inside an area, except short crossings."""
    inside = shapely.get_parts(line.intersection(area))
    along = [part for part in inside if part.length > min(_CROSSING_M, 0.9 * line.length)]
    return line.difference(shapely.union_all(along).buffer(IN_WALL_M / 10))


def glass_walls(lines: Sequence[LineString], area: BaseGeometry) -> list[RawWall]:
    """Walls of glass on single lines, and between two lines that face each other.

    Lines inside other walls or on their faces are ignored, and so are lines between two others; a
    pane may cross walls.
    """
    if not lines:
        return []
    wide = area.buffer(IN_WALL_M)
    parts = shapely.get_parts([_outside(line, wide) for line in lines])
    chains = [shapely.get_coordinates(part) for part in parts if part.length > MIN_SINGLE_M]
    if not chains:
        return []
    segments = np.concatenate([np.stack([c[:-1], c[1:]], axis=1) for c in chains])
    walls = strips_of_lines(segments[~between_others(segments)], PAIR_M)
    found = walls_of_area(shapely.union_all(list(walls.area)), CLOSE_M) if walls.area else []
    ends = [(wall.start, wall.end) for wall in found]
    ends += [((x0, y0), (x1, y1)) for (x0, y0), (x1, y1) in walls.singles.tolist()]
    return [RawWall(a, b, WINDOW_THICKNESS_M, WINDOW_MATERIAL) for a, b in ends]
