"""Fewest reflections at floor and ceiling that the heights of a path need.

The height of a path rises or falls steadily over its length, and turns at the ceiling and at the
floor. Where it meets a wall with an opening, it must be within the opening to pass, and outside to
be reflected. Followed from one wall to the next, the nearest height that is allowed gives the
fewest turns, separately for paths that begin upwards and downwards.
"""

from collections.abc import Iterable
from typing import NamedTuple

from raytrace.kernels.compiling import jit
from raytrace.kernels.plan_view import PARTIAL, PlanView

TOLERANCE_M = 3e-7
"""Heights this far outside an interval count as in it [m]: more than the offsets of one-sided
evaluations (`validity.OFFSET_M`)."""

BEYOND_M, CHANGE_M = 2.0 * TOLERANCE_M, 1e-3
"""A path that has changed its height by more than `CHANGE_M` to reach one that is allowed is that
far beyond it at the next wall [m]: it neither stops rising nor falling."""

HIGHEST_M = 1e9
"""Above every ceiling [m]."""

Turns = tuple[int, float, int, float]
"""Of paths that begin upwards, and of those that begin downwards: how often they have turned, and
the lowest height that they can have if they rise, the highest if they fall [m]."""


class Heights(NamedTuple):
    """Where paths begin and end.

    Attributes
    ----------
    start
        Height at which they begin [m].
    low, high
        Lowest and highest of the heights at which they end [m].
    """

    start: float
    low: float
    high: float

    def reaching(self, others: Iterable[float]) -> "Heights":
        """Return the same, where paths may also end at other heights."""
        ends = tuple(others)
        return Heights(self.start, min(self.low, *ends), max(self.high, *ends)) if ends else self


@jit(inline=True)
def turns_from_edge(heights: Heights) -> Turns:
    """Turns at a horizontal edge; a path stays level only if it ends as high as it begins."""
    level = heights.low - CHANGE_M <= heights.start <= heights.high + CHANGE_M
    beyond = 0.0 if level else BEYOND_M
    return 0, heights.start + beyond, 0, heights.start - beyond


@jit(inner=True)
def nearest_height(view: PlanView, profile: int, is_solid: bool, z: float, rises: bool) -> float:
    """Nearest height that a path comes to, where a profile is solid or open; -1 for none."""
    bottom, found = 0.0, -1.0
    for k in range(view.profile_intervals[profile], view.profile_intervals[profile + 1]):
        top = view.interval_top[k]
        if (view.interval_slab[k] >= 0) == is_solid:
            if rises and top >= z - TOLERANCE_M:
                return z if bottom <= z + CHANGE_M else bottom + BEYOND_M
            if not rises and bottom <= z + TOLERANCE_M:
                found = z if top >= z - CHANGE_M else top - BEYOND_M
        bottom = top
    return found


@jit(inner=True)
def met(
    view: PlanView, profile: int, is_solid: bool, turns: int, z: float, rises: bool
) -> tuple[int, float]:
    """Turns and height after a wall, of a path that rises or falls before it."""
    found = nearest_height(view, profile, is_solid, z, rises)
    if found >= 0.0:
        return turns, found
    z = HIGHEST_M if rises else 0.0
    return turns + 1, nearest_height(view, profile, is_solid, z, not rises)


@jit(inner=True)
def turns_at(view: PlanView, e: int, is_solid: bool, before: Turns) -> Turns:
    """Turns of paths that meet edge e where it is solid, or where it is open."""
    if view.kind[e] != PARTIAL:
        return before
    up, z_up, down, z_down = before
    up, z_up = met(view, view.profile[e], is_solid, up, z_up, up % 2 == 0)
    down, z_down = met(view, view.profile[e], is_solid, down, z_down, down % 2 == 1)
    return up, z_up, down, z_down


@jit(inline=True)
def turns_needed(turns: Turns, heights: Heights) -> int:
    """Fewest turns of paths up to their end, which may be right behind a wall."""
    up, z_up, down, z_down = turns
    low, high = heights.low - TOLERANCE_M - BEYOND_M, heights.high + TOLERANCE_M + BEYOND_M
    ends = z_up <= high if up % 2 == 0 else z_up >= low
    up = up if ends else up + 1
    ends = z_down <= high if down % 2 == 1 else z_down >= low
    return min(up, down if ends else down + 1)
