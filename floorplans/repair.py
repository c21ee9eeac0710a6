"""Mend walls that a drawing left almost right."""

from __future__ import annotations

from dataclasses import dataclass

from floorplans.walls import Point


@dataclass(frozen=True)
class Change:
    """One thing that was mended.

    Attributes
    ----------
    kind : str
        "moved", "joined", "cut", "dropped", "closed" or "raised".
    text : str
        What was done.
    at : (float, float)
        Where, (x, y) [m].
    """

    kind: str
    text: str
    at: Point

    def __str__(self) -> str:
        """Say what was done and where, to the millimetre."""
        x, y = (round(coordinate, 3) + 0.0 for coordinate in self.at)
        return f"{self.kind} at ({x:g}, {y:g}): {self.text}"
