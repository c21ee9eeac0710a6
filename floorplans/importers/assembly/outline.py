"""The outline of a storey, found from its walls, and the walls inside it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from math import dist

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import MultiPoint, Polygon

from floorplans.errors import PlanError
from floorplans.importers.assembly.outline_gaps import gap_links, link_lengths
from floorplans.repair.geometry import Change
from floorplans.repair.walls import split_at_junctions
from floorplans.walls import TOLERANCE_M, Wall, centre_lines

_GAPS_M = (0.0, 0.3, 0.6, 1.0, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0, 5.0, 6.0, 8.0)
"""Widths up to which gaps in the outline are closed; tried in order until one suffices [m]."""
_ENOUGH = 0.02
"""Wider gaps are closed only if that encloses this additional fraction of the walls' length."""
_ON_EDGE_M = 1e-5


@dataclass(frozen=True)
class Storey:
    """Walls in and on an outline, and the changes made."""

    outline: Polygon
    walls: tuple[Wall, ...]
    changes: tuple[Change, ...]


def find_outline(walls: Sequence[Wall], given: Polygon | None, height_m: float) -> Storey:
    """Find the outline that walls enclose; close gaps where necessary, drop walls outside.

    Parameters
    ----------
    walls : sequence of Wall
        Repaired (`floorplans.repair.walls`).
    given : shapely.geometry.Polygon or None
        What the storey covers according to the file: regions outside it are left out.
    height_m : float
        Of the ceiling; walls on the outline are raised to it [m].

    Returns
    -------
    Storey

    Raises
    ------
    PlanError
        When the walls enclose no region.
    """
    pieces = split_at_junctions(walls)
    outline, links = _best_region(pieces, given)
    changes = [
        Change("closed", f"gap of {dist(a, b):.2f} m in the outline closed", a, b) for a, b in links
    ]
    closing = _closing(pieces, links)
    inside = _inside(split_at_junctions([*pieces, *closing]), outline, changes)
    raised = _raised(inside, outline, height_m, changes)
    return Storey(outline, raised, tuple(changes))


def on_edge(walls: Sequence[Wall], outline: Polygon) -> NDArray[np.bool_]:
    """Which walls lie on the outline, (n,)."""
    edge = outline.boundary.buffer(_ON_EDGE_M)
    shapely.prepare(edge)
    return np.array(shapely.covers(edge, centre_lines(walls)), dtype=np.bool_)


Link = tuple[tuple[float, float], tuple[float, float]]


def _best_region(pieces: Sequence[Wall], given: Polygon | None) -> tuple[Polygon, list[Link]]:
    """Region with most of the walls, and the links that close it, for the least width of gaps."""
    lines = centre_lines(pieces)
    total_m = float(shapely.length(lines).sum())
    best: tuple[float, Polygon, list[Link]] | None = None
    links = gap_links(lines, max(_GAPS_M))
    lengths_m = link_lengths(links)
    for gap_m in _GAPS_M:
        region = _region(lines, links[lengths_m <= gap_m], given)
        if region is None:
            continue
        inside = _length_inside(lines, region) / total_m
        if best is None or inside > best[0] + _ENOUGH:
            best = (inside, region, _open_sections(region, lines))
        if best[0] > 1 - _ENOUGH:
            break
    if best is None:
        raise PlanError(
            "the walls enclose no region, even with gaps of "
            f"{_GAPS_M[-1]:g} m closed; check which layers hold the walls, and the unit"
        )
    outline = best[1].simplify(TOLERANCE_M / 10)
    assert isinstance(outline, Polygon)
    return outline, best[2]


def _open_sections(region: Polygon, lines: NDArray[np.object_]) -> list[Link]:
    """Sides of a region without walls, split wherever walls or links meet."""
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
    lines: NDArray[np.object_], links: NDArray[np.float64], given: Polygon | None
) -> Polygon | None:
    """Largest connected region that lines and links enclose; None if there is none."""
    closing = np.array(shapely.linestrings(links), dtype=np.object_)
    noded = shapely.union_all(np.concatenate([lines, closing]))
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
    """Length of the pieces in a region or on its edge [m]."""
    wide = region.buffer(_ON_EDGE_M)
    shapely.prepare(wide)
    return float(shapely.length(lines[shapely.covers(wide, lines)]).sum())


def _closing(pieces: Sequence[Wall], links: Sequence[Link]) -> list[Wall]:
    """Walls on links, with the properties of the longest wall at their ends."""
    tree = shapely.STRtree(centre_lines(pieces))
    longest = max(pieces, key=lambda wall: wall.length_m)
    closing: list[Wall] = []
    for start, end in links:
        near = tree.query(MultiPoint([start, end]), "dwithin", distance=_ON_EDGE_M).tolist()
        touching = [pieces[i] for i in near]
        like = max(touching or [longest], key=lambda wall: wall.length_m)
        closing.append(replace(like, start=start, end=end, openings=()))
    return closing


def _inside(pieces: Sequence[Wall], outline: Polygon, changes: list[Change]) -> list[Wall]:
    """Walls inside or on the outline; the others are dropped and recorded."""
    wide = outline.buffer(_ON_EDGE_M)
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
