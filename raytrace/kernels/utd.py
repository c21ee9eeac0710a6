"""Diffraction at a wedge: the uniform theory of Kouyoumjian and Pathak (1974), for slabs.

The coefficient's four cotangent terms (their eqs. 25-33) keep the perfect conductor's form; the two
that belong to reflections are multiplied by the slab's reflection dyad, after Luebbers (1984), at
the angle whose sine to the face is sqrt(|sin phi sin phi'|), which unlike his is the same in
both directions of the path (docs/theory.md, eqs. 21-21b).
"""

import math
from typing import NamedTuple

from raytrace.kernels.compiling import jit
from raytrace.kernels.field import Radio, both_reflections, slab_lookup
from raytrace.kernels.plan_view import Floats

TRANSITION_MAX = 12.0
"""Largest s of the table of F(s^2) / s; beyond it the asymptotic series is used."""

TRANSITION_STEPS = 6000

COSINE_HALF, SINE_HALF, COSINE_WEDGE, SINE_WEDGE, ROOT_O, ROOT_N = range(6)
"""Columns of `wedge_angles`: cosine and sine of phi / 2 and of phi / 2n, and the roots of
|sin phi| and |sin(n pi - phi)|."""


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


class WedgeTerms(NamedTuple):
    """What a pair of directions makes of a wedge.

    Attributes
    ----------
    cotangent, detour
        Of the four terms: their cotangents and the |cos| of their transition angles. Terms 0 and 1
        belong to phi - phi', 2 (n-face) and 3 (o-face) to phi + phi'.
    cos_minus, cos_plus, sin_plus
        Of (phi - phi') / 2 and (phi + phi') / 2, all that a sheet needs.
    o_cosine, n_cosine
        Cosine of incidence on either face, over sin beta.
    o_turn, n_turn
        How the plane of incidence on either face turns with the slant of the ray (eq. 21a).
    """

    cotangent: tuple[float, float, float, float]
    detour: tuple[float, float, float, float]
    cos_minus: float
    cos_plus: float
    sin_plus: float
    o_cosine: float
    n_cosine: float
    o_turn: float
    n_turn: float


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


@jit(inline=True, fast=True)
def transition_ratio(table: Floats, s: float) -> complex:
    """F(s^2) / s."""
    if s >= TRANSITION_MAX:
        x = s * s
        return complex((1.0 - 0.75 / (x * x)) / s, 0.5 / (x * s))
    t = s * (TRANSITION_STEPS / TRANSITION_MAX)
    k = min(max(int(t), 0), TRANSITION_STEPS)
    w = t - k
    v = 1.0 - w
    return complex(table[k, 0] * v + table[k + 1, 0] * w, table[k, 1] * v + table[k + 1, 1] * w)


@jit(inline=True, fast=True)
def cotangent(sine: float, cosine: float) -> float:
    """Cosine / sine, finite at a shadow boundary, where F makes up for it."""
    if abs(sine) < 1e-13:
        sine = 1e-13
    return cosine / sine


@jit(inline=True, fast=True)
def detour(wedge: Wedge, beta: float, cos_half: float, sin_half: float, sign: float) -> float:
    """|cos((2 pi n N - beta) / 2)|, N = -1, 0, 1 nearest to (sign pi + beta) / (2 pi n)."""
    nearest = (sign * math.pi + beta) / (2.0 * math.pi * wedge.n)
    if nearest >= 0.5:
        return abs(wedge.cos_whole * cos_half + wedge.sin_whole * sin_half)
    if nearest < -0.5:
        return abs(wedge.cos_whole * cos_half - wedge.sin_whole * sin_half)
    return abs(cos_half)


@jit(inline=True)
def off_tie(size: float, tie: float) -> float:
    """0 in place of what is so small that the ray is on a shadow boundary."""
    return 0.0 if abs(size) < tie else size


@jit(inline=True, fast=True)
def wedge_terms(
    wedge: Wedge, phi: float, at: Floats, phi_source: float, source: Floats, tie: float
) -> WedgeTerms:
    """Terms of one pair of directions.

    Parameters
    ----------
    wedge
        The wedge.
    phi, phi_source
        Angles of the diffracted and of the incident ray from the o-face [rad].
    at, source
        (6,) their `wedge_angles`.
    tie
        Half the angle to a shadow boundary [rad] below which the ray is on it.
    """
    ch, sh, gh, fh = at[COSINE_HALF], at[SINE_HALF], source[COSINE_HALF], source[SINE_HALF]
    cos_minus, sin_minus = ch * gh + sh * fh, sh * gh - ch * fh
    cos_plus, sin_plus = ch * gh - sh * fh, sh * gh + ch * fh
    cos_minus, cos_plus = off_tie(cos_minus, tie), off_tie(cos_plus, tie)
    o_cosine, n_cosine = at[ROOT_O] * source[ROOT_O], at[ROOT_N] * source[ROOT_N]
    # halves of cos phi' - cos phi and of sin phi' - sin phi
    cos_step, sin_step = gh * gh - ch * ch, fh * gh - sh * ch
    o_turn = o_cosine * cos_step
    n_turn = -n_cosine * (wedge.cos_whole * cos_step + wedge.sin_whole * sin_step)
    if wedge.is_sheet:
        none = (0.0, 0.0, 0.0, 0.0)
        return WedgeTerms(
            none, none, cos_minus, cos_plus, sin_plus, o_cosine, n_cosine, o_turn, n_turn
        )
    minus, plus = phi - phi_source, phi + phi_source
    detours = (
        off_tie(detour(wedge, minus, cos_minus, sin_minus, 1.0), tie),
        off_tie(detour(wedge, minus, cos_minus, sin_minus, -1.0), tie),
        off_tie(detour(wedge, plus, cos_plus, sin_plus, 1.0), tie),
        off_tie(detour(wedge, plus, cos_plus, sin_plus, -1.0), tie),
    )
    sp, cp = wedge.sin_part, wedge.cos_part
    ch, sh, gh, fh = at[COSINE_WEDGE], at[SINE_WEDGE], source[COSINE_WEDGE], source[SINE_WEDGE]
    cos_n_minus, sin_n_minus = ch * gh + sh * fh, sh * gh - ch * fh
    cos_n_plus, sin_n_plus = ch * gh - sh * fh, sh * gh + ch * fh
    cotangents = (
        cotangent(sp * cos_n_minus + cp * sin_n_minus, cp * cos_n_minus - sp * sin_n_minus),
        cotangent(sp * cos_n_minus - cp * sin_n_minus, cp * cos_n_minus + sp * sin_n_minus),
        cotangent(sp * cos_n_plus + cp * sin_n_plus, cp * cos_n_plus - sp * sin_n_plus),
        cotangent(sp * cos_n_plus - cp * sin_n_plus, cp * cos_n_plus + sp * sin_n_plus),
    )
    return WedgeTerms(
        cotangents, detours, cos_minus, cos_plus, sin_plus, o_cosine, n_cosine, o_turn, n_turn
    )


@jit(inline=True, fast=True)
def face_dyad(
    slabs: Floats, slab: int, cosine: float, turn: float, beta: tuple[float, float]
) -> tuple[complex, complex, complex]:
    """Reflection of a face in the edge's polarisations: along to along, mixed, across to across.

    The plane of incidence is turned against the edge by an angle whose cosine and sine are as
    1 - cosine^2 to cos_beta turn (docs/theory.md, eqs. 21a-21b).

    Parameters
    ----------
    slabs, slab
        The tables, and the face's.
    cosine, turn
        Of the face, see `WedgeTerms`.
    beta
        Sine and cosine of the angle between ray and edge.
    """
    tm, te = both_reflections(slabs, slab, min(cosine * beta[0], 1.0))
    straight, slant = 1.0 - cosine * cosine, beta[1] * turn
    share = slant / (straight * straight + slant * slant + 1e-30)
    both = te + tm
    turned = share * slant * both
    return te - turned, share * straight * both, tm - turned


@jit(inline=True, fast=True)
def diffracted(
    radio: Radio,
    wedge: Wedge,
    terms: WedgeTerms,
    spread: float,
    beta: tuple[float, float],
    field: tuple[complex, complex],
    shines_through: bool,
) -> tuple[complex, complex]:
    """Field behind a wedge, without its common factor (see `common_factor`).

    Parameters
    ----------
    radio, wedge, terms
        Tables, the wedge's faces, and the pair of directions.
    spread
        sqrt(2 k L), L the distance parameter [1].
    beta
        Sine and cosine of the angle of the diffracted ray with the edge, about which the free
        space lies counter-clockwise of the o-face.
    field
        Components of the arriving field along the edge and across it.
    shines_through
        Whether there are also paths that go on through a sheet, so that its shadow holds what it
        lets through.
    """
    table, (along, across) = radio.transition, field
    te, mixed, tm = face_dyad(radio.slabs, wedge.o_slab, terms.o_cosine, terms.o_turn, beta)
    if wedge.is_sheet:
        # cot((pi + b) / 4) + cot((pi - b) / 4) = 2 / cos(b / 2): two terms in one, not singular;
        # the mixed parts of the two faces have opposite signs, and the terms' difference is
        # sin(b / 2) times their sum
        incident = half_plane_term(table, spread, terms.cos_minus)
        reflected = half_plane_term(table, spread, terms.cos_plus)
        mixed *= reflected * terms.sin_plus
        te, tm = te * reflected, tm * reflected
        if shines_through:
            along, across = kept_back(radio.through, wedge, terms, beta, field)
            along, across = incident * along, incident * across
            return (
                along + te * field[0] + mixed * field[1],
                across + tm * field[1] - mixed * field[0],
            )
    else:
        at_n = wedge_term(table, spread, terms.cotangent[2], terms.detour[2])
        at_o = wedge_term(table, spread, terms.cotangent[3], terms.detour[3])
        incident = wedge_term(table, spread, terms.cotangent[0], terms.detour[0])
        incident += wedge_term(table, spread, terms.cotangent[1], terms.detour[1])
        n_te, n_mixed, n_tm = face_dyad(
            radio.slabs, wedge.n_slab, terms.n_cosine, terms.n_turn, beta
        )
        te, mixed, tm = (
            te * at_o + n_te * at_n, mixed * at_o + n_mixed * at_n, tm * at_o + n_tm * at_n
        )  # fmt: skip
    return (incident + te) * along + mixed * across, (incident + tm) * across - mixed * along


@jit(inner=True, fast=True)
def kept_back(
    through: Floats,
    wedge: Wedge,
    terms: WedgeTerms,
    beta: tuple[float, float],
    field: tuple[complex, complex],
) -> tuple[complex, complex]:
    """Field less what a sheet lets through, along its edge and across it."""
    along, across = field
    cosine = min(terms.o_cosine * beta[0], 1.0)
    tm, mix = slab_lookup(through, wedge.o_slab, cosine)
    difference = mix * (1.0 - cosine * cosine)
    straight, slant = 1.0 - terms.o_cosine * terms.o_cosine, beta[1] * terms.o_turn
    size = straight * straight + slant * slant + 1e-30
    turned, mixed = difference * (slant * slant / size), difference * (straight * slant / size)
    through_along = (tm + difference - turned) * along + mixed * across
    through_across = (tm + turned) * across + mixed * along
    return along - through_along, across - through_across


@jit(inline=True, fast=True)
def wedge_term(table: Floats, spread: float, cot: float, bend: float) -> complex:
    """Cot * F, one of the four terms (docs/theory.md, eq. 17)."""
    s = spread * bend
    return transition_ratio(table, s) * (cot * s)


@jit(inline=True, fast=True)
def half_plane_term(table: Floats, spread: float, cosine: float) -> complex:
    """2 F / cosine, two of the four terms of a half plane; 0, its mean, on a shadow boundary."""
    if cosine == 0.0:
        return 0j
    return transition_ratio(table, spread * abs(cosine)) * math.copysign(2.0 * spread, cosine)


@jit(inline=True)
def common_factor(n: float, wavelength: float) -> complex:
    """-exp(-j pi / 4) / (2 n sqrt(2 pi k)); the division by sin beta is the caller's."""
    size = math.sqrt(wavelength) / (4.0 * math.pi * n)
    return complex(-size * math.sqrt(0.5), size * math.sqrt(0.5))
