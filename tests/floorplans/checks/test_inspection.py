"""Everything doubtful about a plan is told with its place, and what is safe is repaired."""

from __future__ import annotations

from dataclasses import replace

import pytest
from shapely.geometry import Polygon
from small_plans import ROOM, box, box_around_courtyard, edited, ring

import floorplans
from floorplans import Opening, Wall
from floorplans.checks.inspection import inspect
from floorplans.loading import loads_unchecked
from floorplans.repair.plan import repair_plan
from floorplans.unchecked import PlanFile

DOOR = Opening(1.0, 1.0, 0.0, 2.1, "door")


def wall(start, end, *openings: Opening, thickness_m: float = 0.1, height_m: float = 3.0) -> Wall:
    return Wall(start, end, "brick", thickness_m, height_m, openings)


def warnings_of(*walls: Wall, **changes):
    """Kinds and places of what is doubtful about the box with more walls in it."""
    found = inspect(PlanFile.of(box(walls, **changes)))
    assert {finding.severity for finding in found} <= {"warning"}
    return [(f.kind, tuple(round(c, 3) for c in f.at)) for f in found if f.kind != "no door"]


@pytest.mark.parametrize("name", floorplans.builtin_names())
def test_builtin_plans_are_beyond_doubt(name) -> None:
    assert inspect(PlanFile.of(floorplans.load(name))) == ()


def test_office_is_beyond_doubt() -> None:
    assert inspect(PlanFile.of(floorplans.generate_office(4, 3, courtyard=True))) == ()


@pytest.mark.parametrize("gap", [1e-3, 0.04, 0.13])
def test_wall_that_almost_meets_is_reported_with_its_end(gap) -> None:
    partition = wall((3.0, 0.0), (3.0, 4.0 - gap), DOOR)
    assert warnings_of(partition) == [("almost meets", (3.0, round(4.0 - gap, 3)))]


def test_gap_one_can_pass_is_none() -> None:
    assert warnings_of(wall((3.0, 0.0), (3.0, 3.0))) == []


def test_corner_that_touches_is_no_gap() -> None:
    assert warnings_of(wall((3.0, 0.0), (3.0, 4.0), DOOR), wall((3.0, 2.2), (6.0, 2.2))) == []


def test_duplicate_wall_is_reported() -> None:
    pair = wall((3.0, 0.0), (3.0, 4.0), DOOR), wall((3.06, 2.2), (3.06, 3.8))
    kinds = {kind for kind, _ in warnings_of(*pair)}
    assert ("side by side", (3.0, 3.0)) in warnings_of(*pair)
    assert kinds == {"side by side", "almost meets"}


def test_walls_across_or_far_apart_are_not_side_by_side() -> None:
    assert warnings_of(wall((3.0, 0.0), (3.0, 4.0), DOOR), wall((2.0, 2.5), (4.0, 2.5))) == []
    assert warnings_of(wall((3.0, 0.0), (3.0, 4.0), DOOR), wall((3.4, 1.0), (3.4, 3.0))) == []


def test_slivers_are_reported() -> None:
    assert ("sliver", (3.0, 1.0)) in warnings_of(wall((3.0, 1.0), (3.03, 1.0)))
    strip = (wall((3.0, 0.0), (3.0, 4.0), DOOR), wall((3.02, 0.0), (3.02, 4.0), DOOR))
    assert ("sliver", (3.01, 2.0)) in warnings_of(*strip)


def test_wall_that_ends_in_a_door_is_reported() -> None:
    partition = wall((3.0, 0.0), (3.0, 4.0), DOOR)
    assert warnings_of(partition, wall((3.0, 1.4), (6.0, 1.4))) == [("wall in opening", (3.0, 1.4))]
    assert warnings_of(partition, wall((3.0, 1.0), (6.0, 1.0))) == []  # at the jamb


def test_room_without_a_door_is_reported() -> None:
    def shut(*openings: Opening):
        partition = wall((4.0, 0.0), (4.0, 4.0), *openings)
        return [f.text for f in inspect(PlanFile.of(box((partition,)))) if f.kind == "no door"]

    window = Opening(1.0, 1.0, 0.9, 2.1, "window", "glass")
    assert shut(DOOR) == []
    assert len(shut(window)) == 2
    assert shut()[0].startswith("no door or passage leads to the room of ")
    low = box((wall((4.0, 0.0), (4.0, 4.0), height_m=1.0),))
    assert [f.kind for f in inspect(PlanFile.of(low))] == ["no door"]  # one room, without a door


def test_courtyard_is_no_room() -> None:
    rooms = [f for f in inspect(PlanFile.of(box_around_courtyard())) if f.kind == "no door"]
    assert len(rooms) == 1
    assert "room of 23 m²" in rooms[0].text


def test_source_and_start_near_a_wall_are_reported() -> None:
    assert warnings_of(source=(0.06, 1.0, 1.5)) == [("source near wall", (0.06, 1.0))]
    assert warnings_of(start=(4.5, 3.85)) == [("start near wall", (4.5, 3.85))]


def test_all_errors_are_reported_with_their_places_in_the_file() -> None:
    text = edited("points = [[3, 0], [3, 4]]", "points = [[3, 0], [3, 4.5]]")
    text = text.replace("start = [4.5, 2.5]", "start = [9, 9]")
    found = [f for f in inspect(loads_unchecked(text)) if f.severity == "error"]
    assert [f.kind for f in found] == ["walls", "start"]
    assert [f.at for f in found] == [pytest.approx((3.0, 4.0), abs=1e-5), (9.0, 9.0)]
    assert found[0].text.startswith("walls[1]: the wall leaves the outline from (3, 4)")


def test_wrong_numbers_hide_what_follows_from_them() -> None:
    text = edited("thickness_m = 0.1", "thickness_m = -0.1").replace("start = [4.5", "start = [9")
    assert [f.text[:22] for f in inspect(loads_unchecked(text))] == ["walls[1].thickness_m ="]


def test_nothing_to_repair_changes_nothing() -> None:
    plan = floorplans.load("flat")
    assert repair_plan(plan).changes == ()
    assert repair_plan(plan).plan.walls == plan.walls


def test_repaired_plan_has_no_findings_and_lists_its_changes() -> None:
    partition = wall((3.0, 0.03), (3.0, 3.96), DOOR)
    repaired = repair_plan(box((partition,), source=(1.0, 1.0, 1.5)))
    assert warnings_of(*repaired.plan.walls[4:]) == []
    assert len(repaired.changes) == 2
    text = repaired.toml()
    assert text.startswith("# Repaired:\n#   (3, 0.03)")
    again = floorplans.loads(text)
    moved = next(w for w in again.walls if w.openings)
    door = moved.point_at(moved.openings[0].offset_m)
    assert door == pytest.approx((3.0, 1.03))  # the door stays where it was


def test_outline_follows_its_walls() -> None:
    corners = [(0.0, 0.0), (6.0, 0.0), (6.0, 4.0), (0.0, 4.0)]
    outline = Polygon([(0.0, 0.04), (6.0, 0.0), (6.0, 4.0), (0.0, 4.0)])
    torn = replace(loads_unchecked(ROOM).plan, outline=outline, walls=ring(corners, "concrete"))
    assert inspect(PlanFile.of(torn))[0].severity == "error"
    repaired = repair_plan(torn)
    assert floorplans.FloorPlan.of(repaired.plan).outline.equals(Polygon(corners))
    assert any("corner of the outline" in str(change) for change in repaired.changes)
