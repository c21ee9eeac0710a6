"""Columns and shafts are solid: no room, no place for source or start, filled in drawings."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from matplotlib.figure import Figure
from small_plans import box, ring

from floorplans import FloorPlan, Opening, PlanError, Wall
from floorplans.checks.inspection import inspect
from floorplans.exporters.ros_map import FREE, OCCUPIED
from floorplans.exporters.ros_map import _pixels as ros_pixels  # pyright: ignore[reportPrivateUsage]
from floorplans.pictures.plan_view import draw_plan
from floorplans.unchecked import PlanFile

HATCH = Opening(0.1, 0.3, 0.0, 2.0, "door", "wood", 0.04)


def post(width_m: float, depth_m: float, x: float = 3.0, y: float = 1.0) -> tuple[Wall, ...]:
    """Return a ring of brick walls around a rectangle."""
    return ring([(x, y), (x + width_m, y), (x + width_m, y + depth_m), (x, y + depth_m)], "brick")


def kinds(plan: FloorPlan) -> list[str]:
    return [finding.kind for finding in inspect(PlanFile.of(plan))]


@pytest.mark.parametrize(("width_m", "depth_m"), [(0.3, 0.3), (0.5, 0.8), (0.2, 2.0)])
def test_ring_of_up_to_two_fifths_of_a_square_metre_is_solid(width_m, depth_m) -> None:
    plan = box(post(width_m, depth_m))
    (region,) = plan.solid_regions
    assert region.polygon.area == pytest.approx(width_m * depth_m)
    assert (region.top_m, region.material) == (3.0, "brick")
    assert kinds(plan) == ["no door"]  # of the box itself


def test_larger_ring_is_a_room_without_a_door() -> None:
    plan = box(post(0.5, 0.81))
    assert plan.solid_regions == ()
    assert kinds(plan) == ["no door", "no door"]


def test_many_columns_give_no_warnings() -> None:
    plan = box(tuple(w for k in range(10) for w in post(0.3, 0.3, 0.3 + 0.56 * k, 2.0)))
    assert len(plan.solid_regions) == 10
    assert kinds(plan) == ["no door"]


def test_closet_with_a_door_is_a_room() -> None:
    front, *others = post(0.6, 0.6)
    plan = box((replace(front, openings=(HATCH,)), *others))
    assert plan.solid_regions == ()


def test_door_elsewhere_in_a_wall_of_the_shaft_does_not_open_it() -> None:
    door = Opening(2.0, 0.8, 0.0, 2.0, "door")
    partition = Wall((3.0, 0.0), (3.0, 4.0), "brick", 0.1, 3.0, (door,))
    sides = ring([(3.0, 0.5), (3.6, 0.5), (3.6, 1.1), (3.0, 1.1)], "brick")[:3]
    (region,) = box((partition, *sides)).solid_regions
    assert region.polygon.bounds == (3.0, 0.5, 3.6, 1.1)


def test_sliver_between_walls_is_still_reported() -> None:
    assert "sliver" in kinds(box(post(0.03, 2.0)))


@given(
    st.floats(0.1, 0.6), st.floats(0.1, 0.6), st.floats(0.5, 3.0), st.floats(0.0, 3.0),
    st.lists(st.tuples(st.floats(0.1, 5.9), st.floats(0.1, 3.9)), min_size=1, max_size=20),
)  # fmt: skip
def test_points_in_a_column_are_outside_up_to_its_top(
    width, depth, top_m, height_m, points
) -> None:
    low = tuple(replace(wall, height_m=top_m) for wall in post(width, depth))
    x, y = np.array(points).T
    within = (x > 3) & (x < 3 + width) & (y > 1) & (y < 1 + depth)
    inside = box(low).contains(np.array(points), height_m)
    assert np.array_equal(inside, ~within | (height_m > top_m))


@pytest.mark.parametrize(
    ("key", "change"), [("source", {"source": (3.3, 1.3, 1.5)}), ("start", {"start": (3.3, 1.3)})]
)
def test_source_and_start_in_a_column_are_errors(key, change) -> None:
    message = f"{key} = .*: the {key} is in a column or shaft: walls without an opening enclose"
    with pytest.raises(PlanError, match=message):
        box(post(0.6, 0.6), **change)
    low = tuple(replace(wall, height_m=1.0) for wall in post(0.6, 0.6))
    assert box(low, **change)  # above it


def test_column_is_filled_in_drawings_and_occupied_in_robot_maps() -> None:
    plan = box(post(0.6, 0.6))
    ax = Figure().add_subplot()
    draw_plan(plan, ax)
    (brick,) = (artist for artist in ax.collections if artist.get_gid() == "walls:brick")
    assert any(path.contains_point((3.3, 1.3)) for path in brick.get_paths())
    values, (x, y) = ros_pixels(plan, 1.0, 0.05)
    assert values[int((1.3 - y) / 0.05), int((3.3 - x) / 0.05)] == OCCUPIED
    assert values[int((1.3 - y) / 0.05), int((4.3 - x) / 0.05)] == FREE
