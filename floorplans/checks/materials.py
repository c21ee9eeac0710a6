"""Checks of a plan's own materials, and of the materials of its sheets."""

from collections.abc import Sequence
from types import MappingProxyType

from floorplans.errors import Place, PlanError, unknown_name
from floorplans.materials import (
    LOSS,
    MATERIAL_EDITIONS,
    MATERIALS,
    NOT_IN_LAYERS,
    PARAMETERS,
    MaterialLayer,
    Own,
    PlanMaterial,
    by_name,
)
from floorplans.values import LENGTH, MAX_LAYERS, MAX_MATERIALS, check_count, check_number


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
    _check_loss(material, place)
    if material.colour is not None and not _is_colour(material.colour):
        raise PlanError("expected #rrggbb", (*place, "colour"), material.colour)
    check_count(material.layers, MAX_LAYERS, (*place, "layers"))
    for index, layer in enumerate(material.layers):
        _check_layer(layer, own, (*place, "layers", index))


def _check_loss(material: PlanMaterial, place: Place) -> None:
    given = [key for key in LOSS if getattr(material, key) is not None]
    if not given:
        return
    if len(given) < len(LOSS):
        missing = next(key for key in LOSS if key not in given)
        raise PlanError(
            f"the key is missing; {given[0]} needs it: expected a number from {LOSS[missing]}",
            (*place, missing),
        )
    for key, allowed in LOSS.items():
        check_number(getattr(material, key), allowed, (*place, key))
    if material.layers or material.b or material.c or material.d:
        raise PlanError(
            "a measured loss takes the place of conductivity, laws and layers; leave those out",
            (*place, "loss_db"),
            material.loss_db,
        )


def _check_layer(layer: MaterialLayer, own: Own, place: Place) -> None:
    known = tuple(name for name in MATERIALS if name not in NOT_IN_LAYERS)
    known += tuple(
        n for n, material in own.items() if not material.layers and material.loss_db is None
    )
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
