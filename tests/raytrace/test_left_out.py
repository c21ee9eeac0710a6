"""What limits leave out: measured at random cells, against maps without these limits."""

from dataclasses import replace

import numpy as np
import pytest
from buildings import Building, box, door, wall

from raytrace import Grid, TraceConfig, Transmitter, compute_radio_map, sample_left_out

BUILDING = Building(
    box(9.0, 4.0).outline,
    (
        *box(9.0, 4.0).sheets,
        *wall((3.0, 0.0), (3.0, 4.0), door(1.0, 2.0)),
        *wall((6.0, 0.0), (6.0, 4.0), door(2.5, 3.5)),
    ),
)
SOURCE = Transmitter((1.3, 1.7, 1.5))
GRID = Grid.over((0.0, 0.0, 9.0, 4.0), 0.5, 1.1)
LIMITED = TraceConfig(2, 1, None, -110.0, dynamic_range_db=10.0)


def traced(config: TraceConfig):
    return compute_radio_map(BUILDING.scene, SOURCE, GRID, config)


@pytest.mark.parametrize(
    "config",
    [
        LIMITED,
        TraceConfig(2, 1, 2, -60.0),
        TraceConfig(2, 1, 2, max_paths=2000),
        TraceConfig(2, 1, None, -110.0, dynamic_range_db=10.0, max_paths=2000),
    ],
)
def test_it_is_the_difference_from_a_wider_map(config: TraceConfig) -> None:
    radio_map = traced(config)
    sample = sample_left_out(BUILDING.scene, radio_map, 20)
    wider = traced(sample.config)
    assert sample.config == replace(
        config,
        min_power_dbm=config.min_power_dbm - 15.0,
        dynamic_range_db=config.dynamic_range_db + 15.0,
        max_paths=None,
    )
    column = np.searchsorted(GRID.x, sample.points[:, 0] - 1e-9)
    row = np.searchsorted(GRID.y, sample.points[:, 1] - 1e-9)
    difference = (wider.rss_dbm - radio_map.rss_dbm)[row, column]
    np.testing.assert_allclose(sample.missing_db, difference, rtol=0, atol=1e-9)
    assert len(np.unique(sample.points, axis=0)) == 20
    assert sample.largest_db > 0.0
    assert sample.median_db >= 0.0


def test_the_share_holds_as_often_as_it_says() -> None:
    radio_map = traced(LIMITED)
    everything = sample_left_out(BUILDING.scene, radio_map, 10**6)
    assert everything.share() == 1.0
    assert len(everything.points) == everything.n_cells == radio_map.rss_dbm.size
    random, n, held = np.random.default_rng(0), 20, 0
    for _ in range(1000):
        some = random.choice(everything.missing_db, n, replace=False)
        within = np.mean(everything.missing_db <= some.max())
        held += within >= replace(everything, points=np.zeros((n, 3))).share(0.9)
    assert held >= 880


def test_a_sample_is_the_same_again_on_any_number_of_threads() -> None:
    radio_map = traced(LIMITED)
    one, other = (sample_left_out(BUILDING.scene, radio_map, 10, seed=3, threads=n) for n in (1, 3))
    np.testing.assert_array_equal(one.points, other.points)
    np.testing.assert_array_equal(one.missing_db, other.missing_db)
    assert "10 of 144 cells" in repr(one)


@pytest.mark.parametrize(
    ("config", "options", "message"),
    [
        (TraceConfig(2, 1, 1), {}, "no limit by power"),
        (LIMITED, {"above_dbm": 30.0}, "no cell of the map"),
        (LIMITED, {"cells": 0}, "cells = 0: expected at least 1"),
        (LIMITED, {"wider_db": 0.0}, "wider_db = 0.0: expected a positive"),
        (LIMITED, {"wider_db": np.nan}, "wider_db = nan: expected a positive"),
    ],
)
def test_what_cannot_be_sampled_is_refused(config, options, message) -> None:
    with pytest.raises(ValueError, match=message):
        sample_left_out(BUILDING.scene, traced(config), **options)


@pytest.mark.parametrize("confidence", [0.0, 1.0, np.nan])
def test_a_confidence_is_a_probability(confidence: float) -> None:
    with pytest.raises(ValueError, match="confidence"):
        sample_left_out(BUILDING.scene, traced(LIMITED), 5).share(confidence)
