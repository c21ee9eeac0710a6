"""The field of a path from its points and materials alone: plain physics, three dimensions.

The field is a complex vector that is turned at every reflection by the slab's dyad and at every
diffraction by the wedge's, with the textbook's formulas and no tables. Time goes as e^(+j w t).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from brute_force import DIFFRACTION, REFLECTION, TRANSMISSION, Found
from brute_force_facets import Edge, Facets, Mask
from numpy.typing import NDArray
from scipy.special import fresnel

from raytrace import Antenna, Transmitter
from raytrace.radio.materials import MATERIALS

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
UP = np.array([0.0, 0.0, 1.0])
CONDUCTOR = np.diag([-1.0, 1.0])
"""Reflection dyad of a wedge's face that conducts perfectly."""


class Slab(NamedTuple):
    """Reflection and transmission; for `r_te` and `r_tm` of a perfect conductor: -1 and 1."""

    r_te: Complexes
    r_tm: Complexes
    t_te: Complexes
    t_tm: Complexes


def slab(permittivity: complex, thickness_m: float, wavelength_m: float, cos_i: Floats) -> Slab:
    """Plane wave on a slab, as a piece of transmission line between two of free space.

    The line's impedance is 1 / cos for TE and cos for TM; what it reflects is the tangential
    electric field, whose sign for TM is the opposite of the usual one.
    """
    q = np.sqrt(permittivity - (1.0 - cos_i**2))
    phase = 2.0 * np.pi / wavelength_m * thickness_m * q

    def line(free: Floats, inside: Complexes) -> tuple[Complexes, Complexes]:
        ratio = inside / free
        back = 1j * np.tan(phase) * (ratio - 1.0 / ratio)
        both = 2.0 + 1j * np.tan(phase) * (ratio + 1.0 / ratio)
        delay = np.exp(-1j * phase)
        return back / both, 4.0 * delay / ((1.0 + delay**2) * both)

    (r_te, t_te), (r_tm, t_tm) = line(1.0 / cos_i, 1.0 / q), line(cos_i, q / permittivity)
    return Slab(r_te, -r_tm, t_te, t_tm)


def metal_like(cos_i: Floats) -> Slab:
    """Return a perfect conductor."""
    one = np.ones_like(cos_i, dtype=np.complex128)
    return Slab(-one, one, 0.0 * one, 0.0 * one)


def transition(x: Floats) -> Complexes:
    """F(x) of Kouyoumjian and Pathak (1974), eq. 27, by Fresnel's integrals."""
    sine, cosine = fresnel(np.sqrt(2.0 * x / np.pi))
    tail = np.sqrt(0.5 * np.pi) * ((0.5 - cosine) - 1j * (0.5 - sine))
    return 2j * np.sqrt(x) * np.exp(1j * x) * tail


def wedge(
    n: float,
    angles: tuple[Floats, Floats],
    sin_beta: Floats,
    k_distance: Floats,
    faces: tuple[Complexes, Complexes],
    through: Complexes | None = None,
) -> Complexes:
    """Dyads (m, 2, 2) times sqrt(k), soft before hard: Kouyoumjian and Pathak, eqs. 25-33.

    Parameters
    ----------
    n
        Free angle over pi.
    angles
        phi' of the incident and phi of the diffracted ray, from the o-face [rad].
    sin_beta
        Sine of the angle with the edge.
    k_distance
        k L, L the distance parameter.
    faces
        Reflection dyads (m, 2, 2) of the o-face and of the n-face, `CONDUCTOR` for a perfect
        conductor.
    through
        Transmission dyad (m, 2, 2) of a sheet, whose shadow holds what it lets through.
    """
    phi_in, phi = angles
    terms = []
    for beta in (phi - phi_in, phi + phi_in):
        for sign in (1.0, -1.0):
            turns = np.round((beta + sign * np.pi) / (2.0 * np.pi * n))
            a = 2.0 * np.cos(n * np.pi * turns - 0.5 * beta) ** 2
            cotangent = 1.0 / np.tan((np.pi + sign * beta) / (2.0 * n))
            terms.append(cotangent * transition(k_distance * a))
    direct, at_n, at_o = (t[:, None, None] for t in (terms[0] + terms[1], terms[2], terms[3]))
    size = -np.exp(-0.25j * np.pi) / (2.0 * n * np.sqrt(2.0 * np.pi) * sin_beta)
    lost = np.eye(2) if through is None else np.eye(2) - through
    return size[:, None, None] * (direct * lost + faces[1] * at_n + faces[0] * at_o)


def unit(vectors: Floats) -> Floats:
    """Vectors (n, 3) of length 1."""
    return vectors / np.linalg.norm(vectors, axis=1)[:, None]


def dot(a: NDArray, b: NDArray) -> NDArray:
    """Scalar products (n,) of vectors (n, 3)."""
    return (a * b).sum(axis=1)


@dataclass(frozen=True)
class Radio:
    """Slabs by number, transmitter, the receivers' antenna, most transmissions of a path."""

    slabs: Sequence[tuple[str, float]]
    source: Transmitter
    receive: Antenna
    max_transmissions: int = 0

    def reflect(self, number: int, cos_i: Floats) -> Slab:
        """Coefficients of a slab by its number."""
        name, thickness_m = self.slabs[number]
        permittivity = MATERIALS[name].complex_permittivity(self.source.frequency_hz)
        return slab(permittivity, thickness_m, self.source.wavelength_m, cos_i)

    def transmit(self, number: int, cos_i: Floats) -> tuple[Complexes, Complexes]:
        """Return T_te and T_tm of a slab, relative to air across the same thickness."""
        c = self.reflect(number, cos_i)
        wave = 2.0 * np.pi / self.source.wavelength_m
        missing = np.exp(1j * wave * self.slabs[number][1] * cos_i)
        return missing * c.t_te, missing * c.t_tm


def path_gains(facets: Facets, found: Found, radio: Radio) -> Complexes:
    """Complex gain (n,) of paths, both antennas included."""
    n, most = found.kinds.shape
    rays = np.diff(found.vertices, axis=1)
    lengths = np.linalg.norm(rays, axis=2)
    first = unit(rays[:, 0])
    field = pattern(radio.source.antenna, first)
    spread = 1.0 / lengths.sum(axis=1)
    may_pass = (found.kinds == TRANSMISSION).sum(axis=1) < radio.max_transmissions
    for k in range(most):
        rows = np.flatnonzero(found.kinds[:, k] == REFLECTION)
        field[rows] = reflected(facets, radio, found.vertices[rows, k : k + 3], field[rows])
        rows = np.flatnonzero(found.kinds[:, k] == TRANSMISSION)
        field[rows] = transmitted(facets, radio, found.vertices[rows, k : k + 2], field[rows])
        rows = np.flatnonzero(found.kinds[:, k] == DIFFRACTION)
        before = lengths[rows, : k + 1].sum(axis=1)
        behind = lengths[rows, k + 1 :].sum(axis=1)
        spread[rows] = 1.0 / np.sqrt(before * behind * (before + behind))
        where = found.vertices[rows, k : k + 3]
        field[rows] = diffracted(
            facets, radio, where, (before, behind), field[rows], may_pass[rows]
        )
    last = np.count_nonzero(found.kinds, axis=1)
    arriving = unit(rays[np.arange(n), last])
    received = dot(field, pattern(radio.receive, -arriving))
    wavelength = radio.source.wavelength_m
    phase = np.exp(-2j * np.pi / wavelength * lengths.sum(axis=1))
    return wavelength / (4.0 * np.pi) * spread * phase * received


def polarisation(directions: Floats) -> Floats:
    """Unit vectors (n, 3) across rays, as close to vertical as they can be."""
    return unit(UP - directions[:, 2, None] * directions)


def pattern(antenna: Antenna, directions: Floats) -> Complexes:
    """Field (n, 3) that an antenna sends towards directions (n, 3)."""
    v = polarisation(directions)
    h = np.cross(v, directions)
    azimuth = np.arctan2(directions[:, 1], directions[:, 0])
    a = antenna.amplitudes(directions[:, 2], azimuth)
    return np.asarray(a.v)[:, None] * v + np.asarray(a.h)[:, None] * h + 0j


def transmitted(facets: Facets, radio: Radio, points: Floats, field: Complexes) -> Complexes:
    """Field behind a wall at the second one of two points (n, 2, 3)."""
    ray = unit(points[:, 1] - points[:, 0])
    facet = np.argmax(facets.containing(points[:, 1]), axis=1)
    normal = facets.normals[facet]
    result = np.empty_like(field)
    for number in np.unique(facets.slab[facet]):
        i = facets.slab[facet] == number
        cos_i = np.abs(dot(ray[i], normal[i]))
        t_te, t_tm = radio.transmit(number, cos_i)
        across = unit(np.cross(ray[i], normal[i]))
        te = dot(field[i], across)[:, None] * across
        result[i] = t_te[:, None] * te + t_tm[:, None] * (field[i] - te)
    return result


def reflected(facets: Facets, radio: Radio, points: Floats, field: Complexes) -> Complexes:
    """Field behind a reflection at the middle one of three points (n, 3, 3)."""
    s_in, s_out = unit(points[:, 1] - points[:, 0]), unit(points[:, 2] - points[:, 1])
    facet = np.argmax(facets.containing(points[:, 1]), axis=1)
    normal = facets.normals[facet]
    across = unit(np.cross(s_in, normal))
    result = np.empty_like(field)
    for number in np.unique(facets.slab[facet]):
        i = facets.slab[facet] == number
        c = radio.reflect(number, np.abs(dot(s_in[i], normal[i])))
        te = c.r_te * dot(field[i], across[i])
        tm = c.r_tm * dot(field[i], np.cross(across[i], s_in[i]))
        result[i] = te[:, None] * across[i] + tm[:, None] * np.cross(across[i], s_out[i])
    return result


def diffracted(
    facets: Facets,
    radio: Radio,
    points: Floats,
    distances: tuple[Floats, Floats],
    field: Complexes,
    may_pass: Mask,
) -> Complexes:
    """Field behind an edge at the middle one of three points, without its spreading.

    The shadow of a sheet holds the transmitted field where a path `may_pass` one more wall.
    """
    before, behind = distances
    s_in, s_out = unit(points[:, 1] - points[:, 0]), unit(points[:, 2] - points[:, 1])
    result = np.zeros_like(field)
    for edge in facets.edges:
        i = np.flatnonzero(_crosses(edge, points))
        if len(i):
            length = before[i] * behind[i] / (before[i] + behind[i])
            result[i] = _over(edge, radio, (s_in[i], s_out[i]), length, field[i], may_pass[i])
    return result


def _crosses(edge: Edge, points: Floats) -> NDArray[np.bool_]:
    """Whether paths meet an edge, and on which side of its faces they come and go."""
    u = (points[:, 1] - edge.start) @ edge.tangent
    off = np.linalg.norm(points[:, 1] - edge.start - u[:, None] * edge.tangent, axis=1)
    on = (off < 1e-6) & (u > 0.0) & (u < edge.length)
    for end in (0, 2):
        on &= edge.angles(points[:, end] - points[:, 1]) <= edge.angle
    return on


def face_dyad(
    radio: Radio, number: int, angles: tuple[Floats, Floats], beta: tuple[Floats, Floats]
) -> Complexes:
    """Reflection (m, 2, 2) of a wedge's face, along the edge before across it.

    Parameters
    ----------
    radio, number
        The face's slab.
    angles
        phi' and phi of the rays, from this face [rad].
    beta
        Sine and cosine of the angle with the edge, about which the free space lies
        counter-clockwise of this face.
    """
    cosine, rotation = _plane_of_incidence(angles, beta)
    c = radio.reflect(number, cosine)
    return rotation @ (np.stack([c.r_te, c.r_tm], 1)[:, :, None] * rotation)


def sheet_dyad(
    radio: Radio, number: int, angles: tuple[Floats, Floats], beta: tuple[Floats, Floats]
) -> Complexes:
    """Transmission (m, 2, 2) of a sheet, as `face_dyad`; docs/theory.md, below eq. 21b."""
    cosine, rotation = _plane_of_incidence(angles, beta)
    coefficients = np.stack(radio.transmit(number, cosine), 1)[:, :, None]
    dyad = np.swapaxes(rotation, 1, 2) @ (coefficients * rotation)
    mixing = np.sin(0.5 * (angles[1] - angles[0]))[:, None, None]
    return dyad * np.where(np.eye(2, dtype=bool), 1.0, mixing)


def _plane_of_incidence(
    angles: tuple[Floats, Floats], beta: tuple[Floats, Floats]
) -> tuple[Floats, Floats]:
    """Cosine of incidence (m,) on a face, and rotation (m, 2, 2) from the edge into its plane."""
    phi_in, phi = angles
    sine = np.sqrt(np.abs(np.sin(phi) * np.sin(phi_in)))
    slant = 0.5 * beta[1] * sine * (np.cos(phi_in) - np.cos(phi))
    turn = np.arctan2(slant, 1.0 - sine**2)
    rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    return np.minimum(sine * beta[0], 1.0), np.moveaxis(rotation, 2, 0)


def _over(
    edge: Edge,
    radio: Radio,
    rays: tuple[Floats, Floats],
    length: Floats,
    field: Complexes,
    may_pass: Mask,
) -> Complexes:
    s_in, s_out = rays
    phi_in, phi = edge.angles(-s_in), edge.angles(s_out)
    sin_beta = np.linalg.norm(np.cross(edge.tangent, s_out), axis=1)
    n = edge.angle / np.pi
    cos_beta = s_out @ edge.tangent
    from_n = (edge.angle - phi_in, edge.angle - phi)
    faces = (
        face_dyad(radio, edge.o_slab, (phi_in, phi), (sin_beta, cos_beta)),
        face_dyad(radio, edge.n_slab, from_n, (sin_beta, -cos_beta)),
    )
    k = 2.0 * np.pi / radio.source.wavelength_m
    through = None
    if may_pass.any() and n > 2.0 - 1e-9 and edge.o_slab == edge.n_slab:
        through = sheet_dyad(radio, edge.o_slab, (phi_in, phi), (sin_beta, cos_beta))
        through = through * may_pass[:, None, None]
    dyad = wedge(n, (phi_in, phi), sin_beta, k * length * sin_beta**2, faces, through)
    round_in = -unit(np.cross(edge.tangent, s_in))
    round_out = unit(np.cross(edge.tangent, s_out))
    along_in, along_out = np.cross(round_in, s_in), np.cross(round_out, s_out)
    arriving = np.stack([dot(field, along_in), dot(field, round_in)], 1)
    along, across = -np.einsum("mij,mj->im", dyad, arriving) / np.sqrt(k)
    return along[:, None] * along_out + across[:, None] * round_out
