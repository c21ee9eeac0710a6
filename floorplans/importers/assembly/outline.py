"""The outline of a storey, found from its walls, and the walls inside it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from math import dist, inf

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import MultiPoint, Polygon

from floorplans.errors import PlanError
from floorplans.importers.assembly.outline_gaps import gap_links, hull_links, link_lengths
from floorplans.importers.assembly.recesses import without_recesses
from floorplans.importers.assembly.wall_network import (
    ON_EDGE_M,
    Lines,
    Network,
    middles,
    not_within,
)
from floorplans.importers.defaults import CLOSED_GAP_M
from floorplans.importers.progress import Report, Step, no_report
from floorplans.repair.geometry import Change
from floorplans.repair.walls import repair_walls, split_at_junctions
from floorplans.walls import TOLERANCE_M, Wall, centre_lines

_GAPS_M = (0.0, 0.3, 0.6, 1.0, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0, 5.0, 6.0, 8.0, 12.0, 20.0, 35.0, 60.0)
"""Widths up to which gaps in the outline are closed; tried in order until one suffices [m]."""
_ENOUGH = 0.02
"""Wider gaps are closed only if that encloses this additional fraction of the walls' length."""
_MOSTLY_OPEN = 0.5
"""Fraction of the walls' length below which what is enclosed is a room, not the building."""
_OPEN_REST = 0.1
"""Fraction of the length of walls that is no closed building, of what is one nevertheless."""
_CORRIDOR_M = 4.0
"""Buildings that are closed by themselves are one only across gaps up to this width [m]."""
_NARROW_M = 0.3
"""A narrower region is a gap between walls, not a building [m]."""

Link = tuple[tuple[float, float], tuple[float, float]]


@dataclass(frozen=True)
class Storey:
    """Walls in and on an outline.

    Attributes
    ----------
    outline : shapely.geometry.Polygon
    walls : tuple of Wall
    changes : tuple of Change
    gaps : tuple of Link
        Where the outline has no wall, because the gap is wider than may be closed [m].
    enclosed : float
        Fraction of the walls' length that is in or on the outline.
    """

    outline: Polygon
    walls: tuple[Wall, ...]
    changes: tuple[Change, ...] = ()
    gaps: tuple[Link, ...] = ()
    enclosed: float = 1.0


@dataclass(frozen=True)
class _Region:
    """What walls and links enclose; the sides that only links close; how much of the walls."""

    polygon: Polygon
    gaps: tuple[Link, ...]
    enclosed: float


def find_outline(
    walls: Sequence[Wall],
    given: Polygon | None,
    height_m: float,
    max_gap_m: float | None = None,
    report: Report = no_report,
) -> Storey:
    """Find the outline that walls enclose; close gaps where necessary, drop walls outside.

    Gaps are closed by the shortest links from free ends and corners of walls to other walls, where
    that brings walls inside: those up to the least width that encloses the building, where no
    greater width up to `max_gap_m` encloses another 2 % of the walls' length. A building that is
    open wider keeps its gaps.

    Parameters
    ----------
    walls : sequence of Wall
        Repaired (`floorplans.repair.walls`).
    given : shapely.geometry.Polygon or None
        What the storey covers according to the file: regions outside it are left out.
    height_m : float
        Of the ceiling; walls on the outline are raised to it [m].
    max_gap_m : float or None
        Wider gaps stay open; None is `CLOSED_GAP_M` [m].
    report : callable
        Called with finished steps.

    Returns
    -------
    Storey
    """
    pieces = split_at_junctions(walls)
    limit_m = CLOSED_GAP_M if max_gap_m is None else max_gap_m
    network = Network(centre_lines(pieces))
    report(Step.WALLS_SPLIT)
    region = _enclosed_region(network, given, limit_m, max_gap_m is not None)
    short = [gap for gap in region.gaps if dist(*gap) <= limit_m]
    changes = [
        Change("closed", f"gap of {dist(a, b):.2f} m in the outline closed", a, b) for a, b in short
    ]
    closing = _closing(pieces, short)
    inside = _inside(split_at_junctions([*pieces, *closing]), region.polygon, changes)
    raised = _raised(inside, region.polygon, height_m, changes)
    gaps = tuple(gap for gap in region.gaps if dist(*gap) > limit_m)
    return Storey(region.polygon, raised, tuple(changes), gaps, region.enclosed)


def outline_of(walls: Sequence[Wall], given: Polygon | None) -> Polygon | None:
    """Outline that walls enclose without any gap; None if there is none.

    Parameters
    ----------
    walls : sequence of Wall
        In their final positions.
    given : shapely.geometry.Polygon or None
        As in `find_outline`.
    """
    network = Network(centre_lines(split_at_junctions(walls)))
    region = _largest_face(network, given)
    return None if region is None else _simplified(region)


def on_edge(walls: Sequence[Wall], outline: Polygon) -> NDArray[np.bool_]:
    """Which walls lie on the outline, (n,)."""
    edge = outline.boundary.buffer(ON_EDGE_M)
    shapely.prepare(edge)
    return np.array(shapely.covers(edge, centre_lines(walls)), dtype=np.bool_)


def _enclosed_region(
    network: Network, given: Polygon | None, limit_m: float, is_strict: bool
) -> _Region:
    """Region that gaps up to a limit close, or one with wider gaps where that is no building.

    Under a strict limit a building is open where the default limit would enclose more of it;
    otherwise only where hardly any of the walls are enclosed, in whatever number of buildings.
    """
    lines = network.lines
    closed = _region(lines, network, given)
    if closed and closed.enclosed > 1 - _ENOUGH:
        return closed
    outer = network if closed is None or given is not None else network.around(closed.polygon)
    links = _links(lines, outer, max(limit_m, CLOSED_GAP_M))
    corridor_m = inf if is_strict or given is not None else _CORRIDOR_M
    found = _best_region(lines, outer, links, given, (limit_m, corridor_m))
    if is_strict and limit_m < CLOSED_GAP_M:
        wider = _best_region(lines, outer, links, given, (CLOSED_GAP_M, inf))
        if wider and (found is None or wider.enclosed > found.enclosed + _ENOUGH):
            return wider
    if found and (found.enclosed > _MOSTLY_OPEN or _is_closed(network, links, found)):
        return found
    links = _links(lines, outer, max(_GAPS_M))
    wider = _best_region(lines, outer, links, given, (max(_GAPS_M), inf))
    if found and not (wider and wider.enclosed > _MOSTLY_OPEN):
        return found
    return wider or _hull(lines)


def _links(lines: Lines, outer: Network, max_gap_m: float) -> NDArray[np.float64]:
    """Links up to a length; beyond what is closed by default, also those of missing sides."""
    links = gap_links(outer.lines, max_gap_m)
    if max_gap_m <= CLOSED_GAP_M:
        return links
    return np.concatenate([links, hull_links(lines, max_gap_m)])


def _best_region(
    lines: Lines,
    outer: Network,
    links: NDArray[np.float64],
    given: Polygon | None,
    limits_m: tuple[float, float],
) -> _Region | None:
    """Region with most of the walls for the least width of gaps; None if there is none.

    The limits are that of all gaps, and of those between buildings that are closed by themselves.
    """
    limit_m, corridor_m = limits_m
    best: _Region | None = None
    for gap_m in [*(width for width in _GAPS_M if width < limit_m), limit_m]:
        if gap_m > corridor_m and best and _are_closed(outer, best.polygon):
            break
        is_short = link_lengths(links) <= gap_m
        outer, links = outer.with_links(links[is_short]), links[~is_short]
        region = _region(lines, outer, given)
        if region and given is None:
            outer = outer.around(region.polygon)
            links = shapely.get_coordinates(
                not_within(np.array(shapely.linestrings(links)), region.polygon)
            ).reshape(-1, 2, 2)
        if region and (best is None or region.enclosed > best.enclosed + _ENOUGH):
            best = region
        if best and best.enclosed > 1 - _ENOUGH:
            break
    return best


def _region(lines: Lines, outer: Network, given: Polygon | None) -> _Region | None:
    """Region that an outer network encloses, and how much of all lines it holds."""
    polygon = _largest_face(outer, given)
    if polygon is None:
        return None
    if given is None:
        gaps = np.array(_open_sections(polygon, outer.lines))
        polygon = without_recesses(polygon, gaps, outer)
    enclosed = _length_inside(lines, polygon) / float(shapely.length(lines).sum())
    return _Region(_simplified(polygon), tuple(_open_sections(polygon, outer.lines)), enclosed)


def _simplified(polygon: Polygon) -> Polygon:
    """Outline without corners on straight sides; it begins at its leftmost corner."""
    simple = shapely.normalize(polygon).simplify(TOLERANCE_M / 10)
    assert isinstance(simple, Polygon)
    return simple


def _is_closed(network: Network, links: NDArray[np.float64], region: _Region) -> bool:
    """Whether most of the walls outside a region are part of other closed buildings."""
    lines = network.lines
    widths_m = [dist(*gap) for gap in region.gaps]
    used = links[link_lengths(links) <= max(widths_m, default=0.0)]
    faces = network.with_links(used).faces()
    wide = shapely.coverage_union_all(faces).buffer(ON_EDGE_M)
    shapely.prepare(wide)
    lengths_m = shapely.length(lines)
    return float(lengths_m[shapely.covers(wide, lines)].sum()) > _MOSTLY_OPEN * lengths_m.sum()


def _are_closed(outer: Network, region: Polygon) -> bool:
    """Whether nearly all walls outside a region are in or on others that are closed."""
    lines = not_within(outer.lines, region.buffer(2 * ON_EDGE_M))
    wide = shapely.coverage_union_all(outer.faces()).buffer(ON_EDGE_M)
    shapely.prepare(wide)
    lengths_m = shapely.length(lines)
    closed_m = float(lengths_m[shapely.covers(wide, lines)].sum())
    return closed_m > (1 - _OPEN_REST) * lengths_m.sum()


def _hull(lines: Lines) -> _Region:
    """Smallest convex region around walls that enclose nothing."""
    hull = shapely.MultiLineString(list(lines)).convex_hull
    if not isinstance(hull, Polygon):
        raise PlanError(
            "the walls enclose no region, because they all lie on one line; check which layers "
            "hold the walls, and the unit"
        )
    ends = shapely.get_coordinates(lines)
    sides = (
        ends[np.array(shapely.dwithin(shapely.linestrings(side), shapely.points(ends), ON_EDGE_M))]
        for side in pairwise(hull.exterior.coords)
    )
    starts = np.array(hull.exterior.coords)[:-1]
    ring = [
        point
        for start, on_side in zip(starts, sides, strict=True)
        for point in on_side[np.argsort(np.hypot(*(on_side - start).T))].tolist()
    ]
    return _Region(hull, tuple(_open_sections(Polygon(ring), lines)), 1.0)


def _open_sections(region: Polygon, lines: Lines) -> list[Link]:
    """Sides of a region without walls, split wherever walls or links meet."""
    sides = [
        ((float(a[0]), float(a[1])), (float(b[0]), float(b[1])))
        for ring in (region.exterior, *region.interiors)
        for a, b in pairwise(ring.coords)
    ]
    halfway = middles(np.array(shapely.linestrings(sides), dtype=np.object_))
    walls = shapely.STRtree(lines).query(halfway, "dwithin", distance=TOLERANCE_M)[0]
    covered = set(walls.tolist())
    return [side for i, side in enumerate(sides) if i not in covered]


def _largest_face(network: Network, given: Polygon | None) -> Polygon | None:
    """Largest connected region that a network encloses; None if there is none."""
    faces = network.faces()
    if given is not None:
        covered = shapely.area(shapely.intersection(faces, given))
        faces = faces[covered > 0.5 * shapely.area(faces)]
    parts = shapely.get_parts(shapely.coverage_union_all(faces))
    polygons = [part for part in parts if isinstance(part, Polygon)]
    by_size = sorted(polygons, key=lambda polygon: -polygon.area)
    wide = (part for part in by_size if not part.buffer(-_NARROW_M / 2).is_empty)
    largest = next(wide, None)
    if largest is None:
        return None
    holes = list(largest.interiors) if given is not None else []
    return Polygon(largest.exterior, holes)


def _length_inside(lines: Lines, region: Polygon) -> float:
    """Length of the pieces in a region or on its edge [m]."""
    wide = region.buffer(ON_EDGE_M)
    shapely.prepare(wide)
    return float(shapely.length(lines[shapely.covers(wide, lines)]).sum())


def _closing(pieces: Sequence[Wall], links: Sequence[Link]) -> list[Wall]:
    """Walls on links, with the properties of the longest wall at their ends."""
    tree = shapely.STRtree(centre_lines(pieces))
    longest = max(pieces, key=lambda wall: wall.length_m)
    closing: list[Wall] = []
    for start, end in links:
        near = tree.query(MultiPoint([start, end]), "dwithin", distance=ON_EDGE_M).tolist()
        touching = [pieces[i] for i in near]
        like = max(touching or [longest], key=lambda wall: wall.length_m)
        closing.append(replace(like, start=start, end=end, openings=()))
    return closing


def _inside(pieces: Sequence[Wall], outline: Polygon, changes: list[Change]) -> list[Wall]:
    """Walls inside or on the outline; the others are dropped and recorded."""
    wide = outline.buffer(ON_EDGE_M)
    shapely.prepare(wide)
    kept = shapely.covers(wide, centre_lines(pieces))
    outside = [wall for wall, stays in zip(pieces, kept, strict=True) if not stays]
    for wall in outside:
        text = f"wall of {wall.length_m:.2f} m outside the outline dropped"
        changes.append(Change("dropped", text, wall.start))
    return [wall for wall, stays in zip(pieces, kept, strict=True) if stays]


def _raised(
    walls: Sequence[Wall], outline: Polygon, height_m: float, changes: list[Change]
) -> tuple[Wall, ...]:
    """Raise walls on the outline to the ceiling."""
    raised: list[Wall] = []
    for wall, edge in zip(walls, on_edge(walls, outline).tolist(), strict=True):
        if edge and wall.height_m < height_m - TOLERANCE_M:
            text = f"wall of {wall.height_m:g} m in the outline raised to the ceiling"
            changes.append(Change("raised", text, wall.start))
            raised.append(replace(wall, height_m=height_m))
        else:
            raised.append(wall)
    return tuple(raised)


def settled(
    storey: Storey, given: Polygon | None, height_m: float, reach_m: float
) -> Storey | None:
    """Make walls meet exactly, and derive the outline from where they then are.

    Parameters
    ----------
    storey : Storey
    given, height_m
        As in `find_outline`.
    reach_m : float
        How far walls are moved [m].

    Returns
    -------
    Storey or None
        None where the outline loses more than `_ENOUGH` of its area; a storey with gaps keeps its
        outline.
    """
    walls = repair_walls(storey.walls, reach_m, 0.0, 0.0).walls
    if storey.gaps:
        return replace(storey, walls=walls)
    outline = outline_of(walls, given)
    if outline is None or outline.area < (1 - _ENOUGH) * storey.outline.area:
        return None
    changes = list(storey.changes)
    inside = _inside(walls, outline, changes)
    return replace(
        storey,
        outline=outline,
        walls=_raised(inside, outline, height_m, changes),
        changes=tuple(changes),
    )
