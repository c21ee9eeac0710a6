"""Antennas of unknown polarisation: powers are means over all polarisations of both."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np
import pytest
from brute_force_field import Radio, path_gains
from comparing import as_found, facets_of, off_ties
from numpy.typing import NDArray
from rooms import ROOMS, SOURCE

from raytrace import (
    Antenna,
    Dielectric,
    Grid,
    HalfWaveDipole,
    Isotropic,
    Scene,
    SceneError,
    TraceConfig,
    Transmitter,
    compute_radio_map,
    evaluate_paths,
    received_power,
    trace_paths,
    trace_points,
)
from raytrace.radio.antennas import Amplitudes
from raytrace.radio.materials import Slab
from raytrace.results.path_statistics import PathStatistics

Floats = NDArray[np.float64]

UNKNOWN = Isotropic(polarisation="mean")
CONFIG = TraceConfig(2, 1, 1)
NAME = "glass window and door"
SENDER = Transmitter(off_ties(SOURCE), antenna=UNKNOWN)


@dataclass(frozen=True)
class Polarised:
    """An isotropic antenna of a given polarisation."""

    v: complex
    h: complex

    def amplitudes(self, sine: Floats, azimuth: Floats) -> Amplitudes:
        one = np.ones(np.shape(sine), np.complex128)
        return Amplitudes(self.v * one, self.h * one)

    def describe(self) -> str:
        return "polarised"


HALF = np.sqrt(0.5)
STATES = (
    Polarised(1.0, 0.0),
    Polarised(0.0, 1.0),
    *(Polarised(HALF, HALF * turn) for turn in (1.0, -1.0, 1j, -1j)),
)
"""Six polarisations whose means of squares are those of all (a spherical design)."""


def power_w(scene: Scene, points: Floats, sender: Transmitter, antenna: Antenna) -> Floats:
    """Received over transmitted power."""
    dbm = received_power(scene, sender, points, CONFIG, receive_antenna=antenna)
    return 10.0 ** ((dbm - sender.power_dbm) / 10.0)


@pytest.mark.parametrize("name", [NAME, "door with lintel", "corner of 270 degrees"])
def test_powers_are_means_over_polarisations(name: str) -> None:
    """Of the field vectors of the brute force, over 6 x 6 polarisations."""
    room = ROOMS[name]
    receivers = room.random_points(3, seed=21)
    paths = trace_paths(room.scene, SENDER, receivers, CONFIG, receive_antenna=UNKNOWN)
    found, facets = as_found(paths), facets_of(room)
    powers = [
        np.abs(path_gains(facets, found, Radio(room.slabs, Transmitter(SENDER.position, antenna=a),
                                               b, 1))) ** 2
        for a, b in product(STATES, STATES)
    ]  # fmt: skip
    expected = np.mean(powers, axis=0)
    assert any("D" in paths.sequence(k) for k in range(len(paths)))
    np.testing.assert_allclose(
        np.abs(paths.gain) ** 2, expected, rtol=2e-3, atol=1e-6 * expected.max()
    )
    whole = np.bincount(paths.receiver, paths.weight * np.abs(paths.gain) ** 2, len(receivers))
    found_w = power_w(room.scene, receivers, SENDER, UNKNOWN)
    np.testing.assert_allclose(found_w, whole, rtol=1e-9)


def test_the_straight_path_loses_half() -> None:
    room = ROOMS[NAME]
    point, straight = room.random_points(1, seed=1), TraceConfig(0, 0, 3)
    vertical = Transmitter(SENDER.position, antenna=Isotropic())
    powers = [
        received_power(room.scene, sender, point, straight, receive_antenna=sender.antenna)[0]
        for sender in (SENDER, vertical)
    ]
    assert powers[0] - powers[1] < -3.0
    open_space = ROOMS["corner of 270 degrees"]
    sees = trace_paths(open_space.scene, SENDER, open_space.random_points(20, seed=1), straight,
                       receive_antenna=UNKNOWN)  # fmt: skip
    free = [k for k in range(len(sees)) if sees.sequence(k) == "LOS"]
    assert free
    friis = vertical.wavelength_m / (4.0 * np.pi * sees.length_m[free])
    np.testing.assert_allclose(np.abs(sees.gain[free]) ** 2, 0.5 * friis**2, rtol=1e-9)


@pytest.mark.parametrize("receive", [UNKNOWN, HalfWaveDipole(), HalfWaveDipole(axis=(1, 1, 1))])
def test_maps_and_kept_paths_have_the_same_powers(receive: Antenna) -> None:
    room = ROOMS[NAME]
    grid = Grid.over((0.4, 0.3, 3.4, 2.3), 1.0, 1.2)
    radio_map = compute_radio_map(room.scene, SENDER, grid, CONFIG, receive_antenna=receive)
    expected = power_w(room.scene, grid.points(), SENDER, receive)
    mapped = 10.0 ** ((radio_map.rss_dbm.ravel() - SENDER.power_dbm) / 10.0)
    np.testing.assert_allclose(mapped, expected, rtol=1e-12)
    assert radio_map.receive_antenna == receive
    kept = trace_points(room.scene, SENDER, grid.points(), CONFIG, receive_antenna=receive)
    # a dipole's pattern is tabulated in one or in two directions
    rtol = 1e-9 if receive == UNKNOWN else 1e-6
    np.testing.assert_allclose(kept.powers(), expected, rtol=rtol, atol=1e-20)


@pytest.mark.parametrize("ends", [(UNKNOWN, UNKNOWN), (HalfWaveDipole(), UNKNOWN)])
def test_maps_have_the_statistics_of_their_paths(ends: tuple[Antenna, Antenna]) -> None:
    """The strongest path, of all polarisations together, and the coherent field among them."""
    room = ROOMS[NAME]
    grid = Grid.over((0.4, 0.3, 3.4, 2.3), 1.0, 1.2)
    sender = Transmitter(SENDER.position, antenna=ends[0])
    radio_map = compute_radio_map(room.scene, sender, grid, CONFIG, receive_antenna=ends[1])
    paths = trace_paths(room.scene, sender, grid.points(), CONFIG, receive_antenna=ends[1])
    expected = PathStatistics.of(paths, sender.power_dbm, grid.x.size * grid.y.size)
    for name in ("rss_dbm", "rss_coherent_dbm", "strongest_path_dbm", "k_factor_db"):
        layer = getattr(radio_map, name)
        assert layer is not None
        np.testing.assert_allclose(layer.ravel(), getattr(expected, name), rtol=0, atol=1e-6)


def test_other_materials_and_derivatives() -> None:
    room, points = ROOMS[NAME], ROOMS[NAME].random_points(4, seed=3)
    kept = trace_points(room.scene, SENDER, points, CONFIG, receive_antenna=UNKNOWN)

    def slabs_at(values: Floats) -> list[Slab]:
        wall = Dielectric.of_law("wall", 1.0 + np.exp(values[0]), 0.0, np.exp(values[1]))
        return [Slab(wall, 0.12)] * len(kept.slabs)

    values, step = np.array([1.2, -2.5]), 1e-4
    powers, derivatives = kept.derivatives(slabs_at, values)
    np.testing.assert_allclose(powers, kept.powers(slabs_at(values)), rtol=1e-11)
    along = np.array([1.0, 0.5])
    ahead, behind = (kept.powers(slabs_at(values + s * along)) for s in (step, -step))
    expected = (ahead - behind) / (2.0 * step)
    np.testing.assert_allclose(
        derivatives @ along, expected, rtol=1e-5, atol=1e-5 * np.abs(expected).max()
    )
    paths = trace_paths(room.scene, SENDER, points, CONFIG, receive_antenna=UNKNOWN)
    again = evaluate_paths(paths, slabs_at(values), SENDER, receive_antenna=UNKNOWN)
    whole = np.bincount(again.receiver, again.weight * np.abs(again.gain) ** 2, len(points))
    np.testing.assert_allclose(whole, powers, rtol=1e-9)


def test_it_has_no_amplitudes() -> None:
    with pytest.raises(SceneError, match="no field amplitudes"):
        UNKNOWN.amplitudes(np.zeros(1), np.zeros(1))
    with pytest.raises(ValueError, match="expected one of 'vertical', 'horizontal', 'mean'"):
        Isotropic(polarisation="round")  # pyright: ignore[reportArgumentType]


def test_the_strongest_paths_are_those_of_all() -> None:
    room, points = ROOMS[NAME], ROOMS[NAME].random_points(3, seed=3)
    paths = trace_paths(room.scene, SENDER, points, CONFIG, receive_antenna=UNKNOWN)
    few = trace_paths(room.scene, SENDER, points, CONFIG, receive_antenna=UNKNOWN, strongest=4)
    for k in range(len(points)):
        expected = np.abs(paths.gain[paths.receiver == k])[:4]
        np.testing.assert_allclose(np.abs(few.gain[few.receiver == k]), expected, rtol=1e-12)
