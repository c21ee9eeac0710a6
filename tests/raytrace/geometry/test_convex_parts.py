"""Parts with many corners are convex exactly where each edge has each corner on its inner side."""

from __future__ import annotations

import time

import numpy as np
import pytest
import shapely

from raytrace.geometry.convex_parts import (
    _is_convex as is_convex,  # pyright: ignore[reportPrivateUsage]
)
from raytrace.geometry.convex_parts import convex_parts
from raytrace.kernels.plan_view import GRAZING_M


def is_convex_by_definition(corners) -> bool:
    ahead = np.roll(corners, -1, axis=0) - corners
    ahead /= np.hypot(*ahead.T)[:, None]
    offset = corners[None, :] - corners[:, None]
    return (ahead[:, :1] * offset[:, :, 1] - ahead[:, 1:] * offset[:, :, 0]).min() >= -GRAZING_M


@pytest.mark.parametrize("n", [65, 200, 1000])
@pytest.mark.parametrize("noise", [0.0, 0.1, 0.6, 3.0, 100.0])
@pytest.mark.parametrize("angle", [0.0, 0.3])
def test_many_corners(n, noise, angle) -> None:
    rng = np.random.default_rng(n)
    row = np.column_stack([np.linspace(0.0, 300.0, n - 2), np.zeros(n - 2)])
    row[1:-1, 1] = noise * GRAZING_M * rng.uniform(-1.0, 1.0, n - 4)
    corners = np.vstack([row, [(300.0, 8.0), (0.0, 8.0)]])
    turn = np.array([(np.cos(angle), -np.sin(angle)), (np.sin(angle), np.cos(angle))])
    corners = corners @ turn.T
    assert is_convex(corners) == is_convex_by_definition(corners)


def test_hall_with_a_thousand_corners_in_a_row_is_one_part_in_time() -> None:
    corners = [(float(x), 0.0) for x in range(1000)] + [(999.0, 5.0), (0.0, 5.0)]
    begin_s = time.process_time()
    parts = convex_parts([shapely.Polygon(corners)], {c: k for k, c in enumerate(corners)}, [])
    assert time.process_time() - begin_s < 20.0  # some 100 s if every merge compared all corners
    assert sorted(parts[0]) == list(range(1002))
    assert len(parts) == 1
