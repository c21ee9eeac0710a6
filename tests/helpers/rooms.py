"""Rooms of every kind of wall and edge that the tracer knows."""

from buildings import GLASS, Building, box, door, ring, wall, window

L_SHAPE = ((0.0, 0.0), (6.0, 0.0), (6.0, 2.0), (3.0, 2.0), (3.0, 4.0), (0.0, 4.0))
SLANTED = ((0.0, 0.0), (6.0, 1.0), (5.5, 4.25), (2.0, 3.0), (1.0, 4.5))
PILLAR = ((3.0, 1.5), (3.5, 1.5), (3.5, 2.0), (3.0, 2.0))
TRIANGLE = ((3.0, 1.5), (3.75, 1.75), (3.25, 2.25))


def _cut(*holes: tuple, high: float = 3.0) -> Building:
    """Return a room of 6 m x 4 m that a wall divides."""
    return box(6.0, 4.0, *wall((3.5, 0.0), (3.5, 4.0), *holes, high=high))


ROOMS: dict[str, Building] = {
    "door with lintel": _cut(door(1.0, 2.0)),
    "open window": _cut(window(1.0, 2.5)),
    "glass window and door": _cut(window(1.0, 2.5, GLASS), door(3.0, 3.5)),
    "doors of two heights": _cut(door(0.5, 1.25), door(2.0, 3.0, head=2.625)),
    "half-height wall": _cut(high=1.25),
    "free wall end": box(6.0, 4.0, *wall((3.5, 0.0), (3.5, 2.5))),
    "half-height free end": box(6.0, 4.0, *wall((3.5, 0.0), (3.5, 2.5), high=1.5)),
    "hanging screen": box(6.0, 4.0, *wall((3.5, 1.0), (3.5, 2.5), low=1.75)),
    "pillar": box(6.0, 4.0, *ring(PILLAR)),
    "three-sided pillar": box(6.0, 4.0, *ring(TRIANGLE)),
    "corner of 270 degrees": Building(L_SHAPE, ring(L_SHAPE)),
    "slanted room": Building(SLANTED, (*ring(SLANTED), *wall((3.0, 0.5), (3.5, 2.0)))),
}
"""All of them hold SOURCE."""

SOURCE = (1.25, 1.5, 1.2)
