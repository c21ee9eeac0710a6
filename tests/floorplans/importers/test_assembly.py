"""What every importer's draft goes through: walls meet, openings hang, the outline closes."""

from __future__ import annotations

import tomllib
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely import affinity
from shapely.geometry import LineString, Point, Polygon, box

import floorplans
from floorplans import PlanError
from floorplans.importers import (
    Draft,
    Imported,
    ImportOptions,
    LayerUse,
    Origin,
    RawOpening,
    RawWall,
    UnusablePlanError,
    assemble,
    import_plan,
)
from floorplans.importers.assembly.outline_gaps import gap_links
from floorplans.importers.assembly.source_and_start import CELL_M, choose_source_and_start
from floorplans.importers.centrelines.align import aligned_to_main_directions, along_walls
from floorplans.importers.centrelines.double_doors import join_leaves
from floorplans.importers.centrelines.gaps import fill_gaps
from floorplans.importers.centrelines.parallel_lines import strips_of_lines
from floorplans.importers.centrelines.split_by_material import by_material
from floorplans.importers.units import guess_unit
from floorplans.walls import Wall


def ring(x0: float, y0: float, x1: float, y1: float, thickness_m: float = 0.3) -> list[RawWall]:
    corners = [(x0, y0), (x1, y0), (x1, y1), (x0, y1), (x0, y0)]
    return [RawWall(a, b, thickness_m, "brick") for a, b in pairwise(corners)]


HALL = Draft("hall", tuple(ring(10, 20, 22, 28)))


def made(draft: Draft, **options: object) -> Imported:
    return assemble(draft, ImportOptions(**options), "hall.dxf")  # type: ignore[arg-type]


def with_walls(*walls: RawWall) -> Draft:
    return replace(HALL, walls=(*HALL.walls, *walls))


def test_a_plan_is_moved_to_the_origin_and_says_where_it_was():
    result = made(HALL)
    assert result.plan.bounds == (0, 0, 12, 8)
    assert result.origin == Origin(10, 20, "the file, in metres")


def test_a_draft_that_knows_its_origin_stays_where_it_is():
    origin = Origin(7.5, 50.1, "degrees east and north")
    result = made(replace(HALL, origin=origin))
    assert result.plan.bounds == (10, 20, 22, 28)
    assert result.origin == origin


def test_the_written_file_reads_back_and_marks_what_was_assumed():
    result = made(HALL)
    text = result.toml()
    assert floorplans.loads(text) == result.plan
    assert "height_m = 3  # assumed: the file gives no height of the storey" in text
    assert "# Imported from hall.dxf" in text.splitlines()[0]
    assumed = {line.split(" = ")[0] for line in text.splitlines() if "# assumed: " in line}
    assert {"height_m", "source", "start", "floor_material", "ceiling_material"} <= assumed


def test_what_the_user_gives_is_not_assumed():
    given_ones = {
        "name": "my hall", "height_m": 4.5, "floor_material": "wood", "ceiling_material": "glass",
        "source": (2.0, 3.0, 1.0), "start": (10.5, 6.5), "wall_material": "metal",
    }  # fmt: skip
    draft = with_walls(RawWall((14, 20), (14, 24)))
    result = made(draft, **given_ones)
    assert [a.key for a in result.assumed] == ["wall thickness_m"]
    plan = result.plan
    assert (plan.name, plan.height_m, plan.source, plan.start) == (
        "my hall", 4.5, (2, 3, 1), (10.5, 6.5)
    )  # fmt: skip
    assert {wall.material for wall in plan.walls} == {"brick", "metal"}


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"height_m": -1.0}, "height_m = -1.0"),
        ({"wall_material": "gold"}, "unknown material"),
        ({"source": (100.0, 1.0, 1.0)}, "the source is outside the outline"),
    ],
)
def test_wrong_options_are_reported(options: dict[str, object], said: str):
    with pytest.raises(PlanError, match=said):
        made(HALL, **options)


def test_walls_that_enclose_nothing_are_a_draft_with_gaps():
    two = Draft("x", (RawWall((0, 0), (30, 0)), RawWall((0, 20), (30, 20))))
    with pytest.raises(UnusablePlanError, match=r"open: 20\.00 m from .* up to 20\.1 m") as caught:
        made(two)
    draft = caught.value.draft
    assert {frozenset(gap) for gap in draft.gaps} == {
        frozenset({(0, 0), (0, 20)}), frozenset({(30, 0), (30, 20)})
    }  # fmt: skip
    assert len(draft.plan.walls) == 2
    with pytest.raises(PlanError, match="the outline is open"):
        floorplans.loads(draft.toml())
    assert draft.toml().startswith("# DRAFT, not traceable")
    assert made(two, close_gaps_m=20.1).plan.outline.area == pytest.approx(600)
    with pytest.raises(PlanError, match="no walls"):
        made(Draft("x", ()))
    with pytest.raises(PlanError, match="all lie on one line"):
        made(Draft("x", (RawWall((0, 0), (30, 0)),)))


@pytest.mark.parametrize("turn", range(4))
def test_a_building_that_lacks_two_sides_is_closed_on_request_with_all_its_walls(turn: int):
    front = [(0.0, 5.0), (7.5, 10.0), (12.5, 17.5)]
    lines = [LineString([(a, 0), (b, 0)]) for a, b in front] + [LineString([(17.5, 0), (17.5, 13)])]
    turned = [affinity.rotate(line, 90 * turn, origin=(0, 0)).coords for line in lines]
    draft = Draft("x", tuple(RawWall((a[0], a[1]), (b[0], b[1]), 0.2) for a, b in turned))
    width_m = float(np.hypot(17.5, 13))
    with pytest.raises(UnusablePlanError, match=rf"open: {width_m:.2f} m from") as caught:
        made(draft)
    assert caught.value.draft.plan.outline.area == pytest.approx(17.5 * 13 / 2)
    closed = made(draft, close_gaps_m=width_m + 0.1)
    assert closed.plan.outline.area == pytest.approx(17.5 * 13 / 2)
    assert not closed.warnings


def test_gaps_wider_than_asked_for_stay_open_even_around_a_closed_room():
    room = ring(1, 1, 3, 3, 0.1)
    walls = [*ring(0, 0, 12, 8)[1:], RawWall((0, 0), (6, 0)), RawWall((9, 0), (12, 0)), *room]
    hall = Draft("x", tuple(walls))
    assert made(hall).plan.outline.area == pytest.approx(96)
    assert made(hall, close_gaps_m=3.0).plan.outline.area == pytest.approx(96)
    with pytest.raises(UnusablePlanError, match=r"3\.00 m from \(6, 0\) to \(9, 0\)"):
        made(hall, close_gaps_m=2.0)


def test_a_hall_open_beyond_the_limit_is_not_taken_for_the_room_in_it():
    room = ring(1, 1, 3, 3, 0.1)
    walls = [*ring(0, 0, 30, 20)[1:], RawWall((0, 0), (8, 0)), RawWall((22, 0), (30, 0)), *room]
    with pytest.raises(UnusablePlanError, match=r"14\.00 m from \(8, 0\) to \(22, 0\)"):
        made(Draft("x", tuple(walls)))


def test_the_largest_of_several_buildings_is_taken_with_a_warning():
    small = [wall for k in range(4) for wall in ring(30 + 20 * k, 0, 39 + 20 * k, 8)]
    result = made(Draft("x", (*ring(0, 0, 12, 8), *small)))
    assert result.plan.outline.area == pytest.approx(96)
    assert any("77 % of the walls, about 136 m" in sentence for sentence in result.warnings)


@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 100_000))
def test_nearly_collinear_walls_and_gaps_make_a_plan_that_passes_its_checks(seed: int):
    """Sides of a hall in pieces with gaps, each piece off its line by 1e-7 m to 1 cm."""
    rng = np.random.default_rng(seed)
    corners = np.array([(0, 0), (20, 0), (20, 12), (0, 12), (0, 0)], dtype=float)
    walls: list[RawWall] = []
    for a, b in pairwise(corners):
        along = (b - a) / np.hypot(*(b - a))
        stops = np.linspace(0, np.hypot(*(b - a)), int(rng.integers(2, 6)))
        for low, high in pairwise(stops):
            off = along[::-1] * (1, -1) * 10.0 ** rng.uniform(-7, -2) * rng.choice([-1, 1])
            gap_m = float(rng.choice([0.0, 0.02, 0.4, 1.5]))
            start, end = a + low * along + off, a + max(high - gap_m, low + 0.3) * along + off
            thickness_m = float(rng.choice([0.1, 0.2, 0.22]))
            walls.append(RawWall(tuple(start), tuple(end), thickness_m, "brick"))  # type: ignore[arg-type]
    plan = made(Draft("hall", tuple(walls))).plan
    assert plan.outline.area == pytest.approx(240, rel=0.03)


def test_a_building_of_kilometres_is_rejected():
    with pytest.raises(PlanError, match="30 km"):
        made(Draft("x", tuple(ring(0, 0, 30_000, 1))))


@pytest.mark.parametrize("gap_m", [0.2, 0.9, 1.9, 3.5])
def test_gaps_in_the_outline_are_closed_and_reported(gap_m: float):
    walls = [*ring(0, 0, 12, 8)[1:], RawWall((0, 0), (6, 0), 0.3), RawWall((6 + gap_m, 0), (12, 0))]
    result = made(Draft("x", tuple(walls)))
    assert result.plan.outline.area == pytest.approx(12 * 8)
    (closed,) = (change for change in result.changes if change.kind == "closed")
    assert {closed.at, closed.to} == {(6, 0), (6 + gap_m, 0)}


@pytest.mark.parametrize("west_is_open", [True, False])
@pytest.mark.parametrize("offset_m", [0.0, 0.7])
def test_a_corridor_that_is_open_at_its_ends_is_closed_there(west_is_open: bool, offset_m: float):
    rooms = [*ring(0, 0, 7, 4), *ring(7, 0, 15, 4), *ring(0, 6, 9, 11), *ring(9, 6, 15, 11)]
    if offset_m:
        rooms += ring(15, 6, 15 + offset_m, 11)
    west = [] if west_is_open else [RawWall((0, 4), (0, 6), 0.3)]
    result = made(Draft("x", (*rooms, *west)))
    assert result.plan.outline.area == pytest.approx(15 * 11 + offset_m * 5)
    closed = [change for change in result.changes if change.kind == "closed"]
    assert len(closed) == 1 + west_is_open
    assert not any(change.kind == "dropped" for change in result.changes)


def test_a_niche_in_the_front_stays_outside_while_a_gap_is_closed():
    front = [(0, 0), (4, 0), (4, 2), (7, 2), (7, 0), (12, 0), (12, 8), (9, 8)]
    back = [(6, 8), (0, 8), (0, 0)]
    walls = [RawWall(a, b, 0.2) for line in (front, back) for a, b in pairwise(line)]
    result = made(Draft("x", tuple(walls)))
    assert result.plan.outline.area == pytest.approx(12 * 8 - 3 * 2)
    assert [c.kind for c in result.changes if c.kind == "closed"] == ["closed"]


def test_gaps_are_closed_past_a_pillar():
    pillar = [replace(wall, thickness_m=0.2) for wall in ring(6, -0.2, 6.4, 0.2)]
    walls = [*ring(0, 0, 12, 8)[1:], RawWall((0, 0), (4.5, 0)), RawWall((8, 0), (12, 0)), *pillar]
    plan = made(Draft("x", tuple(walls))).plan
    assert plan.outline.area == pytest.approx(12 * 8, abs=1)


def test_what_lies_outside_is_dropped_and_reported():
    result = made(with_walls(RawWall((30, 20), (31, 20)), RawWall((10, 20), (9, 19))))
    assert result.plan.bounds == (0, 0, 12, 8)
    assert len(result.plan.walls) == 4
    assert [change.kind for change in result.changes].count("dropped") == 2


def test_low_walls_in_the_outline_are_raised():
    low = [replace(wall, height_m=1.0) for wall in HALL.walls[:1]]
    result = made(replace(HALL, walls=(*low, *HALL.walls[1:])))
    assert {wall.height_m for wall in result.plan.walls} == {3.0}
    assert [change.kind for change in result.changes] == ["raised"]


def test_regions_outside_a_given_outline_are_courtyards():
    inner = [replace(wall, thickness_m=0.3) for wall in ring(14, 22, 18, 26)]
    given_outline = box(10, 20, 22, 28).difference(box(14, 22, 18, 26))
    plan = made(replace(with_walls(*inner), outline=given_outline)).plan
    assert plan.outline.area == pytest.approx(12 * 8 - 16)
    assert len(plan.outline.interiors) == 1


def door(x: float, y: float, width_m: float = 0.9, **more: object) -> RawOpening:
    return RawOpening((x, y), width_m, "door", **more)  # type: ignore[arg-type]


def test_openings_are_attached_to_their_walls():
    draft = replace(
        with_walls(RawWall((16, 20), (16, 28))),
        openings=(door(16.2, 24), RawOpening((12, 28.1), 1.2, "window")),
    )
    plan = made(draft).plan
    inner = next(wall for wall in plan.walls if wall.start[0] == wall.end[0] == 6)
    (opening,) = inner.openings
    assert inner.point_at(opening.offset_m + 0.45) == pytest.approx((6, 4))
    assert (opening.kind, opening.material, opening.head_m) == ("door", None, 2.1)
    (window,) = (o for w in plan.walls if w is not inner for o in w.openings)
    assert (window.kind, window.material, window.sill_m) == ("window", "glass", 0.9)


def test_a_door_in_the_outline_is_filled_and_reported():
    result = made(replace(HALL, openings=(door(14, 20),)))
    (opening,) = (o for wall in result.plan.walls for o in wall.openings)
    assert opening.material == "wood"
    assert any("wood" in a.value for a in result.assumed if a.key == "door material")


def test_an_opening_in_no_wall_is_dropped_and_reported():
    result = made(replace(HALL, openings=(door(15, 25),)))
    assert [str(change) for change in result.changes] == [
        "(5, 5): door that lies in no wall dropped"
    ]


def test_many_openings_without_a_wall_are_a_warning():
    lost = tuple(door(12 + k, 25) for k in range(3))
    on_wall = tuple(door(12 + k, 20) for k in range(8))
    assert not made(replace(HALL, openings=(*on_wall, *lost[:1]))).warnings
    (sentence,) = made(replace(HALL, openings=(*on_wall[:4], *lost))).warnings
    assert sentence.startswith("3 of 7 doors and windows lie in no wall")


@pytest.mark.parametrize("direction", [None, (1.0, 0.0)])
def test_walls_broken_at_a_door_become_one(direction: tuple[float, float] | None):
    halves = (RawWall((10, 24), (14, 24), 0.1), RawWall((14.9, 24), (22, 24), 0.1))
    draft = replace(with_walls(*halves), openings=(door(14.45, 24, direction=direction),))
    plan = made(draft).plan
    (inner,) = (wall for wall in plan.walls if wall.start[1] == wall.end[1] == 4)
    assert inner.length_m == pytest.approx(12)
    assert [o.width_m for o in inner.openings] == pytest.approx([0.9])


def test_a_door_beside_a_wall_across_closes_the_gap_to_it():
    walls = (RawWall((10, 24), (20.9, 24), 0.1),)
    draft = replace(with_walls(*walls), openings=(door(21.35, 24, direction=(1.0, 0.0)),))
    (inner,) = (wall for wall in made(draft).plan.walls if wall.start[1] == wall.end[1] == 4)
    assert inner.length_m == pytest.approx(12)


def test_leaves_of_a_double_door_are_one_opening():
    leaves = [door(1, 0, 0.8, direction=(1.0, 0.0)), door(1.85, 0.02, 0.8, direction=(-1.0, 0.0)),
              door(5, 0, 0.8, direction=(1.0, 0.0))]  # fmt: skip
    joined = join_leaves(leaves)
    assert sorted(round(o.width_m, 2) for o in joined) == [0.8, 1.65]
    assert min(joined, key=lambda o: o.centre[0]).centre[0] == pytest.approx(1.425)


@settings(max_examples=15, deadline=None)
@given(seed=st.integers(0, 10_000))
def test_random_offices_are_plans_whose_source_can_be_reached(seed: int):
    """Rooms in a row with a door each to a hallway; ends are off by up to 2 cm."""
    rng = np.random.default_rng(seed)
    n = int(rng.integers(2, 6))
    xs = np.cumsum([0, *rng.uniform(3, 6, n)]).round(2)
    walls = [*ring(0, 0, float(xs[-1]), 9), RawWall((0, 6), (float(xs[-1]), 6), 0.1)]
    for x in xs[1:-1]:
        walls.append(
            RawWall((float(x) + float(rng.uniform(-0.02, 0.02)), 0.15), (float(x), 5.95), 0.1)
        )
    doors = tuple(door(float(a) + 1.5, 6, 1.4) for a in xs[:-1])
    plan = made(Draft("office", tuple(walls), doors)).plan
    assert plan.outline.area == pytest.approx(xs[-1] * 9)
    assert sum(len(wall.openings) for wall in plan.walls) == n
    assert all(np.isclose((c - CELL_M / 2) % CELL_M, 0) or np.isclose((c - CELL_M / 2) % CELL_M, 1)
               for c in plan.start)  # fmt: skip


def test_source_and_start_are_far_apart_and_off_the_walls():
    walls = [Wall(w.start, w.end, "brick", 0.3, 3.0) for w in ring(0, 0, 12, 8)]
    places = choose_source_and_start(box(0, 0, 12, 8), walls, 3.0)
    assert Point(places.source).distance(box(0, 0, 12, 8).boundary) == 3.5
    assert Point(places.start).distance(box(0, 0, 12, 8).boundary) >= 0.5
    assert places.distance_m > 6


@pytest.mark.parametrize("size_m", [0.1, 0.25, 0.5, 1.0])
def test_a_source_is_on_no_cell_centre(size_m):
    for depth in (1.0, 4.0, 8.0):
        walls = [Wall(w.start, w.end, "brick", 0.3, 3.0) for w in ring(0, 0, 12, depth)]
        x, y = choose_source_and_start(box(0, 0, 12, depth), walls, 3.0).source
        off = [(c / size_m + 0.5) % 1.0 for c in (x, y)]
        assert size_m * np.hypot(*np.minimum(off, np.subtract(1.0, off))) > 0.049


def test_the_start_is_found_from_a_given_source():
    walls = [Wall(w.start, w.end, "brick", 0.3, 3.0) for w in ring(0, 0, 12, 8)]
    places = choose_source_and_start(box(0, 0, 12, 8), walls, 3.0, source=(1.0, 1.0))
    assert places.source == (1, 1)
    assert places.start == (11.5, 7.5)


def test_walls_are_cut_where_the_material_changes_for_long():
    areas = {"brick": box(0, -0.2, 6, 0.2), "concrete": box(6, -0.2, 12, 0.2)}
    pieces = list(by_material(RawWall((0, 0), (12, 0), 0.4), areas))
    assert [(piece.material, piece.end) for piece in pieces] == [
        ("brick", (6, 0)), ("concrete", (12, 0))
    ]  # fmt: skip
    short = {"brick": box(0, -0.2, 6, 0.2), "concrete": box(6, -0.2, 7, 0.2)}
    assert [p.material for p in by_material(RawWall((0, 0), (7, 0), 0.4), short)] == ["brick"]


def test_walls_turn_into_the_main_directions_but_oblique_ones_stay():
    walls = [RawWall((0, 0), (10, 0)), RawWall((0, 0), (0.02, 5)), RawWall((0, 0), (4, 3))]
    turned = aligned_to_main_directions(walls)
    assert turned[0] == walls[0]
    assert turned[1].start[0] == pytest.approx(turned[1].end[0])
    assert turned[2] == walls[2]


def test_openings_turn_into_the_direction_of_their_wall():
    faces = np.array([[(-3, 0), (-0.5, 0.5)], [(-0.5, 0.5), (-0.5, 0.7)], [(9, 9), (10, 9)]])
    nearly, across = door(0, 0.6, direction=(1.0, 0.12)), door(0, 0.6, direction=(0.0, 1.0))
    turned = along_walls([nearly, across], faces)
    assert turned[0].direction == pytest.approx(np.array([2.5, 0.5]) / np.hypot(2.5, 0.5))
    assert turned[1] == across


def test_two_lines_are_one_wall_and_the_nearest_is_the_partner():
    ends = [[(0, y), (5, y)] for y in (0, 0.1, 0.5, 0.7)]
    walls = strips_of_lines(np.array(ends, dtype=float), 0.6)
    assert sorted(round(area.area / 5, 6) for area in walls.area) == [0.1, 0.2]
    assert len(walls.singles) == 0


def test_a_line_without_a_partner_stays_single():
    ends = np.array([[(0, 0), (5, 0)], [(0, 0.1), (3, 0.1)], [(0, 4), (5, 4)]], dtype=float)
    walls = strips_of_lines(ends, 0.6)
    assert [area.area for area in walls.area] == pytest.approx([0.3])
    lengths = sorted(np.abs(walls.singles[:, 1, 0] - walls.singles[:, 0, 0]).tolist())
    assert lengths == pytest.approx([2, 5], abs=0.2)


def _rectangle(x0: float, y0: float, x1: float, y1: float) -> list[list[tuple[float, float]]]:
    corners = [(x0, y0), (x1, y0), (x1, y1), (x0, y1), (x0, y0)]
    return [list(side) for side in pairwise(corners)]


@pytest.mark.parametrize("thickness_m", [0.65, 0.8, 1.0, 1.5])
def test_faces_far_apart_are_a_heavy_wall_where_walls_are_drawn_by_both_faces(thickness_m: float):
    t = thickness_m
    rings = _rectangle(0, 0, 24, 18) + _rectangle(t, t, 24 - t, 18 - t)
    partition = [[(x, t), (x, 18 - t)] for x in (10.0, 10.2)]
    walls = strips_of_lines(np.array(rings + partition), 0.6, 2.5)
    assert len(walls.singles) == 0
    masonry = box(0, 0, 24, 18).difference(box(t, t, 24 - t, 18 - t))
    area = shapely.union_all([*walls.area, box(0, 0, t, t)]).buffer(0.01)
    assert area.buffer(0.1).covers(masonry | box(10, t, 10.2, 18 - t))
    assert area.area == pytest.approx(masonry.area + 0.2 * (18 - 2 * t), rel=0.05)


@pytest.mark.parametrize("width_m", [0.7, 0.9])
def test_a_narrow_room_is_no_heavy_wall(width_m: float):
    single = _rectangle(0, 0, 14, 10) + [[(x, 0), (x, 10)] for x in (6, 6 + width_m, 11)]
    assert not strips_of_lines(np.array(single, dtype=np.float64), 0.6, 2.5).area
    sides = (6.0, 6.1, 6.1 + width_m, 6.2 + width_m)
    double = _rectangle(0, 0, 14, 10) + _rectangle(0.3, 0.3, 13.7, 9.7)
    double += [[(x, 0.3), (x, 9.7)] for x in sides]
    area = shapely.union_all(list(strips_of_lines(np.array(double), 0.6, 2.5).area))
    assert not area.intersects(Point(6.1 + width_m / 2, 5))


def test_faces_set_off_from_each_other_are_filled_as_deep_as_they_are():
    area = shapely.union_all([box(-3, 0, -0.5, 0.1), box(0.5, 0.07, 3, 0.17)])
    (filling,) = fill_gaps(area, [RawOpening((0, 0), 1.0, "door", (1.0, 0.0))])
    _, low, _, high = filling.bounds
    assert (low, high) == pytest.approx((0.035, 0.135), abs=0.006)
    beside_a_pane = shapely.union_all([area, box(-0.5, 0.0, 0.5, 0.07)])
    fillings = fill_gaps(beside_a_pane, [RawOpening((0, 0.2), 1.0, "door", (1.0, 0.0))])
    assert all(f.intersection(beside_a_pane).area < 0.02 * f.area + 1e-3 for f in fillings)


@pytest.mark.parametrize("angle", [0.0, 0.3, 1.2])
def test_a_gap_is_filled_as_deep_as_its_faces(angle: float):
    def turn(shape: Polygon) -> Polygon:
        return affinity.rotate(shape, angle, origin=(0, 0), use_radians=True)

    area = turn(shapely.union_all([box(-3, -0.1, -0.5, 0.2), box(0.5, -0.1, 3, 0.3)]))
    direction = (float(np.cos(angle)), float(np.sin(angle)))
    (filling,) = fill_gaps(area, [RawOpening((0, 0), 1.0, "door", direction)])
    missing = turn(box(-0.5, -0.1, 0.5, 0.2))
    assert filling.symmetric_difference(missing).area < 0.02
    assert fill_gaps(area, [RawOpening((0, 1.5), 1.0, "door", direction)]) == ()


@pytest.mark.parametrize(
    ("size", "doors", "unit"),
    [
        ((900, 700), [90], "cm"),
        ((1200, 900), [36, 30], "in"),
        ((57_000, 28_000), [900], "mm"),
        ((40, 20), [0.9], "m"),
    ],
)
def test_doors_give_the_unit(size: tuple[float, float], doors: list[float], unit: str):
    assert guess_unit(size, doors) == unit


def test_a_unit_that_is_unknown_is_asked_for():
    with pytest.raises(PlanError, match=r"give the unit: m for 15 m x 9 m or ft for 4\.57 m"):
        guess_unit((15, 9), [])
    with pytest.raises(PlanError, match="none would make it a building"):
        guess_unit((1e9, 1e9), [])


def test_the_report_states_layers_assumptions_and_changes():
    layers = (LayerUse("A-WALL", 4, "walls"),)
    result = made(replace(with_walls(RawWall((30, 20), (31, 20))), layers=layers, notes=("so so",)))
    assert "layer A-WALL (4): walls" in result.report
    assert "(20, 0): wall of 1.00 m outside the outline dropped" in result.report
    assert result.report[-1] == "so so"


@pytest.mark.parametrize(
    ("name", "content", "said"),
    [
        ("plan.xyz", b"hello", "cannot be imported; known: .dxf"),
        ("plan", b"x", "no ending"),
        ("plan.dxf", b"", "the file is empty"),
        ("plan.dxf", b"ISO-10303-21;", "it looks like an IFC model"),
        ("plan.ifc", b"  0\nSECTION", "does not begin like an IFC model"),
    ],
)
def test_files_of_another_kind_are_rejected(name: str, content: bytes, said: str, tmp_path: Path):
    path = tmp_path / name
    path.write_bytes(content)
    with pytest.raises(PlanError, match=said):
        import_plan(path)


def test_the_written_text_is_toml_whatever_the_file_is_called():
    text = assemble(HALL, ImportOptions(), "evil\nname = 1.dxf").toml()
    assert tomllib.loads(text)["name"] == "hall"


CHORDS = [(0.0, 0.0), (2.0, 0.0), (3.8, 0.8), (5.1, 2.3), (5.1, 5.0), (0.0, 5.0)]


@pytest.mark.parametrize(
    ("centre", "direction", "widths"),
    [
        ((1.0, 0.0), (1.0, 0.0), [1.5]),  # within a chord
        ((2.9, 0.4), (1.8, 0.8), [0.84, 1.97, 0.84]),  # over two bends
        ((5.1, 4.5), (0.0, 1.0), [1.25]),  # to the corner and not around it
    ],
)
def test_an_opening_covers_the_chords_of_a_curve_and_no_corner(
    centre: tuple[float, float], direction: tuple[float, float], widths: list[float]
):
    ring = [*CHORDS, CHORDS[0]]
    walls = tuple(RawWall(a, b, 0.2, "brick") for a, b in pairwise(ring))
    width_m = 1.5 if len(widths) == 1 else 3.5
    window = RawOpening(centre, width_m, "window", direction)
    plan = assemble(Draft("bow", walls, (window,)), ImportOptions(), "bow.dxf").plan
    found = [o for wall in plan.walls for o in wall.openings]
    assert {o.material for o in found} == {"glass"}
    assert sorted(o.width_m for o in found) == pytest.approx(sorted(widths), abs=0.02)


def test_no_walls_have_no_gaps():
    assert gap_links(np.array([], dtype=np.object_), 8.0).shape == (0, 2, 2)
