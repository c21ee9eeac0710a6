"""A plan as a Mitsuba 3 scene that Sionna RT reads: an XML file and a PLY mesh per material.

A wall is one sheet whose thickness is that of its radio material, as Sionna RT expects. Materials
are `itu-radio-material`s, named `mat-itu_concrete` and so on, with the thickness appended if a
material has several; a plan's own dielectrics are `radio-material`s with their values at one
frequency.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from trimesh.exchange.ply import export_ply

from floorplans.errors import PlanError
from floorplans.exporters.formats import ExportOptions, Files
from floorplans.exporters.mesh import Sheet, sheets
from floorplans.mesh import SheetMaterial, mesh_of
from floorplans.plan import FloorPlan

_SCENE_VERSION = "2.1.0"
_SAME_AS = {"air": "vacuum"}
_WITHOUT_ITU_TYPE = ("absorber", "perfect_conductor")


def render_sionna(plan: FloorPlan, path: Path, options: ExportOptions) -> Files:
    """Render a plan as a scene for Sionna RT.

    Raises
    ------
    PlanError
        When the plan has a material that Sionna RT cannot represent.
    """
    folder = f"{path.stem}_meshes"
    parts = list(sheets(plan))
    names = _material_names(plan, [part.material for part in parts])
    scene = ET.Element("scene", version=_SCENE_VERSION)
    scene.append(ET.Comment(f" {plan.name}; lengths in metres, z up ".replace("--", "- -")))
    for material, name in names.items():
        scene.append(_bsdf(plan, material, name, options.frequency_hz))
    files: dict[str, bytes] = {}
    for part in parts:
        bsdf = names[part.material]
        mesh = f"{part.part}-{bsdf.removeprefix('mat-')}"
        scene.append(_shape(mesh, f"{folder}/{mesh}.ply", bsdf))
        files[f"{folder}/{mesh}.ply"] = _ply(part)
    ET.indent(scene)
    text: str = ET.tostring(scene, encoding="unicode")
    return {path.name: f"{text}\n".encode(), **files}


def _material_names(
    plan: FloorPlan, materials: Sequence[SheetMaterial]
) -> dict[SheetMaterial, str]:
    """Name of each material's bsdf; with its thickness if the name alone is ambiguous."""
    different = tuple(dict.fromkeys(materials))
    n_thicknesses = Counter(material.name for material in different)
    names: dict[SheetMaterial, str] = {}
    for material in different:
        name = f"mat-{'own' if material.name in plan.own_materials else 'itu'}_{material.name}"
        if n_thicknesses[material.name] > 1:
            name += f"-{1000 * material.thickness_m:.6g}mm"
        names[material] = name
    return names


def _bsdf(plan: FloorPlan, material: SheetMaterial, name: str, frequency_hz: float) -> ET.Element:
    if material.name in _WITHOUT_ITU_TYPE:
        raise PlanError(
            f"{material.name} is not among the ITU materials of Sionna RT; take metal or a "
            "dielectric instead"
        )
    own = plan.own_materials.get(material.name)
    if own is None:
        bsdf = ET.Element("bsdf", type="itu-radio-material", id=name)
        itu_type = _SAME_AS.get(material.name, material.name)
        ET.SubElement(bsdf, "string", name="type", value=itu_type)
    elif own.layers:
        raise PlanError(
            "Sionna RT has no layered materials; name the layer that matters most instead",
            ("materials", material.name),
        )
    else:
        f_ghz = frequency_hz / 1e9
        bsdf = ET.Element("bsdf", type="radio-material", id=name)
        permittivity, conductivity = own.a * f_ghz**own.b, own.c * f_ghz**own.d
        ET.SubElement(bsdf, "float", name="relative_permittivity", value=f"{permittivity:.9g}")
        ET.SubElement(bsdf, "float", name="conductivity", value=f"{conductivity:.9g}")
    ET.SubElement(bsdf, "float", name="thickness", value=f"{material.thickness_m:.9g}")
    red, green, blue = (part / 255 for part in bytes.fromhex(plan.colour_of(material.name)[1:]))
    ET.SubElement(bsdf, "rgb", name="color", value=f"{red:.3f}, {green:.3f}, {blue:.3f}")
    return bsdf


def _shape(name: str, file: str, bsdf: str) -> ET.Element:
    shape = ET.Element("shape", type="ply", id=f"mesh-{name}")
    ET.SubElement(shape, "string", name="filename", value=file)
    ET.SubElement(shape, "boolean", name="face_normals", value="true")
    ET.SubElement(shape, "ref", id=bsdf, name="bsdf")
    return shape


def _ply(sheet: Sheet) -> bytes:
    return export_ply(mesh_of(sheet.triangles), vertex_normal=False)
