"""Lines drawn in pieces -> whole lines."""

from __future__ import annotations

from collections.abc import Iterator
from math import cos, radians

import numpy as np
import shapely
from numpy.typing import NDArray

_TOUCH_M = 0.002
"""Ends as near are one [m]."""
_STRAIGHT = cos(radians(4.0))
"""Cosine of the largest bend between two pieces; short ones have rounded directions."""
_ASIDE_M = 0.002
"""Farthest that an end of a piece is from the whole line [m]."""

Segments = NDArray[np.float64]


def joined_pieces(segments: Segments) -> Segments:
    """Join pieces of lines that touch end to end along one straight line.

    A face is often drawn in pieces, from a partition to the next or as the remains of edits.
    Pieces of a curve are joined as far as they deviate from a straight line by 2 mm or less.

    Parameters
    ----------
    segments : (n, 2, 2) float64
        Of some length [m].

    Returns
    -------
    (m, 2, 2) float64
        Those that are joined to none first, in the order given.
    """
    if len(segments) < 2:
        return segments
    mate = _mates(segments)
    whole = [_straight_runs(segments, chain) for chain in _chains(mate)]
    alone = (mate < 0).reshape(-1, 2).all(axis=1)
    runs = np.array([run for chain in whole for run in chain]).reshape(-1, 2, 2)
    return np.concatenate([segments[alone], runs])


def _mates(segments: Segments) -> NDArray[np.int64]:
    """The end (2n,) at which the line of each end goes on, by number; -1 if none or several do.

    Ends 2k and 2k + 1 are those of segment k.
    """
    ends = segments.reshape(-1, 2)
    steps = np.repeat(segments[:, 1] - segments[:, 0], 2, axis=0)
    inward = steps / np.hypot(steps[:, 0], steps[:, 1])[:, None]
    inward[1::2] *= -1
    points = np.array(shapely.points(ends), dtype=np.object_)
    i, j = shapely.STRtree(points).query(points, predicate="dwithin", distance=_TOUCH_M)
    on = (np.sum(inward[i] * inward[j], axis=1) < -_STRAIGHT) & (i // 2 != j // 2)
    i, j = i[on], j[on]
    single = np.bincount(i, minlength=len(ends)) == 1
    kept = single[i] & single[j]
    mate = np.full(len(ends), -1, dtype=np.int64)
    mate[i[kept]] = j[kept]
    return mate


def _chains(mate: NDArray[np.int64]) -> Iterator[list[int]]:
    """Ends along each chain of two segments or more: where its segments begin, then its end."""
    ends = mate.tolist()
    seen: set[int] = set()
    first = [end for end in range(len(ends)) if ends[end] < 0 and ends[end ^ 1] >= 0]
    rings = [end for end in range(len(ends)) if ends[end] >= 0]
    for end in [*first, *rings]:
        if end // 2 in seen:
            continue
        chain, at = [], end
        while at >= 0 and at // 2 not in seen:
            seen.add(at // 2)
            chain.append(at)
            at = ends[at ^ 1]
        yield [*chain, chain[-1] ^ 1]


def _straight_runs(segments: Segments, chain: list[int]) -> Iterator[Segments]:
    """Longest straight lines along a chain of ends, from its beginning on."""
    points = segments.reshape(-1, 2)[chain]
    low = 0
    for high in range(2, len(points)):
        if _aside_m(points[low : high + 1]) > _ASIDE_M:
            yield points[[low, high - 1]]
            low = high - 1
    yield points[[low, len(points) - 1]]


def _aside_m(points: NDArray[np.float64]) -> float:
    """Largest distance of points from the line from the first to the last [m]."""
    along = points[-1] - points[0]
    offset = points - points[0]
    length_m = max(float(np.hypot(*along)), _TOUCH_M)
    return float(np.abs(along[0] * offset[:, 1] - along[1] * offset[:, 0]).max()) / length_m
