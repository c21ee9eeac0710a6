"""What a building is made of: walls by the rooms on both sides, windows and doors."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from floorplans.generators.rooms import Room, Use

Made = tuple[str, float]
"""Material and thickness [m]."""

GLASS_WALL: Made = ("glass", 0.012)
CORE: Made = ("concrete", 0.2)
WINDOW: Made = ("glass", 0.024)
DOOR: Made = ("wood", 0.04)
FURNITURE: Made = ("chipboard", 0.04)

EXTERIOR: tuple[Made, ...] = (("brick", 0.365), ("brick", 0.24), ("concrete", 0.25))
INTERIOR: dict[str, tuple[Made, ...]] = {
    "flat": (("brick", 0.115), ("plasterboard", 0.1), ("brick", 0.175)),
    "office": (("plasterboard", 0.1), ("plasterboard", 0.125)),
    "hotel": (("plasterboard", 0.15), ("brick", 0.175)),
    "school": (("brick", 0.175), ("concrete", 0.15), ("plasterboard", 0.125)),
    "hall": (("plasterboard", 0.125), ("brick", 0.175)),
}
HEIGHT_M: dict[str, tuple[float, float]] = {
    "flat": (2.4, 2.7), "office": (2.6, 3.2), "hotel": (2.4, 2.8), "school": (2.9, 3.4),
    "hall": (5.0, 9.0),
}  # fmt: skip
"""Least and largest height from floor to ceiling."""

DARK: tuple[Use, ...] = ("core", "store", "bath")
"""Rooms that need no window."""


@dataclass(frozen=True)
class Style:
    """Choices for a whole building.

    Attributes
    ----------
    height_m : float
        From floor to ceiling [m].
    exterior, interior : (str, float)
        Material and thickness [m] of walls.
    glazing : float
        Fraction of an exterior wall's length that is windows.
    open_doors : float
        Fraction of the doors that stand open.
    """

    height_m: float
    exterior: Made
    interior: Made
    glazing: float
    open_doors: float

    @classmethod
    def of(cls, kind: str, rng: np.random.Generator) -> Style:
        """Draw the choices for a kind of building."""
        low, high = HEIGHT_M[kind]
        steps = round((high - low) / 0.05)
        return cls(
            round(low + 0.05 * int(rng.integers(0, steps + 1)), 2),
            EXTERIOR[int(rng.integers(len(EXTERIOR)))],
            INTERIOR[kind][int(rng.integers(len(INTERIOR[kind])))],
            0.01 * int(rng.integers(15, 40) if kind == "hall" else rng.integers(30, 75)),
            0.01 * int(rng.integers(20, 90)),
        )

    def wall(self, one: Room | None, other: Room | None) -> Made | None:
        """Return what separates two rooms, None for outside; None where nothing does."""
        if one is None or other is None:
            return self.exterior
        if one.is_one_with(other):
            return None
        uses = {one.use, other.use}
        if "core" in uses:
            return CORE
        if uses == {"meeting", "corridor"}:
            return GLASS_WALL
        return self.interior

    def has_window(self, room: Room) -> bool:
        """Whether a room has windows where it has an exterior wall."""
        return room.use not in DARK
