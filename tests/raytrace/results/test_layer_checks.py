"""Maps whose layers contradict each other are refused; those that the tracer makes never do."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import small_plans

import floorplans
from raytrace import Grid, MapFileError, RadioMap, Scene, TraceConfig, Transmitter
from raytrace import compute_radio_map as traced
from raytrace.results.layers import LAYERS

POWER_DBM = 10.0
BESIDE = (0.0, 0.0, 6.0, 6.0)
"""Bounds of cells of which some are outside the 4 m deep room."""


@pytest.fixture(scope="module")
def whole() -> RadioMap:
    return traced(scene(), Transmitter((1.0, 1.0, 1.5), POWER_DBM), grid(), TraceConfig(1, 1))


def scene() -> Scene:
    walls = small_plans.box().to_mesh()
    return Scene.from_mesh(walls.mesh, walls.face_material, walls.materials)


def grid() -> Grid:
    return Grid.over(BESIDE, 1.0, 2.0)


def reloaded(radio_map: RadioMap, folder: Path) -> RadioMap:
    radio_map.save(folder / "map.h5")
    return RadioMap.load(folder / "map.h5")


HERE, OUTSIDE = (2, 3), (5, 3)

CONTRADICTIONS = {
    "no path, yet paths": ("path_count", OUTSIDE, 1),
    "no path, yet a field": ("rss_coherent_dbm", OUTSIDE, -50.0),
    "no path, yet a strongest one": ("strongest_path_dbm", OUTSIDE, -50.0),
    "no path, yet a delay": ("mean_delay_s", OUTSIDE, 1e-9),
    "no path, yet a spread of delays": ("delay_spread_s", OUTSIDE, 1e-9),
    "no path, yet a spread of angles": ("angular_spread", OUTSIDE, 0.5),
    "no path, yet a K factor": ("k_factor_db", OUTSIDE, 0.0),
    "power without a path": ("path_count", HERE, 0),
    "power without a strongest path": ("strongest_path_dbm", HERE, -np.inf),
    "power without a share of it": ("k_factor_db", HERE, -np.inf),
    "faster than light": ("mean_delay_s", HERE, 1e-9),
    "more than is transmitted": ("rss_dbm", HERE, POWER_DBM + 0.1),
    "a field of more than is transmitted": ("rss_coherent_dbm", HERE, POWER_DBM + 0.1),
    "a path of more than is transmitted": ("strongest_path_dbm", HERE, POWER_DBM + 0.1),
    "a field of more than all paths in phase": ("rss_coherent_dbm", HERE, 0.0),
    "a strongest path below the mean": ("strongest_path_dbm", HERE, -120.0),
    "a K factor of other powers": ("k_factor_db", HERE, 30.0),
}  # fmt: skip


@pytest.mark.parametrize("name", CONTRADICTIONS)
def test_a_contradiction_is_refused_and_named(name, whole, tmp_path) -> None:
    layer, cell, value = CONTRADICTIONS[name]
    changed = whole.layers[layer].copy()
    changed[cell] = value
    with pytest.raises(MapFileError, match="dataset '"):
        reloaded(replace(whole, **{layer: changed}), tmp_path)


@pytest.mark.parametrize("layer", LAYERS)
def test_no_layer_may_have_a_path_where_the_rss_has_none(layer, whole, tmp_path) -> None:
    rss = whole.rss_dbm.copy()
    rss[HERE] = -np.inf
    others = {n: a.copy() for n, a in whole.layers.items() if n not in ("rss_dbm", layer)}
    for name, array in others.items():
        if (value := LAYERS[name].without_path) is not None:
            array[HERE] = value
    changed = replace(whole, rss_dbm=rss, **others)
    if layer in ("rss_dbm", "left_out_db"):
        reloaded(changed, tmp_path)
        return
    with pytest.raises(MapFileError, match=layer):
        reloaded(changed, tmp_path)


def test_a_map_in_the_null_of_an_antenna_is_read_again(tmp_path) -> None:
    over = Grid.over((0.5, 0.5, 2.5, 1.5), 1.0, 2.0)
    made = traced(scene(), Transmitter((1.0, 1.0, 1.5)), over, TraceConfig(0, 0))
    assert made.path_count.tolist() == [[0, 1]]
    again = reloaded(made, tmp_path)
    for name, layer in made.layers.items():
        np.testing.assert_array_equal(layer, again.layers[name])


@pytest.mark.parametrize("source", [(1.0, 1.0, 1.5), (2.0, 2.0, 1.0), (1.5, 1.5, 1.9)])
@pytest.mark.parametrize("config", [TraceConfig(0, 0), TraceConfig(3, 1, 1), TraceConfig(2, 1, 0)])
@pytest.mark.filterwarnings("ignore::raytrace.SceneWarning")
def test_maps_of_the_tracer_contradict_nothing(source, config, tmp_path) -> None:
    walls = floorplans.loads(small_plans.ROOM).to_mesh()
    made = Scene.from_mesh(walls.mesh, walls.face_material, walls.materials)
    for height_m in (source[2], 2.0):  # also grazing, and beside the transmitter
        cells = Grid.over((0.0, 0.0, 6.0, 4.0), 0.5, height_m)
        limited = replace(config, min_power_dbm=-90.0)
        for limits in (config, limited):
            reloaded(traced(made, Transmitter(source), cells, limits), tmp_path)
