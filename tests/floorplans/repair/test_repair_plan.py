"""A repaired plan has no more errors than before, reads back, and is final."""

from __future__ import annotations

from dataclasses import replace
from random import Random

import pytest
from shapely.geometry import Polygon
from small_plans import box

from floorplans import Wall
from floorplans.checks.plan import faults
from floorplans.loading import loads_unchecked
from floorplans.repair.plan import RepairedPlan, repair_plan
from floorplans.unchecked import UncheckedPlan

MOVES_M = (0.0, 0.0, 1e-7, 1e-5, -1e-3, 0.01, -0.03, 0.05, 0.08, -0.1, 0.5)


def drawn(seed: int) -> UncheckedPlan:
    """Return the box with walls in it, and the ends of all walls a little off."""
    random = Random(seed)

    def off(point: tuple[float, float]) -> tuple[float, float]:
        x, y = (coordinate + random.choice(MOVES_M) for coordinate in point)
        return (x, y)

    plan = box((Wall((0.0, 2.0), (3.0, 2.0), "wood", 0.1, 3.0),))
    inside = [
        Wall((random.uniform(0, 6), 0.0), (random.uniform(0, 6), 4.0), "brick", 0.2, 3.0)
        for _ in range(random.randint(0, 3))
    ]
    copies = random.sample(plan.walls, random.randint(0, 2))
    walls = [replace(wall, start=off(wall.start), end=off(wall.end)) for wall in (*inside, *copies)]
    shell = [wall if random.random() < 0.7 else replace(wall, end=off(wall.end))
             for wall in plan.walls]  # fmt: skip
    values = {name: getattr(plan, name) for name in UncheckedPlan.__dataclass_fields__}
    return UncheckedPlan(**values | {"walls": (*shell, *walls)})


@pytest.mark.parametrize("seed", range(40))
def test_a_repair_is_no_worse_reads_back_and_is_final(seed: int) -> None:
    plan = drawn(seed)
    repaired = repair_plan(plan)
    assert len(list(faults(repaired.plan))) <= len(list(faults(plan)))
    assert loads_unchecked(repaired.toml()).plan == repaired.plan
    assert repair_plan(repaired.plan) == RepairedPlan(repaired.plan, ())
    assert repaired.changes or repaired.plan == plan


def test_a_good_plan_is_not_made_wrong() -> None:
    """A wall that ends beside a corner would pull the corner out of the outline."""
    stud = Wall((0.05, 0.0), (3.0, 4.0), "wood", 0.1, 3.0)
    plan = box((stud,))
    repaired = repair_plan(plan)
    assert not list(faults(repaired.plan))


@pytest.mark.parametrize("cell_m", [0.5, 1.0])
def test_a_start_stays_at_the_centre_of_a_cell_where_the_outline_moves(cell_m: float) -> None:
    plan = box(())
    low_x, low_y = plan.outline.bounds[0] - 0.03, plan.outline.bounds[1] - 0.04
    corners = [(low_x, low_y) if p == (0.0, 0.0) else p for p in plan.outline.exterior.coords]
    start = (low_x + 3.5 * cell_m, low_y + 2.5 * cell_m)
    values = {name: getattr(plan, name) for name in UncheckedPlan.__dataclass_fields__}
    off = UncheckedPlan(**values | {"outline": Polygon(corners), "start": start})
    assert any(faults(off))
    repaired = repair_plan(off)
    assert not any(faults(repaired.plan))
    assert repaired.plan.start == pytest.approx((3.5 * cell_m, 2.5 * cell_m))
    assert any(change.text == "start moved with the cells of maps" for change in repaired.changes)


def test_most_drawings_are_improved() -> None:
    wrong = [plan for seed in range(12) if any(faults(plan := drawn(seed)))]
    fewer = sum(repair_plan(plan).changes != () for plan in wrong)
    assert fewer > 0.5 * len(wrong)
