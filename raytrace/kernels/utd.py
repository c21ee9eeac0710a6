"""Diffraction at a wedge: the uniform theory of Kouyoumjian and Pathak (1974), for slabs.

The coefficient's four cotangent terms (their eqs. 25-33) keep the perfect conductor's form; the two
that belong to reflections are multiplied by the slab's reflection dyad, after Luebbers (1984), at
the angle whose sine to the face is sqrt(|sin phi sin phi'|), which unlike his is the same in
both directions of the path (docs/theory.md, eqs. 21-21b).
"""

import math
from typing import NamedTuple

from raytrace.arrays import Floats
from raytrace.kernels.compiling import jit
from raytrace.kernels.field_tables import (
    FieldTables,
    both_reflections,
    row_and_fraction,
    slab_lookup,
)
from raytrace.kernels.lanes import (
    ComplexLanes,
    Lanes,
    absolute,
    any_of,
    complex_of,
    copysign,
    gather_pairs2,
    lanes_of,
    maximum,
    minimum,
    where,
)
from raytrace.kernels.waves import Component
from raytrace.kernels.wedge import FaceAngles, Wedge

TRANSITION_MAX = 12.0
"""Largest s of the table of F(s^2) / s; beyond it the asymptotic series is used."""

TRANSITION_STEPS = 6000


class WedgeTerms(NamedTuple):
    """What a pair of directions makes of a wedge.

    Attributes
    ----------
    cotangent, angular
        Of the four terms: their cotangents and sqrt(a / 2), a the angular term of the transition
        function's argument. Terms 0 and 1 belong to phi - phi', 2 (n-face) and 3 (o-face) to
        phi + phi'. 0 for a sheet.
    cos_minus, sin_minus, cos_plus, sin_plus
        Of (phi - phi') / 2 and (phi + phi') / 2, all that a sheet needs.
    o_cosine, n_cosine
        Cosine of incidence on either face, over sin beta.
    o_turn, n_turn
        How the plane of incidence on either face turns with the slant of the ray (eq. 21a).
    """

    cotangent: tuple[Lanes, Lanes, Lanes, Lanes]
    angular: tuple[Lanes, Lanes, Lanes, Lanes]
    cos_minus: Lanes
    sin_minus: Lanes
    cos_plus: Lanes
    sin_plus: Lanes
    o_cosine: Lanes
    n_cosine: Lanes
    o_turn: Lanes
    n_turn: Lanes


@jit(inline=True, fast=True)
def transition_ratio(table: Floats, s: Lanes) -> ComplexLanes:
    """F(s^2) / s."""
    near = s < TRANSITION_MAX
    inverse = 1.0 / maximum(s, 1.0)
    square = inverse * inverse
    real, imag = inverse * (1.0 - 0.75 * square * square), 0.5 * square * inverse
    if any_of(near):
        row, w = row_and_fraction(s * (TRANSITION_STEPS / TRANSITION_MAX), TRANSITION_STEPS)
        a, b, a2, b2 = gather_pairs2(table, row)
        real = where(near, a + (a2 - a) * w, real)
        imag = where(near, b + (b2 - b) * w, imag)
    return complex_of(real, imag)


@jit(inline=True, fast=True)
def cotangent(sine: Lanes, cosine: Lanes) -> Lanes:
    """Cosine / sine, finite at a shadow boundary, where F makes up for it."""
    return cosine / where(absolute(sine) < 1e-13, lanes_of(1e-13), sine)


@jit(inline=True, fast=True)
def angular_term(wedge: Wedge, beta: Lanes, cos_half: Lanes, sin_half: Lanes, sign: float) -> Lanes:
    """Sqrt(a / 2) = |cos((2 pi n N - beta) / 2)|.

    N = -1, 0, 1 is nearest to (sign pi + beta) / (2 pi n).
    """
    nearest = (beta + sign * math.pi) * (1.0 / (2.0 * math.pi * wedge.n))
    above = wedge.cos_whole * cos_half + wedge.sin_whole * sin_half
    below = wedge.cos_whole * cos_half - wedge.sin_whole * sin_half
    return absolute(where(nearest >= 0.5, above, where(nearest < -0.5, below, cos_half)))


@jit(inline=True)
def unless_grazing(size: Lanes, grazing: Lanes) -> Lanes:
    """0 in place of what is so small that the ray grazes a shadow boundary."""
    return where(absolute(size) < grazing, lanes_of(0.0), size)


@jit(inline=True, fast=True)
def wedge_terms(wedge: Wedge, at: FaceAngles, incident: FaceAngles, grazing: Lanes) -> WedgeTerms:
    """Terms of pairs of directions.

    Parameters
    ----------
    wedge
        The wedge.
    at, incident
        Angles of the diffracted and of the incident rays from the o-face.
    grazing
        Half the angles to a shadow boundary [rad] below which the rays graze it.
    """
    ch, sh, gh, fh = at.cos_half, at.sin_half, incident.cos_half, incident.sin_half
    cos_minus, sin_minus = ch * gh + sh * fh, sh * gh - ch * fh
    cos_plus, sin_plus = ch * gh - sh * fh, sh * gh + ch * fh
    cos_minus, cos_plus = unless_grazing(cos_minus, grazing), unless_grazing(cos_plus, grazing)
    o_cosine, n_cosine = at.root_o * incident.root_o, at.root_n * incident.root_n
    # halves of cos phi' - cos phi and of sin phi' - sin phi
    cos_step, sin_step = gh * gh - ch * ch, fh * gh - sh * ch
    o_turn = o_cosine * cos_step
    n_turn = -n_cosine * (wedge.cos_whole * cos_step + wedge.sin_whole * sin_step)
    zero = lanes_of(0.0)
    angular = cotangents = (zero, zero, zero, zero)
    if not wedge.is_sheet:
        minus, plus = at.phi - incident.phi, at.phi + incident.phi
        angular = (
            unless_grazing(angular_term(wedge, minus, cos_minus, sin_minus, 1.0), grazing),
            unless_grazing(angular_term(wedge, minus, cos_minus, sin_minus, -1.0), grazing),
            unless_grazing(angular_term(wedge, plus, cos_plus, sin_plus, 1.0), grazing),
            unless_grazing(angular_term(wedge, plus, cos_plus, sin_plus, -1.0), grazing),
        )
        cotangents = wedge_cotangents(wedge, at, incident)
    return WedgeTerms(
        cotangents, angular, cos_minus, sin_minus, cos_plus, sin_plus, o_cosine, n_cosine,
        o_turn, n_turn,
    )  # fmt: skip


@jit(inline=True, fast=True)
def wedge_cotangents(
    wedge: Wedge, at: FaceAngles, incident: FaceAngles
) -> tuple[Lanes, Lanes, Lanes, Lanes]:
    """Cotangents of (pi + b) / 2n and (pi - b) / 2n, b = phi - phi' and then phi + phi'."""
    sp, cp = wedge.sin_part, wedge.cos_part
    ch, sh, gh, fh = at.cos_part, at.sin_part, incident.cos_part, incident.sin_part
    cos_minus, sin_minus = ch * gh + sh * fh, sh * gh - ch * fh
    cos_plus, sin_plus = ch * gh - sh * fh, sh * gh + ch * fh
    return (
        cotangent(sp * cos_minus + cp * sin_minus, cp * cos_minus - sp * sin_minus),
        cotangent(sp * cos_minus - cp * sin_minus, cp * cos_minus + sp * sin_minus),
        cotangent(sp * cos_plus + cp * sin_plus, cp * cos_plus - sp * sin_plus),
        cotangent(sp * cos_plus - cp * sin_plus, cp * cos_plus + sp * sin_plus),
    )


@jit(inline=True, fast=True)
def incidence_turn(cosine: Lanes, turn: Lanes, cos_beta: Lanes) -> tuple[Lanes, Lanes]:
    """sin^2 and sin cos of the angle between the plane of incidence and the edge.

    Its cosine and sine are as 1 - cosine^2 to cos_beta turn (docs/theory.md, eqs. 21a-21b).
    """
    straight, slant = 1.0 - cosine * cosine, cos_beta * turn
    scale = slant / (straight * straight + slant * slant + 1e-30)
    return scale * slant, scale * straight


@jit(inline=True, fast=True)
def face_dyad(
    tables: FieldTables, slab: int, cosine: Lanes, turn: Lanes, beta: tuple[Lanes, Lanes]
) -> tuple[ComplexLanes, ComplexLanes, ComplexLanes]:
    """Reflection of a face in the edge's polarisations: along to along, mixed, across to across.

    Parameters
    ----------
    tables, slab
        The slab.
    cosine, turn
        Of the face, see `WedgeTerms`.
    beta
        Sine and cosine of the angle between ray and edge.
    """
    tm, te = both_reflections(tables, slab, minimum(cosine * beta[0], 1.0))
    both, (sine_squared, sine_cosine) = te + tm, incidence_turn(cosine, turn, beta[1])
    turned = both * sine_squared
    return te - turned, both * sine_cosine, tm - turned


@jit(inline=True, fast=True)
def diffracted(
    tables: FieldTables,
    wedge: Wedge,
    terms: WedgeTerms,
    sqrt_2kl: Lanes,
    beta: tuple[Lanes, Lanes],
    field: tuple[Component, Component],
    transmits: Lanes,
) -> tuple[Component, Component]:
    """Fields behind a wedge, without its common factor (see `common_factor`).

    Parameters
    ----------
    tables, wedge, terms
        Tables, the wedge's faces, and the pairs of directions.
    sqrt_2kl
        sqrt(2 k L), L the distance parameter [1].
    beta
        Sine and cosine of the angle of the diffracted ray with the edge, about which the free
        space lies counter-clockwise of the o-face.
    field
        Components of the arriving field along the edge and across it.
    transmits
        1 where paths through a sheet are traced too, so that its shadow holds the transmitted
        field, otherwise 0.
    """
    table, (along, across) = tables.transition, field
    te, mixed, tm = face_dyad(tables, wedge.o_slab, terms.o_cosine, terms.o_turn, beta)
    if wedge.is_sheet:
        # cot((pi + b) / 4) + cot((pi - b) / 4) = 2 / cos(b / 2): two terms in one, not singular;
        # the mixed parts of the two faces have opposite signs, and the terms' difference is
        # sin(b / 2) times their sum
        incident = half_plane_term(table, sqrt_2kl, terms.cos_minus)
        reflected = half_plane_term(table, sqrt_2kl, terms.cos_plus)
        mixed = mixed * (reflected * terms.sin_plus)
        te, tm = te * reflected, tm * reflected
        if len(tables.transmission) > 0:
            behind = transmitted(tables, wedge, terms, beta, field)
            along, across = along - behind[0] * transmits, across - behind[1] * transmits
        return (
            incident * along + te * field[0] + mixed * field[1],
            incident * across + tm * field[1] - mixed * field[0],
        )
    at_n = wedge_term(table, sqrt_2kl, terms.cotangent[2], terms.angular[2])
    at_o = wedge_term(table, sqrt_2kl, terms.cotangent[3], terms.angular[3])
    incident = wedge_term(table, sqrt_2kl, terms.cotangent[0], terms.angular[0])
    incident = incident + wedge_term(table, sqrt_2kl, terms.cotangent[1], terms.angular[1])
    n_te, n_mixed, n_tm = face_dyad(tables, wedge.n_slab, terms.n_cosine, terms.n_turn, beta)
    te, tm = te * at_o + n_te * at_n, tm * at_o + n_tm * at_n
    mixed = mixed * at_o + n_mixed * at_n
    return (incident + te) * along + mixed * across, (incident + tm) * across - mixed * along


@jit(inner=True, fast=True)
def transmitted(
    tables: FieldTables,
    wedge: Wedge,
    terms: WedgeTerms,
    beta: tuple[Lanes, Lanes],
    field: tuple[Component, Component],
) -> tuple[Component, Component]:
    """Field transmitted by a sheet, along its edge and across it."""
    along, across = field
    cosine = minimum(terms.o_cosine * beta[0], 1.0)
    slab = lanes_of(float(wedge.o_slab))
    tm, mix = slab_lookup(tables.transmission, tables.slab_rows, slab, cosine)
    difference = mix * (1.0 - cosine * cosine)
    sine_squared, sine_cosine = incidence_turn(terms.o_cosine, terms.o_turn, beta[1])
    # on the face that is met from the other side the plane turns in the opposite direction
    turned, mixed = difference * sine_squared, difference * (sine_cosine * terms.sin_minus)
    return (
        (tm + difference - turned) * along + mixed * across,
        (tm + turned) * across + mixed * along,
    )


@jit(inline=True, fast=True)
def wedge_term(table: Floats, sqrt_2kl: Lanes, cot: Lanes, angular: Lanes) -> ComplexLanes:
    """Cot * F, one of the four terms (docs/theory.md, eq. 17)."""
    s = sqrt_2kl * angular
    return transition_ratio(table, s) * (cot * s)


@jit(inline=True, fast=True)
def half_plane_term(table: Floats, sqrt_2kl: Lanes, cosine: Lanes) -> ComplexLanes:
    """2 F / cosine, two of the four terms of a half plane; 0, its mean, on a shadow boundary."""
    size = where(absolute(cosine) > 0.0, copysign(2.0 * sqrt_2kl, cosine), 0.0)
    return transition_ratio(table, sqrt_2kl * absolute(cosine)) * size


@jit(inline=True)
def common_factor(n: float, wavelength: float) -> complex:
    """-exp(-j pi / 4) / (2 n sqrt(2 pi k)); the division by sin beta is the caller's."""
    size = math.sqrt(wavelength) / (4.0 * math.pi * n)
    return complex(-size * math.sqrt(0.5), size * math.sqrt(0.5))
