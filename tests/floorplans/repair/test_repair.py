"""Walls that almost meet are made to meet; walls that run along each other become one."""

from __future__ import annotations

from dataclasses import replace
from math import cos, dist, pi, sin

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely.geometry import LineString

from floorplans.repair.geometry import direction
from floorplans.repair.walls import repair_walls, split_at_junctions
from floorplans.walls import TOLERANCE_M, Opening, Point, Wall

ANGLES = st.floats(0, 2 * pi, allow_nan=False)


def wall(start: Point, end: Point, thickness_m: float = 0.1, material: str = "brick") -> Wall:
    return Wall(start, end, material, thickness_m, 3.0)


def turned(walls: list[Wall], angle: float) -> list[Wall]:
    def turn(point: Point) -> Point:
        x, y = point
        return (x * cos(angle) - y * sin(angle), x * sin(angle) + y * cos(angle))

    return [replace(w, start=turn(w.start), end=turn(w.end)) for w in walls]


def lines(walls: tuple[Wall, ...] | list[Wall]) -> list[LineString]:
    return [LineString([w.start, w.end]) for w in walls]


def closed_area(walls: tuple[Wall, ...]) -> float:
    noded = shapely.union_all(lines(walls), grid_size=TOLERANCE_M)
    return float(shapely.area(shapely.polygonize(shapely.get_parts(noded))).sum())


def rattled_room(rng: np.random.Generator, reach_m: float) -> list[Wall]:
    """A room of 6 m x 4 m with a partition, each end off its place by less than half the reach."""
    ends = [
        ((0, 0), (6, 0)), ((6, 0), (6, 4)), ((6, 4), (0, 4)), ((0, 4), (0, 0)), ((2, 0), (2, 4)),
    ]  # fmt: skip
    off = rng.uniform(-0.4 * reach_m, 0.4 * reach_m, (5, 2, 2)) / np.sqrt(2)
    moved = np.array(ends, dtype=float) + off
    return [wall((a[0], a[1]), (b[0], b[1])) for a, b in moved.tolist()]


def test_walls_in_order_stay_untouched():
    room = [wall((0, 0), (6, 0)), wall((6, 0), (6, 4)), wall((6, 4), (0, 0)), wall((2, 0), (2, 1))]
    repaired = repair_walls(room)
    assert repaired.walls == tuple(room)
    assert repaired.changes == ()


@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 10_000), angle=ANGLES)
def test_a_rattled_room_closes_again_at_any_angle(seed: int, angle: float):
    room = turned(rattled_room(np.random.default_rng(seed), 0.05), angle)
    repaired = repair_walls(room, 0.05).walls
    assert closed_area(repaired) == pytest.approx(24, abs=0.6)
    assert len(repaired) == 5


@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 10_000), angle=ANGLES)
def test_a_repaired_plan_needs_no_repair(seed: int, angle: float):
    once = repair_walls(turned(rattled_room(np.random.default_rng(seed), 0.05), angle), 0.05).walls
    twice = repair_walls(once, 0.05)
    moved = [dist(*ends) for a, b in zip(once, twice.walls, strict=True)
             for ends in ((a.start, b.start), (a.end, b.end))]  # fmt: skip
    assert max(moved) <= 2 * TOLERANCE_M


def test_ends_in_a_thick_wall_go_on_to_its_centre_line():
    thick, partition = wall((0, 0), (6, 0), 0.6), wall((2, 0.3), (2, 4))
    repaired = repair_walls([thick, partition]).walls
    assert repaired[0] == thick
    assert repaired[1].start == (2, 0)


def test_corners_of_thick_walls_meet_where_centre_lines_cross():
    along, up = wall((0, 0), (3.8, 0), 0.4), wall((4, 0.2), (4, 3), 0.4)
    repaired = repair_walls([along, up]).walls
    assert repaired[0].end == repaired[1].start == (4, 0)


def test_an_end_that_is_far_off_is_left():
    far = [wall((0, 0), (6, 0)), wall((2, 0.2), (2, 4))]
    assert repair_walls(far, 0.05).walls == tuple(far)


def test_what_sticks_out_beyond_a_wall_is_cut_off():
    repaired = repair_walls([wall((0, 0), (6, 0)), wall((2, -0.04), (2, 4))], 0.05)
    assert repaired.walls[1].start == (2, 0)
    (change,) = repaired.changes
    assert (change.kind, change.at, change.to) == ("moved", (2, -0.04), (2, 0))


@pytest.mark.parametrize("offset_m", [0.0, 0.02])
def test_a_duplicate_wall_becomes_one(offset_m: float):
    repaired = repair_walls([wall((0, 0), (6, 0)), wall((5, offset_m), (1, offset_m))])
    assert repaired.walls == (wall((0, 0), (6, 0)),)
    assert [change.kind for change in repaired.changes] == ["joined"]


def test_overlapping_walls_of_two_materials_share_the_line():
    walls = repair_walls([wall((0, 0), (4, 0), 0.3), wall((3, 0), (6, 0), 0.1, "glass")]).walls
    assert {(w.start, w.end, w.material) for w in walls} == {
        ((0, 0), (4, 0), "brick"),
        ((4, 0), (6, 0), "glass"),
    }


def test_pieces_of_one_wall_are_joined_over_small_gaps():
    pieces = [wall((0, 0), (2, 0)), wall((2.03, 0), (4, 0)), wall((4, 0), (6, 0))]
    assert repair_walls(pieces).walls == (wall((0, 0), (6, 0)),)


def test_pieces_of_like_thickness_are_joined_where_that_is_asked():
    pieces = [wall((0, 0), (3, 0), 0.4), wall((3, 0), (4, 0), 0.36)]
    assert len(repair_walls(pieces).walls) == 2
    (joined,) = repair_walls(pieces, thickness_fraction=0.2).walls
    assert joined.thickness_m == pytest.approx((3 * 0.4 + 0.36) / 4, abs=5e-4)


def test_slivers_are_dropped():
    repaired = repair_walls([wall((0, 0), (6, 0)), wall((3, 0), (3, 0.03))])
    assert repaired.walls == (wall((0, 0), (6, 0)),)
    assert [change.kind for change in repaired.changes] == ["dropped"]


@pytest.mark.parametrize("turned_round", [False, True])
def test_openings_keep_their_place(turned_round: bool):
    door = Opening(1.0, 0.9, 0.0, 2.1, "door")
    ends = ((4.0, 0.0), (2.0, 0.0)) if turned_round else ((2.0, 0.0), (4.0, 0.0))
    short = replace(wall(*ends), openings=(door,))
    before = short.point_at(1.45)
    (joined,) = repair_walls([wall((0, 0), (2, 0)), short, wall((4, 0), (9, 0))]).walls
    (opening,) = joined.openings
    assert joined.point_at(opening.offset_m + opening.width_m / 2) == pytest.approx(before)
    assert opening.width_m == pytest.approx(0.9)


def test_splitting_leaves_the_sheets_and_their_openings():
    door = Opening(1.5, 1.0, 0.0, 2.1, "door")
    long = replace(wall((0, 0), (6, 0)), openings=(door,))
    pieces = split_at_junctions([long, wall((4, 0), (4, 3)), wall((5, -1), (5, 1))])
    on_line = [piece for piece in pieces if piece.start[1] == piece.end[1] == 0]
    assert [(piece.start[0], piece.end[0]) for piece in on_line] == [(0, 4), (4, 5), (5, 6)]
    assert on_line[0].openings == (door,)
    assert sum(piece.length_m for piece in pieces) == pytest.approx(6 + 3 + 2)


def test_no_cut_goes_through_an_opening():
    door = Opening(1.5, 1.0, 0.0, 2.1, "door")
    long = replace(wall((0, 0), (6, 0)), openings=(door,))
    assert long in split_at_junctions([long, wall((2, 0), (2, 3))])


def test_two_thousand_walls_are_repaired():
    rng = np.random.default_rng(7)
    walls: list[Wall] = []
    for i in range(34):
        for j in range(30):
            x, y = 5.0 * i, 4.0 * j
            a, b = rng.uniform(-0.01, 0.01, (2, 2)).tolist()
            walls.append(wall((x + a[0], y + a[1]), (x + 5 + b[0], y + b[1])))
            walls.append(wall((x + b[0], y - a[1]), (x - a[0], y + 4 + b[1]), 0.2, "glass"))
    assert len(walls) > 2000
    repaired = repair_walls(walls, 0.05).walls
    assert closed_area(repaired) == pytest.approx(33 * 5 * 29 * 4, rel=0.01)


def test_a_wall_of_no_length_is_left_for_the_check() -> None:
    wall = Wall((6.0, 0.0), (6.0, 0.0), "concrete", 0.2, 3.0)
    assert direction(wall) == (0.0, 0.0)


@pytest.mark.parametrize("thickness_m", [-1.0, -0.2, -1e-9, 0.0])
def test_a_wall_of_no_thickness_is_left_to_the_checks(thickness_m: float) -> None:
    room = [wall((0, 0), (4, 0)), wall((4, 0.05), (4, 3)), wall((2, 0), (2, 3), thickness_m)]
    repaired = repair_walls(room).walls
    assert [w.thickness_m for w in repaired if w.start == (2, 0)] == [thickness_m]
    assert (4.0, 0.0) in {end for w in repaired for end in (w.start, w.end)}
