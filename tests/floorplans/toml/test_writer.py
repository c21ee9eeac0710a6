"""TOML <-> FloorPlan: nothing is lost, and equal plans are equal texts."""

from dataclasses import replace

import pytest
from hypothesis import given, settings
from small_plans import ROOM, box, box_around_courtyard, edited, plans

import floorplans
from floorplans import FloorPlan, Opening, Wall


@settings(deadline=None, max_examples=60)
@given(plan=plans())
def test_text_reads_back_exactly(plan: FloorPlan) -> None:
    text = floorplans.dumps(plan)
    again = floorplans.loads(text)
    assert again == plan
    assert floorplans.dumps(again) == text
    assert again.sha256 == plan.sha256


def test_file_reads_back_exactly(tmp_path) -> None:
    plan = floorplans.load("flat")
    floorplans.save(plan, tmp_path / "copy.toml")
    assert floorplans.load(tmp_path / "copy.toml") == plan
    assert floorplans.load(str(tmp_path / "copy.toml")) == plan


def test_holes_read_back_exactly() -> None:
    plan = box_around_courtyard()
    assert floorplans.loads(floorplans.dumps(plan)) == plan
    assert plan != replace(plan, outline=box().outline)


def test_polyline_becomes_one_wall_a_piece_with_its_openings() -> None:
    text = edited("points = [[3, 0], [3, 4]]", "points = [[3, 0], [3, 1], [3, 4]]")
    partition = floorplans.loads(text).walls[4:]
    assert [(wall.start, wall.end) for wall in partition] == [((3, 0), (3, 1)), ((3, 1), (3, 4))]
    assert partition[0].openings == ()
    assert partition[1].openings == (
        Opening(0.0, 1.0, 0.0, 2.0, "door"),
        Opening(1.5, 1.0, 1.0, 2.5, "window", "glass"),
    )


def test_defaults_table_fills_in_material_and_thickness() -> None:
    text = edited('material = "plasterboard"\nthickness_m = 0.1\n', "").replace(
        "[[walls]]", '[defaults]\nmaterial = "plasterboard"\nthickness_m = 0.1\n\n[[walls]]', 1
    )
    assert floorplans.loads(text) == floorplans.loads(ROOM)


def test_comments_and_layout_do_not_change_the_digest() -> None:
    plan = floorplans.loads(ROOM)
    assert floorplans.loads("# a comment\n" + ROOM.replace(" = ", "=")).sha256 == plan.sha256
    moved = floorplans.loads(edited("start = [4.5, 2.5]", "start = [4.5, 1.5]"))
    assert moved.sha256 != plan.sha256


def test_negative_zero_is_zero() -> None:
    wall = Wall((3.0, 0.0), (3.0, 1.0), "wood", 0.1, 3.0)
    mirrored = Wall((3.0, -0.0), (3.0, 1.0), "wood", 0.1, 3.0)
    assert box((wall,)) == box((mirrored,))
    assert box((wall,)).sha256 == box((mirrored,)).sha256


@pytest.mark.parametrize("name", floorplans.builtin_names())
def test_builtin_plan_loads_and_reads_back(name: str) -> None:
    plan = floorplans.load(name)
    assert plan.name == name
    assert floorplans.loads(floorplans.dumps(plan)) == plan


def test_builtin_names() -> None:
    assert {"flat", "scenario1", "scenario2"} <= set(floorplans.builtin_names())


@pytest.mark.parametrize(
    ("name", "bounds", "source", "start"),
    [
        ("scenario1", (0, 0, 96, 26), (5, 14, 1.5), (93.5, 2.5)),
        ("scenario2", (0, 0, 76, 58), (4, 4, 1.5), (74.5, 55.5)),
    ],
)
def test_scenarios_have_the_sizes_of_the_paper(name, bounds, source, start) -> None:
    plan = floorplans.load(name)
    assert (plan.bounds, plan.source, plan.start, plan.height_m) == (bounds, source, start, 3)
    heads = {o.head_m for wall in plan.walls for o in wall.openings if o.kind == "door"}
    assert heads == {2.7}
