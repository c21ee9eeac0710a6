"""Sections of lines in areas, found for all lines at once, are those that GEOS finds one by one."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely import affinity
from shapely.geometry import LineString, Point, box

from floorplans.importers.centrelines.areas import MAX_THICKNESS_M, walls_of_area
from floorplans.importers.centrelines.sections import BESIDE_M, sections_inside


def random_area(rng: np.random.Generator, angle_deg: float) -> shapely.Geometry:
    """Strips of wall that cross, turned; niches are cut out of them."""
    corners, sizes = rng.uniform(0, 20, (30, 2)), rng.uniform(0.1, 8, (30, 2))
    sizes[np.arange(30), rng.integers(0, 2, 30)] = 0.3
    strips = [box(*low, *(low + size)) for low, size in zip(corners, sizes, strict=True)]
    niches = [Point(*xy).buffer(0.2) for xy in rng.uniform(0, 20, (40, 2))]
    area = shapely.union_all(strips) - shapely.union_all(niches)
    return affinity.rotate(area, angle_deg, origin=(0, 0))


@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 100_000), angle_deg=st.sampled_from([0.0, 11.0, 45.0]))
def test_sections_are_those_of_each_line_alone(seed: int, angle_deg: float):
    rng = np.random.default_rng(seed)
    area = random_area(rng, angle_deg)
    lines = rng.uniform(-2, 22, (60, 2, 2))
    corners = shapely.get_coordinates(area)
    lines[:20, 0] = rng.choice(corners, 20)
    wide = area.buffer(BESIDE_M)
    for line, sections in zip(lines, sections_inside(lines, area), strict=True):
        least, most = (LineString(line).intersection(where).length for where in (area, wide))
        assert least - 1e-5 <= sum(high - low for low, high in sections) <= most + 1e-5
        assert all(a[1] < b[0] for a, b in pairwise(sections))


@pytest.mark.parametrize("angle_deg", [0.0, 31.0])
def test_a_line_along_the_edge_lies_in_the_area_and_one_beside_it_does_not(angle_deg: float):
    area = affinity.rotate(box(0, 0, 5, 1), angle_deg, origin=(0, 0))
    edge = np.array([[(-1.0, 0.0), (6.0, 0.0)], [(-1.0, -1e-4), (6.0, -1e-4)]])
    turn = np.radians(angle_deg)
    turned = edge @ np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    along, beside = sections_inside(turned, area)
    assert np.array(along) == pytest.approx(np.array([(1.0, 6.0)]), abs=1e-5)
    assert beside == []
    assert sections_inside(turned, shapely.Polygon()) == [[], []]


def test_a_block_in_a_net_of_walls_with_many_holes_is_a_ring():
    net = shapely.union_all(
        [box(3 * k, 0, 3 * k + 0.2, 30.2) for k in range(11)]
        + [box(0, 3 * k, 30.2, 3 * k + 0.2) for k in range(11)]
    )
    block = box(10, 10, 11.8, 11.8)
    walls = walls_of_area(net | block, 0.02)
    ring = [w for w in walls if w.thickness_m == pytest.approx(MAX_THICKNESS_M / 2)]
    faces = shapely.polygonize([LineString([w.start, w.end]) for w in ring])
    assert shapely.area(faces) == pytest.approx(1.8**2, rel=0.01)
    assert sum(w.thickness_m == pytest.approx(0.2) for w in walls) == 22
