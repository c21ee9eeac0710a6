"""Walls aligned to the building's main directions, and openings to their walls."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import radians, sin

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import Point

from floorplans.importers.draft import RawOpening, RawWall

_TURN = radians(1.0)
_SIDEWAYS_M = 0.06
"""A rotation moves an end by at most this [m]."""
_NEARLY = sin(radians(8.0))
_BESIDE_M = 0.6
_MIN_FACE_M = 0.25


def aligned_to_main_directions(walls: Sequence[RawWall]) -> list[RawWall]:
    """Rotate walls that nearly have one of the building's two main directions exactly into it.

    The main directions, at right angles, are those of the greatest length of walls. Walls are
    rotated about their middles.

    Parameters
    ----------
    walls : sequence of RawWall

    Returns
    -------
    list of RawWall
        In the order given.
    """
    if not walls:
        return []
    ends = np.array([(wall.start, wall.end) for wall in walls])
    steps = ends[:, 1] - ends[:, 0]
    lengths = np.hypot(steps[:, 0], steps[:, 1])
    angles = np.arctan2(steps[:, 1], steps[:, 0])
    main = _main_direction(angles, lengths)
    off = (angles - main + np.pi / 4) % (np.pi / 2) - np.pi / 4
    turned = (np.abs(off) <= _TURN) & (np.abs(off) * lengths / 2 <= _SIDEWAYS_M)
    halves = np.stack([np.cos(angles - off), np.sin(angles - off)], axis=1) * lengths[:, None] / 2
    middles = ends.mean(axis=1)
    return [
        replace(wall, start=_point(middle - half), end=_point(middle + half)) if turn else wall
        for wall, turn, middle, half in zip(walls, turned.tolist(), middles, halves, strict=True)
    ]


def along_walls(openings: Sequence[RawOpening], faces: NDArray[np.float64]) -> list[RawOpening]:
    """Align openings with the longest face beside them, if it is nearly parallel.

    Parameters
    ----------
    openings : sequence of RawOpening
    faces : (n, 2, 2) float64
        Lines of walls [m].

    Returns
    -------
    list of RawOpening
        In the order given.
    """
    steps = faces[:, 1] - faces[:, 0]
    lengths = np.hypot(steps[:, 0], steps[:, 1])
    tree = shapely.STRtree(np.array(shapely.linestrings(faces), dtype=np.object_))
    turned: list[RawOpening] = []
    for opening in openings:
        far_m = opening.width_m / 2 + _BESIDE_M
        near = tree.query(Point(opening.centre), "dwithin", distance=far_m)
        near = near[lengths[near] > _MIN_FACE_M]
        along = np.array(opening.direction if opening.direction is not None else (0.0, 0.0))
        across = np.abs(steps[near, 0] * along[1] - steps[near, 1] * along[0])
        near = near[across <= _NEARLY * lengths[near] * np.hypot(*along)]
        if opening.direction is None or not near.size:
            turned.append(opening)
            continue
        longest = int(near[np.argmax(lengths[near])])
        turned.append(replace(opening, direction=_point(steps[longest] / lengths[longest])))
    return turned


def _main_direction(angles: NDArray[np.float64], lengths: NDArray[np.float64]) -> float:
    """Angle in [0, pi / 2) of the greatest length of walls, modulo right angles."""
    quarter = angles % (np.pi / 2)
    bins = np.round(quarter / _TURN).astype(int) % 90
    best = int(np.argmax(np.bincount(bins, lengths)))
    near = np.abs((quarter - best * _TURN + np.pi / 4) % (np.pi / 2) - np.pi / 4) <= _TURN
    mean = np.angle(np.sum(lengths[near] * np.exp(4j * quarter[near]))) / 4 % (np.pi / 2)
    axis = np.round(mean / (np.pi / 2)) * (np.pi / 2)
    return float(axis if abs(mean - axis) < _TURN / 10 else mean)


def _point(xy: NDArray[np.float64]) -> tuple[float, float]:
    return (float(xy[0]), float(xy[1]))
