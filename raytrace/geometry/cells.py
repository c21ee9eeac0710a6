"""The plan view cut into convex cells.

Nothing stands between two points of a convex cell, so a beam that is followed from cell to cell
through their edges needs no occlusion test. An edge of a cell is a wall of one material, a partial
wall (of several materials, or open at some heights: a door, a window, a counter) or a portal (a cut
between two cells, without a wall).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import shapely
from scipy.spatial import KDTree
from shapely.geometry.base import BaseGeometry

from raytrace.arrays import Bools, Floats, Ints
from raytrace.errors import SceneError
from raytrace.geometry.chains import Segment, Vertex, vertex_at
from raytrace.geometry.convex_parts import Edge, Ring, convex_parts, edges_of, undirected
from raytrace.geometry.junctions import NEAR_M
from raytrace.geometry.noding import node
from raytrace.geometry.sheets import Panel, Profile, Sheets
from raytrace.kernels.plan_view import GRAZING_M, PARTIAL, PORTAL, WALL, PlanView


@dataclass(frozen=True, eq=False)
class CellComplex:
    """The plan view for the kernels, and its vertices and walls.

    Attributes
    ----------
    view
        Convex cells and their edges as arrays.
    vertices
        (n, 2) [m].
    wall_segments
        The walls between vertices: (vertex, vertex, profile) of each.
    """

    view: PlanView
    vertices: Floats
    wall_segments: tuple[tuple[int, int, Profile], ...]


def cut_into_cells(sheets: Sheets, ground_margin_m: float | None = None) -> CellComplex:
    """Cut the footprint of a building into convex cells, and the ground around it.

    Parameters
    ----------
    sheets
        The building.
    ground_margin_m
        The ground is the rectangle around the footprint, this much wider on each side [m], without
        the footprint; None for no ground.

    Raises
    ------
    SceneError
        Where the walls do not enclose the footprint.
    """
    walls, cuts = node(sheets.panels, sheets.footprint)
    region = sheets.footprint
    if ground_margin_m is not None:
        x1, y1, x2, y2 = sheets.footprint.bounds
        margin = ground_margin_m
        region = shapely.box(x1 - margin, y1 - margin, x2 + margin, y2 + margin)
        around = [vertex_at(v) for v in shapely.get_coordinates(region.exterior)]
        cuts |= set(pairwise(around))
    faces = _faces([*walls, *cuts], region)
    index: dict[Vertex, int] = {}
    for a, b in [*walls, *cuts]:
        index.setdefault(a, len(index))
        index.setdefault(b, len(index))
    panel_of = {undirected(index[a], index[b]): panel for (a, b), panel in walls.items()}
    rings = convex_parts(faces, index, panel_of)
    outlines = [_outline(ring, panel_of) for ring in rings]
    vertices = _unsnapped(np.array(list(index)), sheets)
    middles = [vertices[ring].mean(axis=0) for ring in rings]
    is_outdoors = ~shapely.contains_xy(sheets.footprint, np.array(middles))
    view = _plan_view(rings, outlines, vertices, sheets.planes, is_outdoors)
    segments = tuple((a, b, panel.profile) for (a, b), panel in panel_of.items())
    return CellComplex(view, vertices, segments)


def _unsnapped(vertices: Floats, sheets: Sheets) -> Floats:
    """Move vertices from the snapping grid back to where they were drawn, or onto their walls."""
    drawn = np.array([end for p in sheets.panels for end in (p.start, p.end)])
    off, nearest = KDTree(drawn).query(vertices)
    exact = np.where((off < 1e-11)[:, None], drawn[nearest], vertices)
    for k in np.flatnonzero(off >= 1e-11):
        away = sheets.planes[:, 2] - sheets.planes[:, :2] @ vertices[k]
        on = np.abs(away) < 1e-11
        if on.any():
            exact[k] += np.linalg.lstsq(sheets.planes[on, :2], away[on])[0]
    return exact


def _faces(segments: list[Segment], region: BaseGeometry) -> list[shapely.Polygon]:
    """Polygons that the segments enclose within a region."""
    lines = [shapely.LineString(segment) for segment in segments]
    polygons = shapely.get_parts(shapely.polygonize(lines))
    inside = [p for p in polygons if region.covers(p.representative_point())]
    open_floor = region.difference(shapely.union_all(inside))
    wide = open_floor.buffer(-NEAR_M)
    if not wide.is_empty:
        missing = wide.representative_point()
        raise SceneError(
            f"the walls do not enclose the floor around ({missing.x:g}, {missing.y:g}): "
            f"{open_floor.area:.3f} m2 lie open"
        )
    return inside


def _outline(ring: Ring, panel_of: dict[Edge, Panel]) -> list[tuple[int, Panel | None]]:
    """Return a cell's corners, each with the panel on the edge that starts there.

    Full walls of one plane and one material, which reflect as one, are joined.
    """
    panels = [panel_of.get(undirected(a, b)) for a, b in edges_of(ring)]

    def is_corner(k: int) -> bool:
        one, two = panels[k - 1], panels[k]
        return (
            one is None
            or two is None
            or not one.profile.is_full
            or (one.plane, one.profile) != (two.plane, two.profile)
        )

    return [(ring[k], panels[k]) for k in range(len(ring)) if is_corner(k)]


def _plan_view(
    rings: list[Ring],
    outlines: list[list[tuple[int, Panel | None]]],
    vertices: Floats,
    planes: Floats,
    is_outdoors: Bools,
) -> PlanView:
    """Arrays of the cells' edges, cell after cell, counter-clockwise."""
    corners = [[v for v, _ in outline] for outline in outlines]
    panels = [panel for outline in outlines for _, panel in outline]
    ends = np.array([edge for ring in corners for edge in edges_of(ring)], dtype=np.int64)
    cell = np.repeat(np.arange(len(corners)), [len(ring) for ring in corners])
    number = {(int(a), int(b)): k for k, (a, b) in enumerate(ends)}
    twin = np.array([number.get((int(b), int(a)), -1) for a, b in ends], dtype=np.int64)
    passable = np.array([p is None or not p.profile.is_solid for p in panels])
    borders = np.array([p is None for p in panels]) & is_outdoors[cell] & (twin < 0)
    passable &= ~borders
    _refuse_open(passable & (twin < 0), vertices[ends])
    profiles = list(dict.fromkeys(p.profile for p in panels if p is not None))
    plane, line = _lines(panels, vertices[ends], planes)
    kind = np.array([_kind(p) for p in panels], dtype=np.int64)
    behind = _behind(rings, corners, ~passable)
    return PlanView(
        cell_edges=_offsets(corners),
        ends=vertices[ends].reshape(-1, 4),
        vertex=ends,
        plane=plane,
        line=line,
        kind=kind,
        profile=np.array([profiles.index(p.profile) if p else -1 for p in panels], dtype=np.int64),
        twin=twin,
        beyond=np.where(passable, cell[twin], -1),
        behind_first=_offsets(behind),
        behind=np.array([f for edges in behind for f in edges], dtype=np.int64),
        cell_of=cell,
        is_outdoors=is_outdoors,
        profile_intervals=_offsets([p.tops for p in profiles]),
        interval_top=np.array([t for p in profiles for t in p.tops]),
        interval_slab=np.array([m for p in profiles for m in p.materials], dtype=np.int64),
    )


def _behind(rings: list[list[int]], corners: list[list[int]], is_solid: Bools) -> list[list[int]]:
    """For each edge that is a wall at every height, the edges of other cells behind it."""
    owner: dict[tuple[int, int], int] = {}
    first = 0
    for ring, kept in zip(rings, corners, strict=True):
        start = ring.index(kept[0])
        number = first - 1
        for a, b in edges_of(ring[start:] + ring[:start]):
            number += a in kept
            owner[a, b] = number
        first += len(kept)
    behind: list[list[int]] = [[] for _ in is_solid]
    for (a, b), edge in owner.items():
        back = owner.get((b, a), -1)
        if is_solid[edge] and back >= 0 and back not in behind[edge]:
            behind[edge].append(back)
    return behind


def _offsets(groups: Sequence[Sequence[object]]) -> Ints:
    """Return where each group starts when they are laid end to end, and the end."""
    return np.cumsum([0, *(len(g) for g in groups)], dtype=np.int64)


def _kind(panel: Panel | None) -> int:
    if panel is None:
        return PORTAL
    return WALL if panel.profile.is_full else PARTIAL


def _refuse_open(lost: Bools, ends: Floats) -> None:
    if lost.any():
        (x1, y1), (x2, y2) = ends[lost][0]
        raise SceneError(
            f"the building is open from ({x1:g}, {y1:g}) to ({x2:g}, {y2:g}): "
            "the outside walls must reach from floor to ceiling"
        )


def _lines(panels: list[Panel | None], ends: Floats, planes: Floats) -> tuple[Floats, Ints]:
    """Line (n, 3) of each edge as normal and offset, and a number that collinear edges share."""
    lines, n_lines = np.empty((len(planes) + len(panels), 3)), len(planes)
    lines[:n_lines] = planes
    number = np.empty(len(panels), dtype=np.int64)
    for k, panel in enumerate(panels):
        if panel is not None and _off(ends[k], planes[panel.plane]) < GRAZING_M:
            number[k] = panel.plane
            continue
        off = _off(ends[k], lines[:n_lines])
        number[k] = int(off.argmin()) if off.min(initial=np.inf) < GRAZING_M else n_lines
        if number[k] == n_lines:
            lines[n_lines] = _line_through(ends[k])
            n_lines += 1
    return lines[number], number


def _line_through(ends: Floats) -> tuple[float, float, float]:
    """Unit normal and offset of the line through two points."""
    u = (ends[1] - ends[0]) / np.hypot(*(ends[1] - ends[0]))
    return (-u[1], u[0], float(-u[1] * ends[0, 0] + u[0] * ends[0, 1]))


def _off(ends: Floats, lines: Floats) -> Floats:
    """Distance from lines (..., 3) of the one of two points that is farther away [m]."""
    across = np.abs(lines[..., :2] @ ends.T - lines[..., 2:])
    return np.maximum(across[..., 0], across[..., 1])
