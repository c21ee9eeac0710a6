"""Generated office buildings of any size, to measure how time and memory scale with a plan."""

from dataclasses import replace
from itertools import pairwise

from shapely.geometry import Polygon

from floorplans.plan import FloorPlan
from floorplans.walls import Opening, Point, Wall

CORRIDOR_M = 2.0
DOOR_M = 0.9
DOOR_OFFSET_M = 1.05
DOOR_HEAD_M = 2.1
WINDOW_HEAD_M = 2.2
WINDOW_SILL_M = 0.9

EXTERIOR = ("brick", 0.3)
CORRIDOR = ("plasterboard", 0.125)
PARTITION = ("plasterboard", 0.1)


def generate_office(
    rooms_x: int,
    rooms_y: int,
    *,
    room_m: tuple[float, float] = (10.0, 7.0),
    height_m: float = 2.8,
    courtyard: bool = False,
) -> FloorPlan:
    """Generate an office: rows of rooms, a corridor beside each row and one in the west.

    Every room has a door to the corridor south of it and a door to its eastern neighbour; the last
    room of a row has a window instead.

    Parameters
    ----------
    rooms_x, rooms_y : int
        Rooms per row, and rows; at least 1 each.
    room_m : (float, float)
        Width and depth of a room [m], at least 2 x 2.
    height_m : float
        From floor to ceiling [m], at least 2.4.
    courtyard : bool
        Whether the middle room is a courtyard, which is not part of the storey.

    Returns
    -------
    FloorPlan
        With rooms_x * rooms_y rooms and two openings per room. 15 x 10 rooms are 150 rooms and 300
        openings on 152 m x 90 m.

    Raises
    ------
    ValueError
        For a courtyard among fewer than 3 x 3 rooms.
    """
    if courtyard and min(rooms_x, rooms_y) < 3:
        raise ValueError(f"{rooms_x} x {rooms_y} rooms: a courtyard needs 3 x 3 or more around it")
    width, depth = room_m
    pitch = depth + CORRIDOR_M
    x_end, y_end = CORRIDOR_M + rooms_x * width, rooms_y * pitch
    court = (rooms_x // 2, rooms_y // 2) if courtyard else None
    corners = [(0.0, 0.0), (x_end, 0.0), (x_end, y_end), (0.0, y_end)]
    walls = [_wall(a, b, EXTERIOR, height_m) for a, b in pairwise([*corners, corners[0]])]
    walls[1] = replace(walls[1], openings=_windows(rooms_y, pitch))
    for row in range(rooms_y):
        y = CORRIDOR_M + row * pitch
        doors = tuple(_opening(i * width, (i, row) == court) for i in range(rooms_x))
        walls.append(_wall((CORRIDOR_M, y), (x_end, y), CORRIDOR, height_m, doors))
        if row < rooms_y - 1:
            walls.append(_wall((CORRIDOR_M, y + depth), (x_end, y + depth), CORRIDOR, height_m))
        for i in range(rooms_x):
            x = CORRIDOR_M + i * width
            door = (_opening(0.0, court in ((i - 1, row), (i, row))),) if i else ()
            walls.append(_wall((x, y), (x, y + depth), PARTITION, height_m, door))
    return FloorPlan(
        name=f"office of {rooms_x} x {rooms_y} rooms",
        outline=Polygon(corners, [_room(*court, room_m)] if court else []),
        walls=tuple(walls),
        height_m=height_m,
        floor_material="concrete",
        ceiling_material="ceiling_board",
        source=(x_end - 0.4 * width, y_end - 0.4 * depth, 1.2),
        start=(0.5, 0.5),
    )


def _room(i: int, row: int, room_m: tuple[float, float]) -> list[Point]:
    """Corners of a room."""
    (width, depth), y = room_m, CORRIDOR_M + row * (room_m[1] + CORRIDOR_M)
    x = CORRIDOR_M + i * width
    return [(x, y), (x + width, y), (x + width, y + depth), (x, y + depth)]


def _wall(
    start: Point,
    end: Point,
    made_of: tuple[str, float],
    height_m: float,
    openings: tuple[Opening, ...] = (),
) -> Wall:
    return Wall(start, end, *made_of, height_m, openings)


def _opening(room_begins_m: float, to_courtyard: bool) -> Opening:
    """Make an open door near the corner of a room, or a window where the courtyard is behind."""
    offset_m = room_begins_m + DOOR_OFFSET_M
    if to_courtyard:
        return _window(offset_m)
    return Opening(offset_m, DOOR_M, 0.0, DOOR_HEAD_M, "door")


def _windows(rooms_y: int, pitch_m: float) -> tuple[Opening, ...]:
    """Make a window for the last room of each row, in the eastern exterior wall."""
    return tuple(_window(CORRIDOR_M + row * pitch_m + DOOR_OFFSET_M) for row in range(rooms_y))


def _window(offset_m: float) -> Opening:
    return Opening(offset_m, DOOR_M, WINDOW_SILL_M, WINDOW_HEAD_M, "window", "glass", 0.02)
