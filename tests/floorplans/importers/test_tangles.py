"""Drawings of thousands of lines: what is found does not depend on how it is searched."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
import shapely
import shapely.ops
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from floorplans import PlanError
from floorplans.importers.assembly.outline import find_outline
from floorplans.importers.assembly.outline_gaps import gap_links, link_lengths
from floorplans.importers.assembly.wall_network import Network
from floorplans.importers.tangle import MAX_CROSSINGS, check_crossings
from floorplans.repair.geometry import along_across, line_crossing, points_on_walls
from floorplans.repair.walls import split_at_junctions
from floorplans.walls import TOLERANCE_M, Wall, centre_lines

MAX_GAP_M = 3.0

seeds = st.integers(0, 100_000)


def segments(seed: int, n: int, side_m: float, length_m: float) -> NDArray[np.float64]:
    """Random lines (n, 2, 2) in a square; every second seed along the axes and on a grid."""
    rng = np.random.default_rng(seed)
    start = rng.uniform(0, side_m, (n, 2))
    angle = rng.uniform(0, 2 * np.pi, n)
    if seed % 2:
        start, angle = start.round(), (angle / np.pi).round() * np.pi / 2
    length = rng.uniform(0.3, 1.0, n) * length_m
    step = length[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    return np.stack([start, start + step], axis=1).round(6)


def walls_of(lines: NDArray[np.float64]) -> list[Wall]:
    return [
        Wall((float(a[0]), float(a[1])), (float(b[0]), float(b[1])), "brick", 0.1, 3.0)
        for a, b in lines
    ]


@settings(max_examples=20, deadline=None)
@given(seed=seeds)
def test_each_free_end_is_linked_to_the_nearest_wall(seed: int):
    lines = centre_lines(split_at_junctions(walls_of(segments(2 * seed, 25, 12.0, 4.0))))
    links = gap_links(lines, MAX_GAP_M)
    assert (link_lengths(links) <= MAX_GAP_M).all()
    ends = shapely.points(shapely.get_coordinates(lines))
    for i, end in enumerate(ends):
        others = np.delete(lines, i // 2)
        gaps_m = shapely.distance(end, others)
        nearest = int(np.argmin(gaps_m))
        shortest = shapely.shortest_line(end, others[nearest])
        inner = shapely.ops.substring(shortest, 0.01, 0.99, normalized=True)
        is_free = 1e-4 < gaps_m[nearest] <= MAX_GAP_M
        if not is_free or shapely.distance(inner, lines).min() < 2e-3:
            continue
        at_end = np.hypot(*(links - np.array([end.x, end.y])).transpose(2, 0, 1)).min(axis=1) < 1e-9
        assert np.isclose(link_lengths(links[at_end]), gaps_m[nearest]).any()


@pytest.mark.parametrize("offset_m", [0.0, 1e-5, 5e-4])
def test_no_link_runs_along_a_wall_or_past_its_end(offset_m: float):
    sides = enumerate([(0, 4), (6, 9), (12, 17)])
    row = [[(a, k * offset_m), (b, k * offset_m)] for k, (a, b) in sides]
    ends = [*row, [(17, 2 * offset_m), (17, 13)]]
    lines = centre_lines(walls_of(np.array(ends)))
    links = gap_links(lines, 30.0)
    inner = shapely.linestrings(links + 0.02 * (links[:, ::-1] - links))
    assert len(links)
    assert shapely.distance(inner[:, None], lines[None]).min() > 1e-3


@settings(max_examples=20, deadline=None)
@given(seed=seeds)
def test_a_group_of_walls_is_linked_to_the_nearest_wall_of_another(seed: int):
    lines = centre_lines(split_at_junctions(walls_of(segments(seed, 30, 15.0, 4.0))))
    links = gap_links(lines, MAX_GAP_M)
    groups = shapely.get_parts(shapely.union_all(shapely.buffer(lines, 1e-4)))
    if len(groups) < 2:
        return
    ends = shapely.points(links.reshape(-1, 2)).reshape(-1, 2)
    for group in groups:
        others = [part for part in groups if part is not group]
        apart_m = float(shapely.distance(group, shapely.union_all(others))) + 2e-4
        touches = np.array(shapely.dwithin(ends, group, 1e-6))
        leaving = link_lengths(links[touches[:, 0] != touches[:, 1]])
        if 1e-3 < apart_m < MAX_GAP_M:
            assert leaving.size
            assert abs(leaving.min() - apart_m) < 1e-3


@settings(max_examples=15, deadline=None)
@given(seed=seeds)
def test_what_walls_and_links_enclose_does_not_depend_on_how_many_are_added_at_once(seed: int):
    lines = centre_lines(split_at_junctions(walls_of(segments(seed, 120, 20.0, 4.0))))
    links = gap_links(lines, MAX_GAP_M)
    at_once = Network(lines).with_links(links)
    staged = Network(lines)
    lengths = link_lengths(links)
    for low_m, high_m in pairwise((0.0, 0.5, 1.0, 2.0, MAX_GAP_M)):
        staged = staged.with_links(links[(lengths > low_m) & (lengths <= high_m)])
    areas = [shapely.area(network.faces()).sum() for network in (at_once, staged)]
    assert areas[0] == pytest.approx(areas[1], abs=1e-6)


@settings(max_examples=15, deadline=None)
@given(seed=seeds)
def test_a_region_stays_closed_when_what_it_holds_is_left_out(seed: int):
    lines = centre_lines(split_at_junctions(walls_of(segments(seed, 120, 20.0, 4.0))))
    network = Network(lines).with_links(gap_links(lines, MAX_GAP_M))
    parts = shapely.get_parts(shapely.coverage_union_all(network.faces()))
    largest = max(parts, key=lambda part: part.area)
    around = network.around(shapely.Polygon(largest.exterior))
    areas = shapely.area(shapely.get_parts(shapely.coverage_union_all(around.faces())))
    assert areas.max() == pytest.approx(shapely.Polygon(largest.exterior).area, abs=1e-6)


@settings(max_examples=30, deadline=None)
@given(seed=seeds)
def test_walls_are_cut_where_others_end_on_or_cross_them(seed: int):
    walls = walls_of(segments(seed, 20, 6.0, 4.0))
    cuts = points_on_walls(walls)
    for i, wall in enumerate(walls):
        expected: list[float] = []
        for other in (w for j, w in enumerate(walls) if j != i):
            for end in (other.start, other.end):
                s, across = along_across(wall, end)
                expected += [s] if abs(across) <= TOLERANCE_M and 0 < s < wall.length_m else []
            crossing = line_crossing(wall, other)
            if crossing is not None:
                s, t = along_across(wall, crossing)[0], along_across(other, crossing)[0]
                expected += [s] if 0 < s < wall.length_m and 0 < t < other.length_m else []
        assert {round(s, 5) for s in cuts[i]} == {round(s, 5) for s in expected}


@settings(max_examples=20, deadline=None)
@given(seed=seeds)
def test_an_outline_does_not_depend_on_the_order_of_the_walls(seed: int):
    rng = np.random.default_rng(seed)
    x, y = (np.cumsum(rng.uniform(1.5, 4.0, 4)).round(2) for _ in range(2))
    ends = [((a, y[0]), (b, y[0])) for a, b in pairwise(x)]
    ends += [((a, c), (a, d)) for a in x for c, d in pairwise(y)]
    ends += [((a, y[3]), (b - 0.4 * (a == x[1]), y[3])) for a, b in pairwise(x)]
    walls = walls_of(np.array(ends))
    mixed = [
        replace(walls[i], start=walls[i].end, end=walls[i].start) if k % 2 else walls[i]
        for k, i in enumerate(rng.permutation(len(walls)).tolist())
    ]
    found, again = (find_outline(w, None, 3.0) for w in (walls, mixed))
    assert found.outline.equals_exact(again.outline, 1e-9)
    assert found.outline.equals(shapely.box(x[0], y[0], x[3], y[3]))
    assert found.outline.exterior.coords[0] == (x[0], y[0])
    assert found.enclosed == again.enclosed == 1.0


def test_a_thicket_of_long_lines_is_refused_before_the_slow_work_and_its_layer_named():
    thicket = segments(2, 900, 50.0, 60.0)
    with pytest.raises(PlanError, match=r"about .* times.*layer HATCH: .*leave it out"):
        check_crossings({"layer WALLS": segments(1, 100, 50.0, 4.0), "layer HATCH": thicket})


def test_a_storey_of_many_rooms_is_no_thicket():
    x, y = np.meshgrid(np.arange(100.0), np.arange(100.0))
    corners = np.stack([x.ravel(), y.ravel()], axis=1)
    rooms = [np.stack([corners, corners + step], axis=1) for step in ([1.0, 0.0], [0.0, 1.0])]
    assert len(corners) ** 2 > MAX_CROSSINGS
    check_crossings({"layer WALLS": np.concatenate(rooms)})
    check_crossings({})
