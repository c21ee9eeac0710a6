"""The materials a plan may name, those of its own, and the colour each is drawn in.

The built-in names are those of Table 3 of Recommendation ITU-R P.2040, in lower case, and a few
that need no table; their physics belongs to the tracer. The colours differ in lightness as well as
in hue, so that they stay distinguishable under common colour-vision deficiencies.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import NamedTuple

from floorplans.errors import Place, PlanError, unknown_name
from floorplans.values import (
    LENGTH,
    MAX_LAYERS,
    MAX_MATERIALS,
    Range,
    check_count,
    check_number,
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
    """

    name: str
    a: float = 1.0
    b: float = 0.0
    c: float = 0.0
    d: float = 0.0
    layers: tuple[MaterialLayer, ...] = ()
    colour: str | None = None

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

Own = Mapping[str, PlanMaterial]
"""A plan's own materials by name."""


def by_name(materials: Sequence[PlanMaterial]) -> Own:
    """A plan's own materials by their names."""
    return {material.name: material for material in materials}


def check_materials(materials: Sequence[PlanMaterial], edition: str | None) -> None:
    """Check a plan's own materials and its edition of the built-in ones.

    Raises
    ------
    PlanError
    """
    if edition is not None and edition not in MATERIAL_EDITIONS:
        problem = unknown_name("edition of ITU-R P.2040", edition, MATERIAL_EDITIONS)
        raise PlanError(problem, ("material_edition",), edition)
    check_count(materials, MAX_MATERIALS, ("materials",))
    own = by_name(materials)
    for material in materials:
        _check_own(material, own, ("materials", material.name))
    if len(own) < len(materials):
        raise PlanError("two materials have the same name", ("materials",))


def _check_own(material: PlanMaterial, own: Own, place: Place) -> None:
    if material.name in MATERIALS or not material.name.isidentifier():
        raise PlanError(
            "expected a name of letters, digits and underscores that no built-in material has",
            place,
        )
    for key, allowed in PARAMETERS.items():
        check_number(getattr(material, key), allowed, (*place, key))
    if material.colour is not None and not _is_colour(material.colour):
        raise PlanError("expected #rrggbb", (*place, "colour"), material.colour)
    check_count(material.layers, MAX_LAYERS, (*place, "layers"))
    for index, layer in enumerate(material.layers):
        _check_layer(layer, own, (*place, "layers", index))


def _check_layer(layer: MaterialLayer, own: Own, place: Place) -> None:
    known = tuple(name for name in MATERIALS if name not in NOT_IN_LAYERS)
    known += tuple(name for name, material in own.items() if not material.layers)
    if layer.material not in known:
        problem = unknown_name("material of a layer", layer.material, known)
        raise PlanError(problem, (*place, "material"), layer.material)
    check_number(layer.thickness_m, LENGTH, (*place, "thickness_m"))


def _is_colour(text: str) -> bool:
    digits = "0123456789abcdefABCDEF"
    return len(text) == 7 and text[0] == "#" and all(letter in digits for letter in text[1:])


def check_material(name: str, place: Place, own: Own = MappingProxyType({})) -> None:
    """Raise `PlanError` for a material that is neither built-in nor one of the plan's own."""
    if name not in MATERIALS and name not in own:
        raise PlanError(unknown_name("material", name, (*MATERIALS, *own)), place, name)


def check_slab(name: str, thickness_m: float, own: Own, place: Place, key: str = "") -> None:
    """Check that a sheet's material is known and fits its thickness.

    Parameters
    ----------
    name, thickness_m
        The sheet's material, and its thickness [m].
    own
        The plan's own materials.
    place
        Of the sheet's table, for the message.
    key
        Prefix of ``material`` and ``thickness_m`` in the names of the keys.

    Raises
    ------
    PlanError
    """
    at = (*place, f"{key}material")
    check_material(name, at, own)
    if name not in own:
        return
    layers_m = own[name].thickness_m
    if layers_m is not None and abs(thickness_m - layers_m) > 1e-6:
        raise PlanError(
            f"the layers of {name} are {layers_m:g} m thick in total; give that, or leave it out",
            (*place, f"{key}thickness_m"),
            thickness_m,
        )
