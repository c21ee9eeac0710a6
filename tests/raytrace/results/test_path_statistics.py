"""What paths amount to, against definitions worked out by hand; tables and channels of paths."""

import numpy as np
import pytest
from buildings import box, door, wall
from hypothesis import given
from hypothesis import strategies as st

import floorplans
from raytrace import (
    Grid,
    HalfWaveDipole,
    Isotropic,
    Paths,
    PathStatistics,
    TraceConfig,
    Transmitter,
    compute_radio_map,
    trace_paths,
)
from raytrace.constants import SPEED_OF_LIGHT
from rssnav import scene_of

POWER_DBM = 20.0


def straight_paths(
    receiver: list[int], length_m: list[float], azimuth: list[float], gain: list[complex]
) -> Paths:
    """Paths without interaction that end at (0, 0, 1) and come from an azimuth [rad]."""
    r, phi = np.array(length_m, dtype=np.float64), np.array(azimuth, dtype=np.float64)
    begin = np.column_stack([r * np.cos(phi), r * np.sin(phi), np.ones(len(r))])
    vertices = np.zeros((len(r), 4, 3))
    vertices[:, 0], vertices[:, 1:, 2] = begin, 1.0
    kinds = np.zeros((len(r), 2), np.int8)
    gains = np.array(gain, np.complex128)
    return Paths(np.array(receiver, np.int64), kinds, vertices, r, gains, np.ones(len(r)))


def statistics(paths: Paths, n_receivers: int = 1) -> PathStatistics:
    return PathStatistics.of(paths, POWER_DBM, n_receivers)


def test_a_single_path_has_no_spread() -> None:
    s = statistics(straight_paths([0], [30.0], [1.0], [1e-3j]))
    assert s.rss_dbm[0] == s.rss_coherent_dbm[0] == s.strongest_path_dbm[0] == pytest.approx(-40.0)
    assert s.mean_delay_s[0] == pytest.approx(30.0 / SPEED_OF_LIGHT)
    assert s.delay_spread_s[0] == 0.0
    assert s.angular_spread[0] == pytest.approx(0.0, abs=1e-6)
    assert s.k_factor_db[0] == np.inf
    assert s.path_count[0] == 1


def test_two_equal_paths_spread_by_half_their_distance() -> None:
    s = statistics(straight_paths([0, 0], [30.0, 60.0], [0.0, np.pi], [1e-3, -1e-3]))
    assert s.rss_dbm[0] == pytest.approx(POWER_DBM - 60.0 + 10.0 * np.log10(2.0))
    assert s.rss_coherent_dbm[0] == -np.inf
    assert s.mean_delay_s[0] == pytest.approx(45.0 / SPEED_OF_LIGHT)
    assert s.delay_spread_s[0] == pytest.approx(15.0 / SPEED_OF_LIGHT)
    assert s.angular_spread[0] == pytest.approx(1.0)
    assert s.k_factor_db[0] == pytest.approx(0.0)


def test_weights_are_powers() -> None:
    """Powers 3 to 1, a right angle apart: sqrt(1 - (3/4)^2 - (1/4)^2)."""
    gain = [np.sqrt(3.0) * 1e-3, 1e-3j]
    s = statistics(straight_paths([0, 0], [10.0, 50.0], [0.0, 0.5 * np.pi], gain))
    assert s.mean_delay_s[0] == pytest.approx(20.0 / SPEED_OF_LIGHT)
    assert s.delay_spread_s[0] == pytest.approx(np.sqrt(300.0) / SPEED_OF_LIGHT)
    assert s.angular_spread[0] == pytest.approx(np.sqrt(6.0) / 4.0)
    assert s.k_factor_db[0] == pytest.approx(10.0 * np.log10(3.0))


def test_a_receiver_without_a_path_is_dark_and_never_nan() -> None:
    s = statistics(straight_paths([1, 1], [10.0, 20.0], [0.0, 1.0], [1e-3, 0.0]), 3)
    for levels in (s.rss_dbm, s.rss_coherent_dbm, s.strongest_path_dbm, s.k_factor_db):
        assert levels[0] == levels[2] == -np.inf
    for values in (s.mean_delay_s, s.delay_spread_s, s.angular_spread):
        assert values[0] == values[2] == 0.0
        assert np.isfinite(values).all()
    assert s.path_count.tolist() == [0, 2, 0]


def test_no_path_at_all() -> None:
    s = statistics(straight_paths([], [], [], []), 2)
    assert s.rss_dbm.tolist() == [-np.inf, -np.inf]
    assert s.path_count.tolist() == [0, 0]


complexes = st.builds(complex, st.floats(-1.0, 1.0), st.floats(-1.0, 1.0)).filter(
    lambda g: abs(g) > 1e-3
)
path_lists = st.lists(
    st.tuples(st.floats(1.0, 500.0), st.floats(-3.0, 3.0), complexes), min_size=1, max_size=9
)


@given(drawn=path_lists, turn=st.floats(-3.0, 3.0))
def test_spreads_keep_their_bounds_and_do_not_turn(
    drawn: list[tuple[float, float, complex]], turn: float
) -> None:
    length, azimuth, gain = (list(column) for column in zip(*drawn, strict=True))
    receiver = [0] * len(drawn)
    s = statistics(straight_paths(receiver, length, azimuth, gain))
    turned = statistics(straight_paths(receiver, length, [a + turn for a in azimuth], gain))
    assert 0.0 <= s.angular_spread[0] <= 1.0
    assert s.angular_spread[0] == pytest.approx(turned.angular_spread[0], abs=1e-6)
    assert s.delay_spread_s[0] <= 0.5 * np.ptp(length) / SPEED_OF_LIGHT + 1e-18
    assert s.rss_coherent_dbm[0] <= s.rss_dbm[0] + 10.0 * np.log10(len(drawn)) + 1e-9
    assert s.strongest_path_dbm[0] <= s.rss_dbm[0] + 1e-9


def test_impulse_response_of_a_path_on_a_tap_is_that_tap() -> None:
    bandwidth_hz = SPEED_OF_LIGHT / 3.0
    channel = straight_paths([1], [12.0], [0.0], [0.5 - 0.25j]).impulse_response(bandwidth_hz)
    assert channel.taps.shape == (2, len(channel.delay_s))
    np.testing.assert_allclose(np.diff(channel.delay_s), 3.0 / SPEED_OF_LIGHT)
    expected = np.zeros(channel.taps.shape[1], np.complex128)
    expected[4] = 0.5 - 0.25j
    np.testing.assert_allclose(channel.taps[1], expected, atol=1e-12)
    assert not channel.taps[0].any()


def test_impulse_response_has_the_channels_spectrum() -> None:
    """Its Fourier transform within the band is sum of gain_i exp(-2 pi j f tau_i)."""
    paths = straight_paths([0, 0, 0], [31.4, 50.2, 77.7], [0.0] * 3, [1.0, -0.5j, 0.2 + 0.3j])
    channel = paths.impulse_response(100e6, 40_000, start_s=-2e-4)
    f_hz = np.array([-20e6, 0.0, 3e6, 30e6])
    spectrum = np.exp(-2j * np.pi * np.outer(f_hz, channel.delay_s)) @ channel.taps[0]
    exact = np.exp(-2j * np.pi * np.outer(f_hz, paths.delay_s)) @ paths.gain
    np.testing.assert_allclose(spectrum, exact, atol=1e-3)


@pytest.mark.parametrize(("bandwidth_hz", "n_taps"), [(0.0, None), (1e6, 0)])
def test_wrong_requests_are_refused(bandwidth_hz: float, n_taps: int | None) -> None:
    with pytest.raises(ValueError, match="expected"):
        straight_paths([0], [1.0], [0.0], [1.0]).impulse_response(bandwidth_hz, n_taps)


def test_table_of_paths() -> None:
    paths = straight_paths([0, 1], [10.0, 20.0], [0.5, -2.0], [1e-3j, 2e-3])
    table = paths.to_dataframe()
    assert table["receiver"].tolist() == [0, 1]
    assert table["sequence"].tolist() == ["LOS", "LOS"]
    np.testing.assert_allclose(table["arrival_azimuth"], [0.5, -2.0])
    np.testing.assert_allclose(table["gain_db"], [-60.0, 20.0 * np.log10(2e-3)])
    np.testing.assert_allclose(table["gain_real"] + 1j * table["gain_imag"], paths.gain)
    np.testing.assert_allclose(table["departure_zenith"], np.pi / 2.0)


OFFICE = box(6.0, 4.0, *wall((3.0, 0.0), (3.0, 4.0), door(1.0, 2.0)))


def test_every_layer_of_a_map_is_the_statistic_of_its_paths() -> None:
    config = TraceConfig(max_reflections=2, max_diffractions=1)
    source = Transmitter((1.234, 1.567, 1.2), POWER_DBM)
    grid = Grid.over((0.0, 0.0, 6.0, 4.0), 0.8, 2.0)
    radio_map = compute_radio_map(OFFICE.scene, source, grid, config)
    paths = trace_paths(OFFICE.scene, source, grid.points(), config)
    expected = PathStatistics.of(paths, POWER_DBM, len(grid.points()))
    layers = {name: layer for name, layer in radio_map.layers.items() if name != "left_out_db"}
    assert len(layers) >= 3
    for name, layer in layers.items():
        values = getattr(expected, name).reshape(grid.shape)
        np.testing.assert_allclose(layer, values, rtol=1e-6, atol=1e-12, err_msg=name)


@pytest.mark.parametrize("both", [False, True])
def test_unknown_polarisations_add_the_powers_of_their_coherent_fields(both: bool) -> None:
    unknown = Isotropic(polarisation="mean")
    scene = scene_of(floorplans.load("flat"))
    transmitter = Transmitter((1.2, 7.9, 0.8), antenna=unknown)
    receiving = unknown if both else HalfWaveDipole()
    grid, config = Grid.over((0.0, 0.0, 12.0, 9.0), 3.0, 1.3), TraceConfig(1, 1, 1)
    radio_map = compute_radio_map(scene, transmitter, grid, config, receive_antenna=receiving)
    points = grid.points()
    paths = trace_paths(scene, transmitter, points, config, receive_antenna=receiving)
    assert paths.pair_gains is not None
    assert paths.pair_gains.shape == (len(paths), 4 if both else 2)
    np.testing.assert_allclose(
        np.abs(paths.gain) ** 2, (np.abs(paths.pair_gains) ** 2).sum(axis=1), rtol=1e-9
    )
    found = PathStatistics.of(paths, transmitter.power_dbm, len(points))
    np.testing.assert_allclose(found.rss_dbm, radio_map.rss_dbm.ravel(), atol=1e-8)
    coherent = radio_map.rss_coherent_dbm.ravel()
    np.testing.assert_allclose(found.rss_coherent_dbm, coherent, atol=1e-6)
