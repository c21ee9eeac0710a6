"""The cost of a map is estimated within a factor of two."""

import time
from functools import cache

import pytest

import floorplans
from raytrace import (
    Grid,
    MemoryLimitError,
    Scene,
    TraceConfig,
    TraceStoppedError,
    Transmitter,
    compute_radio_map,
    estimate_cost,
)
from raytrace.kernels.sums import Sums
from raytrace.solver import cost_estimate

MAPS = [
    ("flat", 6, 1, 1.0),
    ("flat", 5, 1, 0.35),
    ("scenario1", 4, 1, 1.0),
    ("scenario2", 3, 1, 1.0),
    ("scenario2", 4, 0, 1.0),
    ("office", 4, 1, 1.0),
    ("office", 2, 1, 0.5),
]


@cache
def scene_of(name: str) -> tuple[Scene, Transmitter, tuple[float, float, float, float]]:
    plan = floorplans.generate_office(8, 6) if name == "office" else floorplans.load(name)
    walls = plan.to_mesh()
    scene = Scene.from_mesh(walls.mesh, walls.face_material, walls.materials)
    return scene, Transmitter(plan.source), plan.bounds


@pytest.mark.parametrize(("name", "reflections", "diffractions", "cell_size_m"), MAPS)
def test_paths_are_estimated_within_a_factor_of_two(
    name: str, reflections: int, diffractions: int, cell_size_m: float
) -> None:
    scene, source, bounds = scene_of(name)
    grid, config = Grid.over(bounds, cell_size_m, 1.5), TraceConfig(reflections, diffractions)
    cost = estimate_cost(scene, source, grid, config)
    paths = int(compute_radio_map(scene, source, grid, config).path_count.sum())
    assert 0.5 * paths <= cost.paths <= 2.0 * paths
    assert cost.seconds > 0.0
    assert cost.memory_bytes > 0


def test_the_estimated_paths_do_not_depend_on_the_clock() -> None:
    scene, source, bounds = scene_of("scenario1")
    grid = Grid.over(bounds, 1.0, 1.5)
    one, two = (estimate_cost(scene, source, grid, TraceConfig(3, 1)).paths for _ in range(2))
    assert one == two


def test_a_single_cell_is_counted_exactly() -> None:
    scene, source, bounds = scene_of("flat")
    grid = Grid.over((bounds[0], bounds[1], bounds[0] + 2.0, bounds[1] + 2.0), 2.0, 1.5)
    config = TraceConfig(4, 1)
    paths = int(compute_radio_map(scene, source, grid, config).path_count.sum())
    assert estimate_cost(scene, source, grid, config).paths == paths


def test_an_estimate_of_a_large_building_is_bounded() -> None:
    plan = floorplans.generate_office(15, 10)
    walls = plan.to_mesh()
    scene = Scene.from_mesh(walls.mesh, walls.face_material, walls.materials)
    grid = Grid.over(plan.bounds, 1.0, 1.5)
    began_s = time.process_time()
    cost = estimate_cost(scene, Transmitter(plan.source), grid, TraceConfig(20, 1))
    assert time.process_time() - began_s < 2.0
    assert cost.is_extrapolated


def test_an_estimate_can_be_stopped() -> None:
    scene, source, bounds = scene_of("scenario1")
    with pytest.raises(TraceStoppedError):
        estimate_cost(scene, source, Grid.over(bounds, 1.0, 1.5), stop=lambda: True)


def test_an_estimate_keeps_to_its_memory() -> None:
    scene, source, bounds = scene_of("scenario1")
    grid, config = Grid.over(bounds, 1.0, 1.5), TraceConfig(4, 1)
    assert estimate_cost(scene, source, grid, config, max_memory_bytes=300_000).is_extrapolated
    with pytest.raises(MemoryLimitError):
        estimate_cost(scene, source, grid, config, max_memory_bytes=1)


def test_compiling_does_not_count(monkeypatch: pytest.MonkeyPatch) -> None:
    scene, source, bounds = scene_of("flat")
    grid, config, add_sums = Grid.over(bounds, 1.0, 1.5), TraceConfig(2, 1), cost_estimate.add_sums
    known = estimate_cost(scene, source, grid, config).seconds
    calls = list[None]()

    def slow_at_first(*sums: Sums) -> None:
        if not calls:
            time.sleep(1.0)
        calls.append(None)
        add_sums(*sums)

    monkeypatch.setattr(cost_estimate, "add_sums", slow_at_first)
    assert estimate_cost(scene, source, grid, config).seconds < known + 0.5
