"""Images of receivers over a horizontal edge: which may form a path, and how strong it can be.

All of this is known before the legs of a path are unfolded.
"""

import math
from typing import NamedTuple

from raytrace.arrays import Floats
from raytrace.kernels.blocks import Block
from raytrace.kernels.bounds import bounce_bound, free_space, wedge_bound
from raytrace.kernels.building import TraceGeometry
from raytrace.kernels.compiling import jit
from raytrace.kernels.field_tables import FieldTables
from raytrace.kernels.horizontal_edge_field import angles_at_edge, angles_from_wall, hypot
from raytrace.kernels.horizontal_edge_legs import (
    EdgePath,
    EdgeWorkspace,
    HorizontalEdgeArrays,
    ImagesIn,
)
from raytrace.kernels.lanes import (
    WIDTH,
    Lanes,
    Mask,
    absolute,
    lanes_of,
    load,
    maximum,
    minimum,
    sqrt,
    store,
    where,
)
from raytrace.kernels.plan_view import GRAZING_M

MARGIN_M = 1e-6
"""Points of an edge this near to its visible interval are examined [m]."""


class Seen(NamedTuple):
    """Eight receivers in the frame of an edge.

    Attributes
    ----------
    x, h
        Where they are along the edge, and how far off it in the plan view [m].
    low, high
        The interval of the edge that is visible from them [m].
    """

    x: Lanes
    h: Lanes
    low: Lanes
    high: Lanes


@jit(inline=True)
def seen_from(seen: Floats, block: Block, rows: Floats) -> Seen:
    """Receivers of a block in the frame of an edge; `rows` is scratch."""
    for j in range(WIDTH):
        hit = block.first + min(j, block.n - 1)
        rows[0, j], rows[1, j] = seen[hit, 0], seen[hit, 1]
        rows[2, j], rows[3, j] = seen[hit, 2], seen[hit, 3]
    return Seen(load(rows[0]), load(rows[1]), load(rows[2]), load(rows[3]))


@jit(inner=True, fast=True)
def set_images(edge: HorizontalEdgeArrays, h: Lanes, is_bounded: bool, work: EdgeWorkspace) -> None:
    """Set the distances and angles in `work` for images of receivers that far off the edge [m]."""
    for k in range(len(work.across)):
        z = load(work.workspace.image_z[k])
        across = hypot(h, z - edge.z)
        store(work.across[k], across)
        left, before = (k + 1) // 2, k // 2
        nearest = farthest = across
        if k > 0:
            nearest = minimum(across, load(work.nearest[before]))
            farthest = maximum(across, load(work.farthest[before]))
        store(work.nearest[left], nearest)
        store(work.farthest[left], farthest)
        if is_bounded:
            at = halves_of(edge, h, z, work.workspace.rows)
            store(work.halves[k, 0], at[0])
            store(work.halves[k, 1], at[1])


@jit(inline=True)
def may_cross(images: ImagesIn, seen: Seen, p: int, left: int, work: EdgeWorkspace) -> Mask:
    """Whether paths over some image heights can cross the edge within the visible interval."""
    x, (near, far) = images.x[p], (images.nearest[p, left], images.farthest[p, left])
    one = x + (seen.x - x) * (near / (near + load(work.farthest[left])))
    other = x + (seen.x - x) * (far / (far + load(work.nearest[left])))
    low, high = maximum(seen.low, images.low[p]), minimum(seen.high, images.high[p])
    inside = (maximum(one, other) > low - MARGIN_M) & (minimum(one, other) < high + MARGIN_M)
    return inside & (high - low > GRAZING_M)


@jit(inline=True)
def weight_inside(u: Lanes, low: Lanes, high: Lanes) -> Lanes:
    """1 for points inside the interval from low to high, one half at its ends, 0 outside."""
    inside = minimum(u - low, high - u)
    half = where(inside > -GRAZING_M, lanes_of(0.5), 0.0)
    return where(inside >= GRAZING_M, 1.0, half)


@jit(inner=True, fast=True)
def path_bound(
    geometry: TraceGeometry,
    tables: FieldTables,
    path: EdgePath,
    shadow: Floats,
    work: EdgeWorkspace,
) -> Lanes:
    """Bound on the power of paths over an edge, without the walls."""
    total, building = path.before + path.after, geometry.building
    sin_beta = across_edge(path) / total
    product = path.before * path.after / total
    sqrt_2kl = sqrt((4.0 * math.pi / tables.wavelength) * product * sin_beta)
    at, incident = angles_at_edge(path, work.workspace.rows)
    directions = at, at, incident
    bound = wedge_bound(tables, path.edge.wedge, directions, shadow, sqrt_2kl, sin_beta)
    sine_in = lanes_of(abs(path.edge.z - path.z_in)) / path.before
    sine_out = absolute(path.z_out - path.edge.z) / path.after
    bound = bound * bounce_bound(building, tables, sine_in, path.bounces_in)
    bound = bound * bounce_bound(building, tables, sine_out, path.bounces_out)
    return bound * free_space(tables, total)


@jit(inline=True, fast=True)
def halves_of(edge: HorizontalEdgeArrays, h: Lanes, z: Lanes, rows: Floats) -> tuple[Lanes, Lanes]:
    """Cosine and sine of half the angle from the wall (see `angles_from_wall`)."""
    angles = angles_from_wall(edge, h, z, rows)
    return angles.cos_half, angles.sin_half


@jit(inline=True, fast=True)
def quick_bound(
    tables: FieldTables,
    incident: tuple[Lanes, Lanes],
    across_in: Lanes,
    largest_shadow: float,
    work: EdgeWorkspace,
    b: int,
) -> Lanes:
    """`path_bound` for rays at right angles to the edge, and without floor, ceiling and faces.

    Parameters
    ----------
    tables, largest_shadow
        Wavelength and antennas, and the largest |1 - T'|^2 at any angle.
    incident, across_in
        Half the angle before the edge, as from `halves_of`, and the distance there [m].
    work, b
        What is behind it, and which of the height images.
    """
    (gh, fh), across_out = incident, load(work.across[b])
    ch, sh, total = load(work.halves[b, 0]), load(work.halves[b, 1]), across_in + across_out
    size = sqrt(tables.wavelength * total / (across_in * across_out)) * (0.25 / math.pi)
    amplitude = minimum(size / absolute(ch * gh + sh * fh), lanes_of(0.5)) * math.sqrt(
        largest_shadow
    )
    amplitude = amplitude + minimum(size / absolute(ch * gh - sh * fh), lanes_of(0.5))
    return amplitude * amplitude * free_space(tables, total)


@jit(inline=True)
def across_edge(path: EdgePath) -> Lanes:
    """Distances of both ends from the edge's line, added up [m]."""
    before = math.hypot(path.h_in, path.z_in - path.edge.z)
    return before + hypot(path.h_out, path.z_out - path.edge.z)
