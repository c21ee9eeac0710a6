"""Courtyards, islands and round rooms reach the tracer whole; large plans do so in time."""

from __future__ import annotations

import time
from dataclasses import replace
from math import cos, pi, radians, sin

import numpy as np
import pytest
import shapely
from shapely import affinity
from shapely.geometry import Polygon

import floorplans
from floorplans import FloorPlan, Wall
from raytrace import TraceConfig
from rssnav.maps import make_map
from rssnav.scenes import scene_of


def ring(corners, material: str = "brick"):
    return tuple(
        Wall(start, end, material, 0.2, 3.0)
        for start, end in zip(corners, corners[1:] + corners[:1], strict=True)
    )


def hall(outline: Polygon, *walls: Wall) -> FloorPlan:
    """Return a storey with walls along its outline, and others."""
    rings = [outline.exterior, *outline.interiors]
    edges = [ring([tuple(p) for p in r.coords[:-1]]) for r in rings]
    return FloorPlan(
        name="hall",
        outline=outline,
        walls=(*(wall for edge in edges for wall in edge), *walls),
        height_m=3.0,
        floor_material="concrete",
        ceiling_material="concrete",
        source=(1.1, 1.2, 1.5),
        start=(0.5, 0.5),
    )


BOX = Polygon([(0.0, 0.0), (12.0, 0.0), (12.0, 8.0), (0.0, 8.0)])
COURT = [(5.0, 3.0), (7.0, 3.0), (7.0, 5.0), (5.0, 5.0)]
AROUND_COURT = hall(Polygon(BOX.exterior, [COURT]))
ISLAND = hall(
    BOX,
    *ring([(4.0, 3.0), (6.0, 2.5), (5.5, 5.0)]),
    *ring([(4.7, 3.2), (5.3, 3.1), (5.2, 3.9)]),
)
ANGLES = [2 * pi * k / 48 for k in range(48)]
ROUND = hall(Polygon([(2.0 + 4.0 * cos(angle), 2.0 + 4.0 * sin(angle)) for angle in ANGLES]))


def turned(plan: FloorPlan, angle_deg: float) -> FloorPlan:
    """Return the plan turned about (0, 0)."""
    c, s = cos(radians(angle_deg)), sin(radians(angle_deg))

    def turn(x: float, y: float) -> tuple[float, float]:
        return c * x - s * y, s * x + c * y

    return replace(
        plan,
        outline=affinity.rotate(plan.outline, angle_deg, origin=(0, 0)),
        walls=tuple(replace(w, start=turn(*w.start), end=turn(*w.end)) for w in plan.walls),
        source=(*turn(*plan.source[:2]), plan.source[2]),
        start=turn(*plan.start),
    )


@pytest.mark.parametrize("angle_deg", [0.0, 17.3, 45.0, 90.0, 211.7])
@pytest.mark.parametrize("plan", [AROUND_COURT, ISLAND, ROUND], ids=["court", "island", "round"])
def test_cells_cover_the_outline_and_nothing_else(plan, angle_deg) -> None:
    plan = turned(plan, angle_deg)
    view = scene_of(plan).view
    bounds = zip(view.cell_edges[:-1], view.cell_edges[1:], strict=True)
    cells = [Polygon(view.ends[low:high, :2]) for low, high in bounds]
    assert sum(cell.area for cell in cells) == pytest.approx(plan.outline.area, abs=1e-6)
    assert shapely.union_all(cells).symmetric_difference(plan.outline).area < 1e-6
    assert all(cell.convex_hull.area == pytest.approx(cell.area, abs=1e-9) for cell in cells)


def test_nothing_is_received_in_the_courtyard() -> None:
    radio_map = make_map(AROUND_COURT, config=TraceConfig(max_reflections=2, max_diffractions=0))
    x, y = np.meshgrid(radio_map.grid.x, radio_map.grid.y)
    outside = ~shapely.contains_xy(AROUND_COURT.outline, x, y)
    assert outside.sum() == 4
    assert np.isneginf(radio_map.rss_dbm[outside]).all()
    assert np.isfinite(radio_map.rss_dbm[~outside]).mean() > 0.9


def test_scene_of_150_rooms_is_built_in_time() -> None:
    office = floorplans.generate_office(15, 10, courtyard=True)
    start_s = time.process_time()
    scene_of(office)
    assert time.process_time() - start_s < 20.0
