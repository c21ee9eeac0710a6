"""How many parts a plan has, counted before they are checked, because checking takes time."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import cast

from floorplans import FloorPlan
from floorplans.toml.arcs import MAX_CHORDS


@dataclass(frozen=True)
class PlanSize:
    """Numbers of parts of a plan.

    Attributes
    ----------
    walls, openings : int
    outline_points : int
        Corners of the outline and of all courtyards.
    """

    walls: int
    openings: int
    outline_points: int

    @classmethod
    def of(cls, plan: FloorPlan) -> PlanSize:
        """Return the size of a plan."""
        rings = (plan.outline.exterior, *plan.outline.interiors)
        return cls(
            walls=len(plan.walls),
            openings=sum(len(wall.openings) for wall in plan.walls),
            outline_points=sum(len(ring.coords) - 1 for ring in rings),
        )

    @classmethod
    def of_table(cls, table: Mapping[str, object]) -> PlanSize:
        """Return the size of the plan in a TOML table, which may be malformed."""
        walls = [row for row in _rows(table.get("walls")) if isinstance(row, dict)]
        rings = (table.get("outline"), *_rows(table.get("holes")))
        return cls(
            walls=sum(_most_pieces(row) for row in walls),
            openings=sum(len(_rows(row.get("openings"))) for row in walls),
            outline_points=sum(len(_rows(ring)) for ring in rings),
        )


def _most_pieces(wall: Mapping[str, object]) -> int:
    """Most straight pieces that a wall of a file can have."""
    return MAX_CHORDS if "arc" in wall else max(0, len(_rows(wall.get("points"))) - 1)


def _rows(value: object) -> list[object]:
    return cast("list[object]", value) if isinstance(value, list) else []
