"""Materials of IFC elements: layers become a material of the plan's own."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from itertools import groupby
from typing import NamedTuple

from floorplans.importers.defaults import wall_material_of
from floorplans.importers.draft import Assumption
from floorplans.importers.ifc.curves import Entity
from floorplans.importers.layer_names import KINDS, meaning_in
from floorplans.importers.material_names import CAVITY, layer_material_named, material_named
from floorplans.materials import MATERIAL_COLOURS, MaterialLayer, PlanMaterial

FILM_M = 0.003
"""Unknown layers up to this thickness are films, such as a vapour barrier, that matter little."""

_MIN_M = 5e-5
_MAX_NAMES = 4


class Layer(NamedTuple):
    """A layer of an element: the names the file gives its material, and its thickness [m]."""

    names: tuple[str, ...]
    thickness_m: float


class Materials:
    """The materials of a model's elements, collected as they are asked for.

    Parameters
    ----------
    metre : float
        Length of the file's unit [m].
    given : mapping of str to str
        Name or pattern of a material in the file -> KIND:MATERIAL; overrides the names.
    wall_material : str or None
        Of layers with an unknown name; by default that of walls of the layer's thickness.

    Attributes
    ----------
    names : set of str
        Names of all materials so far, as the file gives them.
    """

    def __init__(
        self, metre: float, given: Mapping[str, str], wall_material: str | None = None
    ) -> None:
        self._metre = metre
        self._given = given
        self._wall_material = wall_material
        self._own: dict[tuple[MaterialLayer, ...], PlanMaterial] = {}
        self._assumed: Counter[tuple[str, str, str]] = Counter()
        self.names: set[str] = set()

    @property
    def own(self) -> tuple[PlanMaterial, ...]:
        """Layered materials of all walls so far."""
        return tuple(self._own.values())

    def of_wall(self, wall: Entity) -> tuple[str | None, float | None]:
        """Material of a wall, layered where its layers differ, and the thickness of all layers [m].

        Returns
        -------
        material : str or None
            A built-in one or one of `own`; None if no layer has a known name, and if all are
            cavities or films.
        thickness_m : float or None
            None if the wall has no layers.
        """
        layers = self._layers(wall)
        if not layers:
            return self._first_solid(wall), None
        total_m = sum(layer.thickness_m for layer in layers)
        found = [self._known(layer.names) for layer in layers]
        if CAVITY not in found and not any(found):
            return None, total_m
        if not any(_is_solid(layer, m) for layer, m in zip(layers, found, strict=True)):
            return None, total_m
        stack = self._stack(layers, found)
        if len(stack) == 1:
            return stack[0].material, stack[0].thickness_m
        own = self._layered(stack)
        return own.name, own.thickness_m

    def of_slab(self, element: Entity) -> str | None:
        """Material of the thickest layer of a known one, for floors and ceilings."""
        known = [
            (layer.thickness_m, material)
            for layer in self._layers(element)
            if (material := self._known(layer.names)) not in (None, CAVITY)
        ]
        return max(known)[1] if known else self._first_solid(element)

    def assumed(self) -> Iterator[Assumption]:
        """Yield what was assumed about each material of the file, sorted by its name."""
        for (name, material, why), n in sorted(self._assumed.items()):
            yield Assumption(
                f'material "{name}"', material, f"{why}; {n} layer{'s' * (n > 1)} of walls"
            )

    def _layers(self, element: Entity) -> list[Layer]:
        """Layers of an element in order; empty if it has none, or one without a thickness."""
        material = _material_of(element)
        if material is None:
            return []
        if material.is_a("IfcMaterialLayerSet"):
            rows = [
                (_names(row, row.Material), row.LayerThickness) for row in material.MaterialLayers
            ]
        elif material.is_a("IfcMaterialConstituentSet"):
            widths = _widths(element)
            parts = material.MaterialConstituents or ()
            if not all(part.Name in widths for part in parts):
                return []
            rows = [(_names(part, part.Material), widths[part.Name]) for part in parts]
        else:
            return []
        layers = [Layer(names, round(self._metre * float(width), 4)) for names, width in rows]
        return [layer for layer in layers if layer.thickness_m > _MIN_M]

    def _first_solid(self, element: Entity) -> str | None:
        """First material of an element without layers that is known and no cavity."""
        material = _material_of(element)
        names = [] if material is None else [_names(part, part) for part in _parts(material)]
        found = [self._known(them) for them in names]
        return next((name for name in found if name not in (None, CAVITY)), None)

    def _known(self, names: Sequence[str]) -> str | None:
        self.names.update(names)
        for name in names:
            chosen = meaning_in(self._given, name, KINDS)
            if chosen is not None:
                return chosen[1]
        if not names:
            return CAVITY
        return next(filter(None, map(layer_material_named, names)), None)

    def _stack(
        self, layers: Sequence[Layer], found: Sequence[str | None]
    ) -> tuple[MaterialLayer, ...]:
        """Layers of known materials; neighbours of one material are one layer."""
        rows = [
            (self._assume(layer, material), layer.thickness_m)
            for layer, material in zip(layers, found, strict=True)
        ]
        return tuple(
            MaterialLayer(material, round(sum(thickness_m for _, thickness_m in run), 4))
            for material, run in groupby(rows, key=lambda row: row[0])
        )

    def _assume(self, layer: Layer, material: str | None) -> str:
        """Material of a layer; what its name does not say plainly is noted."""
        name = layer.names[0] if layer.names else "(no name)"
        if material is None:
            thin = layer.thickness_m <= FILM_M
            material = (
                CAVITY if thin else self._wall_material or wall_material_of(layer.thickness_m)
            )
            why = "an unknown name, and a thin film" if thin else "an unknown name"
        elif material == CAVITY:
            why = "a cavity: studs, insulation or air"
        elif material == material_named(name):
            return material
        else:
            why = "the nearest material"
        self._assumed[name, material, why] += 1
        return material

    def _layered(self, stack: tuple[MaterialLayer, ...]) -> PlanMaterial:
        """Material of the plan's own; reversed layers are the same one."""
        for layers in (stack, stack[::-1]):
            if layers in self._own:
                return self._own[layers]
        solid = max((s for s in stack if s.material != CAVITY), key=lambda s: s.thickness_m)
        own = PlanMaterial(
            self._free_name(stack), layers=stack, colour=MATERIAL_COLOURS[solid.material]
        )
        self._own[stack] = own
        return own

    def _free_name(self, stack: Sequence[MaterialLayer]) -> str:
        """Name of the materials in order and the total in millimetres."""
        total_mm = f"{1000 * sum(layer.thickness_m for layer in stack):.0f}"
        name = "_".join([*(layer.material for layer in stack[:_MAX_NAMES]), total_mm])
        taken = {own.name for own in self._own.values()}
        others = (f"{name}_{number}" for number in range(2, len(taken) + 3))
        return next(free for free in (name, *others) if free not in taken)


def _is_solid(layer: Layer, material: str | None) -> bool:
    """Whether a layer of a known or unknown material is neither a cavity nor a film."""
    return material != CAVITY and (material is not None or layer.thickness_m > FILM_M)


def _material_of(element: Entity) -> Entity | None:
    from ifcopenshell.util.element import get_material

    return get_material(element, should_skip_usage=True)


def _parts(material: Entity) -> list[Entity]:
    if material.is_a("IfcMaterialConstituentSet"):
        return [part.Material for part in material.MaterialConstituents or ()]
    if material.is_a("IfcMaterialList"):
        return list(material.Materials)
    return [material] if material.is_a("IfcMaterial") else []


def _names(row: Entity, material: Entity | None) -> tuple[str, ...]:
    """Names of a layer's material, the most telling first; empty for a gap."""
    if getattr(row, "IsVentilated", None) is True:
        return ("Air gap",)
    found = [getattr(of, key, None) for of in (material, row) for key in ("Name", "Category")]
    return tuple(dict.fromkeys(name for name in found if name))


def _widths(element: Entity) -> dict[str, float]:
    """Width of each constituent of an element, in the file's unit, from its quantities."""
    sets = [getattr(rel, "RelatingPropertyDefinition", None) for rel in element.IsDefinedBy]
    return {
        part.Name: float(quantity.LengthValue)
        for them in sets
        if them is not None and them.is_a("IfcElementQuantity")
        for part in them.Quantities
        if part.is_a("IfcPhysicalComplexQuantity")
        for quantity in part.HasQuantities
        if quantity.is_a("IfcQuantityLength")
    }
