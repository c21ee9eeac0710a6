"""What a plan gets where its file says nothing."""

HEIGHT_M = 3.0
"""From floor to ceiling [m]."""
SLAB_MATERIAL = "concrete"

CLOSED_GAP_M = 8.0
"""Widest gap in the outline that is closed [m]."""

WALL_THICKNESS_M = 0.1
WALL_MATERIAL = "plasterboard"
THICK_WALL_MATERIAL, THICK_M = "brick", 0.18
"""Of walls known to be at least as thick [m], where the file names no material: masonry."""

DOOR_HEAD_M = 2.1
DOOR_MATERIAL, DOOR_THICKNESS_M = "wood", 0.04
"""Of doors in the outline; those inside are open."""

WINDOW_SILL_M = 0.9
WINDOW_HEAD_M = 2.1
WINDOW_MATERIAL, WINDOW_THICKNESS_M = "glass", 0.02


def wall_material_of(thickness_m: float | None) -> str:
    """Material of a wall or a layer of it whose material is unknown."""
    thick = thickness_m is not None and thickness_m >= THICK_M
    return THICK_WALL_MATERIAL if thick else WALL_MATERIAL
