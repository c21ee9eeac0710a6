"""Limits by a dynamic range: shared between threads without a trace of how many there are."""

import numpy as np
import pytest
from buildings import Building, box, door, wall

from raytrace import Grid, TraceConfig, Transmitter, compute_radio_map
from raytrace.kernels.beams import CELL
from raytrace.kernels.guard import no_guard
from raytrace.results.layers import LAYERS
from raytrace.solver.dynamic_range import beam_parts, prepare_within_range
from raytrace.solver.evaluation import evaluation_of

BUILDING = Building(
    box(12.0, 4.0).outline,
    (
        *box(12.0, 4.0).sheets,
        *(sheet for x in (3.0, 6.0, 9.0) for sheet in wall((x, 0.0), (x, 4.0), door(1.0, 2.0))),
    ),
)
SOURCE = Transmitter((1.3, 1.7, 1.5))
CONFIG = TraceConfig(2, 1, None, -110.0, dynamic_range_db=20.0)
ON_WALLS = Grid.over((0.0, 0.0, 12.0, 4.0), 1.0, 1.5).points() + np.array([0.5, 0.0, 0.0])
OFF_WALLS = Grid.over((0.0, 0.0, 12.0, 4.0), 0.7, 1.5).points()


@pytest.mark.parametrize(("points", "at_least"), [(OFF_WALLS, 2), (ON_WALLS, 1)])
def test_parts_share_no_receiver(points: np.ndarray, at_least: int) -> None:
    evaluation = evaluation_of(BUILDING.scene.slabs, SOURCE, CONFIG)
    tracing, _ = prepare_within_range(
        BUILDING.scene, SOURCE.position, points, CONFIG, no_guard(), [evaluation]
    )
    targets, cells = tracing.targets, tracing.tree.link[:, CELL]
    parts = beam_parts(tracing, 3)
    assert at_least <= len(parts) <= 3
    np.testing.assert_array_equal(np.sort(np.concatenate(parts)), np.arange(len(cells)))
    receivers = [
        {int(r) for c in np.unique(cells[part])
         for r in targets.number[targets.cell_points[c]:targets.cell_points[c + 1]]}
        for part in parts
    ]  # fmt: skip
    assert sum(map(len, receivers)) == len(set.union(*receivers))


@pytest.mark.parametrize("cell_m", [1.0, 0.7])
@pytest.mark.parametrize("threads", [2, 3, 5])
def test_maps_do_not_depend_on_threads(threads: int, cell_m: float) -> None:
    grid = Grid.over((0.0, 0.0, 12.0, 4.0), cell_m, 1.5)
    one, other = (
        compute_radio_map(BUILDING.scene, SOURCE, grid, CONFIG, threads=n) for n in (1, threads)
    )
    for layer in LAYERS:
        np.testing.assert_array_equal(getattr(one, layer), getattr(other, layer))
