"""Received power at points is that of a map's cells, and the sum over the listed paths."""

from __future__ import annotations

import numpy as np
import pytest

import floorplans
from raytrace import (
    Grid,
    HalfWaveDipole,
    MemoryLimitError,
    Scene,
    SceneError,
    TraceConfig,
    Transmitter,
    compute_radio_map,
    received_power,
    trace_paths,
)
from rssnav.scenes import scene_of

SOURCE = Transmitter((1.2, 7.9, 0.8), 18.0, 2.44e9)
CONFIG = TraceConfig(1, 1, 1)


@pytest.fixture(scope="module")
def flat() -> Scene:
    return scene_of(floorplans.load("flat"))


def test_points_at_cell_centres_have_the_values_of_a_map(flat: Scene) -> None:
    grid = Grid.over((0.0, 0.0, 12.0, 9.0), 1.5, 1.3)
    antenna = HalfWaveDipole(2.0, (1.0, 1.0, 0.0))
    expected = compute_radio_map(flat, SOURCE, grid, CONFIG, receive_antenna=antenna)
    for threads in (1, 2):
        found = received_power(
            flat, SOURCE, grid.points(), CONFIG, receive_antenna=antenna, threads=threads
        )
        np.testing.assert_array_equal(found, expected.rss_dbm.ravel())


def test_points_at_any_heights_sum_their_paths(flat: Scene) -> None:
    rng = np.random.default_rng(81)
    points = rng.uniform((-1.0, -1.0, -0.2), (13.0, 10.0, 2.8), (60, 3))
    paths = trace_paths(flat, SOURCE, points, CONFIG)
    gains = np.bincount(paths.receiver, np.abs(paths.gain) ** 2 * paths.weight, len(points))
    found = received_power(flat, SOURCE, points, CONFIG)
    assert (gains == 0.0).any()
    np.testing.assert_array_equal(np.isneginf(found), gains == 0.0)
    heard = gains > 0.0
    expected_dbm = SOURCE.power_dbm + 10.0 * np.log10(gains[heard])
    np.testing.assert_allclose(found[heard], expected_dbm, rtol=0.0, atol=1e-9)


def test_no_points_have_no_power(flat: Scene) -> None:
    assert received_power(flat, SOURCE, np.empty((0, 3))).shape == (0,)


def test_errors_name_what_is_wrong(flat: Scene) -> None:
    for wrong in (np.zeros((4, 2)), np.zeros(3), np.full((1, 3), np.nan)):
        with pytest.raises(ValueError, match="points of shape"):
            received_power(flat, SOURCE, wrong)
    with pytest.raises(SceneError, match="not inside the building"):
        received_power(flat, Transmitter((50.0, 0.0, 1.0)), np.zeros((1, 3)))
    with pytest.raises(MemoryLimitError, match="200 points"):
        received_power(flat, SOURCE, np.ones((200, 3)), max_memory_bytes=1000)
