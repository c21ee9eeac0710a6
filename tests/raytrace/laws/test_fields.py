"""Every path's complex gain is that of a field vector propagated along it, without any table."""

import numpy as np
import pytest
from brute_force_field import Radio, path_gains
from comparing import as_found, facets_of, off_ties
from rooms import ROOMS, SOURCE

from raytrace import (
    Antenna,
    HalfWaveDipole,
    Isotropic,
    Paths,
    TraceConfig,
    Transmitter,
    trace_paths,
)
from raytrace.kernels.path_points import DIFFRACTION, TRANSMISSION

TOLERANCE = 1e-4
"""Relative: tables are interpolated. Off a dipole's null the worst path is off by 2.4e-5, the
median by 1e-7; near the null, 160 dB under the strongest path counts as nothing."""

ANTENNAS = {"isotropic": Isotropic(), "dipole": HalfWaveDipole()}
TILTED = {
    "horizontal dipole": HalfWaveDipole(axis=(1.0, 0.0, 0.0)),
    "slanted dipole": HalfWaveDipole(axis=(0.3, -0.5, 0.8)),
}
THROUGH = TraceConfig(max_reflections=2, max_diffractions=0, max_transmissions=2)


def with_and_without_tables(
    name: str, antenna: Antenna, config: TraceConfig | None = None
) -> tuple[Paths, np.ndarray]:
    room, config = ROOMS[name], config or TraceConfig(3, 1)
    source = Transmitter(off_ties(SOURCE), antenna=antenna)
    receivers = room.random_points(6, seed=21)
    paths = trace_paths(room.scene, source, receivers, config, receive_antenna=antenna)
    radio = Radio(room.slabs, source, antenna)
    return paths, path_gains(facets_of(room), as_found(paths), radio)


@pytest.mark.parametrize("antenna", ANTENNAS)
@pytest.mark.parametrize("name", ROOMS)
def test_gains_are_those_of_a_field_vector(name: str, antenna: str) -> None:
    paths, expected = with_and_without_tables(name, ANTENNAS[antenna])
    floor = 1e-8 * np.abs(expected).max()
    np.testing.assert_array_less(
        np.abs(paths.gain - expected), TOLERANCE * np.abs(expected) + floor
    )


@pytest.mark.parametrize("antenna", TILTED)
@pytest.mark.parametrize("name", ["door with lintel", "half-height wall", "pillar"])
def test_an_antenna_may_be_tilted(name: str, antenna: str) -> None:
    """Their patterns are tables in two directions, good to 1e-4 of the peak."""
    paths, expected = with_and_without_tables(name, TILTED[antenna])
    whole = np.array([np.abs(g).sum() for g in (paths.gain - expected, expected)])
    assert whole[0] < 1e-3 * whole[1]


@pytest.mark.parametrize("antenna", ["dipole", "slanted dipole"])
@pytest.mark.parametrize("name", ["door with lintel", "half-height wall", "pillar"])
def test_walls_let_through_what_their_slabs_do(name: str, antenna: str) -> None:
    paths, expected = with_and_without_tables(name, (ANTENNAS | TILTED)[antenna], THROUGH)
    assert (paths.interactions == TRANSMISSION).any()
    np.testing.assert_array_less(
        np.abs(paths.gain - expected), 1e-3 * np.abs(expected) + 1e-4 * np.abs(expected).max()
    )


@pytest.mark.parametrize("name", ROOMS)
def test_the_coherent_sum_is_that_of_a_field_vector(name: str) -> None:
    paths, expected = with_and_without_tables(name, HalfWaveDipole())
    for receiver in range(6):
        ours, theirs = (g[paths.receiver == receiver].sum() for g in (paths.gain, expected))
        assert abs(20.0 * np.log10(abs(ours / theirs))) < 1e-3


def test_the_rooms_have_every_kind_of_path() -> None:
    """Vertical and horizontal edges, and reflections before, behind, and on both sides of them."""
    sequences = set()
    heights = set()
    for name in ("door with lintel", "half-height wall"):
        paths, _ = with_and_without_tables(name, Isotropic())
        sequences |= {paths.sequence(k) for k in range(len(paths))}
        row, column = np.nonzero(paths.interactions == DIFFRACTION)
        heights |= set(np.round(paths.vertices[row, column + 1, 2], 6).tolist())
    assert {"LOS", "RRR", "D", "DRRR", "RDRR", "RRRD"} <= sequences
    assert {1.25, 2.25} < heights
