"""Where a plan is solid at a height."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from small_plans import ROOM, box, plans

import floorplans
from floorplans import FloorPlan, Opening, Wall


def partition(plan: FloorPlan, height_m: float) -> list[tuple[float, float]]:
    """Solid intervals along the partition at x = 3, as pairs of y [m]."""
    segments = plan.solid_segments(height_m)
    inside = np.all(segments[:, :, 0] == 3, axis=1)
    return [tuple(ys) for ys in segments[inside][:, :, 1].tolist()]


@pytest.mark.parametrize(
    ("height_m", "expected"),
    [
        (0.5, [(0, 1), (2, 4)]),  # beside the door, in the window's sill
        (1.5, [(0, 1), (2, 4)]),  # beside the door, in the glass
        (1.9, [(0, 1), (2, 4)]),
        (2.0, [(0, 4)]),  # the lintel's lower edge
        (2.3, [(0, 4)]),
        (3.0, [(0, 4)]),
    ],
)
def test_filled_window_is_solid_and_open_door_is_not(height_m, expected) -> None:
    assert partition(floorplans.loads(ROOM), height_m) == expected


@pytest.mark.parametrize(
    ("height_m", "expected"),
    [
        (0.99, [(0, 4)]),
        (1.01, [(0, 2.5), (3.5, 4)]),
        (2.49, [(0, 2.5), (3.5, 4)]),
        (2.51, [(0, 4)]),
    ],
)
def test_open_window_is_open_between_sill_and_head(height_m, expected) -> None:
    window = Opening(2.5, 1.0, 1.0, 2.5, "window")
    plan = box((Wall((3.0, 0.0), (3.0, 4.0), "brick", 0.1, 3.0, (window,)),))
    assert partition(plan, height_m) == expected


@pytest.mark.parametrize(("height_m", "count"), [(0.9, 1), (1.0, 1), (1.1, 0)])
def test_low_wall_is_solid_up_to_its_top(height_m: float, count: int) -> None:
    plan = box((Wall((3.0, 1.0), (3.0, 2.0), "wood", 0.1, 1.0),))
    assert len(partition(plan, height_m)) == count


@settings(deadline=None, max_examples=30)
@given(plan=plans(), share=st.floats(0.001, 0.999))
def test_length_is_that_of_the_walls_minus_openings_at_that_height(plan, share) -> None:
    height = share * plan.height_m
    expected = sum(
        wall.length_m
        - sum(o.width_m for o in wall.openings if not o.material and o.sill_m < height < o.head_m)
        for wall in plan.walls
        if wall.height_m >= height
    )
    segments = plan.solid_segments(height)
    assert segments.dtype == np.float64
    assert segments.shape[1:] == (2, 2)
    lengths = np.linalg.norm(segments[:, 1] - segments[:, 0], axis=1)
    assert lengths.sum() == pytest.approx(expected, rel=1e-9, abs=1e-4)


def test_ends_of_a_whole_wall_are_exact() -> None:
    wall = Wall((0.1, 0.3), (5.7, 3.9), "wood", 0.1, 3.0)
    segments = box((wall,)).solid_segments(1.0)
    assert segments[-1].tolist() == [list(wall.start), list(wall.end)]


@pytest.mark.parametrize("height_m", [-0.1, 3.1, float("nan")])
def test_height_outside_the_storey_is_rejected(height_m: float) -> None:
    with pytest.raises(ValueError, match=r"height_m = .*: expected 0 to 3 \[m\]"):
        box().solid_segments(height_m)
