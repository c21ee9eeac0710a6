"""Small plans for the tests: one room of 6 m x 4 m as text, and random plans."""

from dataclasses import replace

from hypothesis import strategies as st
from shapely.geometry import Polygon

from floorplans import MATERIALS, FloorPlan, Opening, Wall

Corners = list[tuple[float, float]]

ROOM = """
name = "room"
format = 1
height_m = 3
floor_material = "concrete"
ceiling_material = "ceiling_board"
source = [1, 1, 1.5]
start = [4.5, 2.5]
outline = [[0, 0], [6, 0], [6, 4], [0, 4], [0, 0]]

[[walls]]
points = [[0, 0], [6, 0], [6, 4], [0, 4], [0, 0]]
material = "concrete"
thickness_m = 0.2

[[walls]]
points = [[3, 0], [3, 4]]
material = "plasterboard"
thickness_m = 0.1
openings = [
  { kind = "door", offset_m = 1, width_m = 1, head_m = 2 },
  { kind = "window", offset_m = 2.5, width_m = 1, sill_m = 1, head_m = 2.5, material = "glass" },
]
"""
"""One brick-shaped storey with a partition at x = 3 that has an open door and a glazed window."""


def edited(old: str, new: str) -> str:
    """Return ROOM with its one occurrence of `old` replaced."""
    assert ROOM.count(old) == 1, f"{old!r} is not once in ROOM"
    return ROOM.replace(old, new)


def ring(corners: Corners, material: str) -> tuple[Wall, ...]:
    """Return walls of 3 m height around a polygon."""
    sides = zip(corners, corners[1:] + corners[:1], strict=True)
    return tuple(Wall(start, end, material, 0.2, 3.0) for start, end in sides)


def box(walls: tuple[Wall, ...] = (), **changes: object) -> FloorPlan:
    """Return a box of 6 m x 4 m x 3 m with more walls in it."""
    corners = [(0.0, 0.0), (6.0, 0.0), (6.0, 4.0), (0.0, 4.0)]
    fields = {
        "name": "box",
        "outline": Polygon(corners),
        "walls": ring(corners, "concrete") + walls,
        "height_m": 3.0,
        "floor_material": "concrete",
        "ceiling_material": "concrete",
        "source": (1.0, 1.0, 1.5),
        "start": (4.5, 2.5),
    }
    return FloorPlan(**(fields | changes))


def box_around_courtyard() -> FloorPlan:
    """Return the box with a walled courtyard, (4, 1) to (5, 2), that is no part of it."""
    court = [(4.0, 1.0), (5.0, 1.0), (5.0, 2.0), (4.0, 2.0)]
    return box(ring(court, "brick"), outline=Polygon(box().outline.exterior, [court]))


shares = st.floats(0.01, 1.0)
materials = st.sampled_from(MATERIALS)


@st.composite
def openings(draw: st.DrawFn, wall: Wall, may_be_open: bool) -> tuple[Opening, ...]:
    """Draw openings side by side along a wall."""
    steps = draw(st.lists(shares, max_size=7))
    scale = wall.length_m / (sum(steps) + 0.1)
    result: list[Opening] = []
    for index in range(0, len(steps) - 1, 2):
        low, high = sorted((draw(shares), draw(shares)))
        filling = draw(materials if not may_be_open else st.none() | materials)
        result.append(
            Opening(
                offset_m=scale * sum(steps[: index + 1]),
                width_m=scale * steps[index + 1],
                sill_m=draw(st.sampled_from([0.0, 0.5 * low])) * wall.height_m,
                head_m=high * wall.height_m,
                kind=draw(st.sampled_from(["door", "window", "passage"])),
                material=filling,
                thickness_m=draw(st.none() | shares) if filling else None,
            )
        )
    return tuple(result)


@st.composite
def plans(draw: st.DrawFn) -> FloorPlan:
    """Draw a box of any size and place, cut by parallel partitions, with openings everywhere."""
    width, depth, height = (draw(st.floats(2.0, 90.0)) for _ in range(3))
    x0, y0 = draw(st.floats(-50.0, 50.0)), draw(st.floats(-50.0, 50.0))
    x1, y1 = x0 + width, y0 + depth
    corners = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]
    walls: list[Wall] = []
    for side in ring(corners, "concrete"):
        wall = replace(side, material=draw(materials), thickness_m=draw(shares), height_m=height)
        walls.append(replace(wall, openings=draw(openings(wall, may_be_open=False))))
    for tenth in draw(st.sets(st.integers(2, 9))):
        x = x0 + width * tenth / 10
        wall = Wall((x, y0), (x, y1), draw(materials), draw(shares), height * draw(shares))
        walls.append(replace(wall, openings=draw(openings(wall, may_be_open=True))))
    return FloorPlan(
        name=draw(st.text(min_size=1).filter(str.isprintable)),
        outline=Polygon(corners),
        walls=tuple(walls),
        height_m=height,
        floor_material=draw(materials),
        ceiling_material=draw(materials),
        source=(x0 + width * 0.05, y0 + depth * draw(st.floats(0.1, 0.9)), height * 0.5),
        start=(x0 + width * 0.15, y0 + depth / 2),
        floor_thickness_m=draw(shares),
        ceiling_thickness_m=draw(shares),
    )
