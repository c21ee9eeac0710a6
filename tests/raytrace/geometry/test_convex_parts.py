"""Faces are divided into parts that are convex, cover them, and cannot be joined any further."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
import shapely

from raytrace.geometry.convex_parts import convex_parts, edges_of
from raytrace.kernels.plan_view import GRAZING_M


def is_convex(corners) -> bool:
    """By definition: no corner lies beyond an edge by more than the tolerance."""
    ahead = np.roll(corners, -1, axis=0) - corners
    ahead /= np.hypot(*ahead.T)[:, None]
    offset = corners[None, :] - corners[:, None]
    return (ahead[:, :1] * offset[:, :, 1] - ahead[:, 1:] * offset[:, :, 0]).min() >= -GRAZING_M


def parts_of(corners, walls=()):
    vertices = {(float(x), float(y)): k for k, (x, y) in enumerate(corners)}
    return convex_parts([shapely.Polygon(list(vertices))], vertices, walls)


def joined(one, two):
    """The ring of two that share one edge; None if they share none."""
    for a, b in edges_of(one):
        if (b, a) in edges_of(two):
            k, m = one.index(b), two.index(a)
            return [*(one[k:] + one[:k])[:-1], *(two[m:] + two[:m])[:-1]]
    return None


def check_parts(parts, corners) -> None:
    for part in parts:
        assert is_convex(corners[part])
    area = sum(shapely.Polygon(corners[part]).area for part in parts)
    assert area == pytest.approx(shapely.Polygon(corners).area, abs=1e-6)
    for one, two in combinations(parts, 2):
        ring = joined(one, two)
        if ring is not None and len(set(ring)) == len(ring):
            assert not is_convex(corners[ring])


@pytest.mark.parametrize("n", [65, 200, 700])
@pytest.mark.parametrize("noise", [0.0, 0.1, 0.6, 3.0, 100.0])
@pytest.mark.parametrize("angle", [0.0, 0.3])
def test_row_of_many_corners(n, noise, angle) -> None:
    rng = np.random.default_rng(n)
    row = np.column_stack([np.linspace(0.0, 300.0, n - 2), np.zeros(n - 2)])
    row[1:-1, 1] = noise * GRAZING_M * rng.uniform(-1.0, 1.0, n - 4)
    corners = np.vstack([row, [(300.0, 8.0), (0.0, 8.0)]])
    turn = np.array([(np.cos(angle), -np.sin(angle)), (np.sin(angle), np.cos(angle))])
    check_parts(parts_of(corners @ turn.T), corners @ turn.T)


@pytest.mark.parametrize("n", [5, 40, 300])
@pytest.mark.parametrize("seed", range(3))
def test_star_of_random_corners(n, seed) -> None:
    rng = np.random.default_rng(seed)
    angle = np.sort(rng.uniform(0.0, 2.0 * np.pi, n))
    radius = rng.choice([10.0, rng.uniform(5.0, 15.0)], n)
    corners = radius[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])
    if shapely.Polygon(corners).is_valid:
        check_parts(parts_of(corners), corners)


def test_hall_with_a_thousand_corners_in_a_row_is_one_part() -> None:
    corners = [(float(x), 0.0) for x in range(1000)] + [(999.0, 5.0), (0.0, 5.0)]
    (part,) = parts_of(corners)
    assert sorted(part) == list(range(1002))


def test_walls_remain() -> None:
    corners = [(0.0, 0.0), (2.0, 0.0), (4.0, 0.0), (4.0, 3.0), (2.0, 3.0), (0.0, 3.0)]
    assert len(parts_of(corners)) == 1
    one, two = parts_of(corners, walls={(1, 4)})
    assert {frozenset(one), frozenset(two)} == {frozenset({0, 1, 4, 5}), frozenset({1, 2, 3, 4})}
