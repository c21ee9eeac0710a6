"""Mend a plan in what is safe: walls that almost meet, walls drawn twice, the outline with them."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import shapely

from floorplans.checks.plan import building_faults
from floorplans.repair.moves import at_text
from floorplans.repair.walls import REACH_M, Change, repair_walls
from floorplans.toml.writer import dumps
from floorplans.unchecked import UncheckedPlan
from floorplans.walls import TOLERANCE_M, Point


@dataclass(frozen=True)
class Mended:
    """A plan after mending, and what was done, in order."""

    plan: UncheckedPlan
    changes: tuple[Change, ...]

    def toml(self) -> str:
        """Text of the plan's file; it begins with a note of what was changed."""
        note = ["# Repaired:", *(f"#   {c}" for c in self.changes)]
        return "\n".join(note) + "\n\n" + dumps(self.plan)


def mend(plan: UncheckedPlan, reach_m: float = REACH_M) -> Mended:
    """Make walls meet that almost meet, make one of walls drawn twice, and let the outline follow.

    Parameters
    ----------
    plan : UncheckedPlan
        Its numbers are in order.
    reach_m : float
        Nothing is moved farther than walls are thick and this [m].
    """
    repaired = repair_walls(plan.walls, reach_m)
    mended = replace(plan, walls=repaired.walls) if repaired.changes else plan
    followed, moves = _follow(mended, reach_m)
    if _n_faults(followed) < _n_faults(mended):
        return Mended(followed, (*repaired.changes, *moves))
    return Mended(mended, repaired.changes)


def _n_faults(plan: UncheckedPlan) -> int:
    return sum(1 for _ in building_faults(plan))


def _follow(plan: UncheckedPlan, reach_m: float) -> tuple[UncheckedPlan, list[Change]]:
    """Move corners of the outline onto the wall ends they are beside."""
    ends = np.array([end for wall in plan.walls for end in (wall.start, wall.end)]).reshape(-1, 2)
    reach = np.array([wall.thickness_m / 2 + reach_m for wall in plan.walls]).repeat(2)
    moves: dict[Point, Point] = {}
    for corner in {(x, y) for x, y in shapely.get_coordinates(plan.outline).tolist()}:
        gaps = np.hypot(*(ends - corner).T)
        near = np.flatnonzero(gaps <= reach)
        if len(near) and gaps.min() > TOLERANCE_M:
            x, y = ends[near[np.argmin(gaps[near])]]
            moves[corner] = (float(x), float(y))
    outline = shapely.transform(
        plan.outline, lambda points: np.array([moves.get((x, y), (x, y)) for x, y in points])
    )
    changes = [
        Change("moved", f"corner of the outline moved to {at_text(to)}", corner)
        for corner, to in moves.items()
    ]
    return (replace(plan, outline=outline) if outline.is_valid else plan), changes
