"""Channels of arrays against traces with the arrays as antennas, and Doppler against a motion."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import floorplans
from raytrace import (
    AntennaArray,
    HalfWaveDipole,
    Isotropic,
    MemoryLimitError,
    Paths,
    Scene,
    TraceConfig,
    Transmitter,
    channel_matrix,
    trace_paths,
)
from rssnav.scenes import scene_of

TRANSMITTER = Transmitter((1.2, 7.9, 0.8), 18.0, 2.44e9)
POINTS = np.array([[3.1, 6.3, 1.4], [9.7, 2.2, 1.1], [-5.0, -5.0, 1.0]])
CONFIG = TraceConfig(2, 1, 1)
DIPOLE = HalfWaveDipole()


@pytest.fixture(scope="module")
def flat() -> Scene:
    return scene_of(floorplans.load("flat"))


@pytest.fixture(scope="module")
def paths(flat: Scene) -> Paths:
    return trace_paths(flat, TRANSMITTER, POINTS, CONFIG)


def test_weighted_channels_are_the_field_between_the_arrays(flat: Scene, paths: Paths) -> None:
    """The pattern tables of the tracer are interpolated, so the fields agree to 0.5 %."""
    sending = AntennaArray.linear(3, DIPOLE).steered((1.0, -1.0, 0.0))
    receiving = AntennaArray.planar(2, 2, DIPOLE, spacing=0.4).steered((-1.0, 0.5, 0.2))
    channels = channel_matrix(paths, sending, receiving, n_receivers=3)
    assert channels.shape == (3, 1, 4, 3)
    together = np.array(receiving.weights) @ channels[:, 0] @ np.array(sending.weights)
    traced = trace_paths(
        flat, replace(TRANSMITTER, antenna=sending), POINTS, CONFIG, receive_antenna=receiving
    )
    field = np.zeros(3, dtype=np.complex128)
    np.add.at(field, traced.receiver, traced.weight * traced.gain)
    assert field[2] == together[2] == 0.0
    scale = np.abs(paths.at(0).gain).sum() * 2.0 * np.sqrt(3.0)
    np.testing.assert_allclose(together, field, rtol=0.0, atol=0.005 * scale)


def test_an_element_hears_what_an_antenna_at_its_place_hears(flat: Scene, paths: Paths) -> None:
    """Plane waves over 2 cm: the phase is off by the square of the offset over the distance."""
    offset = np.array([0.02, -0.01, 0.015])
    array = AntennaArray(DIPOLE, (tuple(offset / TRANSMITTER.wavelength_m),))
    strongest = paths.at(0).rows(np.arange(5))
    moved = trace_paths(flat, TRANSMITTER, POINTS[:1] + offset, CONFIG).rows(np.arange(5))
    for path in range(5):
        predicted = channel_matrix(strongest.rows(np.array([path])), receive=array)[0, 0, 0, 0]
        turn = np.angle(predicted / moved.gain[path])
        assert abs(turn) < 0.02
        assert abs(predicted) == pytest.approx(abs(moved.gain[path]), rel=0.05)


def test_off_the_carrier_a_channel_turns_with_the_delay(paths: Paths) -> None:
    one = paths.at(0).rows(np.array([0]))
    offsets = np.array([-1e6, 0.0, 2e6])
    channel = channel_matrix(one, offsets_hz=offsets)[0, :, 0, 0]
    expected = one.weight * one.gain * np.exp(-2j * np.pi * offsets * one.delay_s)
    np.testing.assert_allclose(channel, expected, rtol=1e-12)


def test_too_few_receivers_are_refused(paths: Paths) -> None:
    with pytest.raises(ValueError, match="n_receivers = 1: expected at least 2"):
        channel_matrix(paths, n_receivers=1)


@pytest.mark.parametrize("offsets", [(float("nan"),), (1e308,), 0.0])
def test_offsets_that_are_no_frequencies_are_refused(paths: Paths, offsets: object) -> None:
    with pytest.raises(ValueError, match="offsets_hz"):
        channel_matrix(paths, offsets_hz=offsets)  # pyright: ignore[reportArgumentType]


def test_more_than_the_memory_holds_is_refused(paths: Paths) -> None:
    with pytest.raises(MemoryLimitError, match="channels need at least 16 TB"):
        channel_matrix(paths, n_receivers=10**12)
    with pytest.raises(MemoryLimitError, match="taps need at least"):
        paths.impulse_response(20e6, 10**13)
    with pytest.raises(MemoryLimitError, match="taps need at least"):
        paths.impulse_response(20e6, start_s=-1e12)


@pytest.mark.parametrize("bandwidth_hz", [0.0, float("inf"), float("nan"), 1e308])
def test_a_bandwidth_out_of_range_is_refused(paths: Paths, bandwidth_hz: float) -> None:
    with pytest.raises(ValueError, match="bandwidth_hz"):
        paths.impulse_response(bandwidth_hz)


def test_doppler_is_the_rate_at_which_a_path_becomes_shorter(flat: Scene, paths: Paths) -> None:
    velocity = np.array([0.7, -0.4, 0.2])
    step_s = 1e-4
    moved = trace_paths(flat, TRANSMITTER, POINTS[:1] + velocity * step_s, CONFIG)
    before = paths.at(0).rows(np.arange(10))
    rate = (before.length_m - moved.length_m[:10]) / step_s / TRANSMITTER.wavelength_m
    np.testing.assert_allclose(
        before.doppler_hz(TRANSMITTER.frequency_hz, velocity), rate, atol=0.01
    )


def test_doppler_of_a_moving_transmitter(flat: Scene, paths: Paths) -> None:
    velocity = np.array([-0.5, 0.3, 0.1])
    step_s = 1e-4
    place = np.array(TRANSMITTER.position) + velocity * step_s
    moved = trace_paths(flat, replace(TRANSMITTER, position=tuple(place)), POINTS[:1], CONFIG)
    before = paths.at(0).rows(np.arange(10))
    rate = (before.length_m - moved.length_m[:10]) / step_s / TRANSMITTER.wavelength_m
    found = before.doppler_hz(TRANSMITTER.frequency_hz, transmitter_velocity=velocity)
    np.testing.assert_allclose(found, rate, atol=0.01)


def test_an_unknown_polarisation_has_no_channel(flat: Scene) -> None:
    sending = replace(TRANSMITTER, antenna=Isotropic(polarisation="mean"))
    paths = trace_paths(flat, sending, POINTS, TraceConfig(1, 0))
    with pytest.raises(ValueError, match="polarisation of an antenna is unknown"):
        paths.impulse_response(20e6)
    with pytest.raises(ValueError, match="polarisation of an antenna is unknown"):
        channel_matrix(paths)
