"""Layered slabs against textbook multilayers, and the laws that every slab obeys."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from raytrace.constants import SPEED_OF_LIGHT
from raytrace.errors import SceneError
from raytrace.materials import (
    ABSORBER,
    PERFECT_CONDUCTOR,
    SLAB_TABLE_STEPS,
    Dielectric,
    Layer,
    Layered,
    Slab,
    slab_tables,
    transmission_tables,
)
from raytrace.slabs import SlabCoefficients, slab_coefficients, stack_coefficients

F_HZ = 2.4e9
WAVELENGTH_M = SPEED_OF_LIGHT / F_HZ
NORMAL = np.array([1.0])

cosines = st.floats(1e-3, 1.0)
lossless = st.tuples(st.floats(1.0, 12.0).map(complex), st.floats(1e-3, 0.3))
lossy = st.tuples(
    st.builds(complex, st.floats(1.0, 12.0), st.floats(-5.0, 0.0)), st.floats(1e-3, 0.3)
)
stacks = st.lists(lossy, min_size=1, max_size=4)


def polarisations(c: SlabCoefficients) -> tuple[tuple[complex, complex], tuple[complex, complex]]:
    return (c.r_te[0], c.t_te[0]), (c.r_tm[0], c.t_tm[0])


def chain_matrix(stack: list[tuple[complex, float]], cos_i: float) -> SlabCoefficients:
    """Coefficients by the product of the layers' ABCD matrices (Born and Wolf, section 1.6)."""
    found = []
    for of_te in (True, False):
        whole = np.eye(2, dtype=complex)
        for permittivity, thickness_m in stack:
            q = np.sqrt(permittivity - 1.0 + cos_i**2)
            y = q if of_te else permittivity / q
            turn = 2.0 * np.pi / WAVELENGTH_M * q * thickness_m
            layer = [[np.cos(turn), 1j * np.sin(turn) / y], [1j * y * np.sin(turn), np.cos(turn)]]
            whole = whole @ np.array(layer)
        y = cos_i if of_te else 1.0 / cos_i
        electric, magnetic = whole @ (1.0, y)
        found.append((y * electric - magnetic) / (y * electric + magnetic))
        found.append(2.0 * y / (y * electric + magnetic))
    r_te, t_te, r_tm, t_tm = (np.array([value]) for value in found)
    return SlabCoefficients(r_te, -r_tm, t_te, t_tm)


@given(stack=stacks, cos_i=cosines)
def test_layers_are_the_product_of_their_matrices(
    stack: list[tuple[complex, float]], cos_i: float
) -> None:
    c = stack_coefficients(stack, F_HZ, np.array([cos_i]))
    np.testing.assert_allclose(c, chain_matrix(stack, cos_i), atol=1e-9)


@given(layer=lossy, share=st.floats(0.1, 0.9), cos_i=cosines)
def test_a_slab_may_be_cut_into_layers(
    layer: tuple[complex, float], share: float, cos_i: float
) -> None:
    permittivity, d = layer
    cut = [(permittivity, share * d), (permittivity, (1.0 - share) * d)]
    whole = slab_coefficients(permittivity, d, F_HZ, np.array([cos_i]))
    parts = stack_coefficients(cut, F_HZ, np.array([cos_i]))
    np.testing.assert_allclose(parts, whole, atol=1e-9)


@given(stack=st.lists(lossless, min_size=1, max_size=4), cos_i=cosines)
def test_layers_without_loss_keep_the_power(
    stack: list[tuple[complex, float]], cos_i: float
) -> None:
    for r, t in polarisations(stack_coefficients(stack, F_HZ, np.array([cos_i]))):
        assert abs(r) ** 2 + abs(t) ** 2 == pytest.approx(1.0, abs=1e-9)


@given(stack=stacks, cos_i=cosines)
def test_layers_with_loss_take_some(stack: list[tuple[complex, float]], cos_i: float) -> None:
    for r, t in polarisations(stack_coefficients(stack, F_HZ, np.array([cos_i]))):
        assert abs(r) ** 2 + abs(t) ** 2 <= 1.0 + 1e-9


@given(stack=stacks, cos_i=cosines)
def test_transmission_is_reciprocal(stack: list[tuple[complex, float]], cos_i: float) -> None:
    there = stack_coefficients(stack, F_HZ, np.array([cos_i]))
    back = stack_coefficients(stack[::-1], F_HZ, np.array([cos_i]))
    assert there.t_te[0] == pytest.approx(back.t_te[0], abs=1e-9)
    assert there.t_tm[0] == pytest.approx(back.t_tm[0], abs=1e-9)


@given(stack=stacks)
def test_polarisations_are_one_at_normal_incidence(stack: list[tuple[complex, float]]) -> None:
    c = stack_coefficients(stack, F_HZ, NORMAL)
    assert c.r_te[0] == pytest.approx(-c.r_tm[0], abs=1e-9)
    assert c.t_te[0] == pytest.approx(c.t_tm[0], abs=1e-9)


def quarter_wave(permittivity: float) -> tuple[complex, float]:
    return complex(permittivity), WAVELENGTH_M / (4.0 * np.sqrt(permittivity))


def test_a_quarter_wave_slab_reflects_most() -> None:
    """r = (1 - eps) / (1 + eps)."""
    c = stack_coefficients([quarter_wave(4.0)], F_HZ, NORMAL)
    assert c.r_te[0] == pytest.approx((1.0 - 4.0) / (1.0 + 4.0))


def test_a_half_wave_slab_is_transparent() -> None:
    permittivity, d = quarter_wave(4.0)
    c = stack_coefficients([(permittivity, 2.0 * d)], F_HZ, NORMAL)
    assert abs(c.r_te[0]) < 1e-12
    assert c.t_te[0] == pytest.approx(-1.0)


def test_a_quarter_wave_coat_stops_reflection() -> None:
    """A coat with the square root of the core's permittivity on both sides of a half-wave core."""
    coat, core = quarter_wave(2.0), (complex(4.0), WAVELENGTH_M / 4.0)
    c = stack_coefficients([coat, core, coat], F_HZ, NORMAL)
    assert abs(c.r_te[0]) < 1e-12


@pytest.mark.parametrize("pairs", [1, 3, 6])
def test_a_bragg_mirror_reflects_as_the_textbook_says(pairs: int) -> None:
    """Input admittance (eps_high / eps_low)^pairs in air (Born and Wolf, eq. 1.6.(93))."""
    high, low = quarter_wave(5.0), quarter_wave(2.0)
    c = stack_coefficients([high, low] * pairs, F_HZ, NORMAL)
    y = (5.0 / 2.0) ** pairs
    assert c.r_te[0] == pytest.approx((1.0 - y) / (1.0 + y))


def test_metal_as_thick_as_a_wall_is_no_numerical_problem() -> None:
    c = slab_coefficients(complex(1.0, -7.5e7), 0.3, F_HZ, np.array([1e-6, 0.5, 1.0]))
    np.testing.assert_allclose(c.r_te, -1.0, atol=1e-3)
    np.testing.assert_array_equal(c.t_te, 0.0)


@given(cos_i=st.floats(0.0, 1.0), thickness_m=st.floats(1e-3, 1.0))
def test_ideals_are_ideal(cos_i: float, thickness_m: float) -> None:
    mirror = PERFECT_CONDUCTOR.coefficients(thickness_m, F_HZ, np.array([cos_i]))
    assert (mirror.r_te[0], mirror.r_tm[0]) == (-1.0, 1.0)
    nothing = ABSORBER.coefficients(thickness_m, F_HZ, np.array([cos_i]))
    assert not any(abs(value[0]) for value in (*mirror[2:], *nothing))


BOARD = Dielectric.of_law("board", 2.7, 0.0, 0.01, 0.9)
AIR = Dielectric.of_law("air", 1.0)
STUDS = Layered("studs", (Layer(BOARD, 0.0125), Layer(AIR, 0.075), Layer(BOARD, 0.0125)))


def test_two_boards_of_no_gap_are_one_board() -> None:
    pair = Layered("pair", (Layer(BOARD, 0.01), Layer(BOARD, 0.01)))
    np.testing.assert_allclose(
        slab_tables([(pair, 0.02)], F_HZ), slab_tables([(BOARD, 0.02)], F_HZ), atol=1e-9
    )


def test_transmission_tables_hold_both_polarisations() -> None:
    (table,) = transmission_tables([(STUDS, 0.1)], F_HZ)
    cos_i = np.linspace(0.0, 1.0, SLAB_TABLE_STEPS + 1)
    c = STUDS.coefficients(0.1, F_HZ, cos_i).relative_to_air(0.1, F_HZ, cos_i)
    tm, mix = table[:-1, 0] + 1j * table[:-1, 1], table[:-1, 2] + 1j * table[:-1, 3]
    np.testing.assert_allclose(tm, c.t_tm, atol=1e-12)
    np.testing.assert_allclose(mix * (1.0 - cos_i**2) + tm, c.t_te, atol=1e-9)
    assert np.abs(np.diff(mix, 2)[-100:]).max() < 1e-5


def test_a_ray_does_not_notice_a_sheet_of_air() -> None:
    (table,) = transmission_tables([("air", 0.3)], F_HZ)
    np.testing.assert_allclose(
        table[1:], np.broadcast_to((1.0, 0.0, 0.0, 0.0), table[1:].shape), atol=1e-9
    )


def test_tables_of_ideals() -> None:
    reflection = slab_tables([("perfect_conductor", 0.1), ("absorber", 0.1)], F_HZ)
    np.testing.assert_array_equal(reflection[0], [(1.0, 0.0, 0.0, 0.0)] * (SLAB_TABLE_STEPS + 2))
    assert not reflection[1].any()
    assert not transmission_tables([("perfect_conductor", 0.1)], F_HZ).any()


def test_layers_must_be_as_thick_as_said() -> None:
    with pytest.raises(SceneError, match=r"studs of thickness 0.2 m: its layers are 0.1 m thick"):
        Slab.of(STUDS, 0.2)
