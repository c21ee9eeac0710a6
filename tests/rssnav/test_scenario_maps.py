"""The scenarios' maps are such as the paper's must have been."""

from collections.abc import Callable

import numpy as np
import pytest

import floorplans
from raytrace import RadioMap
from rssnav import GridWorld, QLearning, RssAgent

scenarios = pytest.mark.parametrize("name", ["scenario1", "scenario2"])


@scenarios
def test_every_cell_has_a_path(scenario_map: Callable[[str], RadioMap], name: str) -> None:
    radio_map = scenario_map(name)
    assert (radio_map.path_count > 0).all()
    assert np.isfinite(radio_map.rss_dbm).all()
    assert np.isfinite(radio_map.rss_coherent_dbm).all()


@scenarios
def test_no_two_cells_read_the_same(scenario_map: Callable[[str], RadioMap], name: str) -> None:
    rss_dbm = scenario_map(name).rss_dbm
    assert len(np.unique(rss_dbm)) == rss_dbm.size


@scenarios
def test_more_than_minus_21_dbm_are_read_in_the_12_cells_nearer_than_2_m(
    scenario_map: Callable[[str], RadioMap], name: str
) -> None:
    radio_map = scenario_map(name)
    x, y, _ = floorplans.load(name).source
    xx, yy = np.meshgrid(radio_map.grid.x, radio_map.grid.y)
    near = np.hypot(xx - x, yy - y) < 2.0
    np.testing.assert_array_equal(radio_map.rss_dbm > -21.0, near)
    assert near.sum() == 12


@scenarios
def test_no_cell_reads_more_than_was_sent(
    scenario_map: Callable[[str], RadioMap], name: str
) -> None:
    assert scenario_map(name).rss_dbm.max() < 25.0 - 40.0 + 10.0


@scenarios
@pytest.mark.parametrize("speed", [1, 2, 3])
def test_the_paper_s_agent_hears_every_cell_and_knows_each_by_its_reading(
    scenario_map: Callable[[str], RadioMap], name: str, speed: int
) -> None:
    world = GridWorld.from_map(floorplans.load(name), scenario_map(name), speed)
    assert RssAgent().sensitivity_dbm < scenario_map(name).rss_dbm.min()
    assert RssAgent().decision_process(world, QLearning()).readings is None
