"""The points of single paths, in three dimensions, and the steps that their gains depend on."""

import math

from raytrace.arrays import Floats
from raytrace.kernels.beams import IMAGE_X, IMAGE_Y, Tree
from raytrace.kernels.building import Building, TraceGeometry
from raytrace.kernels.compiling import jit
from raytrace.kernels.edge_rays import from_frame
from raytrace.kernels.field import STOREY_TOLERANCE
from raytrace.kernels.guard import Guard, is_stopped
from raytrace.kernels.horizontal_edge_legs import (
    EdgeWorkspace,
    HorizontalEdgeBeams,
    unfold_over_edge,
)
from raytrace.kernels.horizontal_edges import OFFSETS_OF_LEGS_M
from raytrace.kernels.lanes import Lanes, lane, lanes_of
from raytrace.kernels.plan_view import PlanView, folded, slab_at
from raytrace.kernels.records import Record
from raytrace.kernels.reflections import ReflectionBeams
from raytrace.kernels.steps import (
    DIFFRACTION,
    NOTHING,
    REFLECTION,
    TRANSMISSION,
    Steps,
    write_ends,
    write_step,
)
from raytrace.kernels.unfolding import (
    DISTANCE,
    NORMAL,
    PASS_PARTIAL,
    PASS_WALL,
    POINT_X,
    POINT_Y,
    REFLECT_WALL,
    SKEW,
    SURFACE,
    TYPE,
    Leg,
    unfold,
)
from raytrace.kernels.validity import ONE_SIDED_OFFSETS_M
from raytrace.kernels.vertical_edge_legs import VerticalEdgeBeams, angles_of
from raytrace.kernels.wedge_steps import (
    horizontal_terms,
    vertical_terms,
    write_turns,
    write_wedge,
)


@jit(inner=True)
def add_point(points: Floats, k: int, at: tuple[float, float, float]) -> int:
    """Append a point; return how many there are now."""
    points[k, 0], points[k, 1], points[k, 2] = at
    return k + 1


@jit(inner=True)
def interaction(view: PlanView, kind: int, surface: int, z: float) -> tuple[int, int]:
    """Interaction with a wall that a leg meets at height z, and the slab there."""
    if kind in (PASS_WALL, REFLECT_WALL):
        return (TRANSMISSION if kind == PASS_WALL else REFLECTION), surface
    slab = slab_at(view, surface, z)
    if kind == PASS_PARTIAL:
        return (NOTHING if slab < 0 else TRANSMISSION), slab
    return REFLECTION, max(slab, 0)


@jit(inner=True)
def add_leg(
    building: Building,
    whole: tuple[Leg, int, float],
    heights: tuple[float, float, float],
    end: tuple[float, float],
    points: Floats,
    steps: Steps,
    path: int,
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
    points, steps, path, k
        Points of the path, written to from k on; steps of all paths, and which one this is.

    Returns
    -------
    int
        Number of points so far.
    """
    (leg, n, length), (z_root, slope, offset), height = whole, heights, building.height
    done, x, y = 0.0, points[k - 1, 0], points[k - 1, 1]
    cos_elevation = 1.0 / math.sqrt(1.0 + slope * slope)
    upwards = math.copysign(1.0, slope)
    storey = first_storey(z_root / height, upwards)
    at_edge = STOREY_TOLERANCE * height / abs(slope) if slope != 0.0 else 0.0
    for i in range(n + 1):
        last = i == n
        distance = length if last else leg.interactions[i, DISTANCE, 0]
        to_x = end[0] if last else leg.interactions[i, POINT_X, 0]
        to_y = end[1] if last else leg.interactions[i, POINT_Y, 0]
        while slope != 0.0 and (storey * height - z_root) / slope < distance - at_edge:
            w = ((storey * height - z_root) / slope - done) / (distance - done)
            is_ceiling = int(storey) & 1
            slab = building.ceiling if is_ceiling else building.floor
            frame = (abs(slope) * cos_elevation, 0.0, cos_elevation)
            write_step(steps, path, k - 1, REFLECTION, slab, frame)
            z = height if is_ceiling else 0.0
            k = add_point(points, k, (x + w * (to_x - x), y + w * (to_y - y), z))
            storey += upwards
        if not last:
            z = folded(z_root + slope * distance, height)
            beside = folded(z_root + slope * distance + offset, height)
            kind, surface = leg.types[i, TYPE], leg.types[i, SURFACE]
            kind, slab = interaction(building.plan, kind, surface, beside)
            if kind != NOTHING:
                sine = sine_in_storey(slope * cos_elevation, storey - max(upwards, 0.0))
                normal = leg.interactions[i, NORMAL, 0]
                frame = (abs(normal) * cos_elevation, leg.interactions[i, SKEW, 0], -normal * sine)
                write_step(steps, path, k - 1, kind, slab, frame)
                k = add_point(points, k, (to_x, to_y, z))
        done, x, y = distance, to_x, to_y
    return k


@jit(inner=True)
def first_storey(storeys: float, upwards: float) -> float:
    """Number of the floor or ceiling, in storeys, that a ray meets first."""
    return math.floor(storeys - upwards * STOREY_TOLERANCE) + max(upwards, 0.0)


@jit(inner=True)
def sine_in_storey(sine: float, storey: float) -> float:
    """Sine of the elevation in the building of a ray that was unfolded into a storey."""
    return -sine if int(storey) & 1 else sine


@jit(inner=True)
def last_sine(height: float, slope: float, z_end: float) -> float:
    """Sine of the elevation with which a ray of an unfolded slope and height arrives."""
    upwards = math.copysign(1.0, slope)
    storey = first_storey(z_end / height, upwards) - max(upwards, 0.0)
    return sine_in_storey(slope / math.sqrt(1.0 + slope * slope), storey)


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
def transmits_more(steps: Steps, path: int, n: int, most: int) -> float:
    """1 where n interactions of a path hold fewer than that many transmissions, otherwise 0."""
    transmissions = 0
    for k in range(n):
        transmissions += steps.kind[path, k] == TRANSMISSION
    return 1.0 if transmissions < most else 0.0


@jit(inner=True)
def unfold_one(
    view: PlanView, tree: Tree, i: int, target: tuple[float, float], leg: Leg
) -> tuple[int, float, Lanes, Lanes]:
    """Unfold one leg; return its interactions, length, and direction (see `unfolding.unfold`)."""
    at = lanes_of(target[0]), lanes_of(target[1])
    n, length, ux, uy = unfold(view, tree.link, tree.beam, i, at, leg)
    return n, lane(length, 0), ux, uy


@jit(inline=True)
def arriving_from(
    tree: Tree, i: int, end: tuple[float, float], length: float
) -> tuple[float, float]:
    """Horizontal direction in which the root's image of a beam lies from a point."""
    inv_length = 1.0 / length
    return (tree.beam[i, IMAGE_X] - end[0]) * inv_length, (
        tree.beam[i, IMAGE_Y] - end[1]
    ) * inv_length


@jit(allocates=False)
def reflection_points(
    geometry: TraceGeometry,
    beams: ReflectionBeams,
    leg: Leg,
    record: Record,
    points: Floats,
    steps: Steps,
    guard: Guard,
) -> None:
    """Write points (n or 1, k, 3) and steps of recorded reflection paths."""
    building, receivers, hits = geometry.building, geometry.receivers, beams.hits
    z = geometry.transmitter[2]
    for path in range(len(steps.slab)):
        if is_stopped(guard):
            break
        r, i = hits.pair[record.key[path, 0], 0], hits.pair[record.key[path, 0], 1]
        end = (receivers.xy[r, 0], receivers.xy[r, 1])
        n, length, ux, uy = unfold_one(building.plan, beams.tree, i, end, leg)
        image = record.key[path, 3]
        z_end = receivers.image_z[receivers.level[r], image]
        slope = (z_end - z) / length
        row = points[min(path, len(points) - 1)]
        k = start_path(geometry, row)
        heights = (z, slope, ONE_SIDED_OFFSETS_M[record.key[path, 4]])
        k = add_leg(building, (leg, n, length), heights, end, row, steps, path, k)
        finish_path(geometry, r, row, k)
        sec = math.sqrt(1.0 + slope * slope)
        x, y = arriving_from(beams.tree, i, end, length)
        sign = -1.0 if geometry.image_bounces[image] & 1 else 1.0
        write_ends(
            steps, path, (lane(ux, 0), lane(uy, 0), slope / sec),
            (x, y, sign * slope / sec), length * sec, sign / (length * sec),
        )  # fmt: skip


@jit(allocates=False)
def vertical_edge_points(
    geometry: TraceGeometry,
    beams: VerticalEdgeBeams,
    leg: Leg,
    record: Record,
    points: Floats,
    steps: Steps,
    rows: Floats,
    guard: Guard,
) -> None:
    """Write points and steps of recorded paths over a vertical edge; `rows` is scratch (3, 8)."""
    building, receivers = geometry.building, geometry.receivers
    edge, legs, hits = beams.edge, beams.legs, beams.hits
    z, at = geometry.transmitter[2], (edge.x, edge.y)
    for path in range(len(steps.slab)):
        if is_stopped(guard):
            break
        hit, p = record.key[path, 0], record.key[path, 1]
        leg_in = Leg(legs.interactions[p], legs.types[p])
        n_in, length_in = int(legs.n_interactions[p]), float(legs.length[p])
        r, i = hits.pair[hit, 0], hits.pair[hit, 1]
        end = (receivers.xy[r, 0], receivers.xy[r, 1])
        n, length, ux, uy = unfold_one(building.plan, beams.tree, i, end, leg)
        image = record.key[path, 3]
        total = length_in + length
        slope = (receivers.image_z[receivers.level[r], image] - z) / total
        z_edge = z + slope * length_in
        row = points[min(path, len(points) - 1)]
        k = start_path(geometry, row)
        offset = ONE_SIDED_OFFSETS_M[record.key[path, 4]]
        heights = (z, slope, offset)
        k = add_leg(building, (leg_in, n_in, length_in), heights, at, row, steps, path, k)
        write_step(steps, path, k - 1, DIFFRACTION, -1, (0.0, 0.0, 0.0))
        k = add_point(row, k, (edge.x, edge.y, folded(z_edge, building.height)))
        heights = (z_edge, slope, offset)
        k = add_leg(building, (leg, n, length), heights, end, row, steps, path, k)
        finish_path(geometry, r, row, k)
        cosine = 1.0 / math.sqrt(1.0 + slope * slope)
        transmits = transmits_more(steps, path, k - 1, geometry.max_transmissions)
        terms = vertical_terms(edge, angles_of(legs, p), (ux, uy), length, rows)
        product = length * length_in
        root = math.sqrt(4.0 * math.pi * product * cosine / total)
        beta = cosine, last_sine(building.height, slope, z_edge)
        write_wedge(steps, path, edge.wedge, terms, root, beta, transmits)
        x, y = arriving_from(beams.tree, i, end, length)
        sign = -1.0 if geometry.image_bounces[image] & 1 else 1.0
        spreading = sign * math.sqrt(cosine / (product * total)) / edge.wedge.n
        launch = legs.departure[p, 0], legs.departure[p, 1], slope * cosine
        arrival = x, y, sign * slope * cosine
        write_ends(steps, path, launch, arrival, total / cosine, spreading)


@jit(allocates=False)
def horizontal_edge_points(
    geometry: TraceGeometry,
    beams: HorizontalEdgeBeams,
    work: EdgeWorkspace,
    record: Record,
    points: Floats,
    steps: Steps,
    guard: Guard,
) -> None:
    """Write points and steps of recorded paths over a horizontal edge."""
    building, receivers = geometry.building, geometry.receivers
    edge, images, hits, seen = beams.edge, beams.images, beams.hits, beams.seen
    trees = beams.tree, beams.strips
    for path in range(len(steps.slab)):
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
        (n_in, lengths_in, wx, wy), (n, lengths, ux, uy) = unfold_over_edge(
            building.plan, edge.frame, lanes_of(u), trees, (images.beam[p], i),
            (lanes_of(end[0]), lanes_of(end[1])), work,
        )  # fmt: skip
        length_in, length = lane(lengths_in, 0), lane(lengths, 0)
        at, offsets = from_frame(edge.frame, u), OFFSETS_OF_LEGS_M[record.key[path, 4]]
        slope = (-rise_in if geometry.image_bounces[a] & 1 else rise_in) / length_in
        row = points[min(path, len(points) - 1)]
        k = start_path(geometry, row)
        heights = (geometry.transmitter[2], slope, offsets[0])
        k = add_leg(building, (work.leg_in, n_in, length_in), heights, at, row, steps, path, k)
        write_step(steps, path, k - 1, DIFFRACTION, -1, (0.0, 0.0, 0.0))
        k = add_point(row, k, (at[0], at[1], edge.z))
        slope_out = rise_out / length
        heights = (edge.z, slope_out, offsets[1])
        k = add_leg(building, (work.leg_out, n, length), heights, end, row, steps, path, k)
        finish_path(geometry, r, row, k)
        transmits = transmits_more(steps, path, k - 1, geometry.max_transmissions)
        # see horizontal_edge_field.edge_gain
        before = math.hypot(in_, u - images.x[p])
        after = math.hypot(out, u - seen[hit, 0])
        vx = (at[0] - beams.tree.beam[images.beam[p], IMAGE_X]) / length_in
        vy = (at[1] - beams.tree.beam[images.beam[p], IMAGE_Y]) / length_in
        sin_beta = in_ / before
        cos_out = 1.0 / math.sqrt(1.0 + slope_out * slope_out)
        sine_out = slope_out * cos_out
        leave_x, leave_y, frame = lane(ux, 0), lane(uy, 0), edge.frame
        cos_beta = cos_out * (leave_x * frame[0] + leave_y * frame[1]) * -edge.up
        terms = horizontal_terms(
            edge, (images.h[p], -rise_in), (seen[hit, 1], rise_out), work.workspace.rows
        )
        product, total = before * after, before + after
        root = math.sqrt(4.0 * math.pi * product / total) * sin_beta
        write_wedge(steps, path, edge.wedge, terms, root, (sin_beta, cos_beta), transmits)
        write_turns(steps, path, frame, (vx, vy, rise_in / before), (leave_x, leave_y, sine_out))
        is_odd = (geometry.image_bounces[a] + geometry.image_bounces[b]) & 1
        spreading = (-0.5 if is_odd else 0.5) / (math.sqrt(product * total) * sin_beta)
        x = (work.images[i, IMAGE_X, 0] - end[0]) / length
        y = (work.images[i, IMAGE_Y, 0] - end[1]) / length
        sine_in = slope / math.sqrt(1.0 + slope * slope)
        launch = lane(wx, 0), lane(wy, 0), sine_in
        arrival = x, y, (-sine_out if geometry.image_bounces[b] & 1 else sine_out)
        write_ends(steps, path, launch, arrival, total, spreading)
