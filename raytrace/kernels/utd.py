"""Diffraction at a wedge: the uniform theory of Kouyoumjian and Pathak (1974), for slabs.

The coefficient's four cotangent terms (their eqs. 25-33) keep the perfect conductor's form; the two
that belong to reflections are multiplied by the slab's reflection dyad, after Luebbers (1984), at
the angle whose sine to the face is sqrt(|sin phi sin phi'|), which unlike his is the same in
both directions of the path (docs/theory.md, eqs. 21-21b).
"""

import math
from typing import NamedTuple

from raytrace.kernels.compiling import jit
from raytrace.kernels.field import Radio, both_reflections, slab_lookup, steps_into
from raytrace.kernels.lanes import (
    WIDTH,
    ComplexLanes,
    Lanes,
    absolute,
    any_of,
    complex_of,
    copysign,
    gather_pairs2,
    lanes_of,
    load,
    maximum,
    minimum,
    sqrt,
    store,
    where,
)
from raytrace.kernels.plan_view import Floats

TRANSITION_MAX = 12.0
"""Largest s of the table of F(s^2) / s; beyond it the asymptotic series is used."""

TRANSITION_STEPS = 6000

ALONG_FACE = 1e-9
"""A direction this near to a face of a wedge lies in it [rad]."""


class Wedge(NamedTuple):
    """A wedge in the plane across its edge.

    Attributes
    ----------
    n
        Free angle over pi.
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


class WedgeTerms(NamedTuple):
    """What a pair of directions makes of a wedge.

    Attributes
    ----------
    cotangent, detour
        Of the four terms: their cotangents and the |cos| of their transition angles. Terms 0 and 1
        belong to phi - phi', 2 (n-face) and 3 (o-face) to phi + phi'. 0 for a sheet.
    cos_minus, sin_minus, cos_plus, sin_plus
        Of (phi - phi') / 2 and (phi + phi') / 2, all that a sheet needs.
    o_cosine, n_cosine
        Cosine of incidence on either face, over sin beta.
    o_turn, n_turn
        How the plane of incidence on either face turns with the slant of the ray (eq. 21a).
    """

    cotangent: tuple[Lanes, Lanes, Lanes, Lanes]
    detour: tuple[Lanes, Lanes, Lanes, Lanes]
    cos_minus: Lanes
    sin_minus: Lanes
    cos_plus: Lanes
    sin_plus: Lanes
    o_cosine: Lanes
    n_cosine: Lanes
    o_turn: Lanes
    n_turn: Lanes


@jit()
def new_wedge(n: float, o_slab: int, n_slab: int) -> Wedge:
    """Wedge of a free angle n pi."""
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
def face_angles(wedge: Wedge, cosine: Lanes, sine: Lanes, room: Floats) -> FaceAngles:
    """Functions of directions, by cosine and sine of their angle from the o-face.

    Parameters
    ----------
    wedge, cosine, sine
        The wedge, and the directions.
    room
        (>= 3, 8) written to.
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
    store(room[0], cosine)
    store(room[1], sine)
    for k in range(WIDTH):
        phi = angle_from(math.atan2(room[1, k], room[0, k]), 0.0)
        room[0, k] = phi
        room[1, k], room[2, k] = math.cos(phi / (2.0 * wedge.n)), math.sin(phi / (2.0 * wedge.n))
    root_n = root_of(wedge.sin_whole * cosine - wedge.cos_whole * sine)
    return FaceAngles(
        load(room[0]), cos_half, sin_half, load(room[1]), load(room[2]), root_o, root_n
    )


@jit(inline=True)
def root_of(sine: Lanes) -> Lanes:
    """sqrt(|sine|), 0 along a face, where the root of a rounding error would be large."""
    size = absolute(sine)
    return where(size > 1e-12, sqrt(size), 0.0)


@jit(inline=True, fast=True)
def transition_ratio(table: Floats, s: Lanes) -> ComplexLanes:
    """F(s^2) / s."""
    near = s < TRANSITION_MAX
    inverse = 1.0 / maximum(s, 1.0)
    square = inverse * inverse
    real, imag = inverse * (1.0 - 0.75 * square * square), 0.5 * square * inverse
    if any_of(near):
        row, w = steps_into(s * (TRANSITION_STEPS / TRANSITION_MAX), TRANSITION_STEPS)
        a, b, a2, b2 = gather_pairs2(table, row)
        real = where(near, a + (a2 - a) * w, real)
        imag = where(near, b + (b2 - b) * w, imag)
    return complex_of(real, imag)


@jit(inline=True, fast=True)
def cotangent(sine: Lanes, cosine: Lanes) -> Lanes:
    """Cosine / sine, finite at a shadow boundary, where F makes up for it."""
    return cosine / where(absolute(sine) < 1e-13, lanes_of(1e-13), sine)


@jit(inline=True, fast=True)
def detour(wedge: Wedge, beta: Lanes, cos_half: Lanes, sin_half: Lanes, sign: float) -> Lanes:
    """|cos((2 pi n N - beta) / 2)|, N = -1, 0, 1 nearest to (sign pi + beta) / (2 pi n)."""
    nearest = (beta + sign * math.pi) * (1.0 / (2.0 * math.pi * wedge.n))
    above = wedge.cos_whole * cos_half + wedge.sin_whole * sin_half
    below = wedge.cos_whole * cos_half - wedge.sin_whole * sin_half
    return absolute(where(nearest >= 0.5, above, where(nearest < -0.5, below, cos_half)))


@jit(inline=True)
def off_tie(size: Lanes, tie: Lanes) -> Lanes:
    """0 in place of what is so small that the ray is on a shadow boundary."""
    return where(absolute(size) < tie, lanes_of(0.0), size)


@jit(inline=True, fast=True)
def wedge_terms(wedge: Wedge, at: FaceAngles, source: FaceAngles, tie: Lanes) -> WedgeTerms:
    """Terms of pairs of directions.

    Parameters
    ----------
    wedge
        The wedge.
    at, source
        Angles of the diffracted and of the incident rays from the o-face.
    tie
        Half the angles to a shadow boundary [rad] below which the rays are on it.
    """
    ch, sh, gh, fh = at.cos_half, at.sin_half, source.cos_half, source.sin_half
    cos_minus, sin_minus = ch * gh + sh * fh, sh * gh - ch * fh
    cos_plus, sin_plus = ch * gh - sh * fh, sh * gh + ch * fh
    cos_minus, cos_plus = off_tie(cos_minus, tie), off_tie(cos_plus, tie)
    o_cosine, n_cosine = at.root_o * source.root_o, at.root_n * source.root_n
    # halves of cos phi' - cos phi and of sin phi' - sin phi
    cos_step, sin_step = gh * gh - ch * ch, fh * gh - sh * ch
    o_turn = o_cosine * cos_step
    n_turn = -n_cosine * (wedge.cos_whole * cos_step + wedge.sin_whole * sin_step)
    zero = lanes_of(0.0)
    detours = cotangents = (zero, zero, zero, zero)
    if not wedge.is_sheet:
        minus, plus = at.phi - source.phi, at.phi + source.phi
        detours = (
            off_tie(detour(wedge, minus, cos_minus, sin_minus, 1.0), tie),
            off_tie(detour(wedge, minus, cos_minus, sin_minus, -1.0), tie),
            off_tie(detour(wedge, plus, cos_plus, sin_plus, 1.0), tie),
            off_tie(detour(wedge, plus, cos_plus, sin_plus, -1.0), tie),
        )
        cotangents = wedge_cotangents(wedge, at, source)
    return WedgeTerms(
        cotangents, detours, cos_minus, sin_minus, cos_plus, sin_plus, o_cosine, n_cosine,
        o_turn, n_turn,
    )  # fmt: skip


@jit(inline=True, fast=True)
def wedge_cotangents(
    wedge: Wedge, at: FaceAngles, source: FaceAngles
) -> tuple[Lanes, Lanes, Lanes, Lanes]:
    """Cotangents of (pi + b) / 2n and (pi - b) / 2n, b = phi - phi' and then phi + phi'."""
    sp, cp = wedge.sin_part, wedge.cos_part
    ch, sh, gh, fh = at.cos_part, at.sin_part, source.cos_part, source.sin_part
    cos_minus, sin_minus = ch * gh + sh * fh, sh * gh - ch * fh
    cos_plus, sin_plus = ch * gh - sh * fh, sh * gh + ch * fh
    return (
        cotangent(sp * cos_minus + cp * sin_minus, cp * cos_minus - sp * sin_minus),
        cotangent(sp * cos_minus - cp * sin_minus, cp * cos_minus + sp * sin_minus),
        cotangent(sp * cos_plus + cp * sin_plus, cp * cos_plus - sp * sin_plus),
        cotangent(sp * cos_plus - cp * sin_plus, cp * cos_plus + sp * sin_plus),
    )


@jit(inline=True, fast=True)
def face_dyad(
    radio: Radio, slab: int, cosine: Lanes, turn: Lanes, beta: tuple[Lanes, Lanes]
) -> tuple[ComplexLanes, ComplexLanes, ComplexLanes]:
    """Reflection of a face in the edge's polarisations: along to along, mixed, across to across.

    The plane of incidence is turned against the edge by an angle whose cosine and sine are as
    1 - cosine^2 to cos_beta turn (docs/theory.md, eqs. 21a-21b).

    Parameters
    ----------
    radio, slab
        The slab.
    cosine, turn
        Of the face, see `WedgeTerms`.
    beta
        Sine and cosine of the angle between ray and edge.
    """
    tm, te = both_reflections(radio, slab, minimum(cosine * beta[0], 1.0))
    straight, slant = 1.0 - cosine * cosine, beta[1] * turn
    share = slant / (straight * straight + slant * slant + 1e-30)
    both = te + tm
    turned = both * (share * slant)
    return te - turned, both * (share * straight), tm - turned


@jit(inline=True, fast=True)
def diffracted(
    radio: Radio,
    wedge: Wedge,
    terms: WedgeTerms,
    spread: Lanes,
    beta: tuple[Lanes, Lanes],
    field: tuple[ComplexLanes, ComplexLanes],
    shining: Lanes,
) -> tuple[ComplexLanes, ComplexLanes]:
    """Fields behind a wedge, without its common factor (see `common_factor`).

    Parameters
    ----------
    radio, wedge, terms
        Tables, the wedge's faces, and the pairs of directions.
    spread
        sqrt(2 k L), L the distance parameter [1].
    beta
        Sine and cosine of the angle of the diffracted ray with the edge, about which the free
        space lies counter-clockwise of the o-face.
    field
        Components of the arriving field along the edge and across it.
    shining
        1 where there are also paths that go on through a sheet, so that its shadow holds what it
        lets through, else 0.
    """
    table, (along, across) = radio.transition, field
    te, mixed, tm = face_dyad(radio, wedge.o_slab, terms.o_cosine, terms.o_turn, beta)
    if wedge.is_sheet:
        # cot((pi + b) / 4) + cot((pi - b) / 4) = 2 / cos(b / 2): two terms in one, not singular;
        # the mixed parts of the two faces have opposite signs, and the terms' difference is
        # sin(b / 2) times their sum
        incident = half_plane_term(table, spread, terms.cos_minus)
        reflected = half_plane_term(table, spread, terms.cos_plus)
        mixed = mixed * (reflected * terms.sin_plus)
        te, tm = te * reflected, tm * reflected
        if len(radio.through) > 0:
            through = let_past(radio, wedge, terms, beta, field)
            along, across = along - through[0] * shining, across - through[1] * shining
        return (
            incident * along + te * field[0] + mixed * field[1],
            incident * across + tm * field[1] - mixed * field[0],
        )
    at_n = wedge_term(table, spread, terms.cotangent[2], terms.detour[2])
    at_o = wedge_term(table, spread, terms.cotangent[3], terms.detour[3])
    incident = wedge_term(table, spread, terms.cotangent[0], terms.detour[0])
    incident = incident + wedge_term(table, spread, terms.cotangent[1], terms.detour[1])
    n_te, n_mixed, n_tm = face_dyad(radio, wedge.n_slab, terms.n_cosine, terms.n_turn, beta)
    te, tm = te * at_o + n_te * at_n, tm * at_o + n_tm * at_n
    mixed = mixed * at_o + n_mixed * at_n
    return (incident + te) * along + mixed * across, (incident + tm) * across - mixed * along


@jit(inner=True, fast=True)
def let_past(
    radio: Radio,
    wedge: Wedge,
    terms: WedgeTerms,
    beta: tuple[Lanes, Lanes],
    field: tuple[ComplexLanes, ComplexLanes],
) -> tuple[ComplexLanes, ComplexLanes]:
    """What a sheet lets through of a field, along its edge and across it."""
    along, across = field
    cosine = minimum(terms.o_cosine * beta[0], 1.0)
    slab = lanes_of(float(wedge.o_slab))
    tm, mix = slab_lookup(radio.through, radio.slab_rows, slab, cosine)
    difference = mix * (1.0 - cosine * cosine)
    straight, slant = 1.0 - terms.o_cosine * terms.o_cosine, beta[1] * terms.o_turn
    share = slant / (straight * straight + slant * slant + 1e-30)
    # the face that is met from the other side turns the other way
    turned, mixed = difference * (share * slant), difference * (share * straight * terms.sin_minus)
    through_along = (tm + difference - turned) * along + mixed * across
    through_across = (tm + turned) * across + mixed * along
    return through_along, through_across


@jit(inline=True, fast=True)
def wedge_term(table: Floats, spread: Lanes, cot: Lanes, bend: Lanes) -> ComplexLanes:
    """Cot * F, one of the four terms (docs/theory.md, eq. 17)."""
    s = spread * bend
    return transition_ratio(table, s) * (cot * s)


@jit(inline=True, fast=True)
def half_plane_term(table: Floats, spread: Lanes, cosine: Lanes) -> ComplexLanes:
    """2 F / cosine, two of the four terms of a half plane; 0, its mean, on a shadow boundary."""
    size = where(absolute(cosine) > 0.0, copysign(2.0 * spread, cosine), 0.0)
    return transition_ratio(table, spread * absolute(cosine)) * size


@jit(inline=True)
def common_factor(n: float, wavelength: float) -> complex:
    """-exp(-j pi / 4) / (2 n sqrt(2 pi k)); the division by sin beta is the caller's."""
    size = math.sqrt(wavelength) / (4.0 * math.pi * n)
    return complex(-size * math.sqrt(0.5), size * math.sqrt(0.5))
