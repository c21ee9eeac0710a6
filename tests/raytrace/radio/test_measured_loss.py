"""A slab that is told its loss has it; clutter has no diffracting edges."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from cli_plans import ROOM

import floorplans
from floorplans import PlanMaterial, Wall
from raytrace import Dielectric, SceneError, TraceConfig, Transmitter, trace_paths
from rssnav.scenes import scene_of


@pytest.mark.parametrize("permittivity", [1.0, 2.0, 5.3])
@pytest.mark.parametrize("loss_db", [3.0, 12.0, 60.0])
@pytest.mark.parametrize("thickness_m", [0.02, 0.11, 0.4])
def test_the_slab_loses_what_it_is_told(permittivity, loss_db, thickness_m) -> None:
    wall = Dielectric.of_loss("wall", permittivity, loss_db, 2.4e9, thickness_m)
    at_normal = wall.coefficients(thickness_m, 2.4e9, np.ones(1))
    for transmission in (at_normal.t_te, at_normal.t_tm):
        found_db = -20.0 * np.log10(np.abs(transmission[0]))
        assert found_db == pytest.approx(loss_db, abs=1e-6)
    assert wall.complex_permittivity(1e9).real == permittivity


def test_less_than_reflection_alone_loses_is_refused_with_the_least() -> None:
    with pytest.raises(SceneError, match=r"loss_db = 0.1, but reflection alone loses \d\.\d\d dB"):
        Dielectric.of_loss("wall", 5.3, 0.1, 2.4e9, 0.1)


SHELF = PlanMaterial("shelf", 1.0, loss_db=7.0, loss_frequency_hz=2.4e9)
CLUTTER = Wall((1.5, 2.0), (5.5, 2.0), "shelf", 0.4, 3.0, kind="clutter")


def test_a_path_through_clutter_loses_that_much_and_no_edge_of_it_diffracts() -> None:
    shell = floorplans.loads(ROOM)
    empty = replace(shell, walls=shell.walls[:4], materials=(SHELF,))
    full = replace(empty, walls=(*empty.walls, CLUTTER))
    low = replace(empty, walls=(*empty.walls, replace(CLUTTER, height_m=1.0)))
    wall = replace(empty, walls=(*empty.walls, replace(CLUTTER, kind="wall")))
    counts = [
        (len(scene.vertical_edges), len(scene.horizontal_edges))
        for scene in map(scene_of, (empty, full, low, wall))
    ]
    assert counts[0] == counts[1] == counts[2]
    assert counts[3][0] == counts[0][0] + 2
    ends = Transmitter((3.0, 1.0, 1.5)), np.array([[3.0, 3.0, 1.5]])
    direct, through = (
        trace_paths(scene_of(plan), *ends, TraceConfig(0, 0, 1)).gain[0] for plan in (empty, full)
    )
    assert 20.0 * np.log10(abs(direct / through)) == pytest.approx(7.0, abs=1e-3)
