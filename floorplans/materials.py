"""The materials a plan may name, and the colour each is drawn in.

The names are those of Table 3 of Recommendation ITU-R P.2040, in lower case; the physics of a
material belongs to the tracer. The colours stay apart under the common colour-vision deficiencies
because they differ in lightness as well as in hue.
"""

MATERIAL_COLOURS: dict[str, str] = {
    "concrete": "#4d4d4d",
    "brick": "#a6432d",
    "plasterboard": "#e0a83c",
    "wood": "#7a4a1e",
    "glass": "#56b4e9",
    "ceiling_board": "#d9d4c7",
    "chipboard": "#c48f65",
    "plywood": "#d8b98a",
    "marble": "#9fa8c9",
    "floorboard": "#94683c",
    "metal": "#0b3c6f",
    "vacuum": "#f2f2f2",
}
"""Colour of each material as #rrggbb; its keys are all known materials."""

MATERIALS: tuple[str, ...] = tuple(MATERIAL_COLOURS)
"""All known material names."""
