"""Paths that leave a building through its outside walls and come back: the ground around it."""

from dataclasses import replace

import numpy as np
import pytest
from brute_force import DIFFRACTION, Found, find_paths
from brute_force_field import Radio, path_gains
from buildings import GLASS, HEIGHT_M, PLASTERBOARD, Building, door, ring, wall, window
from comparing import as_found, assert_same_paths, facets_of, off_ties
from hypothesis import given, settings
from hypothesis import strategies as st

from raytrace import Isotropic, SceneError, TraceConfig, Transmitter, trace_paths

U_SHAPE = (
    (0.0, 0.0), (3.0, 0.0), (3.0, 4.0), (7.0, 4.0),
    (7.0, 0.0), (10.0, 0.0), (10.0, 7.0), (0.0, 7.0),
)  # fmt: skip
LEFT, RIGHT = (1.234, 1.345, 1.4), (8.345, 1.678)


def wings(ground_margin_m: float | None) -> Building:
    """Return two wings with windows across a yard, and a wall within the part between them."""
    sides = list(zip(U_SHAPE, (*U_SHAPE[1:], U_SHAPE[0]), strict=True))
    glazed = {1: window(1.0, 2.5, GLASS), 3: window(1.5, 3.2, GLASS)}
    walls = [
        sheet
        for k, side in enumerate(sides)
        for sheet in wall(*side, *([glazed[k]] if k in glazed else []))
    ]
    inside = wall((5.0, 4.0), (5.0, 7.0), door(1.0, 2.0))
    return Building(U_SHAPE, (*walls, *inside), ground_margin_m=ground_margin_m)


def under_the_sky(found: Found) -> Found:
    """Leave out paths that are diffracted at the edge of the roof or of the ground."""
    z = found.vertices[:, 1:-1, 2]
    beyond = (found.kinds == DIFFRACTION) & ((z < 1e-6) | (z > HEIGHT_M - 1e-6))
    kept = ~beyond.any(axis=1)
    return Found(found.receiver[kept], found.kinds[kept], found.vertices[kept])


def check(building: Building, seed: int, limits: tuple[int, int, int]) -> int:
    """Require the brute force's paths and fields; return how many paths there are."""
    receivers = building.random_points(4, seed)
    transmitter = Transmitter(off_ties(LEFT), antenna=Isotropic())
    config, isotropic = TraceConfig(*limits), Isotropic()
    paths = trace_paths(building.scene, transmitter, receivers, config, receive_antenna=isotropic)
    facets = facets_of(building)
    found = find_paths(facets, np.array(transmitter.position), receivers, *limits)
    assert_same_paths(as_found(paths), under_the_sky(found), 1e-9)
    radio = Radio(building.slabs, transmitter, isotropic, config.max_transmissions)
    expected = path_gains(facets, as_found(paths), radio)
    allowed = 1e-3 * np.abs(expected) + 1e-6 * np.abs(expected).max()
    assert (np.abs(paths.gain - expected) <= allowed).all()
    return len(paths)


@pytest.mark.parametrize("limits", [(2, 0, 3), (1, 1, 2), (0, 1, 3)])
@given(seed=st.integers(0, 2**32 - 1))
@settings(max_examples=3, derandomize=True)
def test_every_path_through_a_yard_is_found(limits: tuple[int, int, int], seed: int) -> None:
    outside, inside = (check(wings(margin), seed, limits) for margin in (6.0, None))
    assert outside > inside


def test_limits_by_loss_find_every_strong_path_across_a_yard() -> None:
    building, source = wings(6.0), Transmitter(off_ties(LEFT), 0.0)
    receivers = building.random_points(20, 3)
    whole, part = (
        trace_paths(building.scene, source, receivers, config)
        for config in (TraceConfig(2, 1, 6), TraceConfig(2, 1, None, -85.0))
    )
    powers = [np.sort(np.abs(paths.gain) ** 2 * paths.weight)[::-1] for paths in (whole, part)]
    strong = np.count_nonzero(powers[0] > 10.0**-8.5)
    assert 100 < strong <= len(part) < len(whole)
    np.testing.assert_allclose(powers[1][:strong], powers[0][:strong], rtol=1e-9)


def test_the_sky_reflects_nothing() -> None:
    """The yard alone brings the straight line and the ground's reflection; a ceiling none."""
    building = wings(6.0)
    receiver = np.array([[*RIGHT, 1.2]])
    paths = trace_paths(building.scene, Transmitter(LEFT), receiver, TraceConfig(1, 0, 2))
    reflected = paths.interactions == 1
    z = paths.vertices[:, 1:-1, 2][reflected]
    x = paths.vertices[:, 1:-1, 0][reflected]
    over_the_yard = (x > 3.0) & (x < 7.0)
    assert not (z[over_the_yard] > HEIGHT_M - 1e-6).any()
    assert (z[over_the_yard] < 1e-6).any()


def test_without_ground_no_path_leaves() -> None:
    paths = trace_paths(
        wings(None).scene, Transmitter(LEFT), np.array([[*RIGHT, 1.2]]), TraceConfig(2, 1, 5)
    )
    points = paths.vertices[paths.n_interactions[:, None] + 1 >= np.arange(paths.vertices.shape[1])]
    yard = (points[:, 0] > 3.001) & (points[:, 0] < 6.999) & (points[:, 1] < 3.999)
    assert not yard.any()


def test_a_transmitter_and_receivers_may_stand_on_the_ground() -> None:
    building = replace(wings(6.0), sheets=(*ring(U_SHAPE, slab=PLASTERBOARD),))
    source = off_ties((5.1, 1.3, 1.7))
    receivers = np.array([[4.2, 2.4, 1.1], [1.3, 1.1, 1.2], [12.3, 5.1, 2.0]])
    limits = 2, 0, 2
    paths = trace_paths(building.scene, Transmitter(source), receivers, TraceConfig(*limits))
    found = find_paths(facets_of(building), np.array(source), receivers, *limits)
    assert_same_paths(as_found(paths), found, 1e-9)
    assert set(paths.receiver.tolist()) == {0, 1, 2}


@pytest.mark.parametrize("margin", [0.0, -1.0, float("nan"), float("inf")])
def test_the_margin_is_checked(margin: float) -> None:
    with pytest.raises(SceneError, match=r"ground_margin_m = .*: expected more than 0"):
        _ = wings(margin).scene
