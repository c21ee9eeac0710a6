"""Safe repairs of a plan: walls that almost meet, duplicate walls, the outline with them."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import shapely

from floorplans.checks.plan import building_faults
from floorplans.repair.geometry import at_text
from floorplans.repair.walls import REACH_M, Change, repair_walls
from floorplans.toml.writer import dumps
from floorplans.unchecked import UncheckedPlan
from floorplans.walls import TOLERANCE_M, Point


@dataclass(frozen=True)
class RepairedPlan:
    """A repaired plan, and the changes in order."""

    plan: UncheckedPlan
    changes: tuple[Change, ...]

    def toml(self) -> str:
        """Text of the plan's file; it begins with a comment that lists the changes."""
        note = ["# Repaired:", *(f"#   {c}" for c in self.changes)]
        return "\n".join(note) + "\n\n" + dumps(self.plan)


def repair_plan(plan: UncheckedPlan, reach_m: float = REACH_M) -> RepairedPlan:
    """Make walls meet that almost meet, merge duplicate walls, and adjust the outline.

    Parameters
    ----------
    plan : UncheckedPlan
        Its numbers are valid.
    reach_m : float
        Nothing is moved farther than this plus the walls' thickness [m].
    """
    walls, changes = repair_walls(plan.walls, reach_m)
    repaired = replace(plan, walls=walls) if changes else plan
    adjusted, moves = _outline_on_walls(repaired, reach_m)
    if _n_faults(adjusted) < _n_faults(repaired):
        return RepairedPlan(adjusted, (*changes, *moves))
    return RepairedPlan(repaired, changes)


def _n_faults(plan: UncheckedPlan) -> int:
    return sum(1 for _ in building_faults(plan))


def _outline_on_walls(plan: UncheckedPlan, reach_m: float) -> tuple[UncheckedPlan, list[Change]]:
    """Move corners of the outline to the wall ends beside them."""
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
