"""Slab coefficients against published values, a transmission line, and the laws they obey."""

import brute_force_field
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from raytrace.constants import SPEED_OF_LIGHT
from raytrace.radio.materials import MATERIALS, Layer, Layered, Slab
from raytrace.radio.slabs import slab_coefficients
from raytrace.radio.tables import SLAB_TABLE_STEPS, slab_tables

F_HZ = 2.4e9
WAVELENGTH_M = SPEED_OF_LIGHT / F_HZ
KNOWN = sorted(
    name
    for name, material in MATERIALS.items()
    if any(row.low_ghz <= F_HZ * 1e-9 <= row.high_ghz for row in material.rows)
)
LOSSY = sorted(set(KNOWN) - {"metal", "vacuum", "air"})

names = st.sampled_from(LOSSY)
thicknesses = st.floats(1e-3, 0.5)
cosines = st.floats(1e-6, 1.0)


def coefficients(name: str, thickness_m: float, cos_i: float | np.ndarray):
    permittivity = MATERIALS[name].complex_permittivity(F_HZ)
    return slab_coefficients(permittivity, thickness_m, F_HZ, np.atleast_1d(cos_i))


@pytest.mark.parametrize(
    ("degrees", "te", "tm"),
    [
        (0.0, (-7.18, -8.10), (-7.18, -8.10)),
        (45.0, (-4.63, -9.95), (-10.10, -7.60)),
        (60.0, (-3.36, -11.82), (-17.82, -7.17)),
    ],
)
def test_concrete_of_10_cm(
    degrees: float, te: tuple[float, float], tm: tuple[float, float]
) -> None:
    c = coefficients("concrete", 0.10, np.cos(np.radians(degrees)))
    levels = 20.0 * np.log10(np.abs([c.r_te[0], c.t_te[0], c.r_tm[0], c.t_tm[0]]))
    np.testing.assert_allclose(levels, [*te, *tm], atol=0.01)


@given(name=names, thickness_m=thicknesses, cos_i=cosines)
def test_a_slab_is_a_piece_of_transmission_line(
    name: str, thickness_m: float, cos_i: float
) -> None:
    permittivity = MATERIALS[name].complex_permittivity(F_HZ)
    line = brute_force_field.slab(permittivity, thickness_m, WAVELENGTH_M, np.array([cos_i]))
    np.testing.assert_allclose(coefficients(name, thickness_m, cos_i), line, atol=1e-9)


@given(name=names, thickness_m=thicknesses, cos_i=cosines)
def test_no_more_leaves_a_slab_than_arrives(name: str, thickness_m: float, cos_i: float) -> None:
    c = coefficients(name, thickness_m, cos_i)
    for r, t in ((c.r_te, c.t_te), (c.r_tm, c.t_tm)):
        assert abs(r[0]) ** 2 + abs(t[0]) ** 2 <= 1.0 + 1e-12


@given(permittivity=st.floats(1.0, 12.0), thickness_m=thicknesses, cos_i=cosines)
def test_a_slab_without_loss_keeps_the_power(
    permittivity: float, thickness_m: float, cos_i: float
) -> None:
    c = slab_coefficients(complex(permittivity), thickness_m, F_HZ, np.array([cos_i]))
    for r, t in ((c.r_te, c.t_te), (c.r_tm, c.t_tm)):
        assert abs(r[0]) ** 2 + abs(t[0]) ** 2 == pytest.approx(1.0, abs=1e-9)


@given(permittivity=st.floats(1.5, 12.0), thickness_m=thicknesses)
def test_the_parallel_polarisation_vanishes_at_brewsters_angle(
    permittivity: float, thickness_m: float
) -> None:
    """tan theta = sqrt(eps_r) on both faces of a slab at once."""
    cos_brewster = 1.0 / np.sqrt(1.0 + permittivity)
    c = slab_coefficients(complex(permittivity), thickness_m, F_HZ, np.array([cos_brewster]))
    assert abs(c.r_tm[0]) < 1e-12
    assert abs(c.t_tm[0]) == pytest.approx(1.0)


@given(name=names, thickness_m=thicknesses)
def test_polarisations_are_one_at_normal_incidence(name: str, thickness_m: float) -> None:
    c = coefficients(name, thickness_m, 1.0)
    assert c.r_te[0] == pytest.approx(-c.r_tm[0])
    assert c.t_te[0] == pytest.approx(c.t_tm[0])


@pytest.mark.parametrize("name", LOSSY)
def test_everything_is_a_mirror_at_grazing_incidence(name: str) -> None:
    c = coefficients(name, 0.1, 0.0)
    assert c.r_te[0] == pytest.approx(-1.0, abs=1e-6)
    assert c.r_tm[0] == pytest.approx(-1.0, abs=1e-6)


@given(cos_i=st.floats(0.05, 1.0))
def test_metal_is_a_perfect_conductor(cos_i: float) -> None:
    c = coefficients("metal", 0.01, cos_i)
    assert c.r_te[0] == pytest.approx(-1.0, abs=1e-2)
    assert c.r_tm[0] == pytest.approx(1.0, abs=1e-2)
    assert abs(c.t_te[0]) < 1e-12 > abs(c.t_tm[0])


@given(thickness_m=thicknesses, cos_i=cosines)
def test_a_slab_of_vacuum_is_not_there(thickness_m: float, cos_i: float) -> None:
    c = coefficients("vacuum", thickness_m, cos_i)
    assert abs(c.r_te[0]) < 1e-9 > abs(c.r_tm[0])
    delay = np.exp(-2j * np.pi / WAVELENGTH_M * thickness_m * cos_i)
    np.testing.assert_allclose([c.t_te[0], c.t_tm[0]], delay, atol=1e-9)


@pytest.mark.parametrize("name", KNOWN)
def test_the_table_holds_both_polarisations(name: str) -> None:
    (table,) = slab_tables([(name, 0.1)], F_HZ)
    cos_i = np.linspace(0.0, 1.0, SLAB_TABLE_STEPS + 1)
    c = coefficients(name, 0.1, cos_i)
    tm, mix = table[:-1, 0] + 1j * table[:-1, 1], table[:-1, 2] + 1j * table[:-1, 3]
    np.testing.assert_allclose(tm, c.r_tm, atol=1e-12)
    np.testing.assert_allclose(mix * (1.0 - cos_i**2) - tm, c.r_te, atol=1e-9)


COSINES = np.linspace(0.05, 1.0, 40)
CAVITY_WALL = Layered(
    "cavity_wall",
    tuple(
        Layer(MATERIALS[name], thickness_m)
        for name, thickness_m in (("brick", 0.09), ("air", 0.192), ("plasterboard", 0.016))
    ),
)
REVERSED = Layered("reversed", CAVITY_WALL.layers[::-1])


@pytest.mark.parametrize("frequency_hz", [1.8e9, 2.4e9, 5.2e9])
def test_a_wall_transmits_like_its_layers_and_reflects_the_mean_power_of_its_sides(
    frequency_hz: float,
) -> None:
    front, back, wall = (
        material.coefficients(0.298, frequency_hz, COSINES)
        for material in (CAVITY_WALL, REVERSED, Slab.of(CAVITY_WALL, 0.298).as_wall().material)
    )
    for name in ("t_te", "t_tm"):
        np.testing.assert_allclose(getattr(back, name), getattr(front, name), atol=1e-12)
        np.testing.assert_array_equal(getattr(wall, name), getattr(front, name))
    for t, r in (("t_te", "r_te"), ("t_tm", "r_tm")):
        powers = [np.abs(getattr(side, r)) ** 2 for side in (front, back, wall)]
        np.testing.assert_allclose(powers[2], (powers[0] + powers[1]) / 2, rtol=1e-12)
        assert np.all(powers[2] + np.abs(getattr(wall, t)) ** 2 < 1.0)
    assert wall.r_te[-1] == pytest.approx(-wall.r_tm[-1])


def test_a_wall_of_layers_is_the_same_from_either_side() -> None:
    one, other = (
        Slab.of(material, 0.298).as_wall().material.coefficients(0.298, 2.4e9, COSINES)
        for material in (CAVITY_WALL, REVERSED)
    )
    for a, b in zip(one, other, strict=True):
        np.testing.assert_allclose(a, b, atol=1e-12)
