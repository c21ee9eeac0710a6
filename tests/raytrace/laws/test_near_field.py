"""Nothing receives more than is transmitted, however near it is to transmitter, edges and walls."""

import os

import numpy as np
import pytest
from buildings import CONCRETE, GLASS, box, door, wall, window
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from raytrace import (
    Antenna,
    Grid,
    HalfWaveDipole,
    Isotropic,
    RadioMap,
    SceneError,
    SceneWarning,
    TraceConfig,
    Transmitter,
    compute_radio_map,
    trace_paths,
)
from raytrace.constants import SPEED_OF_LIGHT

Floats = NDArray[np.float64]

LONG = "RSSNAV_EXAMPLES" in os.environ

ROOM = box(
    8.0,
    5.0,
    *wall((3.0, 0.0), (3.0, 3.0), door(1.0, 2.0), slab=CONCRETE),
    *wall((5.0, 2.0), (8.0, 2.0), window(1.0, 2.0), slab=GLASS),
)
PLACES = np.array(
    [
        (2.5, 2.5, 1.5),
        (3.0, 1.0, 2.25),  # jamb and lintel of the door
        (3.0, 1.5, 1.0),  # in the door
        (3.0, 3.0, 1.5),  # free end of a wall
        (5.0, 2.0, 0.875),
        (6.5, 2.0, 2.125),  # under the head of the window
        (1e-9, 2.0, 1.5),  # at a wall
        (8.0, 5.0, 1.5),  # in a corner
        (4.0, 4.0, 1e-6),  # at the floor
        (4.0, 4.0, 3.0 - 1e-6),  # at the ceiling
    ]
)
STEPS_M = (0.0, 1e-12, 1e-9, 1e-7, 1e-6, 1e-4, 0.003, 0.01, 0.02)
ANTENNAS = (None, Isotropic())


def receivers_around(place: Floats, seed: int) -> Floats:
    """Return points at a place, a few steps from it in random directions, and all other places."""
    direction = np.random.default_rng(seed).normal(size=(len(STEPS_M), 3))
    direction /= np.linalg.norm(direction, axis=1)[:, None]
    steps = np.array(STEPS_M)[:, None]
    level = direction * (1.0, 1.0, 0.0)
    return np.concatenate([place + steps * direction, place + steps * level, PLACES])


@given(
    place=st.integers(0, len(PLACES) - 1),
    step_m=st.sampled_from(STEPS_M),
    antenna=st.sampled_from(ANTENNAS),
    seed=st.integers(0, 2**32 - 1),
)
@settings(max_examples=int(os.environ.get("RSSNAV_EXAMPLES", 15)), derandomize=not LONG)
def test_no_path_gains_power(place: int, step_m: float, antenna: Antenna, seed: int) -> None:
    around = receivers_around(PLACES[place], seed)
    source = PLACES[place] + [step_m, 0.6 * step_m, 0.0]
    try:
        transmitter = Transmitter(tuple(source), antenna=antenna or HalfWaveDipole())
        paths = trace_paths(
            ROOM.scene, transmitter, around, TraceConfig(2, 1), receive_antenna=antenna
        )
    except SceneError as error:
        assert "stands in the wall" in str(error) or "not inside" in str(error)  # noqa: PT017
        return
    assert np.isfinite(paths.gain).all()
    assert np.isfinite(paths.length_m).all()
    assert np.isfinite(paths.vertices).all()
    assert (abs(paths.gain) <= 1.0 + 1e-12).all()


def small_map(place: Floats, cell_m: float) -> RadioMap:
    """Return the map of a cell around the transmitter and its neighbours."""
    x, y, z = place
    offsets = cell_m * np.arange(-1.0, 2.0)
    grid = Grid(x + offsets, y + offsets, z, cell_m)
    transmitter = Transmitter((x, y, z), antenna=Isotropic())
    config = TraceConfig(2, 1)
    return compute_radio_map(ROOM.scene, transmitter, grid, config, receive_antenna=Isotropic())


@pytest.mark.parametrize("cell_m", [1e-9, 0.005, 1.0])
def test_a_map_is_bounded_by_the_transmit_power_and_says_so(cell_m: float) -> None:
    with pytest.warns(SceneWarning, match="too near to the transmitter"):
        near = small_map(PLACES[0], cell_m)
    for layer in (near.rss_dbm, near.rss_coherent_dbm, near.strongest_path_dbm):
        assert layer is not None
        assert layer.max() == near.transmitter.power_dbm
    for layer in near.layers.values():
        assert not np.isnan(layer).any()


def test_a_map_away_from_the_transmitter_is_not_bounded() -> None:
    wavelength = SPEED_OF_LIGHT / 2.4e9
    x, y, z = PLACES[0]
    distance = np.array([0.02, 0.1, 0.4])
    grid = Grid(x + distance, np.array([y]), z, 1.0)
    source = Transmitter((x, y, z), antenna=Isotropic())
    found = compute_radio_map(
        ROOM.scene, source, grid, TraceConfig(0, 0), receive_antenna=Isotropic()
    )
    expected = source.power_dbm + 20.0 * np.log10(wavelength / (4.0 * np.pi * distance))
    np.testing.assert_allclose(found.rss_dbm[0], expected, atol=1e-6)
