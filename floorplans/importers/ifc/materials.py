"""Materials of IFC elements from their names."""

from __future__ import annotations

from collections.abc import Mapping

from floorplans.importers.ifc.curves import Entity
from floorplans.importers.layer_names import KINDS, material_named, meaning_in


def dominant_material(
    element: Entity, metre: float, layers: Mapping[str, str]
) -> tuple[str | None, float | None]:
    """Material of the thickest layer that has a known one, and the thickness of all layers [m].

    Parameters
    ----------
    element : entity
    metre : float
        Length of the file's unit [m].
    layers : mapping of str to str
        Name or pattern of a material in the file -> KIND:MATERIAL; overrides the names.

    Returns
    -------
    material : str or None
    thickness_m : float or None
        None if the element has no layers.
    """
    from ifcopenshell.util.element import get_material

    material = get_material(element, should_skip_usage=True)
    if material is None:
        return None, None
    if material.is_a("IfcMaterialLayerSet"):
        rows = [
            (metre * float(layer.LayerThickness), _known(layer.Material, layers))
            for layer in material.MaterialLayers
        ]
        known = [row for row in rows if row[1] is not None]
        total_m = sum(row[0] for row in rows)
        return (max(known)[1] if known else None), (total_m if total_m > 0 else None)
    names = [_known(one, layers) for one in _parts(material)]
    return next((name for name in names if name is not None), None), None


def layer_count(element: Entity) -> int:
    """Count the layers of an element's material; 0 if it is not layered."""
    from ifcopenshell.util.element import get_material

    material = get_material(element, should_skip_usage=True)
    if material is None or not material.is_a("IfcMaterialLayerSet"):
        return 0
    return len(material.MaterialLayers)


def _parts(material: Entity) -> list[Entity]:
    if material.is_a("IfcMaterialConstituentSet"):
        return [part.Material for part in material.MaterialConstituents or ()]
    if material.is_a("IfcMaterialList"):
        return list(material.Materials)
    return [material] if material.is_a("IfcMaterial") else []


def _known(material: Entity | None, layers: Mapping[str, str]) -> str | None:
    if material is None or not material.Name:
        return None
    chosen = meaning_in(layers, material.Name, KINDS)
    if chosen is not None:
        return chosen[1]
    return material_named(material.Name) or material_named(getattr(material, "Category", "") or "")
