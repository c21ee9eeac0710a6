"""The materials a plan may name, those of its own, and the colour each is drawn in.

The built-in names are those of Table 3 of Recommendation ITU-R P.2040, in lower case, and a few
that need no table; their physics belongs to the tracer. The colours differ in lightness as well as
in hue, so that they stay distinguishable under common colour-vision deficiencies.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from floorplans.values import (
    Range,
)

MATERIAL_COLOURS: dict[str, str] = {
    "concrete": "#4d4d4d",
    "brick": "#a6432d",
    "plasterboard": "#e0a83c",
    "wood": "#7a4a1e",
    "glass": "#56b4e9",
    "clear_acrylic": "#a8dcf0",
    "ceiling_board": "#d9d4c7",
    "chipboard": "#c48f65",
    "plywood": "#d8b98a",
    "marble": "#9fa8c9",
    "floorboard": "#94683c",
    "vinyl_tile": "#7d8f69",
    "carpet_tile": "#8c5a6e",
    "asphalt_concrete": "#2e2e33",
    "metal": "#0b3c6f",
    "very_dry_ground": "#dcc48e",
    "medium_dry_ground": "#a98f5a",
    "wet_ground": "#5e4b2f",
    "vacuum": "#f2f2f2",
    "air": "#f5f5f5",
    "perfect_conductor": "#052a50",
    "absorber": "#1a1a1a",
}
"""Colour of each material as #rrggbb; its keys are all built-in materials."""

MATERIALS: tuple[str, ...] = tuple(MATERIAL_COLOURS)
"""All built-in material names."""

MATERIAL_EDITIONS = ("P.2040-1", "P.2040-2", "P.2040-3", "P.2040-4")
"""Editions of ITU-R P.2040 that a plan may take the built-in materials from."""

OWN_COLOUR = "#8463a3"
"""Colour of a plan's own material without one."""

NOT_IN_LAYERS = ("perfect_conductor", "absorber")
"""Built-in materials that no wave enters."""


class MaterialLayer(NamedTuple):
    """A layer of a plan's own material: the material it is made of, and its thickness [m]."""

    material: str
    thickness_m: float


@dataclass(frozen=True)
class PlanMaterial:
    """A plan's own material: a dielectric, or layers of other materials.

    Attributes
    ----------
    name : str
        Name by which walls refer to it.
    a, b, c, d : float
        Relative permittivity ``a f^b`` and conductivity ``c f^d`` [S/m], f in GHz; unused
        where there are layers.
    layers : tuple of MaterialLayer
        Built-in dielectrics or the plan's own, one behind the other; empty for a dielectric.
    colour : str or None
        #rrggbb to draw it in.
    loss_db, loss_frequency_hz : float or None
        Loss of a wave that crosses a wall of it at right angles [dB], as measured at a frequency
        [Hz], in place of a conductivity; both or neither.
    """

    name: str
    a: float = 1.0
    b: float = 0.0
    c: float = 0.0
    d: float = 0.0
    layers: tuple[MaterialLayer, ...] = ()
    colour: str | None = None
    loss_db: float | None = None
    loss_frequency_hz: float | None = None

    @property
    def thickness_m(self) -> float | None:
        """Of all layers [m]; None for a dielectric, whose thickness the wall states."""
        return sum(layer.thickness_m for layer in self.layers) if self.layers else None


PARAMETERS = {
    "a": Range(1.0, 1e6),
    "b": Range(-10.0, 10.0),
    "c": Range(0.0, 1e12, "S/m"),
    "d": Range(-10.0, 10.0),
}
"""Ranges of the parameters of a dielectric."""

LOSS = {"loss_db": Range(0.0, 100.0, "dB"), "loss_frequency_hz": Range(1e6, 1e12, "Hz")}
"""Ranges of a measured loss and of its frequency."""

Own = Mapping[str, PlanMaterial]
"""A plan's own materials by name."""


def by_name(materials: Sequence[PlanMaterial]) -> Own:
    """A plan's own materials by their names."""
    return {material.name: material for material in materials}
