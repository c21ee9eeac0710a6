"""Every path's complex gain is that of a field vector carried along it, without any table."""

import numpy as np
import pytest
from comparing import as_found, facets_of
from reference_field import Radio, path_gains
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
from raytrace.kernels.path_points import DIFFRACTION

TOLERANCE = 1e-4
"""Relative: tables are interpolated. Off a dipole's null the worst path is off by 2.4e-5, the
median by 1e-7; near the null, 160 dB under the strongest path counts as nothing."""

ANTENNAS = {"isotropic": Isotropic(), "dipole": HalfWaveDipole()}


def with_and_without_tables(name: str, antenna: Antenna) -> tuple[Paths, np.ndarray]:
    room = ROOMS[name]
    source = Transmitter(SOURCE, antenna=antenna)
    receivers = room.random_points(6, seed=21)
    paths = trace_paths(room.scene, source, receivers, TraceConfig(3, 1), receive_antenna=antenna)
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


@pytest.mark.parametrize("name", ROOMS)
def test_the_coherent_sum_is_that_of_a_field_vector(name: str) -> None:
    paths, expected = with_and_without_tables(name, HalfWaveDipole())
    for receiver in range(6):
        ours, theirs = (g[paths.receiver == receiver].sum() for g in (paths.gain, expected))
        assert abs(20.0 * np.log10(abs(ours / theirs))) < 1e-3


def test_the_rooms_have_every_kind_of_path() -> None:
    """Upright and level edges, and reflections before, behind, and on both sides of them."""
    sequences = set()
    heights = set()
    for name in ("door with lintel", "half-height wall"):
        paths, _ = with_and_without_tables(name, Isotropic())
        sequences |= {paths.sequence(k) for k in range(len(paths))}
        row, column = np.nonzero(paths.interactions == DIFFRACTION)
        heights |= set(np.round(paths.vertices[row, column + 1, 2], 6).tolist())
    assert {"LOS", "RRR", "D", "DRRR", "RDRR", "RRRD"} <= sequences
    assert {1.25, 2.25} < heights
