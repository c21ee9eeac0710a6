"""Arcs of walls become chords, with their openings and the outline."""

from __future__ import annotations

import itertools
from math import hypot, pi

import pytest

import floorplans
from floorplans import PlanError
from floorplans.toml.arcs import CHORD_M, chords_of_arc

BOW = """
name = "bow"
format = 1
height_m = 3
floor_material = "concrete"
ceiling_material = "concrete"
source = [1.3, 1.3, 1.2]
start = [4.5, 1.5]
outline = [[0, 0], [8, 0], [8, 4], [0, 4], [0, 0]]

[[walls]]
points = [[8, 4], [0, 4], [0, 0], [8, 0]]
material = "brick"
thickness_m = 0.3

[[walls]]
points = [[8, 0], [8, 4]]
arc = [10, 2]
material = "brick"
thickness_m = 0.3
openings = [{ kind = "window", offset_m = 1, width_m = 4, head_m = 2, material = "glass" }]
"""


def test_chords_lie_on_the_arc_and_near_it() -> None:
    points = chords_of_arc((2.0, 0.0), (0.0, 2.0), (-2.0, 0.0), ())
    assert (points[0], points[-1]) == ((2.0, 0.0), (-2.0, 0.0))
    assert all(hypot(x, y) == pytest.approx(2.0, abs=2e-6) for x, y in points)
    assert all(y >= 0 for _, y in points)
    middles = [hypot(a[0] + b[0], a[1] + b[1]) / 2 for a, b in itertools.pairwise(points)]
    assert min(middles) > 2.0 - CHORD_M - 1e-6
    long = chords_of_arc((2.0, 0.0), (0.0, -2.0), (0.0, 2.0), ())
    assert min(y for _, y in long) < -1.9


def test_outer_arc_bends_the_outline_and_its_window_loses_no_glass() -> None:
    plan = floorplans.loads(BOW)
    assert plan.outline.area == pytest.approx(32 + pi * 2, rel=0.01)
    assert plan.bounds == pytest.approx((0, 0, 10, 4), abs=0.02)
    panes = [o for wall in plan.walls for o in wall.openings]
    assert len(panes) > 3
    assert sum(o.width_m for o in panes) == pytest.approx(4.0)
    assert floorplans.loads(floorplans.dumps(plan)) == plan


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("[10, 2]", "[8, 2]", "walls[1].arc = [8.0, 2.0]: expected a point of the arc beside"),
        ("[10, 2]", "[8, 0]", "walls[1].arc = [8.0, 0.0]: expected a point of the arc beside"),
        ("[10, 2]", "3", "walls[1].arc"),
        ("[[8, 0], [8, 4]]", "[[8, 0], [9, 1], [8, 4]]", "expected two points, the start"),
        ("[10, 2]", "[900000, 2]", "chords; expected at most 180"),
        ("offset_m = 1,", "offset_m = 5,", "the opening ends"),
    ],
)
def test_wrong_arcs_are_refused(old: str, new: str, message: str) -> None:
    with pytest.raises(PlanError) as caught:
        floorplans.loads(BOW.replace(old, new))
    assert message in str(caught.value)
