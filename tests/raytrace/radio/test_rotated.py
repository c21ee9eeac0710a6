"""A rotated antenna has the field of the antenna in its own axes."""

import numpy as np
import pytest

from raytrace import HalfWaveDipole, Isotropic, PatternTable
from raytrace.radio.rotated import Rotated

RNG = np.random.default_rng(61)
AT = RNG.uniform(-1.0, 1.0, 400), RNG.uniform(-np.pi, np.pi, 400)
LEVEL = [(1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (-3.0, 0.0, 0.0), (1.0, -2.0, 0.0)]
TILTED = [(1.0, 0.5, 0.7), (-1.0, 0.2, -0.4), (0.0, 0.0, 2.0), (0.0, 0.0, -1.0)]


@pytest.mark.parametrize("direction", LEVEL + TILTED)
def test_a_dipole_along_x_becomes_the_dipole_along_the_direction(direction) -> None:
    rotated = Rotated.towards(HalfWaveDipole(1.5, (1.0, 0.0, 0.0)), direction).amplitudes(*AT)
    expected = HalfWaveDipole(1.5, direction).amplitudes(*AT)
    for found, wanted in zip(rotated, expected, strict=True):
        np.testing.assert_allclose(found, wanted, atol=1e-7)


@pytest.mark.parametrize("direction", LEVEL + TILTED)
def test_the_pattern_points_in_the_direction_and_keeps_its_gain(direction) -> None:
    theta, phi = np.linspace(0.0, 180.0, 37), np.linspace(0.0, 360.0, 73)
    gain_dbi = np.add.outer(-np.abs(theta - 90.0) / 15.0, -10.0 * (1.0 - np.cos(np.radians(phi))))
    pattern = PatternTable.of_gain(theta, phi, gain_dbi)
    rotated = Rotated.towards(pattern, direction)
    x, y, z = np.array(direction) / np.linalg.norm(direction)
    found = rotated.amplitudes(np.array([z]), np.array([np.arctan2(y, x)]))
    assert np.abs(found.v) ** 2 + np.abs(found.h) ** 2 == pytest.approx(1.0, abs=1e-6)
    assert PatternTable.of(rotated).mean_gain == pytest.approx(pattern.mean_gain, rel=2e-3)


def test_a_direction_without_length_is_none() -> None:
    with pytest.raises(ValueError, match="expected three finite numbers, not all 0"):
        Rotated.towards(HalfWaveDipole(), (0.0, 0.0, 0.0))


@pytest.mark.parametrize("axis", [(), (1.0, 0.0), (1.0, 0.0, 0.0, 0.0)])
def test_axes_of_another_length_are_refused(axis: tuple[float, ...]) -> None:
    with pytest.raises(ValueError, match="expected orthogonal unit vectors"):
        Rotated(Isotropic(), axis, (0.0, 0.0, 1.0))  # pyright: ignore[reportArgumentType]


def test_it_prints_in_a_line_and_compares_by_its_exact_axes() -> None:
    one, other = (Rotated.towards(Isotropic(), (1.0, y, 0.0)) for y in (0.3, 0.3000001))
    assert (
        repr(one)
        == repr(other)
        == (
            "Rotated(Isotropic(gain_db=0.0, polarisation='vertical'), "
            "x_axis=(0.9578, 0.2873, 0), z_axis=(0, 0, 1))"
        )
    )
    assert one != other
