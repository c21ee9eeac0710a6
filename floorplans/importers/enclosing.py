"""The outline of a storey, found from its walls, and walls brought to its inside."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from math import dist

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import LineString, MultiLineString, Point, Polygon
from shapely.geometry.base import BaseGeometry

from floorplans.errors import PlanError
from floorplans.repair import split_at_junctions
from floorplans.repair_walls import Change, direction, tidy_point, wall_lines
from floorplans.walls import TOLERANCE_M, Wall

_GAPS_M = (0.0, 0.3, 1.0, 2.0, 4.0, 8.0)
"""Gaps in the outline that are closed: tried in this order, the least that does it."""
_ENOUGH = 0.02
"""A wider gap is closed only if it brings this share of all walls' length inside."""
_ON_EDGE_M = 1e-5


@dataclass(frozen=True)
class Storey:
    """Walls in and on an outline, and what was done to get there."""

    outline: Polygon
    walls: tuple[Wall, ...]
    changes: tuple[Change, ...]


def enclose(walls: Sequence[Wall], given: Polygon | None, height_m: float) -> Storey:
    """Find what the walls close in, close gaps where they must be, drop what is outside.

    Parameters
    ----------
    walls : sequence of Wall
        They meet where they should (`floorplans.repair`).
    given : shapely.geometry.Polygon or None
        What the file says the storey covers: regions outside it are left out.
    height_m : float
        Of the ceiling; walls in the outline are raised to it [m].

    Returns
    -------
    Storey

    Raises
    ------
    PlanError
        When the walls close no region.
    """
    pieces = split_at_junctions(walls)
    outline, links = _best_region(pieces, given)
    changes = [
        Change("closed", f"gap of {dist(a, b):.2f} m in the outline closed", a, b) for a, b in links
    ]
    closing = [_like_nearest(pieces, a, b) for a, b in links]
    inside = _inside(split_at_junctions([*pieces, *closing]), outline, changes)
    raised = _raised(inside, outline, height_m, changes)
    return Storey(outline, raised, tuple(changes))


def on_edge(walls: Sequence[Wall], outline: Polygon) -> NDArray[np.bool_]:
    """Which walls lie in the outline, (n,)."""
    edge = outline.boundary.buffer(_ON_EDGE_M)
    shapely.prepare(edge)
    return np.array(shapely.covers(edge, wall_lines(walls)), dtype=np.bool_)


Link = tuple[tuple[float, float], tuple[float, float]]


def _best_region(pieces: Sequence[Wall], given: Polygon | None) -> tuple[Polygon, list[Link]]:
    """Region that holds most of the walls, and the links it needs, for the least width of gap."""
    lines = wall_lines(pieces)
    total_m = float(shapely.length(lines).sum())
    best: tuple[float, Polygon, list[Link]] | None = None
    for gap_m in _GAPS_M:
        links = _links(pieces, lines, gap_m) if gap_m else []
        region = _region(lines, links, given)
        if region is None:
            continue
        share = _length_inside(lines, region) / total_m
        if best is None or share > best[0] + _ENOUGH:
            best = (share, region, _open_stretches(region, lines))
    if best is None:
        raise PlanError(
            "the walls close no region, even with gaps of "
            f"{_GAPS_M[-1]:g} m closed; check which layers hold the walls, and the unit"
        )
    outline = best[1].simplify(TOLERANCE_M / 10)
    assert isinstance(outline, Polygon)
    return outline, best[2]


def _open_stretches(region: Polygon, lines: NDArray[np.object_]) -> list[Link]:
    """Sides of a region, cut wherever walls or links meet, that are no walls."""
    sides = [
        ((float(a[0]), float(a[1])), (float(b[0]), float(b[1])))
        for ring in (region.exterior, *region.interiors)
        for a, b in pairwise(ring.coords)
    ]
    middles = shapely.line_interpolate_point(shapely.linestrings(sides), 0.5, normalized=True)
    walls = shapely.STRtree(lines).query(middles, "dwithin", distance=TOLERANCE_M)[0]
    covered = set(walls.tolist())
    return [side for i, side in enumerate(sides) if i not in covered]


def _region(
    lines: NDArray[np.object_], links: Sequence[Link], given: Polygon | None
) -> Polygon | None:
    """Largest connected region that lines and links close in; None if there is none."""
    noded = shapely.union_all([*lines, *(LineString(link) for link in links)])
    faces = shapely.get_parts(shapely.polygonize(shapely.get_parts(noded)))
    if given is not None:
        covered = shapely.area(shapely.intersection(faces, given))
        faces = faces[covered > 0.5 * shapely.area(faces)]
    parts = shapely.get_parts(shapely.union_all(faces))
    polygons = [part for part in parts if isinstance(part, Polygon) and part.area > 0]
    if not polygons:
        return None
    largest = max(polygons, key=lambda polygon: polygon.area)
    holes = list(largest.interiors) if given is not None else []
    return Polygon(largest.exterior, holes)


def _length_inside(lines: NDArray[np.object_], region: Polygon) -> float:
    """Length of the pieces in a region, its edge included [m]."""
    wide = region.buffer(_ON_EDGE_M)
    shapely.prepare(wide)
    return float(shapely.length(lines[shapely.covers(wide, lines)]).sum())


def _links(pieces: Sequence[Wall], lines: NDArray[np.object_], gap_m: float) -> list[Link]:
    """Short ways from each loose end: straight on, to the nearest wall, to other loose ends."""
    tree = shapely.STRtree(lines)
    loose = _loose_ends(pieces, tree)
    links: list[Link] = []
    for i, here, ahead in loose:
        targets = [q for _, q, _ in loose if q != here and dist(here, q) <= gap_m]
        near = [j for j in tree.query(Point(here), "dwithin", distance=gap_m).tolist() if j != i]
        ray = LineString([here, (here[0] + gap_m * ahead[0], here[1] + gap_m * ahead[1])])
        others: BaseGeometry = MultiLineString([lines[j] for j in near])
        if near:
            targets.append(_nearest(others, here))
            targets += [
                _nearest(hit, here) for hit in [ray.intersection(others)] if not hit.is_empty
            ]
        links += [(here, to) for to in targets if _free(here, to, others)]
    return links + _links_between_parts(lines, gap_m)


def _links_between_parts(lines: NDArray[np.object_], gap_m: float) -> list[Link]:
    """Shortest ways between walls that hang together and others, such as pillars."""
    parts = shapely.get_parts(shapely.union_all([line.buffer(TOLERANCE_M) for line in lines]))
    near = shapely.STRtree(parts).query(parts, predicate="dwithin", distance=gap_m)
    links: list[Link] = []
    for i, j in near[:, near[0] < near[1]].T.tolist():
        ends = shapely.get_coordinates(shapely.shortest_line(parts[i], parts[j]))
        here, to = (_nearest(MultiLineString(list(lines)), tidy_point(x, y)) for x, y in ends)
        links.append((here, to))
    return links


def _loose_ends(
    pieces: Sequence[Wall], tree: shapely.STRtree
) -> list[tuple[int, tuple[float, float], tuple[float, float]]]:
    """Ends that touch no other wall: the wall's index, the end, and the direction outwards."""
    loose: list[tuple[int, tuple[float, float], tuple[float, float]]] = []
    for i, wall in enumerate(pieces):
        ux, uy = direction(wall)
        for end, ahead in ((wall.start, (-ux, -uy)), (wall.end, (ux, uy))):
            if len(tree.query(Point(end), "dwithin", distance=2 * TOLERANCE_M)) == 1:
                loose.append((i, end, ahead))
    return loose


def _nearest(geometry: BaseGeometry, here: tuple[float, float]) -> tuple[float, float]:
    x, y = shapely.get_coordinates(shapely.shortest_line(geometry, Point(here)))[0]
    return tidy_point(x, y)


def _free(here: tuple[float, float], to: tuple[float, float], walls: BaseGeometry) -> bool:
    """Whether a link has a length and no wall in its way."""
    length_m = dist(here, to)
    if length_m <= 10 * TOLERANCE_M:
        return False
    inner = shapely.line_interpolate_point(LineString([here, to]), [0.01, 0.99], normalized=True)
    return not LineString(list(inner)).intersects(walls)


def _like_nearest(
    pieces: Sequence[Wall], start: tuple[float, float], end: tuple[float, float]
) -> Wall:
    """Make a wall that looks like the longest of those at the ends of the link."""
    touching = [
        wall
        for wall in pieces
        if min(dist(a, b) for a in (wall.start, wall.end) for b in (start, end)) < 1e-5
    ]
    like = max(touching or pieces, key=lambda wall: wall.length_m)
    return replace(like, start=start, end=end, openings=())


def _inside(pieces: Sequence[Wall], outline: Polygon, changes: list[Change]) -> list[Wall]:
    """Walls in the outline or on it; the others are dropped, and told."""
    wide = outline.buffer(_ON_EDGE_M)
    shapely.prepare(wide)
    kept = shapely.covers(wide, wall_lines(pieces))
    outside = [wall for wall, stays in zip(pieces, kept, strict=True) if not stays]
    for wall in outside:
        text = f"wall of {wall.length_m:.2f} m outside the outline dropped"
        changes.append(Change("dropped", text, wall.start))
    return [wall for wall, stays in zip(pieces, kept, strict=True) if stays]


def _raised(
    walls: Sequence[Wall], outline: Polygon, height_m: float, changes: list[Change]
) -> tuple[Wall, ...]:
    """Raise walls in the outline to the ceiling."""
    raised: list[Wall] = []
    for wall, edge in zip(walls, on_edge(walls, outline).tolist(), strict=True):
        if edge and wall.height_m < height_m - TOLERANCE_M:
            text = f"wall of {wall.height_m:g} m in the outline raised to the ceiling"
            changes.append(Change("raised", text, wall.start))
            raised.append(replace(wall, height_m=height_m))
        else:
            raised.append(wall)
    return tuple(raised)
