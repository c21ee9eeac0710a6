"""What arrives without any wall in the way: Friis' equation and the antennas."""

import numpy as np
import pytest
from buildings import box

from raytrace import (
    DIPOLE_PEAK_GAIN_DBI,
    Grid,
    HalfWaveDipole,
    Isotropic,
    TraceConfig,
    Transmitter,
    compute_radio_map,
    trace_paths,
)
from raytrace.constants import SPEED_OF_LIGHT
from raytrace.radio.antennas import vertical_amplitude

HALL = box(64.0, 32.0)
DIRECT = TraceConfig(max_reflections=0, max_diffractions=0)
SOURCE = np.array([20.0, 10.0, 1.5])


def direct_gain(receivers: np.ndarray, source: Transmitter, **antenna: Isotropic) -> np.ndarray:
    paths = trace_paths(HALL.scene, source, receivers, DIRECT, **antenna)
    assert len(paths) == len(receivers)
    return paths.gain


def friis(distance: np.ndarray, frequency_hz: float) -> np.ndarray:
    wavelength = SPEED_OF_LIGHT / frequency_hz
    phase = np.exp(-2j * np.pi * distance / wavelength)
    return wavelength / (4.0 * np.pi * distance) * phase


def test_path_loss_at_1_m_is_40_05_db() -> None:
    receiver = SOURCE + np.array([1.0, 0.0, 0.0])
    (gain,) = direct_gain(receiver[None], Transmitter(tuple(SOURCE)))
    assert -20.0 * np.log10(abs(gain)) == pytest.approx(40.05, abs=0.005)


def test_25_dbm_at_2_m_are_minus_21_07_dbm() -> None:
    grid = Grid(np.array([SOURCE[0] + 2.0]), np.array([SOURCE[1]]), 1.5, 1.0)
    radio_map = compute_radio_map(HALL.scene, Transmitter(tuple(SOURCE)), grid, DIRECT)
    assert radio_map.rss_dbm[0, 0] == pytest.approx(-21.07, abs=0.005)
    assert radio_map.rss_coherent_dbm[0, 0] == pytest.approx(radio_map.rss_dbm[0, 0], abs=1e-9)


@pytest.mark.parametrize("frequency_hz", [1.2e9, 2.4e9, 5.8e9, 60e9])
def test_isotropic_antennas_obey_friis_in_size_and_phase(frequency_hz: float) -> None:
    receivers = HALL.random_points(50, seed=3)
    source = Transmitter(tuple(SOURCE), frequency_hz=frequency_hz, antenna=Isotropic())
    gain = direct_gain(receivers, source, receive_antenna=Isotropic())
    distance = np.linalg.norm(receivers - SOURCE, axis=1)
    np.testing.assert_allclose(gain, friis(distance, frequency_hz), rtol=1e-8)


def test_dipoles_see_each_other_with_their_pattern_twice() -> None:
    receivers = HALL.random_points(50, seed=4)
    ray = receivers - SOURCE
    distance = np.linalg.norm(ray, axis=1)
    theta = np.arccos(ray[:, 2] / distance)
    pattern = np.cos(0.5 * np.pi * np.cos(theta)) / np.sin(theta)
    gain = direct_gain(receivers, Transmitter(tuple(SOURCE)))
    np.testing.assert_allclose(gain, friis(distance, 2.4e9) * pattern**2, rtol=1e-6)


def test_a_lossless_dipole_gains_2_15_db_at_each_end() -> None:
    receivers = HALL.random_points(5, seed=5)
    lossless = HalfWaveDipole(DIPOLE_PEAK_GAIN_DBI)
    plain = direct_gain(receivers, Transmitter(tuple(SOURCE)))
    source = Transmitter(tuple(SOURCE), antenna=lossless)
    both = direct_gain(receivers, source, receive_antenna=lossless)
    np.testing.assert_allclose(20 * np.log10(np.abs(both / plain)), 2 * 2.15, atol=0.005)


def test_the_peak_gain_is_that_of_a_lossless_dipole() -> None:
    """All power fed leaves: the mean of the power gain over the sphere is 1."""
    cos_theta = np.linspace(-1.0, 1.0, 200_001)
    power = vertical_amplitude(HalfWaveDipole(DIPOLE_PEAK_GAIN_DBI), cos_theta) ** 2
    assert 0.5 * np.trapezoid(power, cos_theta) == pytest.approx(1.0, abs=1e-5)


def test_a_dipole_is_silent_straight_up() -> None:
    (gain,) = direct_gain(SOURCE[None] + np.array([0.0, 0.0, 1.0]), Transmitter(tuple(SOURCE)))
    assert abs(gain) < 1e-7


def test_power_adds_in_dbm() -> None:
    grid = Grid.over((0.0, 0.0, 64.0, 32.0), 8.0, 2.0)
    weak, strong = (
        compute_radio_map(HALL.scene, Transmitter(tuple(SOURCE), power_dbm=p), grid, DIRECT)
        for p in (0.0, 25.0)
    )
    np.testing.assert_allclose(strong.rss_dbm - weak.rss_dbm, 25.0, rtol=1e-12)
