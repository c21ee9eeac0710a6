"""Short links across gaps between walls, candidates for closing the outline."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import KDTree

from floorplans.walls import TOLERANCE_M

_NEAREST_ENDS = 4
_NEAREST_WALLS = 8
_SPREAD = np.cos(np.pi / 4)
_CORNER = np.sin(np.radians(20.0))
"""Sine of the least bend between two walls that is a corner."""
_CLEAR_M = 1e-3
_CLEAR_FRACTION = 5e-4
"""A link that comes as near to a wall between its ends, in metres or as a fraction of its length,
runs along it or past its end."""
_FIRST_RADIUS_M = 0.25
_BEYOND = 1e-5
"""Fraction of the longest link that a link straight ahead begins beyond an end."""

Segments = NDArray[np.float64]
Lines = NDArray[np.object_]


def gap_links(lines: Lines, max_gap_m: float) -> Segments:
    """Links from free ends, corners and between groups of walls, without a wall in between.

    From each free end they go to the nearest free ends, to the nearest wall, and straight ahead;
    from each corner, as at the open end of a corridor, straight ahead along both walls; from each
    group of connected walls, such as a pillar, to the nearest walls of other groups.

    Parameters
    ----------
    lines : (n,) shapely lines
        Walls that meet at their ends only.
    max_gap_m : float
        Length of the longest link [m].

    Returns
    -------
    (n, 2, 2) float64
        Link, end, and (x, y) [m].
    """
    tree = shapely.STRtree(lines)
    owner, ends, ahead = _free_ends(lines, tree)
    at_corner, corners, along = _corners(lines, tree)
    return _clear(
        [
            _to_ends(ends, max_gap_m),
            _to_walls(owner, ends, lines, tree, max_gap_m),
            _straight_ahead(owner, ends, ahead, lines, tree, max_gap_m),
            _straight_ahead(at_corner, corners, along, lines, tree, max_gap_m),
            _between_groups(lines, tree, max_gap_m),
        ],
        tree,
        max_gap_m,
    )


def hull_links(lines: Lines, max_gap_m: float) -> Segments:
    """Links along the sides of the smallest convex region around all walls, as of `gap_links`.

    A building that lacks whole sides is closed by them: its far ends are nobody's nearest.
    """
    ring = shapely.get_coordinates(shapely.convex_hull(shapely.multilinestrings(lines)))
    sides = np.stack([ring[:-1], ring[1:]], axis=1)
    return _clear([sides], shapely.STRtree(lines), max_gap_m)


def link_lengths(links: Segments) -> NDArray[np.float64]:
    """Length of each link [m], (n,)."""
    steps = links[:, 1] - links[:, 0]
    return np.hypot(steps[:, 0], steps[:, 1])


def _free_ends(
    lines: Lines, tree: shapely.STRtree
) -> tuple[NDArray[np.int64], NDArray[np.float64], NDArray[np.float64]]:
    """Ends that touch no other wall: the wall's index, the end, and the unit vector ahead."""
    ends, ahead = _ends(lines)
    touching, _ = tree.query(_points(ends), "dwithin", distance=2 * TOLERANCE_M)
    free = np.flatnonzero(np.bincount(touching, minlength=len(ends)) == 1)
    return free // 2, ends[free], ahead[free]


def _ends(lines: Lines) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Both ends of each line and the unit vectors ahead, (2 n, 2)."""
    ends = shapely.get_coordinates(lines).reshape(-1, 2)
    ahead = ends - ends.reshape(-1, 2, 2)[:, ::-1].reshape(-1, 2)
    return ends, ahead / np.hypot(ahead[:, 0], ahead[:, 1])[:, None]


def _to_ends(ends: NDArray[np.float64], max_gap_m: float) -> Segments:
    """Links between free ends, each to a few of the nearest."""
    if len(ends) < 2:
        return np.empty((0, 2, 2))
    k = min(_NEAREST_ENDS + 1, len(ends))
    _, near = KDTree(ends).query(ends, k=k, distance_upper_bound=max_gap_m)
    here, rank = np.nonzero(np.asarray(near) < len(ends))
    there = np.asarray(near)[here, rank]
    return np.stack([ends[here], ends[there]], axis=1)[here < there]


def _to_walls(
    owner: NDArray[np.int64],
    ends: NDArray[np.float64],
    lines: Lines,
    tree: shapely.STRtree,
    max_gap_m: float,
) -> Segments:
    """Link from each free end to the nearest other wall."""
    links = [np.empty((0, 2, 2))]
    todo = np.arange(len(ends))
    done = [todo[:0]]
    for radius_m in _radii(max_gap_m):
        points = _points(ends[todo])
        which, wall = tree.query(points, "dwithin", distance=radius_m)
        other = wall != owner[todo[which]]
        which, wall = which[other], wall[other]
        best = _first_of_each(which, shapely.distance(points[which], lines[wall]))
        shortest = shapely.shortest_line(points[which[best]], lines[wall[best]])
        links.append(shapely.get_coordinates(shortest).reshape(-1, 2, 2))
        done.append(todo[which[best]])
        todo = np.delete(todo, which[best])
    return np.concatenate(links)[np.argsort(np.concatenate(done))]


def _radii(most_m: float) -> Iterator[float]:
    """Doubling distances up to the largest [m]: what is near is found before much is compared."""
    radius_m = min(_FIRST_RADIUS_M, most_m)
    while radius_m < most_m:
        yield radius_m
        radius_m *= 2
    yield most_m


def _straight_ahead(
    owner: NDArray[np.int64],
    ends: NDArray[np.float64],
    ahead: NDArray[np.float64],
    lines: Lines,
    tree: shapely.STRtree,
    max_gap_m: float,
) -> Segments:
    """Link from the end of each wall straight ahead to the first wall beyond."""
    links = [np.empty((0, 2, 2))]
    todo = np.arange(len(ends))
    done = [todo[:0]]
    for radius_m in _radii(max_gap_m):
        hit, found = _first_ahead(
            owner[todo], ends[todo], ahead[todo], lines, tree, (radius_m, _BEYOND * max_gap_m)
        )
        links.append(found)
        done.append(todo[hit])
        todo = np.delete(todo, hit)
    return np.concatenate(links)[np.argsort(np.concatenate(done))]


def _first_ahead(
    owner: NDArray[np.int64],
    ends: NDArray[np.float64],
    ahead: NDArray[np.float64],
    lines: Lines,
    tree: shapely.STRtree,
    reach: tuple[float, float],
) -> tuple[NDArray[np.int64], Segments]:
    """Which ends have a wall ahead within a distance, and the links to the first.

    The distance and how far beyond an end the search begins are `reach` [m].
    """
    radius_m, skipped_m = reach
    beyond = ends + skipped_m * ahead
    rays = np.array(
        shapely.linestrings(np.stack([beyond, ends + radius_m * ahead], axis=1)), dtype=np.object_
    )
    which, wall = tree.query(rays, "intersects")
    other = wall != owner[which]
    which, wall = which[other], wall[other]
    shortest = np.array(
        shapely.shortest_line(
            _points(beyond)[which], shapely.intersection(rays[which], lines[wall])
        ),
        dtype=np.object_,
    )
    best = _first_of_each(which, shapely.length(shortest))
    links = shapely.get_coordinates(shortest[best]).reshape(-1, 2, 2)
    links[:, 0] = ends[which[best]]
    return which[best], links


def _corners(
    lines: Lines, tree: shapely.STRtree
) -> tuple[NDArray[np.int64], NDArray[np.float64], NDArray[np.float64]]:
    """Ends at which two walls meet at an angle: as those of `_free_ends`."""
    ends, ahead = _ends(lines)
    touching, wall = tree.query(_points(ends), "dwithin", distance=2 * TOLERANCE_M)
    is_pair = np.bincount(touching, minlength=len(ends)) == 2
    other = is_pair[touching] & (wall != touching // 2)
    end, beside = touching[other], ahead[2 * wall[other]]
    along = ahead[end]
    bends = np.abs(along[:, 0] * beside[:, 1] - along[:, 1] * beside[:, 0]) > _CORNER
    return end[bends] // 2, ends[end[bends]], along[bends]


def _between_groups(lines: Lines, tree: shapely.STRtree, max_gap_m: float) -> Segments:
    """Links from each group of connected walls to a few of the nearest other walls."""
    if not len(lines):
        return np.empty((0, 2, 2))
    touching = tree.query(lines, "dwithin", distance=2 * TOLERANCE_M)
    graph = coo_array((np.ones(touching.shape[1]), tuple(touching)), shape=(len(lines),) * 2)
    n_groups, labels = connected_components(graph, directed=False)
    todo = np.ones(n_groups, dtype=np.bool_)
    found: list[NDArray[np.int64]] = []
    for radius_m in _radii(max_gap_m):
        a, b = _pairs_of_groups(lines, tree, labels, todo, radius_m)
        distance_m = shapely.distance(lines[a], lines[b])
        best = _first_of_each(labels[a] * len(lines) + b, distance_m)
        best = best[np.lexsort((distance_m[best], labels[a[best]]))]
        group = labels[a[best]]
        rank = np.arange(len(best)) - np.searchsorted(group, group)
        complete = np.bincount(group, minlength=n_groups) >= _NEAREST_WALLS
        kept = best[(rank < _NEAREST_WALLS) & (complete[group] | (radius_m == max_gap_m))]
        found.append(np.stack([a[kept], b[kept]]))
        todo &= ~complete
    a, b = np.concatenate(found, axis=1)
    a, b = np.stack([a, b])[:, np.argsort(labels[a], kind="stable")]
    links = shapely.get_coordinates(shapely.shortest_line(lines[a], lines[b]))
    return _spread(labels[a], links.reshape(-1, 2, 2))


def _pairs_of_groups(
    lines: Lines,
    tree: shapely.STRtree,
    labels: NDArray[np.int64],
    todo: NDArray[np.bool_],
    distance_m: float,
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Walls of some groups, and walls of other groups within a distance, in the walls' order.

    Every such pair has a wall outside the largest group, which may hold nearly all walls: those
    outside it are looked up alone.
    """
    largest = int(np.argmax(np.bincount(labels)))
    wanted = todo[labels] | todo[largest]
    asked = np.flatnonzero(wanted & (labels != largest))
    first, second = tree.query(lines[asked], "dwithin", distance=distance_m)
    first = asked[first]
    mirrored = labels[second] == largest
    a = np.concatenate([first, second[mirrored]])
    b = np.concatenate([second, first[mirrored]])
    used = (labels[a] != labels[b]) & todo[labels[a]]
    a, b = a[used], b[used]
    order = np.lexsort((b, a))
    return a[order], b[order]


def _spread(group: NDArray[np.int64], links: Segments) -> Segments:
    """Links that leave their group in distinct directions, the shortest of each direction."""
    lengths = link_lengths(links)
    kept: dict[int, list[NDArray[np.float64]]] = {}
    chosen: list[int] = []
    for i in np.argsort(lengths, kind="stable").tolist():
        along = (links[i, 1] - links[i, 0]) / max(float(lengths[i]), TOLERANCE_M)
        directions = kept.setdefault(int(group[i]), [])
        if all(along @ other < _SPREAD for other in directions):
            directions.append(along)
            chosen.append(i)
    return links[chosen]


def _first_of_each(which: NDArray[np.int64], value: NDArray[np.float64]) -> NDArray[np.int64]:
    """Indices of the smallest value of each number in `which`."""
    order = np.lexsort((value, which))
    _, first = np.unique(which[order], return_index=True)
    return order[first]


def _clear(links: Sequence[Segments], tree: shapely.STRtree, max_gap_m: float) -> Segments:
    """Links that are neither too short nor too long, without a wall in between."""
    found = np.concatenate(links)
    lengths = link_lengths(found)
    found = found[(lengths > 10 * TOLERANCE_M) & (lengths <= max_gap_m)]
    return found[_unobstructed(found, tree)]


def _unobstructed(links: Segments, tree: shapely.STRtree) -> NDArray[np.bool_]:
    """Which links neither meet nor nearly touch a wall between their ends."""
    step = 0.01 * (links[:, 1] - links[:, 0])
    inner = np.stack([links[:, 0] + step, links[:, 1] - step], axis=1)
    clear_m = np.minimum(_CLEAR_M, _CLEAR_FRACTION * link_lengths(links))
    lines = np.array(shapely.linestrings(inner), dtype=np.object_)
    clear = np.ones(len(links), dtype=np.bool_)
    clear[tree.query(lines, "dwithin", distance=clear_m)[0]] = False
    return clear


def _points(ends: NDArray[np.float64]) -> Lines:
    return np.array(shapely.points(ends), dtype=np.object_)
