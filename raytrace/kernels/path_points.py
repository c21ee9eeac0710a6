"""The points of single paths, in three dimensions."""

import math

from raytrace.arrays import Floats, Int8s
from raytrace.kernels.beams import Tree
from raytrace.kernels.building import Building, TraceGeometry
from raytrace.kernels.compiling import jit
from raytrace.kernels.field import STOREY_TOLERANCE
from raytrace.kernels.guard import Guard, is_stopped
from raytrace.kernels.horizontal_edge_legs import (
    EdgeWorkspace,
    HorizontalEdgeBeams,
    unfold_over_edge,
)
from raytrace.kernels.horizontal_edges import OFFSETS_OF_LEGS_M
from raytrace.kernels.lanes import lane, lanes_of
from raytrace.kernels.plan_view import PlanView, folded, slab_at
from raytrace.kernels.records import Record
from raytrace.kernels.reflections import ReflectionBeams
from raytrace.kernels.strips import from_frame
from raytrace.kernels.unfolding import (
    DISTANCE,
    PASS_PARTIAL,
    PASS_WALL,
    POINT_X,
    POINT_Y,
    SURFACE,
    TYPE,
    Leg,
    unfold,
)
from raytrace.kernels.validity import ONE_SIDED_OFFSETS_M
from raytrace.kernels.vertical_edges import VerticalEdgeBeams

NOTHING, REFLECTION, DIFFRACTION, TRANSMISSION = 0, 1, 2, 3
"""Interactions, as in `Paths.interactions`."""


@jit(inner=True)
def add_point(
    points: Floats, kinds: Int8s, k: int, kind: int, at: tuple[float, float, float]
) -> int:
    """Append a point that is not the first one; return how many there are now."""
    points[k, 0], points[k, 1], points[k, 2] = at
    kinds[k - 1] = kind
    return k + 1


@jit(inner=True)
def interaction(view: PlanView, kind: int, surface: int, z: float) -> int:
    """Interaction with a wall that a leg meets at height z."""
    if kind == PASS_WALL:
        return TRANSMISSION
    if kind == PASS_PARTIAL:
        return NOTHING if slab_at(view, surface, z) < 0 else TRANSMISSION
    return REFLECTION


@jit(inner=True)
def add_leg(
    building: Building,
    whole: tuple[Leg, int, float],
    heights: tuple[float, float, float],
    end: tuple[float, float],
    points: Floats,
    kinds: Int8s,
    k: int,
) -> int:
    """Append the interactions of a leg with walls, floor and ceiling in their order.

    Parameters
    ----------
    building
        The building.
    whole
        The leg (the first of eight), its number of interactions, its horizontal length [m].
    heights
        Unfolded height at its root [m], slope, and the height offset of its evaluation [m].
    end
        Where it ends in the plan view [m]; `points[k - 1]` is where it begins.
    points, kinds, k
        Written to from k on.

    Returns
    -------
    int
        Number of points so far.
    """
    (leg, n, length), (z_root, slope, offset), height = whole, heights, building.height
    done, x, y = 0.0, points[k - 1, 0], points[k - 1, 1]
    upwards = math.copysign(1.0, slope)
    storey = math.floor(z_root / height - upwards * STOREY_TOLERANCE) + max(upwards, 0.0)
    at_edge = STOREY_TOLERANCE * height / abs(slope) if slope != 0.0 else 0.0
    for i in range(n + 1):
        last = i == n
        distance = length if last else leg.interactions[i, DISTANCE, 0]
        to_x = end[0] if last else leg.interactions[i, POINT_X, 0]
        to_y = end[1] if last else leg.interactions[i, POINT_Y, 0]
        while slope != 0.0 and (storey * height - z_root) / slope < distance - at_edge:
            w = ((storey * height - z_root) / slope - done) / (distance - done)
            z = height if int(storey) & 1 else 0.0
            k = add_point(points, kinds, k, REFLECTION, (x + w * (to_x - x), y + w * (to_y - y), z))
            storey += upwards
        if not last:
            z = folded(z_root + slope * distance, height)
            beside = folded(z_root + slope * distance + offset, height)
            kind = interaction(building.plan, leg.types[i, TYPE], leg.types[i, SURFACE], beside)
            if kind != NOTHING:
                k = add_point(points, kinds, k, kind, (to_x, to_y, z))
        done, x, y = distance, to_x, to_y
    return k


@jit(inner=True)
def start_path(geometry: TraceGeometry, points: Floats) -> int:
    """Write the transmitter as the first point."""
    for k in range(3):
        points[0, k] = geometry.transmitter[k]
    return 1


@jit(inner=True)
def finish_path(geometry: TraceGeometry, r: int, points: Floats, k: int) -> None:
    """Write the receiver as the last point, repeated to the end."""
    receivers = geometry.receivers
    for end in range(k, len(points)):
        points[end, 0], points[end, 1] = receivers.xy[r, 0], receivers.xy[r, 1]
        points[end, 2] = receivers.image_z[receivers.level[r], 0]


@jit(inner=True)
def unfold_one(
    view: PlanView, tree: Tree, i: int, target: tuple[float, float], leg: Leg
) -> tuple[int, float]:
    """Number of interactions and length of a leg (see `unfolding.unfold`)."""
    at = lanes_of(target[0]), lanes_of(target[1])
    n, length, _, _ = unfold(view, tree.link, tree.beam, i, at, leg)
    return n, lane(length, 0)


@jit(allocates=False)
def reflection_points(
    geometry: TraceGeometry,
    beams: ReflectionBeams,
    leg: Leg,
    record: Record,
    points: Floats,
    kinds: Int8s,
    guard: Guard,
) -> None:
    """Write points (n, k, 3) and interactions (n, k - 2) of recorded reflection paths."""
    building, receivers, hits = geometry.building, geometry.receivers, beams.hits
    z = geometry.transmitter[2]
    for path in range(record.used[0]):
        if is_stopped(guard):
            break
        r, i = hits.pair[record.key[path, 0], 0], hits.pair[record.key[path, 0], 1]
        end = (receivers.xy[r, 0], receivers.xy[r, 1])
        n, length = unfold_one(building.plan, beams.tree, i, end, leg)
        slope = (receivers.image_z[receivers.level[r], record.key[path, 3]] - z) / length
        k = start_path(geometry, points[path])
        heights = (z, slope, ONE_SIDED_OFFSETS_M[record.key[path, 4]])
        k = add_leg(building, (leg, n, length), heights, end, points[path], kinds[path], k)
        finish_path(geometry, r, points[path], k)


@jit(allocates=False)
def vertical_edge_points(
    geometry: TraceGeometry,
    beams: VerticalEdgeBeams,
    leg: Leg,
    record: Record,
    points: Floats,
    kinds: Int8s,
    guard: Guard,
) -> None:
    """Write points and interactions of recorded paths over a vertical edge."""
    building, receivers = geometry.building, geometry.receivers
    edge, legs, hits = beams.edge, beams.legs, beams.hits
    z = geometry.transmitter[2]
    for path in range(record.used[0]):
        if is_stopped(guard):
            break
        hit, p = record.key[path, 0], record.key[path, 1]
        leg_in = Leg(legs.interactions[p], legs.types[p])
        n_in, length_in = int(legs.n_interactions[p]), float(legs.length[p])
        r, i = hits.pair[hit, 0], hits.pair[hit, 1]
        end = (receivers.xy[r, 0], receivers.xy[r, 1])
        n, length = unfold_one(building.plan, beams.tree, i, end, leg)
        image_z = receivers.image_z[receivers.level[r], record.key[path, 3]]
        slope = (image_z - z) / (length_in + length)
        z_edge = z + slope * length_in
        row, kind = points[path], kinds[path]
        k = start_path(geometry, row)
        at, offset = (edge.x, edge.y), ONE_SIDED_OFFSETS_M[record.key[path, 4]]
        k = add_leg(building, (leg_in, n_in, length_in), (z, slope, offset), at, row, kind, k)
        z_point = folded(z_edge, building.height)
        k = add_point(row, kind, k, DIFFRACTION, (edge.x, edge.y, z_point))
        k = add_leg(building, (leg, n, length), (z_edge, slope, offset), end, row, kind, k)
        finish_path(geometry, r, row, k)


@jit(allocates=False)
def horizontal_edge_points(
    geometry: TraceGeometry,
    beams: HorizontalEdgeBeams,
    work: EdgeWorkspace,
    record: Record,
    points: Floats,
    kinds: Int8s,
    guard: Guard,
) -> None:
    """Write points and interactions of recorded paths over a horizontal edge."""
    building, receivers = geometry.building, geometry.receivers
    edge, images, hits, seen = beams.edge, beams.images, beams.hits, beams.seen
    trees = beams.tree, beams.strips
    for path in range(record.used[0]):
        if is_stopped(guard):
            break
        hit, p = int(record.key[path, 0]), int(record.key[path, 1])
        a, b = int(record.key[path, 2]), int(record.key[path, 3])
        r, i = hits.pair[hit, 0], hits.pair[hit, 1]
        rise_in = float(edge.z - geometry.transmitter_z[a])
        rise_out = float(receivers.image_z[receivers.level[r], b] - edge.z)
        in_, out = math.hypot(images.h[p], rise_in), math.hypot(seen[hit, 1], rise_out)
        u = (images.x[p] * out + seen[hit, 0] * in_) / (in_ + out)
        end = (receivers.xy[r, 0], receivers.xy[r, 1])
        (n_in, lengths_in, _, _), (n, lengths, _, _) = unfold_over_edge(
            building.plan, edge.frame, lanes_of(u), trees, (images.beam[p], i),
            (lanes_of(end[0]), lanes_of(end[1])), work,
        )  # fmt: skip
        length_in, length = lane(lengths_in, 0), lane(lengths, 0)
        at, offsets = from_frame(edge.frame, u), OFFSETS_OF_LEGS_M[record.key[path, 4]]
        slope = (-rise_in if geometry.image_bounces[a] & 1 else rise_in) / length_in
        row, kind = points[path], kinds[path]
        k = start_path(geometry, row)
        heights = (geometry.transmitter[2], slope, offsets[0])
        k = add_leg(building, (work.leg_in, n_in, length_in), heights, at, row, kind, k)
        k = add_point(row, kind, k, DIFFRACTION, (at[0], at[1], edge.z))
        heights = (edge.z, rise_out / length, offsets[1])
        k = add_leg(building, (work.leg_out, n, length), heights, end, row, kind, k)
        finish_path(geometry, r, row, k)
