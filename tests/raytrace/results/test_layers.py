"""The layers of a map against the plain statistics of single paths."""

import numpy as np
import pytest

import floorplans
from raytrace import (
    Grid,
    PathStatistics,
    Scene,
    TraceConfig,
    Transmitter,
    compute_radio_map,
    trace_paths,
)

LAYERS = (
    "rss_dbm", "rss_coherent_dbm", "path_count", "strongest_path_dbm", "mean_delay_s",
    "delay_spread_s", "angular_spread", "k_factor_db",
)  # fmt: skip


@pytest.mark.parametrize("limits", [TraceConfig(0, 0), TraceConfig(2, 1), TraceConfig(1, 1, 1)])
@pytest.mark.parametrize("name", ["scenario2", "flat"])
def test_layers_are_the_statistics_of_the_paths(name: str, limits: TraceConfig) -> None:
    plan = floorplans.load(name)
    walls = plan.to_mesh()
    scene = Scene.from_mesh(walls.mesh, walls.face_material, walls.materials)
    source = Transmitter(plan.source)
    grid = Grid.over(plan.bounds, 3.0 if name == "scenario2" else 1.0, 1.75)
    radio_map = compute_radio_map(scene, source, grid, limits)
    paths = trace_paths(scene, source, grid.points(), limits)
    expected = PathStatistics.of(paths, source.power_dbm, len(grid.points()))
    for layer in LAYERS:
        ours, theirs = getattr(radio_map, layer).ravel(), getattr(expected, layer)
        np.testing.assert_allclose(
            ours,
            theirs,
            rtol=1e-6,
            atol=1e-7 if layer == "angular_spread" else 1e-12,
            err_msg=layer,
        )
