"""The least loss of beams from a vertical edge, by the ways on which power arrives there.

A term of the diffraction coefficient is strong near its shadow boundary only, so each pair of a way
and a beam has a bound of its own (docs/theory.md, section 16).
"""

import math
from typing import NamedTuple

import numpy as np

from raytrace.arrays import Floats, Ints
from raytrace.kernels.compiling import jit
from raytrace.kernels.wedge import ALONG_FACE, Wedge, new_wedge


class EdgeWays(NamedTuple):
    """Ways from the transmitter to a vertical edge, by rising number of reflections.

    Attributes
    ----------
    wedge, axis
        The edge's wedge, and the direction of its o-face in the plan view.
    order, length, fraction
        (n,) wall reflections, horizontal length [m], and largest fraction of the power that the
        walls leave; n = 0 for roots that are no vertical edge.
    parts
        (n, 2) cosine and sine of phi' / 2n.
    sines
        (n, 2) sines of the angles to the o-face and to the n-face, at least 0.
    """

    wedge: Wedge
    axis: tuple[float, float]
    order: Ints
    length: Floats
    fraction: Floats
    parts: Floats
    sines: Floats


class Directions(NamedTuple):
    """An interval of the directions in which rays leave an edge, less than pi wide.

    Attributes
    ----------
    cos_low, sin_low, cos_high, sin_high
        Of phi / 2n at its ends.
    o_sine, n_sine
        Least sines of the angles to the faces.
    """

    cos_low: float
    sin_low: float
    cos_high: float
    sin_high: float
    o_sine: float
    n_sine: float


def no_edge_ways() -> EdgeWays:
    """Return the ways to what is no vertical edge."""
    none, two = np.zeros(0), np.zeros((0, 2))
    return EdgeWays(new_wedge(2.0, 0, 0), (0.0, 0.0), np.zeros(0, np.int64), none, none, two, two)


@jit(inline=True)
def angle_at(wedge: Wedge, x: float, y: float, along: float) -> float:
    """Angle of a direction from the o-face; one within the o-face is `along` (0 or 2 pi)."""
    phi = math.atan2(y, x)
    if abs(phi) < ALONG_FACE:
        phi = along
    elif phi < 0.0:
        phi += 2.0 * math.pi
    return min(phi, wedge.n * math.pi)


@jit(inline=True)
def least_sine(low: float, high: float) -> float:
    """Least |sin| between two angles, less than pi apart."""
    one, other = math.sin(low), math.sin(high)
    return min(abs(one), abs(other)) if one * other > 0.0 else 0.0


@jit(inner=True)
def directions_between(
    wedge: Wedge, low: tuple[float, float], high: tuple[float, float]
) -> Directions:
    """Directions counter-clockwise from one to another, both in the frame of the o-face."""
    n = wedge.n
    phi_low = angle_at(wedge, low[0], low[1], 0.0)
    phi_high = angle_at(wedge, high[0], high[1], 2.0 * math.pi)
    a, b = phi_low / (2.0 * n), phi_high / (2.0 * n)
    return Directions(
        math.cos(a), math.sin(a), math.cos(b), math.sin(b), least_sine(phi_low, phi_high),
        least_sine(n * math.pi - phi_high, n * math.pi - phi_low),
    )  # fmt: skip


@jit(inline=True)
def largest_cotangent(low: tuple[float, float], high: tuple[float, float]) -> float:
    """Largest |cot| between two angles, less than pi apart, by their cosines and sines."""
    if low[1] * high[1] <= 0.0:
        return math.inf
    return max(abs(low[0] / low[1]), abs(high[0] / high[1]))


@jit(inline=True)
def turned(wedge: Wedge, angle: tuple[float, float], sign: float) -> tuple[float, float]:
    """Cosine and sine of (pi + sign b) / 2n, by those of b / 2n."""
    cosine, sine = angle[0], sign * angle[1]
    return (
        wedge.cos_part * cosine - wedge.sin_part * sine,
        wedge.sin_part * cosine + wedge.cos_part * sine,
    )


@jit(inline=True)
def sum_of(
    one: tuple[float, float], other: tuple[float, float], sign: float
) -> tuple[float, float]:
    """Cosine and sine of one angle plus or minus another."""
    return (
        one[0] * other[0] - sign * one[1] * other[1],
        one[1] * other[0] + sign * one[0] * other[1],
    )


@jit(inner=True)
def largest_amplitude(
    wedge: Wedge,
    incoming: tuple[float, float],
    outgoing: Directions,
    reflected: tuple[float, float],
    through: float,
    size: float,
) -> float:
    """Largest field behind an edge over that of a free path as long (docs/theory.md, eq. 47).

    Parameters
    ----------
    wedge, incoming, outgoing
        The wedge; cosine and sine of phi' / 2n; the directions behind it.
    reflected
        Largest reflection coefficients of the o-face and the n-face.
    through
        Largest factor of the terms of the incident ray.
    size
        1 / (2 n sqrt(2 pi k L)).
    """
    low, high = (outgoing.cos_low, outgoing.sin_low), (outgoing.cos_high, outgoing.sin_high)
    total = 0.0
    for sign in (-1.0, 1.0):
        one, other = sum_of(low, incoming, sign), sum_of(high, incoming, sign)
        at_n = largest_cotangent(turned(wedge, one, 1.0), turned(wedge, other, 1.0))
        at_o = largest_cotangent(turned(wedge, one, -1.0), turned(wedge, other, -1.0))
        at_n, at_o = min(at_n * size, 0.5), min(at_o * size, 0.5)
        total += (
            through * (at_n + at_o) if sign < 0.0 else reflected[0] * at_o + reflected[1] * at_n
        )
    return total
