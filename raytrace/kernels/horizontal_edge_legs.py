"""The legs of paths that cross a horizontal edge, unfolded and checked against the walls."""

from typing import NamedTuple

import numpy as np

from raytrace.arrays import Floats, Ints
from raytrace.kernels.beam_hits import Hits
from raytrace.kernels.beams import IMAGE_X, IMAGE_Y, PARENT, Tree
from raytrace.kernels.blocks import Block
from raytrace.kernels.building import Building, TraceGeometry
from raytrace.kernels.compiling import jit
from raytrace.kernels.edge_rays import from_frame
from raytrace.kernels.lanes import WIDTH, Lanes, Mask, lanes_of, load, store
from raytrace.kernels.plan_view import PlanView
from raytrace.kernels.strips import StripTree
from raytrace.kernels.unfolding import Leg, new_leg, unfold
from raytrace.kernels.validity import walls_met
from raytrace.kernels.wedge import Wedge
from raytrace.kernels.workspace import Workspace, new_workspace


class HorizontalEdgeArrays(NamedTuple):
    """A lintel, a sill or the top of a wall.

    Attributes
    ----------
    frame
        (8,) of its edge of the plan view, seen from the side the paths leave to.
    z
        Its height [m].
    up
        1 where the wall is above it, -1 where below.
    wedge
        The end of the wall's sheet.
    """

    frame: Floats
    z: float
    up: float
    wedge: Wedge


class ImagesIn(NamedTuple):
    """Beams from the transmitter that meet a horizontal edge, by rising number of reflections.

    Attributes
    ----------
    order, beam
        (n,) reflections, and the beam.
    x, h
        (n,) image of the transmitter in the frame of the edge [m]; h < 0 behind it.
    low, high
        (n,) the interval of the edge within the beam [m].
    fraction
        (n,) see `beams.FRACTION`.
    nearest, farthest
        (n, max_reflections + 1) least and largest distance of its images in floor and ceiling, of
        so many reflections at most, from the edge's line [m].
    """

    order: Ints
    beam: Ints
    x: Floats
    h: Floats
    low: Floats
    high: Floats
    fraction: Floats
    nearest: Floats
    farthest: Floats


class HorizontalEdgeBeams(NamedTuple):
    """An edge, the beams to it and from one side of it, and the receivers visible from these.

    Attributes
    ----------
    edge, tree, images
        The edge, all beams from the transmitter, and those that meet the edge.
    strips, hits, seen
        Beams from the edge, and the receivers visible from them (see `strip_hits.hit_from_strip`).
    ranks, over_edge
        (n, 4), (n, max_reflections + 1, DISTANCES + 1) bounds on the power by each image, see
        `losses.LossLimit` and `bounds_over_edge`; n = 0 where no loss limits the beams.
    """

    edge: HorizontalEdgeArrays
    tree: Tree
    images: ImagesIn
    strips: StripTree
    hits: Hits
    seen: Floats
    ranks: Floats
    over_edge: Floats


class EdgeWorkspace(NamedTuple):
    """Working arrays for paths over horizontal edges.

    Attributes
    ----------
    workspace
        Those of every path class.
    leg_in, leg_out
        The legs to the edge and from it.
    images
        (n_beams, 2, 8) images of the points where paths cross the edge [m].
    across
        (2 max_reflections + 1, 8) distances of the receivers' images from the edge's line [m].
    nearest, farthest
        (max_reflections + 1, 8) the same as in `ImagesIn`.
    halves
        (2 max_reflections + 1, 2, 8) cosine and sine of half the angles between these and the wall;
        not set without a power threshold.
    """

    workspace: Workspace
    leg_in: Leg
    leg_out: Leg
    images: Floats
    across: Floats
    nearest: Floats
    farthest: Floats
    halves: Floats


def new_edge_workspace(
    max_reflections: int, beams: HorizontalEdgeBeams, n_others: int = 0
) -> EdgeWorkspace:
    """Working arrays for the paths over an edge."""
    strips = beams.strips
    leg_in, leg_out = new_leg(beams.tree.link[beams.images.beam]), new_leg(strips.link)
    return EdgeWorkspace(
        new_workspace(max_reflections, max(len(leg_in.types), len(leg_out.types)), n_others),
        leg_in,
        leg_out,
        np.empty((len(strips.link), 2, WIDTH)),
        np.empty((2 * max_reflections + 1, WIDTH)),
        np.empty((max_reflections + 1, WIDTH)),
        np.empty((max_reflections + 1, WIDTH)),
        np.empty((2 * max_reflections + 1, 2, WIDTH)),
    )


class EdgePath(NamedTuple):
    """Eight paths over a horizontal edge, from the same image of the transmitter.

    Attributes
    ----------
    edge
        The edge.
    u
        Where they cross it, from its start [m].
    before, after
        Lengths before and behind the edge [m].
    h_in, h_out
        Distances of transmitter and receivers from the edge in the plan view [m].
    z_in, z_out
        Images of their heights as seen from the edge [m].
    bounces_in, bounces_out
        Reflections at floor and ceiling before and behind the edge.
    beam_in, beam_out
        Beams that meet the edge, and the receivers.
    leg, image_in, image_out
        Numbers of the beam to the edge among those that meet it, and of the height images.
    order
        All reflections.
    """

    edge: HorizontalEdgeArrays
    u: Lanes
    before: Lanes
    after: Lanes
    h_in: float
    h_out: Lanes
    z_in: float
    z_out: Lanes
    bounces_in: int
    bounces_out: int
    beam_in: int
    beam_out: int
    leg: int
    image_in: int
    image_out: int
    order: int


class EdgeLegs(NamedTuple):
    """Both legs of eight paths over a horizontal edge.

    Attributes
    ----------
    n_in, n_out
        Number of their interactions.
    length_in, length_out
        Horizontal lengths [m].
    departure, leaving
        Horizontal directions at the transmitter, and from the edge.
    arriving
        Horizontal directions that they come from.
    slope_in, slope_out
        Growth of the unfolded heights over horizontal distance.
    """

    n_in: int
    n_out: int
    length_in: Lanes
    length_out: Lanes
    departure: tuple[Lanes, Lanes]
    leaving: tuple[Lanes, Lanes]
    arriving: tuple[Lanes, Lanes]
    slope_in: Lanes
    slope_out: Lanes


@jit(inline=True)
def unfold_over_edge(
    view: PlanView,
    frame: Floats,
    u: Lanes,
    trees: tuple[Tree, StripTree],
    beams: tuple[int, int],
    receivers: tuple[Lanes, Lanes],
    work: EdgeWorkspace,
) -> tuple[tuple[int, Lanes, Lanes, Lanes], tuple[int, Lanes, Lanes, Lanes]]:
    """Unfold both legs of paths that cross the edge at u (see `unfolding.unfold`)."""
    tree, strips = trees
    leg_in = unfold(view, tree.link, tree.beam, beams[0], from_frame(frame, u), work.leg_in)
    i = beams[1]
    while i >= 0:
        x, y = from_frame(strips.frame[i], u)
        store(work.images[i, IMAGE_X], x)
        store(work.images[i, IMAGE_Y], y)
        i = strips.link[i, PARENT]
    leg_out = unfold(view, strips.link, work.images, beams[1], receivers, work.leg_out)
    return leg_in, leg_out


@jit(inner=True)
def legs_over_edge(
    view: PlanView,
    path: EdgePath,
    trees: tuple[Tree, StripTree],
    block: Block,
    work: EdgeWorkspace,
) -> EdgeLegs:
    """Unfold both legs of paths; their interactions are written to `work`."""
    edge = path.edge
    beams, receivers = (path.beam_in, path.beam_out), (block.x, block.y)
    legs = unfold_over_edge(view, edge.frame, path.u, trees, beams, receivers, work)
    (n_in, length_in, wx, wy), (n_out, length_out, ux, uy) = legs
    inv_length = 1.0 / length_out
    arriving = (
        (load(work.images[path.beam_out, IMAGE_X]) - block.x) * inv_length,
        (load(work.images[path.beam_out, IMAGE_Y]) - block.y) * inv_length,
    )
    rise_in = edge.z - path.z_in
    start = -rise_in if path.bounces_in & 1 else rise_in
    slope_out = (path.z_out - edge.z) * inv_length
    return EdgeLegs(
        n_in,
        n_out,
        length_in,
        length_out,
        (wx, wy),
        (ux, uy),
        arriving,
        start / length_in,
        slope_out,
    )


@jit(inner=True)
def walls_of_leg(
    building: Building, leg: Leg, n: int, z_root: Lanes, slope: Lanes, offset: float
) -> tuple[Lanes, Mask]:
    """`validity.walls_met`, not inlined."""
    return walls_met(building, leg, n, z_root, slope, offset)


@jit(inner=True)
def walls_over_edge(
    geometry: TraceGeometry,
    edge: HorizontalEdgeArrays,
    legs: EdgeLegs,
    offsets: tuple[float, float],
    work: EdgeWorkspace,
) -> tuple[Lanes, Mask]:
    """Transmissions on paths, and which graze an edge, as for `validity.walls_met`."""
    building, z = geometry.building, lanes_of(geometry.transmitter[2])
    before, grazing = walls_of_leg(building, work.leg_in, legs.n_in, z, legs.slope_in, offsets[0])
    z = lanes_of(edge.z)
    behind, also = walls_of_leg(building, work.leg_out, legs.n_out, z, legs.slope_out, offsets[1])
    return before + behind, grazing | also
