"""The legs from the transmitter to a vertical edge."""

import math
from typing import Any, NamedTuple

import numpy as np

from raytrace.arrays import Bools, Floats, Int32s, Ints
from raytrace.kernels.beam_hits import Hits
from raytrace.kernels.beams import FRACTION, IMAGE_X, IMAGE_Y, ORDER, Tree
from raytrace.kernels.compiling import jit
from raytrace.kernels.guard import Guard, is_stopped
from raytrace.kernels.lanes import WIDTH, Lanes, lane, lanes_of
from raytrace.kernels.plan_view import PlanView
from raytrace.kernels.unfolding import Leg, has_height_limits, max_interactions, unfold
from raytrace.kernels.wedge import ALONG_FACE, FaceAngles, Wedge, angle_from, face_angles


class VerticalEdgeArrays(NamedTuple):
    """A vertical edge.

    Attributes
    ----------
    x, y, z_low, z_high
        Where it stands [m]; it ends beyond floor and ceiling where it reaches them.
    o_face
        Azimuth of its o-face [rad].
    wedge
        Its angle and faces.
    """

    x: float
    y: float
    z_low: float
    z_high: float
    o_face: float
    wedge: Wedge


class LegsIn(NamedTuple):
    """The legs from the transmitter to an edge, by rising number of reflections.

    Attributes
    ----------
    order, n_interactions, length
        (n,) reflections, interactions, and horizontal length [m].
    weight, fraction
        (n,) weight of a grazing leg, and see `beams.FRACTION`.
    departure
        (n, 2) horizontal direction at the transmitter.
    has_height_limits
        (n,) see `unfolding.has_height_limits`.
    angles
        (n, 7) see `wedge.FaceAngles`.
    interactions, types
        (n, n_max + 1, 5, 8), (n, n_max + 1, 3) their legs, the same in all eight lanes.
    """

    order: Ints
    n_interactions: Ints
    length: Floats
    weight: Floats
    fraction: Floats
    departure: Floats
    has_height_limits: Bools
    angles: Floats
    interactions: Floats
    types: Ints


class VerticalEdgeBeams(NamedTuple):
    """An edge, the legs to it, the beams from it, and the receivers visible from these.

    Attributes
    ----------
    edge, legs, tree, hits
        These.
    ranks
        (n_legs, 4) see `losses.LossLimit`; n_legs = 0 where no loss limits the beams.
    """

    edge: VerticalEdgeArrays
    legs: LegsIn
    tree: Tree
    hits: Hits
    ranks: Floats


class LegsOut(NamedTuple):
    """Eight legs from the edge, of one beam.

    Attributes
    ----------
    leg, n, length, inv_length, order
        The legs, their interactions, horizontal lengths [m] and their inverses, and reflections.
    angles
        The directions at the wedge.
    arriving
        Horizontal directions that the paths come from.
    has_height_limits
        See `unfolding.has_height_limits`.
    """

    leg: Leg
    n: int
    length: Lanes
    inv_length: Lanes
    order: int
    angles: FaceAngles
    arriving: tuple[Lanes, Lanes]
    has_height_limits: bool


@jit(inline=True)
def angles_towards(edge: VerticalEdgeArrays, ux: Lanes, uy: Lanes, rows: Floats) -> FaceAngles:
    """Angles of horizontal directions from the o-face; `rows` is scratch."""
    c, s = math.cos(edge.o_face), math.sin(edge.o_face)
    return face_angles(edge.wedge, ux * c + uy * s, uy * c - ux * s, rows)


@jit(inline=True)
def angles_of(legs: LegsIn, p: int) -> FaceAngles:
    """Angles from the o-face in which leg p arrives."""
    a = legs.angles[p]
    return FaceAngles(
        lanes_of(a[0]), lanes_of(a[1]), lanes_of(a[2]), lanes_of(a[3]), lanes_of(a[4]),
        lanes_of(a[5]), lanes_of(a[6]),
    )  # fmt: skip


def leg_bytes(link: Int32s) -> int:
    """Size of a row of `LegsIn` where the legs are those of some beams."""
    return 15 * 8 + (max_interactions(link) + 1) * (5 * WIDTH + 4) * 8


def legs_to_edge(
    view: PlanView,
    tree: Tree,
    beams: Int32s,
    weight: Floats,
    edge: VerticalEdgeArrays,
    guard: Guard,
) -> LegsIn:
    """Unfold the legs from the transmitter to an edge.

    Parameters
    ----------
    view, tree
        The plan view and the beams from the transmitter.
    beams, weight
        (n,) beams from which the edge is visible, by rising order, and weights of grazing ones.
    edge
        The edge; legs that arrive within its wall or along a face are left out: a face reflects
        a grazing ray with -1, so that the two cancel.
    guard
        May end the work.
    """
    n, n_max = len(beams), max_interactions(tree.link[beams])
    legs = LegsIn(
        np.empty(n, np.int64),
        np.empty(n, np.int64),
        np.empty(n),
        np.empty(n),
        np.empty(n),
        np.empty((n, 2)),
        np.empty(n, np.bool_),
        np.empty((n, 7)),
        np.empty((n, n_max + 1, 5, WIDTH)),
        np.empty((n, n_max + 1, 4), np.int64),
    )
    kept = fill_legs(view, tree, beams, weight, edge, legs, guard)
    columns: Any = legs
    return LegsIn(*(column[:kept] for column in columns))


@jit()
def fill_legs(
    view: PlanView,
    tree: Tree,
    beams: Int32s,
    weight: Floats,
    edge: VerticalEdgeArrays,
    legs: LegsIn,
    guard: Guard,
) -> int:
    """Fill in legs as `legs_to_edge` makes them; return how many there are."""
    rows, kept = np.empty((3, WIDTH)), 0
    target = lanes_of(edge.x), lanes_of(edge.y)
    for b in range(len(beams)):
        if is_stopped(guard):
            break
        i = beams[b]
        dx, dy = tree.beam[i, IMAGE_X] - edge.x, tree.beam[i, IMAGE_Y] - edge.y
        phi = angle_from(math.atan2(dy, dx), edge.o_face)
        if not ALONG_FACE < phi < edge.wedge.n * math.pi - ALONG_FACE:
            continue
        leg = Leg(legs.interactions[kept], legs.types[kept])
        n, length, ux, uy = unfold(view, tree.link, tree.beam, i, target, leg)
        legs.departure[kept, 0], legs.departure[kept, 1] = lane(ux, 0), lane(uy, 0)
        legs.order[kept], legs.n_interactions[kept] = tree.link[i, ORDER], n
        legs.length[kept], legs.weight[kept] = lane(length, 0), weight[b]
        legs.fraction[kept] = tree.beam[i, FRACTION]
        legs.has_height_limits[kept] = has_height_limits(leg, n)
        inv_length = 1.0 / math.hypot(dx, dy)
        angles = angles_towards(edge, lanes_of(dx * inv_length), lanes_of(dy * inv_length), rows)
        for k, angle in enumerate(angles):
            legs.angles[kept, k] = lane(angle, 0)
        kept += 1
    return kept
