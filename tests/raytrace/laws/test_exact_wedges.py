"""The traced field about conducting edges against the exact one of a point source.

The exact field of a point source at a wedge of two perfectly conducting half planes is the sum of
what geometrical optics gives and an integral over the edge (Svensson, Fred and Vanderkooy 1999,
after Biot and Tolstoy 1957). It holds for a vertical dipole beside a vertical edge, where the
field is parallel to the edge (soft), and in the plane across a horizontal edge (hard).
"""

from typing import NamedTuple

import numpy as np
import pytest
from buildings import Building, Sheet, box, wall
from numpy.typing import NDArray

from raytrace import Isotropic, TraceConfig, Transmitter, trace_paths

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]

SOFT, HARD = -1.0, 1.0
VACUUM, CONDUCTOR = 0, 1
SLABS = (("vacuum", 0.1), ("perfect_conductor", 0.1))
HEIGHT_M = 12.0
LEVEL_M = 6.0
EDGE = np.array([20.0, 20.0, LEVEL_M])
WAVELENGTH_M = Transmitter((0.0, 0.0, 0.0)).wavelength_m
K = 2.0 * np.pi / WAVELENGTH_M

UNIFORM = 3e-4
"""What the uniform theory leaves out, over the incident field at the edge: 1e-4 was seen."""


class Polar(NamedTuple):
    """Distance from the edge [m] and angle from the first face [rad] of points across it."""

    r: Floats
    angle: Floats


def wedge_diffraction(n: float, source: Polar, receivers: Polar, kind: float) -> Complexes:
    """Diffracted part of the exact field, e^(-jkR) / R being the direct one.

    Integrated along a path that bends into the half plane where the integrand falls off.
    """
    u = np.linspace(0.0, 6.0, 20_001)
    eta = u - 0.5j * np.tanh(2.0 * u)
    turn = 1.0 - 1.0j / np.cosh(2.0 * u) ** 2
    r2 = source.r**2 + receivers.r[:, None] ** 2
    length = np.sqrt(r2 + 2.0 * source.r * receivers.r[:, None] * np.cosh(eta))
    total = np.zeros_like(length)
    for out in (1.0, -1.0):
        for back in (1.0, -1.0):
            phi = (np.pi + out * source.angle + back * receivers.angle)[:, None] / n
            weight = 1.0 if out != back else kind
            total += weight * np.sin(phi) / (np.cosh(eta / n) - np.cos(phi))
    integrand = total * np.exp(-1j * K * length) / length * turn
    return -np.trapezoid(integrand, u, axis=1) / (2.0 * np.pi * n)


def wedge_field(n: float, source: Polar, receivers: Polar, kind: float) -> Complexes:
    """Exact field: direct, reflected by either face, diffracted."""
    field = wedge_diffraction(n, source, receivers, kind)
    images = ((1.0, source.angle), (kind, -source.angle), (kind, 2.0 * n * np.pi - source.angle))
    for weight, angle in images:
        apart = np.abs(receivers.angle - angle)
        square = source.r**2 + receivers.r**2 - 2.0 * source.r * receivers.r * np.cos(apart)
        distance = np.sqrt(square)
        field += np.where(apart < np.pi, weight * np.exp(-1j * K * distance) / distance, 0.0)
    return field


def hall(*inside: Sheet) -> Building:
    """Return conducting walls in a hall that reflects nothing."""
    empty = box(40.0, 40.0, height=HEIGHT_M)
    outside = tuple(s._replace(slab=VACUUM) for s in empty.sheets)
    return Building(
        empty.outline, (*outside, *inside), HEIGHT_M, SLABS, floor=VACUUM, ceiling=VACUUM
    )


def screen(start: tuple[float, float]) -> tuple[Sheet, ...]:
    return wall(start, (EDGE[0], EDGE[1]), slab=CONDUCTOR, high=HEIGHT_M)


def traced_field(building: Building, source: Floats, receivers: Floats) -> Complexes:
    transmitter = Transmitter(tuple(source), antenna=Isotropic())
    paths = trace_paths(
        building.scene, transmitter, receivers, TraceConfig(1, 1), receive_antenna=Isotropic()
    )
    field = np.zeros(len(receivers), dtype=np.complex128)
    np.add.at(field, paths.receiver, paths.gain)
    return field * 4.0 * np.pi / WAVELENGTH_M


def polar(points: Floats, face: Floats, across: Floats) -> Polar:
    """Return points about the edge, seen from a face towards a direction across it."""
    away = points - EDGE
    x, y = away @ face, away @ across
    return Polar(np.hypot(x, y), np.arctan2(y, x) % (2.0 * np.pi))


WEST, EAST, SOUTH, UP = np.array(
    [[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]]
)
VERTICAL = {
    "half plane": (2.0, hall(*screen((20.0, 0.0)))),
    "corner of 270 degrees": (1.5, hall(*screen((20.0, 0.0)), *screen((0.0, 20.0)))),
}


@pytest.mark.parametrize("azimuth_deg", [-70.0, -25.0, 40.0])
@pytest.mark.parametrize("name", VERTICAL)
def test_vertical_edges_are_soft(name: str, azimuth_deg: float) -> None:
    """All around the edge, through lit and shadowed regions and their boundaries."""
    n, building = VERTICAL[name]
    turn = np.radians(azimuth_deg)
    source = EDGE + 9.0 * np.array([np.cos(turn), np.sin(turn), 0.0])
    angle = np.linspace(0.05, n * np.pi - 0.05, 40)
    around = np.cos(angle)[:, None] * SOUTH + np.sin(angle)[:, None] * EAST
    receivers = EDGE + np.linspace(4.0, 12.0, 40)[:, None] * around
    exact = wedge_field(n, polar(source[None], SOUTH, EAST), polar(receivers, SOUTH, EAST), SOFT)
    error = np.abs(traced_field(building, source, receivers) - exact)
    assert (error < UNIFORM / 9.0).all()


def test_a_lintel_is_hard_across() -> None:
    """Behind the wall, from deep in its shadow to full light."""
    building = hall(*wall((20.0, 0.0), (20.0, 40.0), slab=CONDUCTOR, low=LEVEL_M, high=HEIGHT_M))
    source = np.array([12.0, 20.0, 3.0])
    z = np.linspace(0.5, 11.5, 40)
    receivers = np.column_stack([np.full(40, 27.0), np.full(40, source[1]), z])
    exact = wedge_field(2.0, polar(source[None], UP, WEST), polar(receivers, UP, WEST), HARD)
    error = np.abs(traced_field(building, source, receivers) - exact)
    assert (error < UNIFORM / 8.0).all()
