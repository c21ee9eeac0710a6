"""Meshes and scenes for other programs keep the plan's sheets, materials and units."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from dataclasses import replace

import numpy as np
import pytest
import trimesh
from small_plans import box, box_around_courtyard

import floorplans
from floorplans import PlanError, Wall
from floorplans.exporters import ExportOptions, export
from floorplans.exporters.mesh import sheets
from floorplans.materials import MaterialLayer, PlanMaterial


def partition(material: str, thickness_m: float = 0.1) -> Wall:
    return Wall((3.0, 0.0), (3.0, 3.0), material, thickness_m, 3.0)


@pytest.mark.parametrize("suffix", ["glb", "ply", "stl", "obj"])
def test_mesh_has_the_plans_area_and_size(tmp_path, suffix) -> None:
    plan = box_around_courtyard()
    (path,) = export(plan, tmp_path / f"plan.{suffix}")
    mesh = trimesh.load_mesh(path)
    assert mesh.area == pytest.approx(plan.to_mesh().mesh.area, rel=1e-6)
    assert sorted(mesh.extents) == pytest.approx([3.0, 4.0, 6.0], rel=1e-6)


def test_sheets_are_the_mesh() -> None:
    plan = floorplans.load("flat")
    parts = list(sheets(plan))
    assert sum(len(part.triangles) for part in parts) == len(plan.to_mesh().mesh.faces)
    assert [part.part for part in parts][-2:] == ["floor", "ceiling"]
    assert "walls brick 300 mm" in {part.name for part in parts}


def test_glb_is_y_up_and_names_its_materials(tmp_path) -> None:
    (path,) = export(floorplans.load("flat"), tmp_path / "flat.glb")
    scene = trimesh.load_scene(path)
    low, high = scene.bounds
    assert (low, high) == (
        pytest.approx([0.0, 0.0, -9.0], abs=1e-6),
        pytest.approx([12.0, 2.6, 0.0], abs=1e-6),
    )
    glass = scene.geometry["walls glass 20 mm"].visual.material
    assert glass.name == "walls glass 20 mm"
    assert "#{:02x}{:02x}{:02x}".format(*glass.baseColorFactor[:3]) == "#56b4e9"


def test_ply_has_colours_and_a_material_a_face(tmp_path) -> None:
    plan = floorplans.load("flat")
    (path,) = export(plan, tmp_path / "flat.ply")
    walls, mesh = plan.to_mesh(), trimesh.load(path, process=False)
    header = path.read_bytes().split(b"end_header")[0].decode()
    for index, material in enumerate(walls.materials):
        assert f"material {index} = {material.name}, {material.thickness_m:g} m" in header
    faces = mesh.metadata["_ply_raw"]["face"]["data"]
    assert np.array_equal(faces["material"].reshape(-1), walls.face_material)
    assert np.array_equal(mesh.visual.face_colors, walls.mesh.visual.face_colors)


def test_stl_names_its_solids(tmp_path) -> None:
    (path,) = export(box(), tmp_path / "box.stl")
    solids = [line for line in path.read_text().splitlines() if line.startswith("solid")]
    assert solids == [
        "solid walls_concrete_200_mm",
        "solid floor_concrete_200_mm",
        "solid ceiling_concrete_200_mm",
    ]


def scene_of(plan, tmp_path, **options):
    path, *meshes = export(plan, tmp_path / "scene.xml", options=ExportOptions(**options))
    return ET.fromstring(path.read_text()), meshes


def test_sionna_scene_has_a_mesh_and_an_itu_material_for_each_sheet(tmp_path) -> None:
    plan = floorplans.load("flat")
    scene, meshes = scene_of(plan, tmp_path)
    bsdfs = {bsdf.get("id"): bsdf for bsdf in scene.iter("bsdf")}
    assert {b.get("type") for b in bsdfs.values()} == {"itu-radio-material"}
    for shape in scene.iter("shape"):
        assert shape.find("ref").get("id") in bsdfs
        file = tmp_path / shape.find("string[@name='filename']").get("value")
        assert file in meshes
    area = sum(trimesh.load(mesh).area for mesh in meshes)
    assert area == pytest.approx(plan.to_mesh().mesh.area, rel=1e-6)
    concrete = bsdfs["mat-itu_concrete"]
    assert concrete.find("string[@name='type']").get("value") == "concrete"
    assert concrete.find("float[@name='thickness']").get("value") == "0.2"
    wood = {name for name in bsdfs if "wood" in name}
    assert wood == {"mat-itu_wood-40mm", "mat-itu_wood-50mm"}


def test_sionna_scene_holds_own_dielectrics_at_a_frequency(tmp_path) -> None:
    tile = PlanMaterial("tile", a=4.0, b=0.5, c=0.01, d=1.0)
    plan = replace(box(), walls=(*box().walls, partition("tile")), materials=(tile,))
    scene, _ = scene_of(plan, tmp_path, frequency_hz=4e9)
    bsdf = next(b for b in scene.iter("bsdf") if b.get("type") == "radio-material")
    values = {f.get("name"): float(f.get("value")) for f in bsdf.iter("float")}
    assert values == {"relative_permittivity": 8.0, "conductivity": 0.04, "thickness": 0.1}


@pytest.mark.parametrize(
    ("plan", "expected"),
    [
        (box((partition("absorber"),)), "absorber is not among the ITU materials of Sionna RT"),
        (
            replace(
                box(),
                walls=(*box().walls, partition("sandwich", 0.02)),
                materials=(PlanMaterial("sandwich", layers=(MaterialLayer("wood", 0.02),)),),
            ),
            "Sionna RT has no layered materials",
        ),
    ],
)
def test_what_sionna_cannot_represent_is_rejected_and_nothing_written(
    tmp_path, plan, expected
) -> None:
    with pytest.raises(PlanError, match=expected):
        export(plan, tmp_path / "scene.xml")
    assert list(tmp_path.iterdir()) == []
