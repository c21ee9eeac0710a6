"""Paths left out by power or number, and the bound on what is missing."""

import numpy as np
import pytest
from rooms import ROOMS, SOURCE

from raytrace import Grid, RadioMap, TraceConfig, Transmitter, compute_radio_map, trace_paths

ROOM = ROOMS["door with lintel"]
GRID = Grid.over(
    tuple(np.ravel([np.min(ROOM.outline, axis=0), np.max(ROOM.outline, axis=0)])), 1.0, 1.5
)


def traced(**limits: float) -> RadioMap:
    return compute_radio_map(ROOM.scene, Transmitter(SOURCE), GRID, TraceConfig(3, 1, **limits))


@pytest.fixture(scope="module")
def whole() -> RadioMap:
    return traced()


@pytest.mark.parametrize("min_power_dbm", [-80.0, -60.0, -45.0])
def test_what_is_missing_keeps_its_bound(whole: RadioMap, min_power_dbm: float) -> None:
    part = traced(min_power_dbm=min_power_dbm)
    kept, left = 10.0 ** (part.rss_dbm / 10.0), 10.0 ** (part.left_out_db / 10.0)
    everything = 10.0 ** (whole.rss_dbm / 10.0)
    assert (kept <= everything * (1.0 + 1e-12)).all()
    assert (everything <= kept * (1.0 + left) * (1.0 + 1e-12)).all()
    assert (part.path_count < whole.path_count).any()
    source = Transmitter(SOURCE)
    paths = trace_paths(ROOM.scene, source, GRID.points(), TraceConfig(3, 1))
    strong = source.power_dbm + paths.gain_db >= min_power_dbm
    counts = np.bincount(paths.receiver[strong], minlength=part.path_count.size)
    assert (part.path_count.ravel() >= np.floor(counts)).all()


def test_nothing_is_left_out_unasked(whole: RadioMap) -> None:
    assert whole.left_out_db is not None
    assert (whole.left_out_db == -np.inf).all()


@pytest.mark.parametrize("max_paths", [1000, 5000])
def test_a_map_takes_no_more_paths_than_it_may(whole: RadioMap, max_paths: int) -> None:
    part = traced(max_paths=max_paths)
    assert 0 < part.path_count.sum() <= max_paths < whole.path_count.sum()
    everything, kept = 10.0 ** (whole.rss_dbm / 10.0), 10.0 ** (part.rss_dbm / 10.0)
    some = kept > 0.0
    left = 10.0 ** (part.left_out_db[some] / 10.0)
    assert (everything[some] <= kept[some] * (1.0 + left) * (1.0 + 1e-12)).all()


def test_a_high_limit_changes_nothing(whole: RadioMap) -> None:
    part = traced(max_paths=10**12)
    np.testing.assert_array_equal(part.rss_dbm, whole.rss_dbm)
    np.testing.assert_array_equal(part.rss_coherent_dbm, whole.rss_coherent_dbm)


@pytest.mark.parametrize(
    ("limits", "message"),
    [({"max_paths": 0}, "max_paths = 0: expected"), ({"min_power_dbm": np.nan}, "= nan: expected")],
)
def test_limits_are_checked(limits: dict[str, float], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        TraceConfig(**limits)
