"""Monopole, patch, sector and arrays: textbook gains, energy, steering, and how files keep them."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from raytrace import SceneError
from raytrace.antennas import (
    Antenna,
    AntennaArray,
    HalfWaveDipole,
    Isotropic,
    Monopole,
    Patch,
    PatternTable,
    Rotated,
    Sector,
)
from raytrace.radio import antenna_array
from raytrace.radio.antennas import vertical_amplitude
from raytrace.results.antenna_file import as_stored

DIRECTIONS = st.tuples(*[st.floats(-1.0, 1.0)] * 3).filter(lambda v: np.linalg.norm(v) > 0.1)


def gain_db(antenna: Antenna, sine: float, azimuth_deg: float) -> float:
    v, h = antenna.amplitudes(np.array([sine]), np.radians([azimuth_deg]))
    return float(10.0 * np.log10(max(abs(v[0]) ** 2 + abs(h[0]) ** 2, 1e-40)))


def gain_towards(antenna: Antenna, direction: tuple[float, float, float]) -> float:
    x, y, z = np.array(direction) / np.linalg.norm(direction)
    return gain_db(antenna, z, np.degrees(np.arctan2(y, x)))


@pytest.mark.parametrize("permittivity", [1.0, 2.2, 4.4, 10.2])
def test_a_lossless_patch_radiates_what_it_is_fed(permittivity: float) -> None:
    """The mean of the gain over the sphere, by another rule than the patch's own."""
    patch = Patch(permittivity)
    assert PatternTable.of(patch, 1.0).mean_gain == pytest.approx(1.0, abs=2e-4)
    assert gain_db(patch, 0.0, 0.0) == pytest.approx(patch.peak_gain_db)


def test_a_patch_on_air_has_the_gain_of_the_textbook() -> None:
    """Two slots of half a wavelength, half a wavelength apart: 9.3 dBi (Balanis, section 14.2.2).

    The directivity is (2 pi W / lambda)^2 pi / I by eq. 14-53, with the integral I over the half
    plane of polar angles and azimuths of Balanis, eq. 14-53a, here by the trapezoidal rule.
    """
    theta, phi = np.meshgrid(np.linspace(1e-6, np.pi - 1e-6, 2001), np.linspace(0, np.pi, 2001))
    x = np.pi * 0.5
    shape = np.sin(x * np.cos(theta)) / np.cos(theta)
    integrand = shape**2 * np.sin(theta) ** 3 * np.cos(x * np.sin(theta) * np.sin(phi)) ** 2
    integral = np.trapezoid(np.trapezoid(integrand, theta[0], axis=1), phi[:, 0])
    directivity = (2.0 * np.pi * 0.5) ** 2 * np.pi / integral
    assert 10.0 * np.log10(directivity) == pytest.approx(Patch(1.0).peak_gain_db, abs=1e-3)


def test_a_patch_is_polarised_along_z_and_radiates_forwards_only() -> None:
    patch = Patch()
    v, h = patch.amplitudes(np.array([0.0, 0.5]), np.zeros(2))
    assert np.all(v > 0.0)
    assert np.allclose(h, 0.0)
    assert gain_db(patch, 0.0, 180.0) < -300.0
    assert gain_db(patch, 0.0, 90.0) < -300.0


def test_a_monopole_is_the_upper_half_of_a_dipole() -> None:
    assert Monopole().peak_gain_db == pytest.approx(5.16, abs=0.005)
    upper, lower = gain_db(Monopole(), 0.5, 20.0), gain_db(Monopole(), -0.5, 20.0)
    assert upper - gain_db(HalfWaveDipole(), 0.5, 20.0) == pytest.approx(5.161, abs=1e-3)
    assert lower < -300.0


@pytest.mark.parametrize(
    ("sine", "azimuth_deg", "expected"),
    [
        (0.0, 0.0, 8.0),
        (0.0, 32.5, 5.0),
        (np.sin(np.radians(32.5)), 0.0, 5.0),
        (np.sin(np.radians(32.5)), -32.5, 2.0),
        (0.0, 180.0, -22.0),
        (0.9, 120.0, -22.0),
    ],
)
def test_a_sector_follows_the_table_of_3gpp(
    sine: float, azimuth_deg: float, expected: float
) -> None:
    assert gain_db(Sector(), sine, azimuth_deg) == pytest.approx(expected, abs=1e-9)


def test_a_slanted_sector_has_both_polarisations() -> None:
    v, h = Sector(slant_deg=45.0).amplitudes(np.zeros(1), np.zeros(1))
    assert v == pytest.approx(h)


@given(DIRECTIONS, st.integers(1, 6), st.integers(1, 4))
def test_a_steered_array_has_its_full_gain_where_it_points(
    direction: tuple[float, float, float], n_y: int, n_z: int
) -> None:
    array = AntennaArray.planar(n_y, n_z).steered(direction)
    full = 10.0 * np.log10(n_y * n_z)
    assert gain_towards(array, direction) == pytest.approx(full, abs=1e-6)
    v, _ = array.amplitudes(np.linspace(-1, 1, 21), np.linspace(0, 6, 21))
    assert np.all(np.abs(v) ** 2 <= n_y * n_z * (1 + 1e-9))


def test_a_line_of_two_half_a_wavelength_apart_cancels_along_itself() -> None:
    pair = AntennaArray.linear(2)
    assert gain_db(pair, 0.0, 0.0) == pytest.approx(3.0103, abs=1e-4)
    assert gain_db(pair, 0.0, 90.0) < -200.0


@given(DIRECTIONS)
def test_an_array_factor_multiplies_the_element(direction: tuple[float, float, float]) -> None:
    at = np.array(direction) / np.linalg.norm(direction)
    array = AntennaArray.linear(3, Patch()).steered((1.0, 0.4, 0.0))
    factor = array.response(at) @ np.array(array.weights)
    gain = gain_towards(array, direction) - gain_towards(Patch(), direction)
    if gain_towards(Patch(), direction) > -100.0:
        assert gain == pytest.approx(20.0 * np.log10(max(abs(factor), 1e-20)), abs=1e-6)


@pytest.mark.parametrize("antenna", [Isotropic(-2.0), Monopole(4.0), Patch(3.0), Sector(6.0)])
def test_files_keep_named_antennas(antenna: Antenna) -> None:
    assert as_stored(antenna) is antenna


def test_files_keep_arrays_as_tables() -> None:
    array = AntennaArray.linear(4, Rotated.towards(Sector(), (0.0, 1.0, 0.0)))
    stored = as_stored(array)
    assert isinstance(stored, PatternTable)
    assert gain_db(stored, 0.0, 70.0) == pytest.approx(gain_db(array, 0.0, 70.0), abs=1e-6)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Patch(0.5), "permittivity = 0.5: expected a number of at least 1"),
        (lambda: Sector(beamwidth_deg=0.0), "beamwidth_deg = 0.0"),
        (lambda: Sector(slant_deg=float("nan")), "slant_deg = nan: expected a finite number"),
        (lambda: AntennaArray.linear(0), "n = 0: expected an integer from 1 to 4096"),
        (lambda: AntennaArray(offsets=()), r"offsets of shape \(0,\)"),
        (lambda: AntennaArray(weights=(1.0, 1.0)), r"weights of shape \(2,\): expected \(1,\)"),
        (lambda: AntennaArray.linear(2, axis=(0.0, 0.0, 0.0)), "not all 0"),
        (lambda: AntennaArray.linear(2).steered((0.0, 0.0, 0.0)), "not all 0"),
        (lambda: HalfWaveDipole(float("nan")), "peak_gain_db = nan: expected a number from -300"),
        (lambda: Isotropic(1e4), r"gain_db = 10000\.0: expected a number from -300 to 300 dB"),
        (lambda: Monopole(float("-inf")), "peak_gain_db = -inf"),
        (lambda: Sector(peak_gain_db=1e308), r"peak_gain_db = 1e\+308"),
        (lambda: Sector(beamwidth_deg=5e-324), r"expected 0\.01 to 360"),
        (lambda: Rotated(Patch(), (2.0, 0.0, 0.0), (0.0, 0.0, 1.0)), "expected orthogonal unit"),
        (lambda: Rotated(Patch(), (1.0, 0.0, 0.0), (1.0, 0.0, 0.0)), "expected orthogonal unit"),
        (lambda: AntennaArray.linear(2.5), r"n = 2\.5"),  # pyright: ignore[reportArgumentType]
        (lambda: AntennaArray.linear(10**12), "n = 1000000000000"),
        (lambda: AntennaArray.planar(100, 100), r"n_y \* n_z = 10000"),
        (lambda: AntennaArray.linear(2, spacing=float("inf")), "spacing = inf"),
        (lambda: AntennaArray(offsets=((1e308, 0.0, 0.0),)), "up to 1e\\+06 wavelengths"),
        (lambda: AntennaArray(weights=(1e308,)), r"up to 1e\+15"),
        (lambda: PatternTable.of(Isotropic(), 0.0), r"step_deg = 0\.0: expected 0\.1 to 90"),
        (lambda: PatternTable.of(Isotropic(), 1e-9), "step_deg = 1e-09"),
        (lambda: PatternTable.of_gain([0, 180], [0, 360], [[1e308] * 2] * 2), "expected finite"),
    ],
)
def test_wrong_parameters_are_refused(make: object, message: str) -> None:
    assert callable(make)
    with pytest.raises(ValueError, match=message):
        make()


def test_a_direction_may_be_as_long_as_a_number() -> None:
    far = Rotated.towards(Patch(), (1e308, 1e308, 0.0))
    np.testing.assert_allclose(far.x_axis, Rotated.towards(Patch(), (1.0, 1.0, 0.0)).x_axis)
    assert HalfWaveDipole(axis=(0.0, 5e-324, 0.0)) == HalfWaveDipole(axis=(0.0, 1.0, 0.0))


def test_the_pattern_of_an_array_is_the_same_in_blocks(monkeypatch: pytest.MonkeyPatch) -> None:
    array = AntennaArray.planar(4, 3, Patch()).steered((1.0, 0.3, 0.1))
    at = np.meshgrid(np.linspace(-1.0, 1.0, 9), np.linspace(0.0, 6.0, 11), indexing="ij")
    whole = array.amplitudes(*at)
    monkeypatch.setattr(antenna_array, "BLOCK", 50)
    np.testing.assert_allclose(array.amplitudes(*at), whole, rtol=1e-12, atol=1e-15)


def test_the_message_about_a_directive_antenna_names_it() -> None:
    with pytest.raises(SceneError, match=r"patch, permittivity 2\.2"):
        vertical_amplitude(Patch(), np.zeros(3))
