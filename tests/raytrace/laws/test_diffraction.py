"""The uniform theory against exact solutions, and the tracer's field across shadow boundaries."""

from dataclasses import replace

import brute_force_field
import numpy as np
import pytest
from buildings import CONCRETE, PLASTERBOARD, Building, Sheet, box, wall
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.special import fresnel, jv

from raytrace import TraceConfig, Transmitter, trace_paths
from raytrace.kernels.utd import TRANSITION_MAX, TRANSITION_STEPS
from raytrace.radio.tables import transition_table

Floats = NDArray[np.float64]
SOFT, HARD = 0, 1
CONDUCTOR = (-1.0, 1.0)


@pytest.mark.parametrize(
    ("x", "value"),
    [
        (0.01, 0.12421 + 0.10658j),
        (0.1, 0.36810 + 0.23445j),
        (0.3, 0.57171 + 0.27299j),
        (1.0, 0.80953 + 0.23220j),
        (3.0, 0.94724 + 0.13258j),
        (10.0, 0.99304 + 0.04835j),
    ],
)
def test_transition_function_has_its_published_values(x: float, value: complex) -> None:
    assert brute_force_field.transition(np.array(x)) == pytest.approx(value, abs=1e-5)


def test_the_table_is_the_transition_function_over_its_root() -> None:
    s = np.arange(1, TRANSITION_STEPS + 2) * (TRANSITION_MAX / TRANSITION_STEPS)
    table = transition_table()[1:]
    expected = brute_force_field.transition(s**2) / s
    np.testing.assert_allclose(table[:, 0] + 1j * table[:, 1], expected, rtol=1e-9)


def uniform_field(n: float, phi: float, phi_in: float, kr: float, kind: int) -> complex:
    """Plane wave on a perfectly conducting wedge: rays, and the uniform theory's edge wave."""
    field = 0j
    if abs(phi - phi_in) < np.pi:
        field += np.exp(1j * kr * np.cos(phi - phi_in))
    for face in (0.0, n * np.pi):
        if abs(phi - face) + abs(phi_in - face) < np.pi:
            field += CONDUCTOR[kind] * np.exp(1j * kr * np.cos(phi + phi_in - 2.0 * face))
    angles = np.array([phi_in]), np.array([phi])
    one = np.ones(1)
    faces = (brute_force_field.CONDUCTOR,) * 2
    edge = brute_force_field.wedge(n, angles, one, kr * one, faces)[0, kind, kind]
    return field + edge * np.exp(-1j * kr) / np.sqrt(kr)


def half_plane_field(phi: float, phi_in: float, kr: float, kind: int) -> complex:
    """Sommerfeld's exact solution."""

    def lit(angle: float) -> complex:
        x = np.sqrt(2.0 * kr) * np.cos(0.5 * angle)
        sine, cosine = fresnel(x * np.sqrt(2.0 / np.pi))
        integral = np.sqrt(0.5 * np.pi) * ((cosine + 0.5) - 1j * (sine + 0.5))
        return np.exp(0.25j * np.pi) / np.sqrt(np.pi) * integral * np.exp(1j * kr * np.cos(angle))

    return lit(phi - phi_in) + CONDUCTOR[kind] * lit(phi + phi_in)


def wedge_field(n: float, phi: float, phi_in: float, kr: float, kind: int) -> complex:
    """The exact series of Bessel functions (Balanis 1989, eqs. 11-180 to 11-189)."""
    m = np.arange(int(n * (kr + 60)))
    nu = m / n
    wave = np.sin if kind == SOFT else np.cos
    weight = np.where(m == 0, 1.0, 2.0) * 2.0 / n
    terms = weight * np.exp(0.5j * np.pi * nu) * jv(nu, kr) * wave(nu * phi) * wave(nu * phi_in)
    return complex(terms.sum())


angles = st.floats(0.02, 0.98)


@given(phi=angles, phi_in=angles, kr=st.floats(0.5, 500.0), kind=st.sampled_from([SOFT, HARD]))
def test_the_half_plane_is_sommerfelds(phi: float, phi_in: float, kr: float, kind: int) -> None:
    turn = 2.0 * np.pi
    phi, phi_in = phi * turn, phi_in * turn
    if abs(abs(phi - phi_in) - np.pi) > 1e-6 and abs(abs(phi + phi_in - turn) - np.pi) > 1e-6:
        exact = half_plane_field(phi, phi_in, kr, kind)
        assert uniform_field(2.0, phi, phi_in, kr, kind) == pytest.approx(exact, abs=1e-6)


@pytest.mark.parametrize("kind", [SOFT, HARD])
@pytest.mark.parametrize("n", [1.5, 1.75, 1.25])
def test_the_wedge_is_close_to_its_series(n: float, kind: int) -> None:
    """The uniform theory drops terms of higher order in 1 / kr: 1e-2 at kr = 50."""
    rng = np.random.default_rng(31)
    for phi, phi_in in n * np.pi * rng.uniform(0.1, 0.9, (40, 2)):
        exact = wedge_field(n, phi, phi_in, 50.0, kind)
        assert uniform_field(n, phi, phi_in, 50.0, kind) == pytest.approx(exact, abs=1e-2)


VACUUM = 4
METAL = 5
SLABS = (
    ("concrete", 0.2), ("plasterboard", 0.1), ("glass", 0.01), ("ceiling_board", 0.02),
    ("vacuum", 0.1), ("metal", 0.05),
)  # fmt: skip
HALL_HEIGHT_M = 12.0
TIP = (20.0, 20.0)
SCREENS = {"absorbing": VACUUM, "concrete": CONCRETE, "metal": METAL}


def hall(*inside: Sheet) -> Building:
    """Return walls in a hall of 40 m x 40 m whose own walls reflect nothing."""
    empty = box(40.0, 40.0, height=HALL_HEIGHT_M)
    outside = tuple(s._replace(slab=VACUUM) for s in empty.sheets)
    sheets = (*outside, *inside)
    return replace(empty, sheets=sheets, slabs=SLABS, floor=VACUUM, ceiling=VACUUM)


def vertical(slab: int) -> Building:
    return hall(*wall((20.0, 0.0), TIP, slab=slab, high=HALL_HEIGHT_M))


def corner(slab: int) -> Building:
    legs = ((20.0, 0.0), (0.0, 20.0))
    return hall(*(s for a in legs for s in wall(a, TIP, slab=slab, high=HALL_HEIGHT_M)))


def lintel(slab: int) -> Building:
    return hall(*wall((20.0, 0.0), (20.0, 40.0), slab=slab, low=6.0, high=HALL_HEIGHT_M))


def total_field(building: Building, source: Floats, receivers: Floats, walls: int = 0) -> Floats:
    limits = TraceConfig(1, 1, walls)
    paths = trace_paths(building.scene, Transmitter(tuple(source)), receivers, limits)
    field = np.zeros(len(receivers), dtype=np.complex128)
    np.add.at(field, paths.receiver, paths.gain)
    return field


def jump_db(
    building: Building, source: Floats, middle: Floats, sideways: Floats, walls: int = 0
) -> float:
    """Largest step of the field over a boundary through `middle`, both sides extrapolated to it."""
    steps = np.array([1e-6, 1e-5, 1e-4, 1e-3])
    offsets = np.concatenate([side * near * steps for side in (-1, 1) for near in (1, 2, 3)])
    receivers = middle + offsets[:, None] * sideways
    field = total_field(building, source, receivers, walls).reshape(2, 3, -1)
    carried_on = 3.0 * field[:, 0] - 3.0 * field[:, 1] + field[:, 2]
    return float(np.abs(20.0 * np.log10(np.abs(carried_on[0] / carried_on[1]))).max())


EDGES = {
    "vertical, horizontal rays": (vertical, np.array([14.0, 14.0, 5.0]), (20.0, 20.0, 5.0)),
    "vertical, sloped rays": (vertical, np.array([14.0, 16.0, 4.0]), (20.0, 20.0, 6.0)),
    "corner of 270 degrees": (corner, np.array([26.0, 12.0, 4.0]), (20.0, 20.0, 5.0)),
    "lintel": (lintel, np.array([14.0, 20.5, 3.0]), (20.0, 20.0, 6.0)),
    "lintel, skew rays": (lintel, np.array([14.0, 15.5, 4.0]), (20.0, 20.0, 6.0)),
}


def beyond(source: Floats, tip: Floats, mirror: tuple[float, ...]) -> tuple[Floats, Floats]:
    """Return a point behind an edge on the line from the (mirrored) source, and a side step."""
    ray = (tip - source) * np.array(mirror)
    edge = np.array([0.0, 0.0, 1.0]) if ray[2] == 0 or tip[2] < 6.0 else np.array([0.0, 1.0, 0.0])
    sideways = np.cross(ray, edge)
    return tip + 0.8 * ray, sideways / np.linalg.norm(sideways)


@pytest.mark.parametrize("screen", SCREENS)
@pytest.mark.parametrize("edge", EDGES)
@pytest.mark.parametrize("boundary", ["incident", "reflected"])
def test_the_field_has_no_step_at_a_shadow_boundary(edge: str, screen: str, boundary: str) -> None:
    build, source, tip = EDGES[edge]
    mirror = (1.0, 1.0, 1.0) if boundary == "incident" else (-1.0, 1.0, 1.0)
    middle, sideways = beyond(source, np.array(tip), mirror)
    assert jump_db(build(SCREENS[screen]), source, middle, sideways) < 0.01


@pytest.mark.parametrize("edge", EDGES)
def test_half_the_field_is_left_on_an_incident_boundary(edge: str) -> None:
    """Nothing is reflected by an absorbing screen; what is off 6.02 dB is the wedge's far face."""
    build, source, tip = EDGES[edge]
    middle, sideways = beyond(source, np.array(tip), (1.0, 1.0, 1.0))
    shadowed = total_field(build(VACUUM), source, middle + 1e-6 * np.outer([-1, 1], sideways))
    free = total_field(hall(), source, middle[None])
    levels = 20.0 * np.log10(np.abs(shadowed / free))
    np.testing.assert_allclose(levels, -6.02, atol=0.1)


SHEETS = ("vertical, horizontal rays", "vertical, sloped rays", "lintel", "lintel, skew rays")


@pytest.mark.parametrize("screen", ["absorbing", "concrete", "plasterboard"])
@pytest.mark.parametrize("face", ["one face", "the other face"])
@pytest.mark.parametrize("edge", SHEETS)
@pytest.mark.parametrize("boundary", ["incident", "reflected"])
def test_nor_has_it_where_paths_go_through_the_screen(
    edge: str, face: str, screen: str, boundary: str
) -> None:
    build, source, tip = EDGES[edge]
    if face == "the other face":
        source = np.array([40.0 - source[0], *source[1:]])
    mirror = (1.0, 1.0, 1.0) if boundary == "incident" else (-1.0, 1.0, 1.0)
    middle, sideways = beyond(source, np.array(tip), mirror)
    slab = PLASTERBOARD if screen == "plasterboard" else SCREENS[screen]
    assert jump_db(build(slab), source, middle, sideways, walls=1) < 0.03
