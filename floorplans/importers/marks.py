"""Places that a drawing marks: the source, the start and the transmitters."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from shapely.geometry import Point, Polygon

from floorplans.repair.geometry import tidy_point
from floorplans.walls import Point as Point2

Position = tuple[float, float, float]


@dataclass(frozen=True)
class Marks:
    """Places in a drawing.

    Attributes
    ----------
    source : (float, float, float) or None
        (x, y, z) [m].
    start : (float, float) or None
        (x, y) [m].
    transmitters : tuple of (float, float, float)
        (x, y, z) of each [m].
    """

    source: Position | None = None
    start: Point2 | None = None
    transmitters: tuple[Position, ...] = ()

    def moved(self, to: Callable[[Point2], Point2]) -> Marks:
        """Return the places with other (x, y)."""
        return Marks(
            None if self.source is None else (*to(self.source[:2]), self.source[2]),
            None if self.start is None else to(self.start),
            tuple((*to((x, y)), z) for x, y, z in self.transmitters),
        )

    def shifted(self, d_x: float, d_y: float) -> Marks:
        """Return the places translated by (d_x, d_y) [m]."""
        return self.moved(lambda point: tidy_point(point[0] + d_x, point[1] + d_y))

    def inside(self, outline: Polygon, height_m: float) -> Marks:
        """Return the places inside a building whose ceiling is at a height [m]."""

        def is_in(x: float, y: float, z: float = height_m / 2) -> bool:
            return outline.contains(Point(x, y)) and 0.0 < z < height_m

        return Marks(
            self.source if self.source and is_in(*self.source) else None,
            self.start if self.start and is_in(*self.start) else None,
            tuple(place for place in self.transmitters if is_in(*place)),
        )

    def missing_in(self, others: Marks) -> Iterator[str]:
        """Yield a sentence about what others lack."""
        for name in ("source", "start"):
            place = getattr(self, name)
            if place is not None and getattr(others, name) is None:
                yield f"the {name} of the drawing, {place}, is outside the building: left out"
        n_lost = len(self.transmitters) - len(others.transmitters)
        if n_lost:
            yield f"{n_lost} transmitters of the drawing are outside the building: left out"
