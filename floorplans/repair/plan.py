"""Safe repairs of a plan: walls that almost meet, duplicate walls, the outline with them."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

import numpy as np
import shapely
from shapely.geometry import Polygon

from floorplans.checks.plan import faults, geos_flags_ignored
from floorplans.repair.geometry import at_text, tidy_point
from floorplans.repair.walls import REACH_M, Change, repair_walls
from floorplans.toml.writer import dumps
from floorplans.unchecked import UncheckedPlan
from floorplans.walls import TOLERANCE_M, Point

_MAX_PASSES = 8


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

    A plan stays as it is where its repair would have more errors, or would not be final: repairing
    a repaired plan changes nothing.

    Parameters
    ----------
    plan : UncheckedPlan
        Its numbers are valid.
    reach_m : float
        In one pass, nothing is moved farther than this plus the walls' thickness [m].
    """
    plan = UncheckedPlan(
        **{field.name: getattr(plan, field.name) for field in fields(UncheckedPlan)}
    )
    repaired, changes = plan, ()
    for _ in range(_MAX_PASSES):
        with geos_flags_ignored():
            once = _repair_once(repaired, reach_m)
        if not once.changes:
            return RepairedPlan(repaired, changes)
        repaired, changes = once.plan, (*changes, *once.changes)
    return RepairedPlan(plan, ())


def _repair_once(plan: UncheckedPlan, reach_m: float) -> RepairedPlan:
    walls, changes = repair_walls(plan.walls, reach_m)
    repaired = RepairedPlan(replace(plan, walls=walls) if changes else plan, changes)
    outline, moves = _outline_on_walls(repaired.plan, reach_m)
    adjusted = RepairedPlan(outline, (*changes, *moves))
    fewest = min((RepairedPlan(plan, ()), repaired, adjusted), key=_n_faults)
    return repaired if _n_faults(repaired) == _n_faults(fewest) else fewest


def _n_faults(repaired: RepairedPlan) -> int:
    return sum(1 for _ in faults(repaired.plan))


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
    if not outline.is_valid:
        return plan, []
    return _start_on_cells(replace(plan, outline=outline), plan.outline, changes)


def _start_on_cells(
    plan: UncheckedPlan, old: Polygon, changes: list[Change]
) -> tuple[UncheckedPlan, list[Change]]:
    """Move the start with the lower left corner of the outline, where the cells of maps begin.

    A start at the centre of a cell stays one, whatever the cells' size.
    """
    (x0, y0, *_), (x1, y1, *_) = old.bounds, plan.outline.bounds
    if plan.start is None or (x0, y0) == (x1, y1):
        return plan, changes
    start = tidy_point(plan.start[0] + x1 - x0, plan.start[1] + y1 - y0)
    moved = Change("moved", "start moved with the cells of maps", plan.start, start)
    return replace(plan, start=start), [*changes, moved]
