"""Large plans at any angle, with coordinates rounded in a file, are cut into sound cells.

`RSSNAV_EXAMPLES=2000 pytest tests/raytrace/geometry/test_rounded_plans.py` searches longer, with
new plans every time.
"""

import os
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
import shapely
from buildings import CONCRETE, GLASS, Building, box, door, wall, window
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from rounded_plans import rounded_building

from raytrace import Paths, Scene, TraceConfig, Transmitter, trace_paths
from raytrace.geometry.sheets import COINCIDENT_M
from raytrace.kernels.plan_view import GRAZING_M, PORTAL

Floats = NDArray[np.float64]

LONG = "RSSNAV_EXAMPLES" in os.environ


def check_cells(scene: Scene) -> None:
    """Cells are convex, not flat, and tile the footprint; who passes an edge comes out of it."""
    view, area = scene.view, 0.0
    for first, last in pairwise(view.cell_edges.tolist()):
        ends = view.ends[first:last]
        assert len(ends) >= 3
        np.testing.assert_array_equal(ends[:, 2:], np.roll(ends[:, :2], -1, axis=0))
        ahead = ends[:, 2:] - ends[:, :2]
        length = np.hypot(*ahead.T)
        to = ends[None, :, :2] - ends[:, None, :2]
        inside = (ahead[:, :1] * to[:, :, 1] - ahead[:, 1:] * to[:, :, 0]) / length[:, None]
        assert inside.min() >= -2.0 * GRAZING_M
        assert inside.max(axis=1).min() > GRAZING_M
        area += shapely.Polygon(ends[:, :2]).area
    assert abs(area - scene.footprint.area) < COINCIDENT_M * scene.footprint.length
    assert (view.twin[view.kind == PORTAL] >= 0).all()
    passable = view.twin >= 0
    np.testing.assert_array_equal(view.twin[view.twin[passable]], np.flatnonzero(passable))


def check_walls(building: Building) -> None:
    """No wall is lost, none is made of a cut."""
    cells = building.scene.cells
    ends = np.array([cells.vertices[[a, b]] for a, b, _ in cells.wall_segments])
    drawn = shapely.union_all([shapely.LineString([s.start, s.end]) for s in building.sheets])
    length = np.hypot(*(ends[:, 1] - ends[:, 0]).T).sum()
    near = shapely.union_all(shapely.linestrings(ends)).buffer(2.0 * COINCIDENT_M)
    assert drawn.difference(near).length < COINCIDENT_M * len(building.sheets)
    assert length < drawn.length + 4.0 * COINCIDENT_M * len(building.sheets)


@given(
    seed=st.integers(0, 2**32 - 1),
    size_m=st.sampled_from([20.0, 100.0, 300.0, 500.0]),
    n_rows=st.integers(1, 25),
    decimals=st.sampled_from([6, 7, 8, 9, 10, 10, 10, 12, 15]),
)
@settings(max_examples=int(os.environ.get("RSSNAV_EXAMPLES", 12)), derandomize=not LONG)
def test_cells_of_rounded_plans_are_sound(
    seed: int, size_m: float, n_rows: int, decimals: int
) -> None:
    building = rounded_building(seed, size_m, n_rows, decimals)
    check_cells(building.scene)
    check_walls(building)


@pytest.mark.parametrize("turn_deg", range(3, 180, 20))
def test_a_cut_beside_a_wall_in_line_becomes_that_wall(turn_deg: int) -> None:
    turn = np.radians(turn_deg)
    ahead = np.array([np.cos(turn), np.sin(turn)])
    corner, near, far, end = (tuple(np.round(50.0 + t * ahead, 10)) for t in (25, 5, 0, -25))
    spur = (corner[0] + (10.0 if corner[0] < 85.0 else -10.0), corner[1])
    walls = (*wall(spur, corner), *wall(corner, near), *wall(far, end))
    building = box(100.0, 100.0, *walls)
    check_cells(building.scene)
    check_walls(building)


def test_walls_off_by_rounding_are_one_wall() -> None:
    beside = wall((2.0, 4e-7), (4.0, -3e-7), slab=GLASS)
    crossing = (*wall((5.0, 0.0), (5.0, 6.0)), *wall((4.0, 3.0), (5.0 - 8e-7, 3.0)))
    building = box(8.0, 6.0, *beside, *crossing)
    check_cells(building.scene)
    check_walls(building)
    assert len(building.scene.view.cell_edges) - 1 == 3


@pytest.mark.parametrize("width_m", [5e-7, 1e-6, 1.5e-6, 2e-6, 1e-5])
@pytest.mark.parametrize("at_m", [2.1, 2.5, 3.0])
@pytest.mark.parametrize("lean_m", [0.0, 3e-4])
def test_openings_about_as_narrow_as_the_tolerance(width_m, at_m, lean_m) -> None:
    holes = door(1.0, 2.0), window(at_m, at_m + width_m)
    building = box(6.0, 4.0, *wall((3.0, 0.0), (3.0 + lean_m, 4.0), *holes))
    check_cells(building.scene)
    check_walls(building)


@pytest.mark.parametrize("turn_deg", [11.0, 123.4])
def test_a_turned_and_rounded_plan_has_the_paths_of_the_plan(turn_deg: float) -> None:
    walls = (
        *wall((0.0, 5.0), (3.0, 5.0), door(1.0, 2.0)),
        *wall((4.0, 5.0), (7.0, 5.0)),
        *wall((7.0, 5.0), (7.0, 8.0)),
        *wall((8.5, 5.0), (12.0, 5.0), slab=CONCRETE),
    )
    plan = box(12.0, 9.0, *walls)
    turn = np.radians(turn_deg)
    matrix = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    turned = rounded(plan.moved(matrix, np.array([180.0, -70.0])))
    places = plan.random_points(6, seed=1)
    moved = np.column_stack([places[:, :2] @ matrix.T + [180.0, -70.0], places[:, 2]])
    one, two = (trace(b.scene, at) for b, at in ((plan, places), (turned, moved)))
    np.testing.assert_array_equal(np.bincount(one.receiver), np.bincount(two.receiver))
    np.testing.assert_allclose(one.length_m, two.length_m, rtol=1e-9)
    np.testing.assert_allclose(abs(one.gain), abs(two.gain), rtol=1e-5, atol=1e-12)


def rounded(building: Building) -> Building:
    """Return a building with coordinates of ten decimals."""

    def at(p: tuple[float, float]) -> tuple[float, float]:
        return round(p[0], 10), round(p[1], 10)

    sheets = (s._replace(start=at(s.start), end=at(s.end)) for s in building.sheets)
    return replace(building, outline=tuple(map(at, building.outline)), sheets=tuple(sheets))


def trace(scene: Scene, places: Floats) -> Paths:
    """Return the paths between the first place and all others, in order of length."""
    paths = trace_paths(scene, Transmitter(tuple(places[0])), places[1:], TraceConfig(3, 1))
    order = np.lexsort((paths.length_m, paths.receiver))
    return paths.rows(order)
