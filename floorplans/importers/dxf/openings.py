"""Symbols of doors and windows in a drawing -> openings."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from math import dist, hypot

import numpy as np
import shapely
from shapely.geometry import LineString, Point, Polygon
from shapely.geometry.base import BaseGeometry

from floorplans.importers.draft import RawOpening
from floorplans.importers.dxf.curves import Curve, Swing
from floorplans.importers.dxf.drawing import Symbol
from floorplans.walls import OpeningKind
from floorplans.walls import Point as Point2

_LEAF_M = (0.35, 2.0)
_LEAF_FRACTION = 0.4
"""Arcs smaller than this fraction of a symbol's largest are handles and stops."""
_BESIDE_M = 0.1
"""Largest distance of a door's hinge from its wall [m]."""
_AHEAD_M = 1.0
"""How far walls are searched on both sides of a door [m]."""
_DRAWN_FRACTION = 0.8
_CLUSTER_M = 0.1
_MAX_DEPTH_M = 1.0
_SHUT_M = 1.5
"""Half of the widest gap across which outer walls are assumed to continue [m]."""
_MIN_WIDTH_M = 0.3


def openings_of_symbol(symbol: Symbol, walls: BaseGeometry) -> list[RawOpening]:
    """Openings of a door's or window's block, in metres.

    A door is as wide as the radius of its swing, and lies between the hinge and the end of the arc
    towards which its wall continues. Without a swing, the opening is the longer side of the block's
    box along the block's own axes.

    Parameters
    ----------
    symbol : Symbol
    walls : shapely geometry
        All lines and areas of walls [m].

    Returns
    -------
    list of RawOpening
        Empty if the symbol is too small to be an opening; a "passage" if neither name nor swing
        distinguishes door and window: see `as_windows_outside`.
    """
    kind: OpeningKind = "window" if symbol.kind == "window" else "door"
    swings = door_swings(symbol.curves) if kind == "door" else []
    if swings:
        return [opening_of_swing(swing, symbol.curves, walls) for swing in swings]
    points = [point for curve in symbol.curves for point in curve.points]
    opening = _opening_of_box(points, symbol.axis, kind)
    if opening is None:
        return []
    return [opening if symbol.named else replace(opening, kind="passage")]


def door_swings(curves: Sequence[Curve]) -> list[Swing]:
    """Arcs of leaves among the curves of a door."""
    low_m, high_m = _LEAF_M
    swings = [c.swing for c in curves if c.swing is not None and low_m <= c.swing.radius <= high_m]
    largest_m = max((swing.radius for swing in swings), default=0.0)
    large = [swing for swing in swings if swing.radius >= _LEAF_FRACTION * largest_m]
    return [swing for swing in swings if swing in large or _is_second_leaf(swing, large)]


def _is_second_leaf(swing: Swing, others: Sequence[Swing]) -> bool:
    """Whether a small leaf shuts against a larger one, as in a door of two unequal leaves."""
    return any(
        dist(end, shut) <= _BESIDE_M
        and abs(dist(swing.hinge, other.hinge) - swing.radius - other.radius) <= _BESIDE_M
        for other in others
        for end in swing.ends
        for shut in other.ends
    )


def opening_of_swing(swing: Swing, curves: Sequence[Curve], walls: BaseGeometry) -> RawOpening:
    """Opening that a leaf closes: towards the end of its swing where the wall continues.

    Parameters
    ----------
    swing : Swing
    curves : sequence of Curve
        Of the same symbol; the leaf among them is drawn open.
    walls : shapely geometry
        All lines and areas of walls [m].
    """
    lines = [LineString(curve.points) for curve in curves if curve.swing is None]
    leaves = shapely.union_all([line.buffer(_BESIDE_M) for line in lines])
    x, y = swing.hinge
    near = walls.intersection(Point(x, y).buffer(swing.radius + 2 * _AHEAD_M)).buffer(_BESIDE_M)

    def wall_ahead_m(end: Point2) -> float:
        """Length of wall behind the hinge and beyond the end, reduced where the leaf is drawn."""
        ux, uy = (end[0] - x) / swing.radius, (end[1] - y) / swing.radius
        behind = LineString([swing.hinge, (x - ux * _AHEAD_M, y - uy * _AHEAD_M)])
        beyond = LineString([end, (end[0] + ux * _AHEAD_M, end[1] + uy * _AHEAD_M)])
        leaf = LineString([swing.hinge, end])
        drawn = leaf.intersection(leaves).length > _DRAWN_FRACTION * leaf.length
        wall_m = behind.intersection(near).length + beyond.intersection(near).length
        return wall_m - (_AHEAD_M / 2 if drawn else 0.0)

    return RawOpening.between(swing.hinge, max(swing.ends, key=wall_ahead_m), "door")


def _opening_of_box(points: Sequence[Point2], axis: Point2, kind: OpeningKind) -> RawOpening | None:
    """Opening along the longer side of the box around points, parallel to an axis."""
    if len(points) < 2:
        return None
    along = np.array(axis) / hypot(*axis)
    across = np.array([-along[1], along[0]])
    frame = np.stack([along, across])
    local = np.array(points) @ frame.T
    low, high = local.min(axis=0), local.max(axis=0)
    side = int(np.argmax(high - low))
    width_m = float((high - low)[side])
    if width_m < _MIN_WIDTH_M:
        return None
    x, y = (low + high) / 2 @ frame
    return RawOpening(
        (float(x), float(y)), width_m, kind, (float(frame[side][0]), float(frame[side][1]))
    )


def as_windows_outside(openings: Sequence[RawOpening], area: BaseGeometry) -> list[RawOpening]:
    """Make an opening of unknown kind a window in the outer walls, a door inside.

    Parameters
    ----------
    openings : sequence of RawOpening
        Those of unknown kind are a "passage".
    area : shapely geometry
        Of the walls [m].
    """
    if all(opening.kind != "passage" for opening in openings):
        return list(openings)
    closed = shapely.get_parts(area.buffer(_SHUT_M))
    blocks = [Polygon(part.exterior) for part in closed if isinstance(part, Polygon)]
    inner = shapely.union_all(blocks).buffer(-_SHUT_M - _MAX_DEPTH_M / 2)
    return [
        replace(opening, kind="door" if inner.contains(Point(opening.centre)) else "window")
        if opening.kind == "passage"
        else opening
        for opening in openings
    ]


@dataclass(frozen=True)
class LooseLines:
    """A cluster of lines of windows or doors, and the opening it forms, if any."""

    opening: RawOpening | None
    lines: tuple[LineString, ...]


def loose_lines(curves: Sequence[Curve], kind: OpeningKind) -> Iterator[LooseLines]:
    """Cluster lines that touch or nearly touch, with the opening each cluster would be.

    Parameters
    ----------
    curves : sequence of Curve
        Of layers of windows or doors, in metres, without arcs of doors.
    kind : {"door", "window"}
    """
    lines = [LineString([*c.points, *c.points[: c.closed]]) for c in curves]
    if not lines:
        return
    clusters = shapely.get_parts(shapely.union_all([line.buffer(_CLUSTER_M) for line in lines]))
    tree = shapely.STRtree(lines)
    for cluster in clusters:
        members = tuple(lines[i] for i in tree.query(cluster, predicate="intersects").tolist())
        yield LooseLines(_opening_of_cluster(members, kind), members)


def _opening_of_cluster(lines: Sequence[LineString], kind: OpeningKind) -> RawOpening | None:
    envelope = shapely.oriented_envelope(shapely.multilinestrings(list(lines)))
    if isinstance(envelope, Polygon):
        a, b, c = shapely.get_coordinates(envelope)[:3]
        sides = sorted(
            [(float(np.hypot(*(b - a))), b - a), (float(np.hypot(*(c - b))), c - b)],
            key=lambda s: s[0],
        )
        (depth_m, _), (width_m, along) = sides
    else:
        depth_m, width_m = 0.0, envelope.length
        ends = shapely.get_coordinates(envelope)
        along = ends[-1] - ends[0] if len(ends) > 1 else np.zeros(2)
    if depth_m > _MAX_DEPTH_M or width_m < _MIN_WIDTH_M or depth_m > width_m:
        return None
    middle = envelope.centroid
    return RawOpening((middle.x, middle.y), width_m, kind, (float(along[0]), float(along[1])))
