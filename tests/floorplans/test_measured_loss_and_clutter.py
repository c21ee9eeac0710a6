"""Materials of a measured loss, and clutter: in files, checks and meshes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from cli_plans import ROOM

import floorplans
from floorplans import PlanError, PlanMaterial, Wall
from floorplans.geojson_plan import plan_from_geojson, plan_to_geojson

ROOM_PLAN = floorplans.loads(ROOM)
SHELF = PlanMaterial("shelf", 2.0, loss_db=6.0, loss_frequency_hz=2.4e9)
CLUTTER = Wall((4.0, 1.0), (5.0, 1.0), "shelf", 0.4, 2.0, kind="clutter")
PLAN = replace(ROOM_PLAN, materials=(SHELF,), walls=(*ROOM_PLAN.walls, CLUTTER))


def test_both_come_back_from_toml_and_geojson() -> None:
    assert floorplans.loads(floorplans.dumps(PLAN)) == PLAN
    assert plan_from_geojson(plan_to_geojson(PLAN)) == PLAN


def test_clutter_of_the_material_of_a_wall_is_apart_in_the_mesh() -> None:
    twin = replace(CLUTTER, start=(4.0, 3.0), end=(5.0, 3.0), kind="wall")
    mesh = replace(PLAN, walls=(*PLAN.walls, twin)).to_mesh()
    shelves = [k for k, material in enumerate(mesh.materials) if material.name == "shelf"]
    assert sorted(mesh.clutter[shelves]) == [False, True]
    assert mesh.clutter.sum() == 1
    height = mesh.mesh.triangles_center[mesh.clutter[mesh.face_material], 1]
    np.testing.assert_allclose(height, 1.0)


def test_clutter_does_not_close_the_outline() -> None:
    walls = tuple(replace(wall, kind="clutter") for wall in ROOM_PLAN.walls[:1])
    with pytest.raises(PlanError, match="outline is open"):
        replace(ROOM_PLAN, walls=(*walls, *ROOM_PLAN.walls[1:]))


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"loss_frequency_hz": None}, "shelf.loss_frequency_hz: the key is missing; loss_db needs"),
        ({"loss_db": None}, "shelf.loss_db: the key is missing; loss_frequency_hz needs it"),
        ({"loss_db": -1.0}, "shelf.loss_db = -1.0: expected a finite number from 0 to 100"),
        ({"loss_frequency_hz": 2.4}, "shelf.loss_frequency_hz = 2.4"),
        ({"c": 0.1}, "takes the place of conductivity"),
        ({"loss_db": "6"}, 'loss_db = "6": expected a finite number'),
    ],
)
def test_a_wrong_loss_is_named(wrong: dict[str, object], message: str) -> None:
    with pytest.raises(PlanError) as caught:
        replace(PLAN, materials=(replace(SHELF, **wrong),))
    assert message in str(caught.value)


def test_texts_that_contradict_themselves_are_refused() -> None:
    text = floorplans.dumps(PLAN)
    for old, new, message in (
        ("loss_db = 6\n", "loss_db = 6\nconductivity = 1\n", "loss_db takes its place"),
        ("relative_permittivity = 2\n", "", "expected one of"),
        ("loss_frequency_hz = 2400000000\n", "", "loss_frequency_hz: the key is missing"),
        ('kind = "clutter"', 'kind = "cluter"', 'did you mean "clutter"'),
    ):
        assert text.count(old) == 1
        with pytest.raises(PlanError) as caught:
            floorplans.loads(text.replace(old, new))
        assert message in str(caught.value)
