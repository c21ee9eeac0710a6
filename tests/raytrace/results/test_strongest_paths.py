"""The strongest paths alone are the first ones of all paths."""

import numpy as np
import pytest

import floorplans
from raytrace import MemoryLimitError, Scene, TraceConfig, Transmitter, trace_paths
from rssnav import scene_of

TRANSMITTER = Transmitter((1.2, 7.9, 0.8))
CONFIG = TraceConfig(3, 1, 1)
POINTS = np.array([[3.1, 6.3, 1.4], [9.7, 2.2, 1.1], [-5.0, 0.0, 1.0], [6.5, 4.5, 2.0]])


@pytest.fixture(scope="module")
def flat() -> Scene:
    return scene_of(floorplans.load("flat"))


@pytest.mark.parametrize("count", [1, 7, 10_000_000])
def test_they_are_the_first_of_all_paths(flat: Scene, count: int) -> None:
    everything = trace_paths(flat, TRANSMITTER, POINTS, CONFIG)
    found = trace_paths(flat, TRANSMITTER, POINTS, CONFIG, strongest=count)
    for receiver in range(len(POINTS)):
        expected, own = everything.at(receiver), found.at(receiver)
        assert len(own) == min(count, len(expected))
        np.testing.assert_allclose(np.abs(own.gain), np.abs(expected.gain[:count]), rtol=1e-12)
        np.testing.assert_allclose(own.weight, expected.weight[:count])


def test_halves_of_grazing_paths_count_once() -> None:
    """Behind a pillar's corner two beams find half of each grazing path."""
    scene = scene_of(floorplans.load("scenario1"))
    source = Transmitter((5.0, 14.0, 1.5))
    points = np.array([[5.0, 8.0, 2.0], [15.0, 14.5, 2.0]])
    everything = trace_paths(scene, source, points, TraceConfig(2, 1))
    found = trace_paths(scene, source, points, TraceConfig(2, 1), strongest=12)
    for receiver in range(len(points)):
        expected, own = everything.at(receiver), found.at(receiver)
        np.testing.assert_allclose(np.abs(own.gain), np.abs(expected.gain[:12]), rtol=1e-12)
        np.testing.assert_allclose(own.weight, expected.weight[:12])


def test_memory_is_that_of_the_paths_returned(flat: Scene) -> None:
    limit, config = 15_000_000, TraceConfig(4, 1, 1)
    points = np.repeat(POINTS, 20, axis=0)
    with pytest.raises(MemoryLimitError):
        trace_paths(flat, TRANSMITTER, points, config, max_memory_bytes=limit)
    found = trace_paths(flat, TRANSMITTER, points, config, strongest=20, max_memory_bytes=limit)
    assert len(found) == 20 * 60


def test_no_paths_at_all_are_no_choice(flat: Scene) -> None:
    with pytest.raises(ValueError, match="strongest = 0: expected at least 1"):
        trace_paths(flat, TRANSMITTER, POINTS, CONFIG, strongest=0)
