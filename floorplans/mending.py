"""Mend a plan in what is safe: walls that almost meet, walls drawn twice, the outline with them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import dist

import numpy as np
import shapely
from shapely.geometry import LineString, Polygon
from shapely.geometry.polygon import LinearRing

from floorplans.plan import UncheckedPlan
from floorplans.repair import REACH_M, Change, repair_walls
from floorplans.toml_writer import dumps
from floorplans.walls import TOLERANCE_M, Point, Wall


@dataclass(frozen=True)
class Mended:
    """A plan after mending, and what was done, in order."""

    plan: UncheckedPlan
    changes: tuple[Change, ...]

    def toml(self) -> str:
        """Text of the plan's file; it begins with a note of what was changed."""
        note = ["# Mended by `rssnav plan check --fix`:", *(f"#   {c}" for c in self.changes)]
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
    changes = list(repaired.changes)
    shell = _follow(plan.outline.exterior, repaired.walls, changes)
    holes = [_follow(hole, repaired.walls, changes) for hole in plan.outline.interiors]
    outline = Polygon(shell, holes)
    if not outline.is_valid:
        outline = plan.outline
    return Mended(replace(plan, walls=repaired.walls, outline=outline), tuple(changes))


def _follow(ring: LinearRing, walls: tuple[Wall, ...], changes: list[Change]) -> list[Point]:
    """Move corners of a ring that lie beside a wall's line onto the end or the line they are at."""
    lines = np.array([LineString([wall.start, wall.end]) for wall in walls], dtype=np.object_)
    reach = np.array([wall.thickness_m / 2 + REACH_M for wall in walls])
    moved: list[Point] = []
    for x, y in ring.coords:
        corner = shapely.Point(x, y)
        gaps = shapely.distance(lines, corner)
        near = np.flatnonzero(gaps <= reach)
        if not len(near) or gaps[near].min() <= TOLERANCE_M:
            moved.append((x, y))
            continue
        target = _nearest([walls[k] for k in near], (x, y))
        moved.append(target)
        changes.append(Change("moved", f"corner of the outline moved to {target}", (x, y)))
    return moved


def _nearest(walls: list[Wall], corner: Point) -> Point:
    """End of a wall that is nearest to a corner."""
    ends = [end for wall in walls for end in (wall.start, wall.end)]
    return min(ends, key=lambda end: dist(end, corner))
