"""A wedge, and the angles of rays from its faces."""

import math
from typing import NamedTuple

from raytrace.arrays import Floats
from raytrace.kernels.compiling import jit
from raytrace.kernels.lanes import (
    WIDTH,
    Lanes,
    absolute,
    copysign,
    lanes_of,
    load,
    sqrt,
    store,
    where,
)

ALONG_FACE = 1e-9
"""A direction this near to a face of a wedge lies in it [rad]."""


class Wedge(NamedTuple):
    """A wedge in the plane across its edge.

    Attributes
    ----------
    n
        Exterior angle over pi.
    o_slab, n_slab
        Slabs of its faces.
    cos_part, sin_part
        Of pi / 2n.
    cos_whole, sin_whole
        Of n pi.
    is_sheet
        Whether it is the end of one sheet: a half plane with the same slab on both faces.
    """

    n: float
    o_slab: int
    n_slab: int
    cos_part: float
    sin_part: float
    cos_whole: float
    sin_whole: float
    is_sheet: bool


class FaceAngles(NamedTuple):
    """Functions of angles phi from the o-face that the wedge terms are made of.

    Attributes
    ----------
    phi
        The angle, 0 to 2 pi [rad]; 0 for a sheet, which does not need it.
    cos_half, sin_half
        Of phi / 2.
    cos_part, sin_part
        Of phi / 2n; 0 for a sheet.
    root_o, root_n
        Roots of |sin phi| and |sin(n pi - phi)|.
    """

    phi: Lanes
    cos_half: Lanes
    sin_half: Lanes
    cos_part: Lanes
    sin_part: Lanes
    root_o: Lanes
    root_n: Lanes


def new_wedge(n: float, o_slab: int, n_slab: int) -> Wedge:
    """Return the wedge of an exterior angle n pi."""
    part, whole = 0.5 * math.pi / n, n * math.pi
    is_sheet = abs(n - 2.0) < 1e-12 and o_slab == n_slab
    return Wedge(
        n,
        o_slab,
        n_slab,
        math.cos(part),
        math.sin(part),
        math.cos(whole),
        math.sin(whole),
        is_sheet,
    )


@jit(inline=True)
def angle_from(azimuth: float, o_face: float) -> float:
    """Angle of a direction from the o-face, 0 to 2 pi."""
    phi = azimuth - o_face + ALONG_FACE
    return phi - 2.0 * math.pi * math.floor(phi / (2.0 * math.pi)) - ALONG_FACE


@jit(inline=True)
def face_angles(wedge: Wedge, cosine: Lanes, sine: Lanes, rows: Floats) -> FaceAngles:
    """Functions of directions, by cosine and sine of their angle from the o-face.

    Parameters
    ----------
    wedge, cosine, sine
        The wedge, and the directions.
    rows
        (>= 3, 8) scratch.
    """
    wide = sqrt(0.5 + 0.5 * absolute(cosine))
    narrow = 0.5 * absolute(sine) / wide
    ahead = cosine > 0.0
    along = ahead & (absolute(sine) < ALONG_FACE)
    side = copysign(lanes_of(1.0), sine)
    cos_half = where(ahead, wide, narrow) * where(along, lanes_of(1.0), side)
    sin_half = where(ahead, narrow, wide) * where(along, side, lanes_of(1.0))
    root_o = root_of(sine)
    zero = lanes_of(0.0)
    if wedge.is_sheet:
        return FaceAngles(zero, cos_half, sin_half, zero, zero, root_o, root_o)
    store(rows[0], cosine)
    store(rows[1], sine)
    for k in range(WIDTH):
        phi = angle_from(math.atan2(rows[1, k], rows[0, k]), 0.0)
        rows[0, k] = phi
        rows[1, k], rows[2, k] = math.cos(phi / (2.0 * wedge.n)), math.sin(phi / (2.0 * wedge.n))
    root_n = root_of(wedge.sin_whole * cosine - wedge.cos_whole * sine)
    return FaceAngles(
        load(rows[0]), cos_half, sin_half, load(rows[1]), load(rows[2]), root_o, root_n
    )


@jit(inline=True)
def root_of(sine: Lanes) -> Lanes:
    """sqrt(|sine|), 0 along a face, where the root of a rounding error would be large."""
    size = absolute(sine)
    return where(size > 1e-12, sqrt(size), 0.0)
