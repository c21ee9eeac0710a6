"""Antenna patterns: components, normalisation, tables, and patterns from files."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import ArrayLike, NDArray

from raytrace import (
    DIPOLE_PEAK_GAIN_DBI,
    Antenna,
    AntennaError,
    HalfWaveDipole,
    Isotropic,
    PatternTable,
    SceneError,
)
from raytrace.radio.antennas import Amplitudes, vertical_amplitude
from raytrace.radio.tables import AZIMUTH_STEPS, ELEVATION_STEPS, pattern_tables

Floats = NDArray[np.float64]

ANTENNAS: list[Antenna] = [
    HalfWaveDipole(),
    HalfWaveDipole(2.15, (1.0, 0.0, 0.0)),
    HalfWaveDipole(axis=(0.3, -0.5, 0.8)),
    Isotropic(-3.0),
]
parts = st.floats(-1.0, 1.0)
directions = st.tuples(parts, parts, parts).filter(lambda v: np.linalg.norm(v) > 0.1)


def unit(vector: tuple[float, float, float] | Floats) -> Floats:
    return np.asarray(vector) / np.linalg.norm(vector, axis=-1, keepdims=True)


def table_coordinates(direction: ArrayLike) -> tuple[Floats, Floats]:
    """Row and column of directions (..., 3) on the grid of `pattern_tables`."""
    x, y, z = np.moveaxis(np.asarray(direction, dtype=np.float64), -1, 0)
    row = (1.0 + z / (np.abs(z) + np.hypot(x, y))) * (0.5 * ELEVATION_STEPS)
    part = np.abs(y) / np.maximum(np.abs(x) + np.abs(y), 1e-300)
    turn = np.where(x >= 0.0, np.where(y >= 0.0, part, 4.0 - part), 0.0)
    turn = np.where(x < 0.0, np.where(y >= 0.0, 2.0 - part, 2.0 + part), turn)
    return row, turn * (0.25 * AZIMUTH_STEPS)


def look_up(
    tables: tuple[NDArray[np.complex128], NDArray[np.complex128]], direction: ArrayLike
) -> Amplitudes:
    """Interpolate the tables of an antenna in directions (..., 3), as the kernels do."""
    row, column = table_coordinates(direction)
    i = np.minimum(row.astype(np.int64), ELEVATION_STEPS - 1)
    j = np.minimum(column.astype(np.int64), AZIMUTH_STEPS - 1)
    down, across = row - i, column - j
    v, h = (
        (1.0 - down) * ((1.0 - across) * t[i, j] + across * t[i, j + 1])
        + down * ((1.0 - across) * t[i + 1, j] + across * t[i + 1, j + 1])
        for t in tables
    )
    return Amplitudes(v, h)


def around_the_sphere(n: int) -> Floats:
    """Unit vectors (n, 3), evenly spread (Fibonacci)."""
    z = 1.0 - (2.0 * np.arange(n) + 1.0) / n
    turn = np.pi * (3.0 - np.sqrt(5.0)) * np.arange(n)
    c = np.sqrt(1.0 - z**2)
    return np.column_stack([c * np.cos(turn), c * np.sin(turn), z])


def field(antenna: Antenna, direction: Floats) -> NDArray[np.complex128]:
    """Vector field (n, 3) towards directions (n, 3), from the two components."""
    x, y, z = direction.T
    azimuth = np.arctan2(y, x)
    v, h = antenna.amplitudes(z, azimuth)
    c = np.sqrt(1.0 - z**2)
    tau = np.column_stack([-z * np.cos(azimuth), -z * np.sin(azimuth), c])
    psi = np.column_stack([-np.sin(azimuth), np.cos(azimuth), 0.0 * z])
    return np.asarray(v)[:, None] * tau + np.asarray(h)[:, None] * psi


@given(axis=directions, direction=directions)
def test_a_dipole_radiates_along_the_projection_of_its_wire(
    axis: tuple[float, float, float], direction: tuple[float, float, float]
) -> None:
    d, s = unit(axis), unit(direction)
    cos_chi = float(d @ s)
    sin2 = max(float((np.cross(d, s) ** 2).sum()), 1e-30)
    cosine = np.sin(0.5 * np.pi * sin2 / (1.0 + abs(cos_chi)))  # of pi / 2 times cos_chi
    expected = cosine / sin2 * (d - cos_chi * s)
    found = field(HalfWaveDipole(axis=tuple(d)), s[None])[0]
    np.testing.assert_allclose(found, expected, atol=1e-6)


def test_a_dipole_radiates_almost_nothing_almost_along_its_wire() -> None:
    d, s = unit((0.0, -1.0, -1.0)), unit((0.0, -1.0, -0.99999))
    size = np.linalg.norm(field(HalfWaveDipole(axis=tuple(d)), s[None])[0])
    assert size == pytest.approx(0.25 * np.pi * np.linalg.norm(np.cross(d, s)), rel=1e-4)


def test_a_vertical_dipole_is_the_textbook_pattern() -> None:
    theta = np.linspace(0.01, np.pi - 0.01, 99)
    v, h = HalfWaveDipole().amplitudes(np.cos(theta), 0.7 + 0.0 * theta)
    expected = np.cos(0.5 * np.pi * np.cos(theta)) / np.sin(theta)
    np.testing.assert_allclose(v, expected, rtol=1e-9)
    assert not h.any()


@pytest.mark.parametrize("axis", [(0, 0, 1), (1, 0, 0), (1, 2, -3)])
def test_a_lossless_dipole_radiates_what_it_is_fed(axis: tuple[float, float, float]) -> None:
    s = around_the_sphere(20_000)
    gain = (np.abs(field(HalfWaveDipole(DIPOLE_PEAK_GAIN_DBI, axis), s)) ** 2).sum(axis=1)
    assert gain.mean() == pytest.approx(1.0, abs=1e-4)
    assert 10.0 * np.log10(gain.max()) == pytest.approx(DIPOLE_PEAK_GAIN_DBI, abs=1e-3)


@pytest.mark.parametrize("antenna", ANTENNAS)
def test_tables_hold_the_pattern_to_1e_4(antenna: Antenna) -> None:
    s = np.concatenate([around_the_sphere(20_000), np.eye(3), 0.0 - np.eye(3)])
    found = look_up(pattern_tables(antenna), s)
    exact = antenna.amplitudes(s[:, 2], np.arctan2(s[:, 1], s[:, 0]))
    assert np.abs(found.v - exact.v).max() < 1e-4
    assert np.abs(found.h - exact.h).max() < 1e-4


def test_tables_close_around_the_vertical() -> None:
    for part in pattern_tables(HalfWaveDipole(axis=(0.3, -0.5, 0.8))):
        assert part.shape == (ELEVATION_STEPS + 1, AZIMUTH_STEPS + 1)
        np.testing.assert_allclose(part[:, 0], part[:, -1], atol=1e-12)


def test_the_tracer_says_which_antennas_it_takes() -> None:
    with pytest.raises(SceneError, match=r"along \(1, 0, 0\).*the same in all azimuths"):
        vertical_amplitude(HalfWaveDipole(axis=(1.0, 0.0, 0.0)), np.linspace(-1.0, 1.0, 9))


@pytest.mark.parametrize("axis", [(0.0, 0.0, 0.0), (np.nan, 0.0, 1.0)])
def test_an_axis_is_a_direction(axis: tuple[float, float, float]) -> None:
    with pytest.raises(ValueError, match="expected three finite numbers"):
        HalfWaveDipole(axis=axis)


THETA, PHI = np.linspace(0.0, 180.0, 37), np.linspace(0.0, 360.0, 25)
PATCH_DBI = 6.0 * np.cos(np.radians(THETA))[:, None] - 2.0 * np.cos(np.radians(PHI))


def test_a_gain_table_is_met_at_its_nodes() -> None:
    antenna = PatternTable.of_gain(THETA, PHI, PATCH_DBI)
    theta, phi = np.meshgrid(np.radians(THETA[1:-1]), np.radians(PHI[:-1]), indexing="ij")
    v, h = antenna.amplitudes(np.cos(theta), phi)
    np.testing.assert_allclose(20.0 * np.log10(np.abs(v)), PATCH_DBI[1:-1, :-1], atol=1e-9)
    assert (v.real > 0.0).all()
    assert not h.any()


def test_a_dipole_as_a_table_is_the_dipole() -> None:
    theta, phi = np.linspace(0.0, 180.0, 181), np.linspace(0.0, 360.0, 181)
    dipole = HalfWaveDipole(DIPOLE_PEAK_GAIN_DBI, (1.0, 1.0, 0.5))
    v, h = dipole.amplitudes(
        *np.meshgrid(np.cos(np.radians(theta)), np.radians(phi), indexing="ij")
    )
    antenna = PatternTable(theta, phi, -v + 0j, h + 0j)
    s = around_the_sphere(999)
    np.testing.assert_allclose(field(antenna, s), field(dipole, s), atol=1e-3)
    assert antenna.mean_gain == pytest.approx(1.0, abs=1e-3)


def write_csv(path: Path, columns: dict[str, Floats]) -> Path:
    rows = np.column_stack(list(columns.values()))
    lines = [",".join(columns), *(",".join(map(repr, row)) for row in rows.tolist())]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def grid_columns() -> dict[str, Floats]:
    theta, phi = np.meshgrid(THETA, PHI, indexing="ij")
    return {"theta_deg": theta.ravel(), "phi_deg": phi.ravel()}


def test_a_gain_is_read_from_csv_in_any_order(tmp_path: Path) -> None:
    columns = {**grid_columns(), "gain_dbi": PATCH_DBI.ravel()}
    shuffled = np.random.default_rng(7).permutation(PATCH_DBI.size)
    path = write_csv(tmp_path / "patch.csv", {k: v[shuffled] for k, v in columns.items()})
    assert PatternTable.from_csv(path) == PatternTable.of_gain(THETA, PHI, PATCH_DBI)


def test_components_with_phase_are_read_from_csv(tmp_path: Path) -> None:
    flat = np.full(PATCH_DBI.size, -3.0)
    gains = {"gain_theta_dbi": flat, "gain_phi_dbi": flat}
    columns = {**grid_columns(), **gains, "phase_phi_deg": 0.0 * flat + 90.0}
    antenna = PatternTable.from_csv(write_csv(tmp_path / "circular.csv", columns))
    np.testing.assert_allclose(antenna.e_phi, 1j * antenna.e_theta)
    assert antenna.mean_gain == pytest.approx(2.0 * 10.0**-0.3, rel=1e-2)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "columns none: expected theta_deg"),
        ("theta_deg,phi_deg\n0,0\n", "columns theta_deg, phi_deg: expected"),
        ("theta_deg,phi_deg,gain_dbi\n0,0,x\n", "line 2: gain_dbi = 'x': expected a number"),
        (
            "theta_deg,phi_deg,gain_dbi\n0,0,1\n180,360,1\n",
            "no line for theta_deg = 0, phi_deg = 360",
        ),
        (
            "theta_deg,phi_deg,gain_dbi\n0,0,1\n90,0,1\n0,360,1\n90,360,1\n",
            "theta_deg runs from 0 to 90: expected rising values from 0 to 180",
        ),
    ],
)
def test_a_wrong_file_is_refused(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "antenna.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(AntennaError) as caught:
        PatternTable.from_csv(path)
    assert "antenna.csv" in str(caught.value)
    assert message in str(caught.value)


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(AntennaError, match=r"none\.csv: the file cannot be read"):
        PatternTable.from_csv(tmp_path / "none.csv")
