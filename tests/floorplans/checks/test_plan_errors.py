"""Every wrong plan gives one message with file, table, key, value and remedy."""

from dataclasses import replace

import pytest
from shapely.geometry import Polygon
from small_plans import ROOM, box, edited

import floorplans
from floorplans import Opening, PlanError, Wall

WALL_1 = 'material = "plasterboard"'
DOOR = '{ kind = "door", offset_m = 1, width_m = 1, head_m = 2 }'
RING = "outline = [[0, 0], [6, 0], [6, 4], [0, 4], [0, 0]]"
SIDES = "points = [[0, 0], [6, 0], [6, 4], [0, 4], [0, 0]]"
PARTITION = "points = [[3, 0], [3, 4]]"


def door(text: str) -> str:
    return edited(DOOR, "{ " + text + " }")


def another_wall(points: str) -> str:
    return f'{ROOM}\n[[walls]]\npoints = {points}\nmaterial = "wood"\nthickness_m = 0.1\n'


def message_of(text: str) -> str:
    with pytest.raises(PlanError) as caught:
        floorplans.loads(text, origin="office.toml")
    return str(caught.value)


CASES = {
    "unknown key": (
        edited("start = [", "strat = ["),
        'office.toml: strat: unknown key; did you mean "start"? Known: name, format',
    ),
    "unknown key of a wall": (
        edited(WALL_1, f"{WALL_1}\ncolour = 3"),
        "office.toml: walls[1].colour: unknown key. Known: kind, points, arc, material",
    ),
    "unknown key of an opening": (
        door('kind = "door", ofset_m = 1, width_m = 1, head_m = 2'),
        'walls[1].openings[0].ofset_m: unknown key; did you mean "offset_m"?',
    ),
    "missing key": (
        edited('name = "room"\n', ""),
        "office.toml: name: the key is missing; expected a string",
    ),
    "missing material": (
        edited(WALL_1, ""),
        "office.toml: walls[1].material: the key is missing; expected a string",
    ),
    "missing format": (
        edited("format = 1\n", ""),
        "office.toml: format: the key is missing; expected a number",
    ),
    "another format": (
        edited("format = 1", "format = 2"),
        "office.toml: format = 2.0: expected 1, the only format there is",
    ),
    "text for a number": (
        edited("height_m = 3", 'height_m = "3 m"'),
        'office.toml: height_m = "3 m": expected a number, not a string',
    ),
    "boolean for a number": (
        edited("height_m = 3", "height_m = true"),
        "office.toml: height_m = true: expected a number, not a boolean",
    ),
    "date for a text": (
        edited('name = "room"', "name = 2026-01-31"),
        'office.toml: name = "2026-01-31": expected a string, not a date or time',
    ),
    "nan": (
        edited("height_m = 3", "height_m = nan"),
        "office.toml: height_m = NaN: expected a finite number",
    ),
    "number for a table": (
        edited(DOOR, "7"),
        "office.toml: walls[1].openings[0] = 7: expected a table, not a number",
    ),
    "number for a list": (
        edited(PARTITION, "points = 3"),
        "office.toml: walls[1].points = 3: expected a list of points [x, y], not a number",
    ),
    "two coordinates for three": (
        edited("source = [1, 1, 1.5]", "source = [1, 1]"),
        "office.toml: source = [1, 1]: expected 3 numbers [x, y, z] [m]",
    ),
    "text for a coordinate": (
        edited("start = [4.5, 2.5]", 'start = [4.5, "b"]'),
        'office.toml: start[1] = "b": expected a number, not a string',
    ),
    "name of two lines": (
        edited('name = "room"', 'name = "a\\nb"'),
        r'office.toml: name = "a\nb": expected one line of printable text',
    ),
    "unknown floor material": (
        edited('floor_material = "concrete"', 'floor_material = "concret"'),
        'office.toml: floor_material = "concret": unknown material; did you mean "concrete"? '
        "Known: concrete, brick",
    ),
    "unknown wall material": (
        edited(WALL_1, 'material = "plaster"'),
        'office.toml: walls[1].material = "plaster": unknown material; did you mean "plasterboard"',
    ),
    "unknown filling": (
        edited('material = "glass"', 'material = "glas"'),
        'walls[1].openings[1].material = "glas": unknown material; did you mean "glass"?',
    ),
    "unknown kind": (
        door('kind = "gate", offset_m = 1, width_m = 1, head_m = 2'),
        'walls[1].openings[0].kind = "gate": unknown kind of opening. Known: door, window, passage',
    ),
    "no height": (
        edited("height_m = 3", "height_m = 0"),
        "office.toml: height_m = 0.0: expected a finite number from 1e-09 to 1000 [m]",
    ),
    "negative thickness": (
        edited("thickness_m = 0.1", "thickness_m = -0.1"),
        "office.toml: walls[1].thickness_m = -0.1: expected a finite number from 1e-09 to 1000 [m]",
    ),
    "wall above the ceiling": (
        edited(WALL_1, f"{WALL_1}\nheight_m = 3.5"),
        "walls[1].height_m = 3.5: the wall rises above the ceiling at 3 m; lower it",
    ),
    "wall of no length": (
        edited(PARTITION, "points = [[3, 0], [3, 4], [3, 4]]"),
        "office.toml: walls[1]: the wall has no length: it starts and ends at (3, 4); give two",
    ),
    "wall of one point": (
        edited(PARTITION, "points = [[3, 0]]"),
        "office.toml: walls[1].points = [[3.0, 0.0]]: expected at least two points",
    ),
    "wall outside": (
        edited(PARTITION, "points = [[3, 0], [3, 4.5]]"),
        "office.toml: walls[1]: the wall leaves the outline from (3, 4) to (3, 4.5); shorten it",
    ),
    "wall along another": (
        another_wall("[[3, 1], [3, 2], [4, 2]]"),
        "walls[2]: the wall runs along another wall from (3, 1) to (3, 2); one wall is one sheet",
    ),
    "opening before the wall": (
        door('kind = "door", offset_m = -0.5, width_m = 1, head_m = 2'),
        "walls[1].openings[0].offset_m = -0.5: the opening begins before its wall; expected 0 or",
    ),
    "opening beyond the wall": (
        door('kind = "door", offset_m = 3.5, width_m = 1, head_m = 2'),
        "walls[1].openings[0].offset_m = 3.5: the opening ends 4.5 m along a wall of 4 m; with its "
        "width of 1 m, expected at most 3",
    ),
    "negative width": (
        door('kind = "door", offset_m = 1, width_m = -1, head_m = 2'),
        "walls[1].openings[0].width_m = -1.0: expected a finite number from 1e-09 to 1000 [m]",
    ),
    "opening above the wall": (
        door('kind = "door", offset_m = 1, width_m = 1, head_m = 3.2'),
        "walls[1].openings[0].head_m = 3.2: the opening is higher than its wall; expected at most",
    ),
    "opening below the floor": (
        door('kind = "door", offset_m = 1, width_m = 1, sill_m = -0.1, head_m = 2'),
        "walls[1].openings[0].sill_m = -0.1: the opening begins below the floor; expected 0 or",
    ),
    "sill at the head": (
        door('kind = "door", offset_m = 1, width_m = 1, sill_m = 2, head_m = 2'),
        "walls[1].openings[0].sill_m = 2.0: the sill is not below the head; expected less than 2",
    ),
    "thickness without material": (
        door('kind = "door", offset_m = 1, width_m = 1, head_m = 2, thickness_m = 0.04'),
        "walls[1].openings[0].thickness_m = 0.04: thickness without a material; name the filling",
    ),
    "overlapping openings": (
        door('kind = "door", offset_m = 1.6, width_m = 1, head_m = 2'),
        "walls[1].openings[1]: the opening overlaps openings[0], which reaches from 1.6 m to 2.6 m "
        "along the wall and from 0 m to 2 m above the floor; move or shrink one of them",
    ),
    "opening around a corner": (
        edited(
            'material = "concrete"\nthickness_m = 0.2',
            'material = "concrete"\nthickness_m = 0.2\n'
            'openings = [{ kind = "door", offset_m = 5.5, width_m = 1, head_m = 2 }]',
        ),
        "walls[0].openings[0].offset_m = 5.5: the opening goes around the corner at (6, 0), 6 m "
        "along the wall; move it to one side or split it",
    ),
    "outline not closed": (
        edited(RING, "outline = [[0, 0], [6, 0], [6, 4], [0, 4]]"),
        "outline[3] = [0.0, 4.0]: outline is not closed; repeat the first point [0.0, 0.0]",
    ),
    "hole not closed": (
        edited(RING, f"{RING}\nholes = [[[1, 1], [2, 1], [2, 2], [1, 2]]]"),
        "holes[0][3] = [1.0, 2.0]: holes[0] is not closed; repeat the first point [1.0, 1.0]",
    ),
    "outline of two corners": (
        edited(RING, "outline = [[0, 0], [6, 0], [0, 0]]"),
        "expected at least three corners and the first one again",
    ),
    "outline crosses itself": (
        edited(RING, "outline = [[0, 0], [6, 0], [0, 4], [6, 4], [0, 0]]"),
        "office.toml: outline: the ring is not a simple polygon: Self-intersection[3 2]; no edge",
    ),
    "outline without a wall": (
        edited(SIDES, "points = [[0, 0], [6, 0], [6, 4], [0, 4]]"),
        "office.toml: outline: the outline is open from (0, 4) to (0, 0); put a wall from floor to",
    ),
    "hole without walls": (
        edited(RING, f"{RING}\nholes = [[[1, 2], [2, 2], [2, 3], [1, 3], [1, 2]]]"),
        "outline: the outline is open from (1, 2) to (2, 2)",
    ),
    "source outside": (
        edited("source = [1, 1, 1.5]", "source = [7, 1, 1.5]"),
        "office.toml: source = [7.0, 1.0, 1.5]: the source is outside the outline, which reaches "
        "from (0, 0) to (6, 4); move it into a room",
    ),
    "source in a wall": (
        edited("source = [1, 1, 1.5]", "source = [3, 0.5, 1.5]"),
        "office.toml: source = [3.0, 0.5, 1.5]: the source is in a wall; move it into a room",
    ),
    "source in a lintel": (
        edited("source = [1, 1, 1.5]", "source = [3, 1.5, 2.5]"),
        "the source is in a wall; move it into a room",
    ),
    "source on the ceiling": (
        edited("source = [1, 1, 1.5]", "source = [1, 1, 3]"),
        "source = [1.0, 1.0, 3.0]: the source is not between floor and ceiling; expected a height "
        "above 0 and below 3 [m]",
    ),
    "start outside": (
        edited("start = [4.5, 2.5]", "start = [4.5, -2.5]"),
        "office.toml: start = [4.5, -2.5]: the start is outside the outline, which reaches from",
    ),
    "start in a wall": (
        edited("start = [4.5, 2.5]", "start = [3, 0.5]"),
        "office.toml: start = [3.0, 0.5]: the start is in a wall; move it into a room",
    ),
}


@pytest.mark.parametrize(("text", "expected"), CASES.values(), ids=CASES.keys())
def test_message_names_file_table_key_and_remedy(text: str, expected: str) -> None:
    message = message_of(text)
    assert expected in message
    assert message.startswith("office.toml: ")


def test_room_the_cases_are_edits_of_is_itself_right() -> None:
    assert floorplans.loads(ROOM).name == "room"


def test_malformed_toml_gives_line_and_column() -> None:
    message = message_of(edited("height_m = 3", "height_m = "))
    assert message.startswith("office.toml: not valid TOML: ")
    assert "at line 4, column" in message


def test_missing_file_names_the_builtin_plans() -> None:
    with pytest.raises(PlanError, match=r"^nowhere\.toml: .*No such file.*flat, .*scenario2"):
        floorplans.load("nowhere.toml")


def test_file_that_is_no_text(tmp_path) -> None:
    (tmp_path / "map.toml").write_bytes(b"\x89HDF\xff")
    with pytest.raises(PlanError, match=r"map\.toml: not UTF-8 text"):
        floorplans.load(tmp_path / "map.toml")


def test_wall_is_named_as_in_the_file_although_polylines_are_split() -> None:
    text = another_wall("[[1, 2], [2, 2], [2, 5]]")
    assert "office.toml: walls[2]: the wall leaves the outline" in message_of(text)


def test_exterior_opening_needs_a_filling() -> None:
    window = '{ kind = "window", offset_m = 1, width_m = 2, sill_m = 1, head_m = 2 }'
    open_window = edited(
        'material = "concrete"\nthickness_m = 0.2',
        f'material = "concrete"\nthickness_m = 0.2\nopenings = [{window}]',
    )
    assert "the outline is open from (1, 0) to (3, 0)" in message_of(open_window)
    glazed = open_window.replace("head_m = 2 }]", 'head_m = 2, material = "glass" }]')
    assert floorplans.loads(glazed).walls[0].openings[0].material == "glass"


def test_exterior_wall_must_reach_the_ceiling() -> None:
    low = edited('material = "concrete"\nthick', 'material = "concrete"\nheight_m = 2.9\nthick')
    assert "outline: the outline is open from" in message_of(low)


def test_window_above_a_door_is_no_overlap() -> None:
    stacked = (
        Opening(1.0, 1.0, 0.0, 2.0, "door"),
        Opening(0.5, 2.0, 2.2, 2.8, "window", "glass"),
    )
    plan = box((Wall((3.0, 0.0), (3.0, 4.0), "brick", 0.1, 3.0, stacked),))
    assert plan.walls[-1].openings == stacked


def test_start_may_be_in_a_doorway_or_above_a_low_wall() -> None:
    assert floorplans.loads(edited("start = [4.5, 2.5]", "start = [3, 1.5]")).start == (3, 1.5)
    counter = Wall((4.5, 0.0), (4.5, 4.0), "wood", 0.1, 1.0)
    assert box((counter,)).start[0] == counter.start[0]


def test_plan_made_in_python_is_checked_too() -> None:
    with pytest.raises(PlanError, match=r"^source = \[9\.0, 1\.0, 1\.5\]: the source is outside"):
        box(source=(9.0, 1.0, 1.5))
    with pytest.raises(PlanError, match=r"^walls\[4\]\.end\[0\] = NaN: expected a finite"):
        box((Wall((1.0, 1.0), (float("nan"), 1.0), "wood", 0.1, 3.0),))
    with pytest.raises(PlanError, match=r"^outline: the outline has heights"):
        box(outline=Polygon([(0, 0, 0), (6, 0, 0), (6, 4, 0), (0, 4, 0)]))
    with pytest.raises(PlanError, match=r"^outline: the outline has no area"):
        replace(box(), outline=Polygon())


def test_wall_may_touch_others_and_the_outline_within_a_micrometre() -> None:
    wall = Wall((3.0, -5e-7), (3.0, 4.0 + 5e-7), "wood", 0.1, 3.0)
    assert box((wall,)).walls[-1] == wall
