"""Sheets with several drawings: each is found, one is taken, and any other can be."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import dxf_drawings as draw
import numpy as np
import pytest

from floorplans import PlanError
from floorplans.frame import PlanFrame
from floorplans.importers import Imported, ImportOptions, import_plan

UNITS = {"mm": (4, 0.001), "in": (1, 0.0254), "m": (6, 1.0)}
WIDTH_M, DEPTH_M = 20.0, 12.0


def sheet(
    folder: Path, n: int, gap_m: float, unit: str = "mm", frame: PlanFrame | None = None
) -> Path:
    """Storeys side by side; the second has one wall more."""
    code, unit_m = UNITS[unit]
    corners = [(0, 0), (WIDTH_M, 0), (WIDTH_M, DEPTH_M), (0, DEPTH_M), (0, 0)]
    sides = [*pairwise(corners), ((8, 0), (8, 5)), ((8, 6), (8, DEPTH_M)), ((8, 6), (14, 6))]
    lines = [
        [(x + k * (WIDTH_M + gap_m), y) for x, y in side]
        for k in range(n)
        for side in [*sides, *([((14, 6), (14, DEPTH_M))] if k == 1 else [])]
    ]
    points = np.array(lines, dtype=float).reshape(-1, 2)
    ends = (frame or PlanFrame()).to_drawing(points) / unit_m
    doc = draw.new(code)
    pairs = [((a[0], a[1]), (b[0], b[1])) for a, b in ends.reshape(-1, 2, 2).tolist()]
    draw.add_lines(doc.modelspace(), pairs, "A-WALL", 1.0)
    return draw.save(doc, folder)


def size_of(imported: Imported) -> tuple[float, float]:
    x_min, y_min, x_max, y_max = imported.plan.bounds
    return x_max - x_min, y_max - y_min


@pytest.mark.parametrize("unit", UNITS)
@pytest.mark.parametrize(("n", "gap_m", "turn_deg"), [(2, 6.0, 0.0), (3, 9.0, 10.0)])
def test_each_drawing_of_a_sheet_is_listed_and_can_be_taken(
    tmp_path: Path, n: int, gap_m: float, turn_deg: float, unit: str
) -> None:
    path = sheet(tmp_path, n, gap_m, unit, PlanFrame(500.0, -30.0, turn_deg))
    imported = import_plan(path)
    assert [part.is_taken for part in imported.parts].count(True) == 1
    assert len(imported.parts) == n
    assert f"{n} separate drawings (corners in {unit})" in imported.warnings[0]
    for k, part in enumerate(imported.parts):
        one = import_plan(path, ImportOptions(region=part.bounds))
        assert one.parts == ()
        assert size_of(one) == pytest.approx((WIDTH_M, DEPTH_M))
        frame = PlanFrame(500.0, -30.0, turn_deg)
        corner = frame.to_drawing(np.array([[k * (WIDTH_M + gap_m), 0.0]]))[0]
        assert (one.origin.x, one.origin.y) == pytest.approx(corner.tolist(), abs=1e-6)


@pytest.mark.parametrize("gap_m", [2.0, 3.5])
def test_two_rows_of_rooms_on_a_corridor_are_one_building(tmp_path: Path, gap_m: float) -> None:
    imported = import_plan(sheet(tmp_path, 2, gap_m))
    assert imported.parts == ()
    assert size_of(imported) == pytest.approx((2 * WIDTH_M + gap_m, DEPTH_M))


def test_drawings_are_joined_across_a_gap_on_request(tmp_path: Path) -> None:
    joined = import_plan(sheet(tmp_path, 2, 6.0), ImportOptions(close_gaps_m=6.5))
    assert size_of(joined) == pytest.approx((2 * WIDTH_M + 6.0, DEPTH_M))


def test_a_region_without_walls_is_refused_with_the_extent_of_the_walls(tmp_path: Path) -> None:
    with pytest.raises(PlanError, match=r"region = .*reach from \(0, 0\) to \(20000, 12000\)"):
        import_plan(sheet(tmp_path, 1, 0.0), ImportOptions(region=(-9.0, -9.0, -1.0, -1.0)))
