"""The materials a plan may name are those the tracer knows, and its own reach the tracer."""

from dataclasses import replace

import cli_plans
import numpy as np
import pytest

import floorplans
from floorplans import MaterialLayer, PlanMaterial
from raytrace import SceneError, TraceConfig
from raytrace.radio.itu import TABLES
from raytrace.radio.materials import MATERIAL_NAMES, Dielectric, Layer, Layered
from rssnav.maps import make_map
from rssnav.scenes import scene_of

BOARD = PlanMaterial("board", 2.1, c=0.01, d=0.5)
STUDS = PlanMaterial(
    "studs",
    layers=(MaterialLayer("board", 0.02), MaterialLayer("air", 0.06), MaterialLayer("board", 0.02)),
)
ROOM = floorplans.loads(cli_plans.ROOM)
NO_INTERACTIONS = TraceConfig(max_reflections=0, max_diffractions=0)


def test_plans_and_tracer_name_the_same_materials() -> None:
    assert set(floorplans.MATERIALS) == set(MATERIAL_NAMES)


def test_plans_and_tracer_name_the_same_editions() -> None:
    assert set(floorplans.MATERIAL_EDITIONS) == set(TABLES)


def test_own_materials_reach_the_tracer() -> None:
    partition = replace(ROOM.walls[-1], material="studs")
    plan = replace(ROOM, walls=(*ROOM.walls[:-1], partition), materials=(BOARD, STUDS))
    (slab,) = (slab for slab in scene_of(plan).slabs if slab.material.name == "studs")
    board = Dielectric.of_law("board", 2.1, 0.0, 0.01, 0.5)
    air = Dielectric.of_law("air", 1.0)
    assert slab.material == Layered(
        "studs", (Layer(board, 0.02), Layer(air, 0.06), Layer(board, 0.02))
    )
    assert slab.thickness_m == pytest.approx(0.1)


def test_only_walls_reflect_as_the_mean_of_both_sides() -> None:
    lined = PlanMaterial("lined", layers=(MaterialLayer("board", 0.02), MaterialLayer("air", 0.08)))
    partition = replace(ROOM.walls[-1], material="lined", thickness_m=0.1)
    plan = replace(
        ROOM,
        walls=(*ROOM.walls[:-1], partition),
        materials=(BOARD, lined),
        floor_material="lined",
        floor_thickness_m=0.1,
    )
    scene = scene_of(plan)
    both = {slab.material for slab in scene.slabs if slab.material.name == "lined"}
    floor = scene.slabs[scene.floor_slab].material
    assert isinstance(floor, Layered)
    assert both == {floor, replace(floor, from_both_sides=True)}
    assert not floor.from_both_sides


def test_edition_is_the_one_asked_for_then_the_plans_then_the_newest() -> None:
    of_plan = replace(ROOM, material_edition="P.2040-3")
    assert scene_of(ROOM).material_edition == "P.2040-4"
    assert scene_of(of_plan).material_edition == "P.2040-3"
    assert scene_of(of_plan, "P.2040-1").material_edition == "P.2040-1"


def test_a_map_of_another_edition_is_made_again(tmp_path) -> None:
    file, told = tmp_path / "room.h5", []
    one = TraceConfig(max_reflections=1, max_diffractions=0)
    new = make_map(ROOM, file, config=one)
    old = make_map(ROOM, file, config=one, edition="P.2040-1", notice=told.append)
    assert told == [f"{file} was made with a different material edition; recomputing it"]
    assert old.provenance["material_edition"] == "P.2040-1"
    lit = np.isfinite(new.rss_dbm)
    assert 0.01 < np.abs(new.rss_dbm[lit] - old.rss_dbm[lit]).max() < 3.0


def test_a_frequency_outside_a_materials_range_is_refused_with_the_range() -> None:
    message = r"plan 'room': plasterboard at 500 GHz: defined only for 1 to 100 GHz, 110"
    walls = tuple(replace(wall, material="plasterboard") for wall in ROOM.walls)
    plan = replace(ROOM, walls=walls, floor_material="air", ceiling_material="air")
    with pytest.raises(SceneError, match=message):
        make_map(plan, frequency_hz=500e9, config=NO_INTERACTIONS)


def test_an_edition_without_the_material_is_refused() -> None:
    with pytest.raises(SceneError, match=r"plan 'room': ITU-R P.2040-1 has no 'plywood'"):
        scene_of(replace(ROOM, floor_material="plywood"), "P.2040-1")
