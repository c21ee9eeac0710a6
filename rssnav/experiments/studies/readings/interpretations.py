"""Interpretations of the paper's start, source, goal and count of steps."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

INSIDE = 1e-9
"""Slack of a comparison of distances [m]."""


@dataclass(frozen=True)
class Goal:
    """Cells in which a flight ends: those within a horizontal distance of the source.

    Attributes
    ----------
    radius_m : float
        The distance [m].
    closed : bool
        Whether a cell at just that distance is one of them.
    """

    radius_m: float
    closed: bool

    def contains(self, distance_m: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Mark the distances of any shape [m] that are within it."""
        slack = INSIDE if self.closed else -INSIDE
        return distance_m <= self.radius_m + slack

    def __str__(self) -> str:
        """Return the rule."""
        return f"D {'≤' if self.closed else '<'} {self.radius_m:.3g} m"


@dataclass(frozen=True)
class Geometry:
    """Where the UAV may be and where a flight ends.

    Attributes
    ----------
    start_offset_m : float
        What is added to both of the paper's indices of the start to give its coordinates [m]; the
        receivers are at whole metres from it.
    source_offset_m : tuple of float
        What is added to the paper's coordinates (x, y) of the source [m].
    goal : Goal
        Where a flight ends.
    """

    start_offset_m: float
    source_offset_m: tuple[float, float]
    goal: Goal


STARTS = {
    0.5: "cell centre, indices from 0",
    0.0: "whole metres",
    -0.5: "cell centre, indices from 1",
    -1.0: "whole metres, indices from 1",
}
"""Interpretations of the start's indices, by what they add to them [m]."""

STATED_GOAL = Goal(2.0, closed=False)
"""The paper's goal of the location-based agent."""

GOALS = (
    STATED_GOAL,
    Goal(2.0, closed=True),
    Goal(np.hypot(1.5, 1.5).item(), closed=True),
    Goal(np.hypot(1.0, 2.0).item(), closed=True),
    Goal(2.5, closed=False),
    Goal(2.5, closed=True),
    Goal(np.hypot(0.5, 2.5).item(), closed=True),
    Goal(3.0, closed=False),
)
"""Goals around distances that a lattice of whole or half metres has."""

SOURCE_SHIFTS_M = (0.0, 0.5, -0.5)
"""Shifts of the source along both axes: none, and to either centre of a cell [m]."""

OFFSETS_M = np.linspace(-1.0, 1.0, 17)
"""Shifts of the source along each axis against whole metres, for the map of offsets [m]."""


def geometries() -> tuple[Geometry, ...]:
    """List all combinations of start, shift of the source and goal."""
    return tuple(
        Geometry(start, (shift, shift), goal)
        for start, shift, goal in product(STARTS, SOURCE_SHIFTS_M, GOALS)
    )


def offsets() -> tuple[Geometry, ...]:
    """List receivers on whole metres with the stated goal, and the source at any eighth of one."""
    return tuple(
        Geometry(0.0, (float(dx), float(dy)), STATED_GOAL)
        for dx, dy in product(OFFSETS_M, OFFSETS_M)
    )
