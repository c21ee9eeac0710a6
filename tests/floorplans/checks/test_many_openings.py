"""Thousands of openings are checked in time that does not grow with the square of their number."""

from __future__ import annotations

import time
from dataclasses import replace
from itertools import combinations

import pytest
from hypothesis import given
from hypothesis import strategies as st
from shapely.geometry import Polygon
from small_plans import ROOM, box, ring

from floorplans import FloorPlan, Opening, Wall
from floorplans.checks.inspection import inspect
from floorplans.checks.walls import overlapping_pair
from floorplans.loading import loads_unchecked
from floorplans.unchecked import PlanFile
from floorplans.walls import solid_heights

N = 2000
LENGTH_M = 1000.0
coordinates = st.integers(0, 12).map(lambda k: k / 4) | st.floats(0.0, 3.0)


@st.composite
def openings(draw: st.DrawFn) -> Opening:
    low, sill = draw(coordinates), draw(coordinates)
    return Opening(low, draw(coordinates), sill, sill + draw(coordinates), "window", "glass")


@given(st.lists(openings(), max_size=12))
def test_sweep_finds_an_overlap_where_comparing_all_pairs_does(several) -> None:
    pairs = {
        (i, j)
        for (i, one), (j, other) in combinations(enumerate(several), 2)
        if one.overlaps(other)
    }
    found = overlapping_pair(several)
    assert found in pairs if pairs else found is None


def glazed(kind: str) -> FloorPlan:
    """Return a hall of 1000 m x 5 m with 2000 windows in its lower wall."""
    corners = [(0.0, 0.0), (LENGTH_M, 0.0), (LENGTH_M, 5.0), (0.0, 5.0)]
    lower, *others = ring(corners, "concrete")
    step_m = LENGTH_M / N

    def window(offset_m: float, k: int) -> Opening:
        low, high = 0.5 + 0.5 * k / N, 2.0 + 0.5 * k / N
        return Opening(offset_m, 0.6 * step_m, low, high, "window", "glass", 0.01)

    row = [window((k + 0.2) * step_m, k) for k in range(N)]
    stack = [
        replace(row[0], sill_m=3.0 * k / N + 1e-4, head_m=3.0 * (k + 1) / N - 1e-4)
        for k in range(N)
    ]
    pieces = [
        replace(
            lower,
            start=(k * step_m, 0.0),
            end=((k + 1) * step_m, 0.0),
            openings=(window(0.2 * step_m, k),),
        )
        for k in range(N)
    ]
    walls = {
        "in a row": (replace(lower, openings=tuple(row)),),
        "over each other": (replace(lower, openings=tuple(stack)),),
        "one in each of many walls": tuple(pieces),
    }
    return replace(
        box(),
        outline=Polygon(corners),
        walls=(*walls[kind], *others),
        source=(2.2, 2.5, 1.5),
        start=(5.5, 2.5),
    )


@pytest.mark.parametrize("kind", ["in a row", "over each other", "one in each of many walls"])
def test_two_thousand_openings_are_checked_in_seconds(kind) -> None:
    plan = glazed(kind)
    begin_s = time.process_time()
    findings = inspect(PlanFile.of(plan))
    assert time.process_time() - begin_s < 4.0  # comparing all pairs takes from 10 s to minutes
    assert [finding.kind for finding in findings] == ["no door"]


def test_wall_is_solid_below_and_above_an_opening() -> None:
    door = Opening(1.0, 1.0, 0.0, 2.0, "door")
    glass = Opening(2.5, 1.0, 1.0, 2.5, "window", "glass")
    walls = (Wall((3.0, 0.0), (3.0, 4.0), "brick", 0.1, 2.8, (door, glass)),)
    assert solid_heights(walls, (3.0, 0.5)) == [(0.0, 2.8)]
    assert solid_heights(walls, (3.0, 1.5)) == [(2.0, 2.8)]
    assert solid_heights(walls, (3.0, 3.0)) == [(0.0, 2.8)]  # the pane is solid as well
    assert solid_heights(walls, (3.1, 0.5)) == []


def test_plan_without_walls_has_an_open_outline() -> None:
    text = ROOM.partition("[[walls]]")[0] + "walls = []\n"
    assert {finding.kind for finding in inspect(loads_unchecked(text))} == {"outline"}
