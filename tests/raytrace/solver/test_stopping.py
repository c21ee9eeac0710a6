"""A trace ends when it is stopped, and before it takes more memory than it may."""

import threading
import time
import tracemalloc
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
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
    trace_paths,
)
from raytrace.memory import free_bytes, memory_limit

PLAN = floorplans.load("flat")
WALLS = PLAN.to_mesh()
SCENE = Scene.from_mesh(WALLS.mesh, WALLS.face_material, WALLS.materials)
SOURCE = Transmitter(PLAN.source)
GRID = Grid.over(PLAN.bounds, 1.0, 1.5)
RECEIVERS = np.array([[9.0, 6.5, 2.0]])
ENDLESS = TraceConfig(20, 1, max_transmissions=20)
SMALL = TraceConfig(2, 1)
MEMORY = 1 << 32
"""More than beams fill in the time for which the tests let them grow [bytes]."""

TRACES: dict[str, Callable[..., Any]] = {
    "map": partial(compute_radio_map, SCENE, SOURCE, GRID),
    "paths": partial(trace_paths, SCENE, SOURCE, RECEIVERS),
}


@pytest.fixture(params=TRACES)
def trace(request: pytest.FixtureRequest) -> Callable[..., Any]:
    """Trace with compiled kernels."""
    TRACES[request.param](SMALL)
    return TRACES[request.param]


@pytest.mark.parametrize("after_s", [0.0, 0.3, 1.5])
@pytest.mark.parametrize("config", [ENDLESS, TraceConfig(18, 1)])
def test_a_stopped_trace_ends_within_a_second(
    trace: Callable[..., Any], config: TraceConfig, after_s: float
) -> None:
    stops_s = time.monotonic() + after_s
    with pytest.raises(TraceStoppedError):
        trace(config, stop=lambda: time.monotonic() > stops_s, max_memory_bytes=MEMORY)
    assert time.monotonic() - stops_s < 1.0
    for thread in threading.enumerate():
        if thread.name.startswith("ThreadPoolExecutor"):
            thread.join(10.0)
            assert not thread.is_alive()


@pytest.mark.parametrize("limit_bytes", [1 << 20, 1 << 25])
def test_no_more_memory_is_taken_than_the_limit(
    trace: Callable[..., Any], limit_bytes: int
) -> None:
    tracemalloc.start()
    try:
        with pytest.raises(MemoryLimitError, match="of memory, but the limit leaves"):
            trace(ENDLESS, max_memory_bytes=limit_bytes)
        assert tracemalloc.get_traced_memory()[1] < 1.2 * limit_bytes + (8 << 20)
    finally:
        tracemalloc.stop()


def test_cells_are_counted_before_they_are_made() -> None:
    fine = Grid.over((0.0, 0.0, 12.0, 8.0), 0.001, 1.5)
    tracemalloc.start()
    try:
        with pytest.raises(MemoryLimitError, match="12000 x 8000 cells need at least"):
            compute_radio_map(SCENE, SOURCE, fine, SMALL, max_memory_bytes=MEMORY)
        assert tracemalloc.get_traced_memory()[1] < 16 << 20
    finally:
        tracemalloc.stop()


def test_limits_that_suffice_change_nothing() -> None:
    free = compute_radio_map(SCENE, SOURCE, GRID, SMALL)
    for threads in (1, 2):
        limited = compute_radio_map(
            SCENE, SOURCE, GRID, SMALL, threads=threads, stop=bool, max_memory_bytes=64 << 20
        )
        for name, layer in free.layers.items():
            np.testing.assert_array_equal(layer, limited.layers[name])


def test_half_of_the_free_memory_is_the_limit() -> None:
    assert 0 < memory_limit() <= free_bytes()
    assert memory_limit(1 << 20) == 1 << 20
    with pytest.raises(ValueError, match="max_memory_bytes = 0: expected at least 1"):
        memory_limit(0)
