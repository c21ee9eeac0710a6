"""Diffraction at a wedge: the uniform theory of Kouyoumjian and Pathak (1974), for slabs.

The coefficient's four cotangent terms (their eqs. 25-33) keep the perfect conductor's form; the two
that belong to reflections are multiplied by the slab's reflection coefficient, after Luebbers
(1984), at the angle whose sine to the face is sqrt(|sin phi sin phi'|), which unlike his is
the same in both directions of the path (docs/theory.md, eq. 21).
"""

import math
from typing import NamedTuple

from raytrace.kernels.compiling import jit
from raytrace.kernels.field import Radio, both_reflections
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
    cos_minus, cos_plus
        Of (phi - phi') / 2 and (phi + phi') / 2, all that a sheet needs.
    o_cosine, n_cosine
        Cosine of incidence on either face, over sin beta.
    """

    cotangent: tuple[float, float, float, float]
    detour: tuple[float, float, float, float]
    cos_minus: float
    cos_plus: float
    o_cosine: float
    n_cosine: float


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
    k = int(t)
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


@jit(inline=True, fast=True)
def wedge_terms(
    wedge: Wedge, phi: float, at: Floats, phi_source: float, source: Floats
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
    """
    ch, sh, gh, fh = at[COSINE_HALF], at[SINE_HALF], source[COSINE_HALF], source[SINE_HALF]
    cos_minus, sin_minus = ch * gh + sh * fh, sh * gh - ch * fh
    cos_plus, sin_plus = ch * gh - sh * fh, sh * gh + ch * fh
    o_cosine, n_cosine = at[ROOT_O] * source[ROOT_O], at[ROOT_N] * source[ROOT_N]
    if wedge.is_sheet:
        none = (0.0, 0.0, 0.0, 0.0)
        return WedgeTerms(none, none, cos_minus, cos_plus, o_cosine, n_cosine)
    minus, plus = phi - phi_source, phi + phi_source
    detours = (
        detour(wedge, minus, cos_minus, sin_minus, 1.0),
        detour(wedge, minus, cos_minus, sin_minus, -1.0),
        detour(wedge, plus, cos_plus, sin_plus, 1.0),
        detour(wedge, plus, cos_plus, sin_plus, -1.0),
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
    return WedgeTerms(cotangents, detours, cos_minus, cos_plus, o_cosine, n_cosine)


@jit(inline=True, fast=True)
def diffraction(
    radio: Radio, wedge: Wedge, terms: WedgeTerms, spread: float, sin_beta: float
) -> tuple[complex, complex]:
    """Soft and hard coefficient, without their common factor (see `common_factor`).

    Parameters
    ----------
    radio, wedge, terms
        Tables, the wedge's faces, and the pair of directions.
    spread
        sqrt(2 k L), L the distance parameter [1].
    sin_beta
        Sine of the angle between ray and edge.
    """
    table = radio.transition
    o_tm, o_te = both_reflections(radio.slabs, wedge.o_slab, min(terms.o_cosine * sin_beta, 1.0))
    if wedge.is_sheet:
        # cot((pi + b) / 4) + cot((pi - b) / 4) = 2 / cos(b / 2): two terms in one, not singular
        incident = half_plane_term(table, spread, terms.cos_minus)
        reflected = half_plane_term(table, spread, terms.cos_plus)
        return incident + o_te * reflected, incident + o_tm * reflected
    n_tm, n_te = both_reflections(radio.slabs, wedge.n_slab, min(terms.n_cosine * sin_beta, 1.0))
    incident = wedge_term(table, spread, terms.cotangent[0], terms.detour[0])
    incident += wedge_term(table, spread, terms.cotangent[1], terms.detour[1])
    at_n = wedge_term(table, spread, terms.cotangent[2], terms.detour[2])
    at_o = wedge_term(table, spread, terms.cotangent[3], terms.detour[3])
    return incident + n_te * at_n + o_te * at_o, incident + n_tm * at_n + o_tm * at_o


@jit(inline=True, fast=True)
def wedge_term(table: Floats, spread: float, cot: float, bend: float) -> complex:
    """Cot * F, one of the four terms (docs/theory.md, eq. 17)."""
    s = spread * bend
    return transition_ratio(table, s) * (cot * s)


@jit(inline=True, fast=True)
def half_plane_term(table: Floats, spread: float, cosine: float) -> complex:
    """2 F / cosine, two of the four terms of a half plane."""
    return transition_ratio(table, spread * abs(cosine)) * math.copysign(2.0 * spread, cosine)


@jit(inline=True)
def common_factor(n: float, wavelength: float) -> complex:
    """-exp(-j pi / 4) / (2 n sqrt(2 pi k)); the division by sin beta is the caller's."""
    size = math.sqrt(wavelength) / (4.0 * math.pi * n)
    return complex(-size * math.sqrt(0.5), size * math.sqrt(0.5))
