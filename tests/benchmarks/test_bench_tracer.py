"""Speed of the tracer on the two scenarios.

    pytest tests/benchmarks/test_bench_tracer.py --benchmark-enable

times whole maps on one thread and on two, and reflections alone; extra_info holds the paths and
the nanoseconds a path. Without --benchmark-enable nothing is traced.
"""

import pytest
from pytest_benchmark.fixture import BenchmarkFixture

import floorplans
from raytrace import Grid, RadioMap, Scene, TraceConfig, Transmitter, compute_radio_map

ROUNDS = 3

scenarios = pytest.mark.parametrize("name", ["scenario1", "scenario2"])


def timed(benchmark: BenchmarkFixture, name: str, limits: TraceConfig, threads: int) -> RadioMap:
    if benchmark.disabled:
        pytest.skip("runs with --benchmark-enable")
    plan = floorplans.load(name)
    walls = plan.to_mesh()
    scene = Scene.from_mesh(walls.mesh, walls.face_material, walls.materials)
    grid = Grid.over(plan.bounds, 1.0, 2.0)
    radio_map = benchmark.pedantic(
        compute_radio_map,
        args=(scene, Transmitter(plan.source), grid, limits),
        kwargs={"threads": threads},
        rounds=ROUNDS,
        warmup_rounds=1,
    )
    paths = int(radio_map.path_count.sum())
    benchmark.extra_info["paths"] = paths
    benchmark.extra_info["ns a path"] = 1e9 * benchmark.stats.stats.min / paths
    return radio_map


@scenarios
@pytest.mark.parametrize("threads", [1, 2])
def test_bench_whole_map(benchmark: BenchmarkFixture, name: str, threads: int) -> None:
    radio_map = timed(benchmark, name, TraceConfig(6, 1), threads)
    assert (radio_map.path_count > 0).all()


@scenarios
def test_bench_reflections_alone(benchmark: BenchmarkFixture, name: str) -> None:
    radio_map = timed(benchmark, name, TraceConfig(6, 0), threads=1)
    assert radio_map.path_count.max() > 100
