"""Flights on a floor without walls, searched exactly.

A flight of n steps, b of them diagonal, ends when it first touches the goal. For each cell and
each n, a word holds in its bit b whether the cell can be reached so without having touched the goal
before. Walls only remove flights, so one that does not exist here exists on no floor plan. Flights
of 64 diagonal steps and more drop out of the words; the printed lengths have at most 57.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rssnav.experiments.paper.counting import Count
from rssnav.experiments.studies.readings.interpretations import Geometry
from rssnav.experiments.studies.readings.lengths import StepCounts
from rssnav.world import ACTIONS

Words = NDArray[np.uint64]

ONE = np.uint64(1)


@dataclass(frozen=True)
class Floor:
    """Size of a scenario, its start and its source, as the paper states them.

    Attributes
    ----------
    size_m : tuple of int
        (x, y) [m].
    start_index : tuple of int
        The paper's index (x, y) of the start.
    source_m : tuple of float
        The paper's coordinates (x, y) of the source [m].
    """

    size_m: tuple[int, int]
    start_index: tuple[int, int]
    source_m: tuple[float, float]


FLOORS = {1: Floor((96, 26), (93, 2), (5.0, 14.0)), 2: Floor((76, 58), (74, 55), (4.0, 4.0))}
"""The paper's scenarios."""


@dataclass(frozen=True, eq=False)
class Lattice:
    """Receivers that can be reached at one speed; a step moves by one along an axis or both.

    Attributes
    ----------
    start : tuple of int
        Row and column of the start.
    goal : ndarray of bool, shape (n_y, n_x)
        Receivers at which a flight ends.
    """

    start: tuple[int, int]
    goal: NDArray[np.bool_]


def lattice(floor: Floor, geometry: Geometry, speed: int) -> Lattice:
    """Place the receivers that can be reached at a speed; none is on the border, where walls stand.

    Parameters
    ----------
    floor : Floor
        Size, start and source.
    geometry : Geometry
        Their interpretation.
    speed : int
        Metres between these receivers along each axis.

    Returns
    -------
    Lattice
    """
    axes: list[NDArray[np.float64]] = []
    start: list[int] = []
    for size, index in zip(floor.size_m, floor.start_index, strict=True):
        at = index + geometry.start_offset_m
        first = at % speed or float(speed)
        axes.append(np.arange(first, size, speed))
        start.append(round((at - first) / speed))
    shift = geometry.source_offset_m
    x, y = np.meshgrid(*axes)
    distance = np.hypot(x - floor.source_m[0] - shift[0], y - floor.source_m[1] - shift[1])
    return Lattice((start[1], start[0]), geometry.goal.contains(distance))


@dataclass(frozen=True, eq=False)
class Arrivals:
    """Numbers of diagonal steps with which flights enter the goal, after each number of steps.

    Attributes
    ----------
    straight, diagonal : list of int
        Bit b of the entry n: a flight of n steps, b of them diagonal, enters the goal with its last
        step, which is straight or diagonal.
    without_first : list of int
        As above for any last step, where the first step is in neither number.
    """

    straight: list[int]
    diagonal: list[int]
    without_first: list[int]

    def has(self, counts: StepCounts, count: Count) -> bool:
        """Whether a flight has these counted steps."""
        n, b = counts.steps, counts.diagonal
        if count is Count.ALL:
            return bool((self.straight[n] | self.diagonal[n]) >> b & 1)
        if count is Count.WITHOUT_FIRST:
            return bool(self.without_first[n] >> b & 1)
        return bool(self.straight[n + 1] >> b & 1 or self.diagonal[n + 1] >> (b + 1) & 1)

    @property
    def least_steps(self) -> int:
        """Fewest steps of a flight that enters the goal; -1 where none does."""
        lit = [bool(s | d) for s, d in zip(self.straight, self.diagonal, strict=True)]
        return lit.index(True) if any(lit) else -1


def arrivals(receivers: Lattice, most_steps: int) -> Arrivals:
    """Find how flights of up to ``most_steps`` + 1 steps enter the goal.

    Parameters
    ----------
    receivers : Lattice
        Receivers, start and goal.
    most_steps : int
        Most counted steps.

    Returns
    -------
    Arrivals
    """
    start = np.zeros(receivers.goal.shape, np.uint64)
    start[receivers.start] = ~receivers.goal[receivers.start]
    straight, diagonal = entries(receivers.goal, start, most_steps + 1, _moved)
    first = np.bitwise_or(*_moved(start))
    second = np.where(receivers.goal, np.uint64(0), (first > 0).astype(np.uint64))
    later = entries(receivers.goal, second, most_steps, _moved)
    without_first = [s | d for s, d in zip(*later, strict=True)]
    without_first[0] |= (straight[1] | diagonal[1]) > 0
    return Arrivals(straight, diagonal, without_first)


def entries(
    goal: NDArray[np.bool_],
    words: Words,
    n_steps: int,
    moved_by: Callable[[Words], tuple[Words, Words]],
) -> tuple[list[int], list[int]]:
    """Bits of the flights that enter the goal by a straight and by a diagonal n-th step.

    Parameters
    ----------
    goal : ndarray of bool
        Where a flight ends.
    words : ndarray of uint64, of the same shape
        Flights before the first step.
    n_steps : int
        Most steps.
    moved_by : callable
        Returns the words after one more step, by straight and by diagonal steps.
    """
    straight, diagonal = [0], [0]
    for _ in range(n_steps):
        moved = moved_by(words)
        straight.append(int(np.bitwise_or.reduce(moved[0][goal], initial=0)))
        diagonal.append(int(np.bitwise_or.reduce(moved[1][goal], initial=0)))
        words = np.where(goal, np.uint64(0), np.bitwise_or(*moved))
    return straight, diagonal


def _moved(words: Words) -> tuple[Words, Words]:
    """Words after one more step, by straight and by diagonal steps."""
    n_y, n_x = words.shape
    straight, diagonal = np.zeros_like(words), np.zeros_like(words)
    for dx, dy in ACTIONS:
        target = straight if dx == 0 or dy == 0 else diagonal
        target[max(0, dy) : n_y + min(0, dy), max(0, dx) : n_x + min(0, dx)] |= words[
            max(0, -dy) : n_y + min(0, -dy), max(0, -dx) : n_x + min(0, -dx)
        ]
    return straight, diagonal << ONE
