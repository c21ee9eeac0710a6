"""The diffraction of a single path, as `Steps.wedge` holds it."""

import math

from raytrace.arrays import Floats
from raytrace.kernels.compiling import jit
from raytrace.kernels.horizontal_edge_field import turned_to_edge
from raytrace.kernels.horizontal_edge_legs import HorizontalEdgeArrays
from raytrace.kernels.lanes import Lanes, lane, lanes_of
from raytrace.kernels.plan_view import GRAZING_M
from raytrace.kernels.steps import (
    COSINE_N,
    COSINE_O,
    FACTOR_0,
    FACTOR_1,
    FACTOR_2,
    FACTOR_3,
    IN_ACROSS,
    IN_ALONG,
    MIXED_N,
    MIXED_O,
    MIXED_SHADOW,
    OUT_ACROSS,
    OUT_ALONG,
    ROOT_2KL,
    SHADOWS,
    SIZE_0,
    SIZE_1,
    SIZE_2,
    SIZE_3,
    SQUARED_N,
    SQUARED_O,
    Steps,
)
from raytrace.kernels.utd import WedgeTerms, incidence_turn, wedge_terms
from raytrace.kernels.vertical_edge_legs import VerticalEdgeArrays, angles_towards
from raytrace.kernels.wedge import FaceAngles, Wedge, face_angles


@jit(inner=True)
def write_wedge(
    steps: Steps,
    path: int,
    wedge: Wedge,
    terms: WedgeTerms,
    root_2kl: float,
    beta: tuple[float, float],
    transmits: float,
) -> None:
    """Write a diffraction without a rotation into the edge's polarisations.

    Parameters
    ----------
    steps, path
        Written to.
    wedge, terms
        The wedge, and its terms (the first of eight).
    root_2kl
        sqrt(2 k L) for a wavelength of 1 m.
    beta, transmits
        See `utd.diffracted`.
    """
    row = steps.wedge[path]
    steps.face[path, 0], steps.face[path, 1] = wedge.o_slab, wedge.n_slab
    row[ROOT_2KL] = root_2kl
    cos_beta = lanes_of(beta[1])
    squared, mixed = incidence_turn(terms.o_cosine, terms.o_turn, cos_beta)
    row[COSINE_O] = min(lane(terms.o_cosine, 0) * beta[0], 1.0)
    row[SQUARED_O], row[MIXED_O] = lane(squared, 0), lane(mixed, 0)
    row[COSINE_N] = row[SQUARED_N] = row[MIXED_N] = row[SHADOWS] = row[MIXED_SHADOW] = 0.0
    if wedge.is_sheet:
        row[FACTOR_0], row[SIZE_0] = half_plane_pair(lane(terms.cos_minus, 0))
        row[FACTOR_3], row[SIZE_3] = half_plane_pair(lane(terms.cos_plus, 0))
        row[FACTOR_1] = row[SIZE_1] = row[FACTOR_2] = row[SIZE_2] = 0.0
        row[MIXED_SHADOW] = row[MIXED_O] * lane(terms.sin_minus, 0)
        row[MIXED_O] *= lane(terms.sin_plus, 0)
        row[SHADOWS] = transmits
    else:
        squared, mixed = incidence_turn(terms.n_cosine, terms.n_turn, cos_beta)
        row[COSINE_N] = min(lane(terms.n_cosine, 0) * beta[0], 1.0)
        row[SQUARED_N], row[MIXED_N] = lane(squared, 0), lane(mixed, 0)
        for k in range(4):
            angular = lane(terms.angular[k], 0)
            row[FACTOR_0 + 2 * k] = angular
            row[SIZE_0 + 2 * k] = lane(terms.cotangent[k], 0) * angular
    row[IN_ALONG], row[IN_ACROSS], row[OUT_ALONG], row[OUT_ACROSS] = 1.0, 0.0, 1.0, 0.0


@jit(inner=True)
def write_turns(
    steps: Steps,
    path: int,
    frame: Floats,
    arriving: tuple[float, float, float],
    leaving: tuple[float, float, float],
) -> None:
    """Write the rotations into the polarisations of a horizontal edge and back.

    Parameters
    ----------
    steps, path
        Written to.
    frame
        Of the edge, see `strips`.
    arriving, leaving
        Horizontal direction and sine of the elevation of the ray, before and behind the edge.
    """
    row = steps.wedge[path]
    along, across = turned_to_edge(
        frame, lanes_of(arriving[0]), lanes_of(arriving[1]), lanes_of(arriving[2])
    )
    row[IN_ALONG], row[IN_ACROSS] = lane(along, 0), lane(across, 0)
    inv_sin2 = 1.0 / (row[IN_ALONG] * row[IN_ALONG] + row[IN_ACROSS] * row[IN_ACROSS])
    row[IN_ALONG] *= inv_sin2
    row[IN_ACROSS] *= inv_sin2
    along, across = turned_to_edge(
        frame, lanes_of(leaving[0]), lanes_of(leaving[1]), lanes_of(leaving[2])
    )
    row[OUT_ALONG], row[OUT_ACROSS] = lane(along, 0), lane(across, 0)


@jit(inner=True)
def half_plane_pair(cosine: float) -> tuple[float, float]:
    """Factor and size of a term of a half plane, see `utd.half_plane_term`."""
    return abs(cosine), (math.copysign(2.0, cosine) if cosine != 0.0 else 0.0)


@jit(inner=True)
def vertical_terms(
    edge: VerticalEdgeArrays,
    angles_in: FaceAngles,
    leaving: tuple[Lanes, Lanes],
    length_out: float,
    rows: Floats,
) -> WedgeTerms:
    """Terms of a path over a vertical edge, as `vertical_edges.pair_of` makes them."""
    angles_out = angles_towards(edge, leaving[0], leaving[1], rows)
    grazing = (0.5 * GRAZING_M) * (1.0 / lanes_of(length_out))
    return wedge_terms(edge.wedge, angles_out, angles_in, grazing)


@jit(inner=True)
def horizontal_terms(
    edge: HorizontalEdgeArrays,
    before: tuple[float, float],
    behind: tuple[float, float],
    rows: Floats,
) -> WedgeTerms:
    """Terms of a path over a horizontal edge, as `horizontal_edge_field.over_edge` makes them.

    Parameters
    ----------
    edge
        The edge.
    before, behind
        Distance from the edge in the plan view, and height above it (of the image), of transmitter
        and receiver [m].
    rows
        Scratch.
    """
    h_in, h_out = before[0], behind[0]
    z_in, z_out = edge.up * before[1], behind[1] * edge.up
    inv_in, inv_out = 1.0 / math.hypot(h_in, z_in), 1.0 / math.hypot(h_out, z_out)
    incident = face_angles(edge.wedge, lanes_of(z_in * inv_in), lanes_of(h_in * inv_in), rows)
    at = face_angles(edge.wedge, lanes_of(z_out * inv_out), lanes_of(h_out * inv_out), rows)
    grazing = lanes_of((abs(h_in) + h_out) * inv_out * (0.5 * GRAZING_M * inv_in))
    return wedge_terms(edge.wedge, at, incident, grazing)
