"""What the three families of paths share: the trace's constants, sums and records."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from raytrace.kernels.beams import Hits
from raytrace.kernels.compiling import jit
from raytrace.kernels.field import Radio
from raytrace.kernels.lanes import (
    WIDTH,
    ComplexLanes,
    Lanes,
    absolute,
    any_of,
    floor,
    gather_pairs1,
    imag_of,
    lane,
    lanes_of,
    load,
    maximum,
    minimum,
    real_of,
    sqrt,
    store,
    where,
)
from raytrace.kernels.plan_view import Floats, Ints, PlanView
from raytrace.kernels.unfolding import KIND, NORMAL, REFLECT_WALL, WHAT, Leg, new_leg


class Trace(NamedTuple):
    """Everything that stays the same through a trace.

    Attributes
    ----------
    plan, radio
        Plan view, and wavelength, materials and antennas.
    source
        (3,) the transmitter [m].
    source_z
        (2 max_order + 1,) images of its height in floor and ceiling [m].
    receivers
        (n, 2) plan-view positions [m].
    level
        (n,) which of the receiver heights each is at.
    image_z
        (n_levels, 2 max_order + 1) images of each height in floor and ceiling [m].
    image_bounces
        (2 max_order + 1,) how many reflections each image has.
    max_order, max_walls
        Most reflections on a path, and most walls it goes through.
    least_power
        Paths whose power is known to be below this are left out [share of the transmitted].
    """

    plan: PlanView
    radio: Radio
    source: Floats
    source_z: Floats
    receivers: Floats
    level: Ints
    image_z: Floats
    image_bounces: Ints
    max_order: int
    max_walls: int
    least_power: float


class Sums(NamedTuple):
    """What arrives at each receiver; a path at a tie counts with its share.

    Attributes
    ----------
    field
        (n,) complex sum of the paths' gains.
    power
        (n,) sum of their squared magnitudes.
    n_paths
        (n, max_order + 1) number of paths by reflections.
    moments
        (n, 5) sums of power times detour and times its square, the detour being what a path is
        longer than the straight line [m]; sums of power times cosine and times sine of the
        azimuth it arrives at; power of the strongest path.
    left_out
        (n,) bound on the power of the paths that were left out.
    bins
        (LEVELS,) paths left out by their bounds, in steps of 1 dB downwards from 0 dB; counted
        only where everything is left out.
    """

    field: NDArray[np.complex128]
    power: Floats
    n_paths: Floats
    moments: Floats
    left_out: Floats
    bins: Floats


LEVELS = 400
"""Rows of `Sums.bins`."""

DETOUR, DETOUR_SQUARED, COSINE, SINE, STRONGEST = range(5)
"""Columns of `Sums.moments`."""


class Record(NamedTuple):
    """Room for single paths, filled until it is full.

    Attributes
    ----------
    key
        (n, 5) int32 hit, leg to the edge, height image before and after it, -1 where the path
        has none; and which of the `LOOKS` at it this is.
    gain, share
        (n,) complex path gain, and share at a tie.
    used
        (1,) number of paths met, also of those there was no room for; -1 if none is wanted.
    """

    key: NDArray[np.int32]
    gain: NDArray[np.complex128]
    share: Floats
    used: Ints


def new_sums(n_receivers: int, max_order: int) -> Sums:
    """Sums of no paths."""
    return Sums(
        np.zeros(n_receivers, np.complex128),
        np.zeros(n_receivers),
        np.zeros((n_receivers, max_order + 1)),
        np.zeros((n_receivers, 5)),
        np.zeros(n_receivers),
        np.zeros(LEVELS),
    )


def new_record(n_paths: int) -> Record:
    """Room for that many paths."""
    return Record(
        np.empty((n_paths, 5), np.int32),
        np.empty(n_paths, np.complex128),
        np.empty(n_paths),
        np.zeros(1, np.int64),
    )


def no_record() -> Record:
    """Record that is not wanted."""
    record = new_record(0)
    record.used[0] = -1
    return record


class Room(NamedTuple):
    """Room that a kernel works in.

    Attributes
    ----------
    leg
        Legs to eight receivers.
    receivers
        (8,) which ones.
    levels, image_z
        (8,), (2 max_order + 1, 8) which of the receiver heights they are at, and its images in
        floor and ceiling [m].
    counts
        (max_order + 1, 8) paths to them by reflections.
    rows
        (8, 8) whatever is needed for a moment.
    """

    leg: Leg
    receivers: Ints
    levels: Ints
    image_z: Floats
    counts: Floats
    rows: Floats


@jit()
def new_room(max_order: int, n_items: int) -> Room:
    """Room for legs of that many items."""
    return Room(
        new_leg(n_items),
        np.zeros(WIDTH, np.int64),
        np.full(WIDTH, -1, np.int64),
        np.empty((2 * max_order + 1, WIDTH)),
        np.empty((max_order + 1, WIDTH)),
        np.empty((8, WIDTH)),
    )


class Block(NamedTuple):
    """Up to eight receivers that one beam lights.

    Attributes
    ----------
    first, n
        Their hits are first to first + n.
    beam
        The beam.
    x, y
        Where they are [m].
    share
        How much of their surroundings is lit; 0 for those beyond n.
    straight
        Their distances from the source [m].
    """

    first: int
    n: int
    beam: int
    x: Lanes
    y: Lanes
    share: Lanes
    straight: Lanes


@jit(inline=True)
def next_block(trace: Trace, hits: Hits, first: int, room: Room) -> Block:
    """Take the receivers of the next hits, as far as they are of one beam; the last fills up."""
    beam, n = int(hits.pair[first, 1]), 0
    for j in range(WIDTH):
        hit = first + j
        if j == n and hit < len(hits.pair) and hits.pair[hit, 1] == beam:
            n += 1
        hit = first + min(j, n - 1)
        r = hits.pair[hit, 0]
        room.receivers[j] = r
        room.rows[0, j], room.rows[1, j] = trace.receivers[r, 0], trace.receivers[r, 1]
        room.rows[2, j] = hits.share[hit] if j < n else 0.0
        if room.levels[j] != trace.level[r]:
            room.levels[j] = trace.level[r]
            for k in range(trace.image_z.shape[1]):
                room.image_z[k, j] = trace.image_z[trace.level[r], k]
    for k in range(len(room.counts)):
        store(room.counts[k], lanes_of(0.0))
    x, y = load(room.rows[0]), load(room.rows[1])
    return Block(first, n, beam, x, y, load(room.rows[2]), straight_line(trace, x, y, room))


@jit(inline=True)
def straight_line(trace: Trace, x: Lanes, y: Lanes, room: Room) -> Lanes:
    """Distances from the source to receivers [m]."""
    dx, dy, dz = x - trace.source[0], y - trace.source[1], load(room.image_z[0]) - trace.source[2]
    return sqrt(dx * dx + dy * dy + dz * dz)


class Bundle(NamedTuple):
    """Sums over paths that arrive at eight receivers; see `Sums`."""

    real: Lanes
    imag: Lanes
    power: Lanes
    detour: Lanes
    detour_squared: Lanes
    cosine: Lanes
    sine: Lanes
    strongest: Lanes


@jit(inline=True)
def no_paths() -> Bundle:
    """Sums of no paths."""
    none = lanes_of(0.0)
    return Bundle(none, none, none, none, none, none, none, none)


@jit(inline=True, fast=True)
def with_path(
    bundle: Bundle,
    gain: ComplexLanes,
    detour: Lanes,
    share: Lanes,
    direction: tuple[Lanes, Lanes],
) -> Bundle:
    """Sums with a path more each.

    Parameters
    ----------
    bundle
        The sums.
    gain, detour, share
        Of the paths; the detour is what it is longer than the straight line [m].
    direction
        Cosine and sine of the azimuths they arrive at.
    """
    counts = share > 0.0
    real, imag = where(counts, real_of(gain), 0.0), where(counts, imag_of(gain), 0.0)
    size = real * real + imag * imag
    power = size * share
    late = power * detour
    return Bundle(
        bundle.real + real * share,
        bundle.imag + imag * share,
        bundle.power + power,
        bundle.detour + late,
        bundle.detour_squared + late * detour,
        bundle.cosine + power * direction[0],
        bundle.sine + power * direction[1],
        maximum(bundle.strongest, size),
    )


@jit(inline=True)
def counted(room: Room, order: int, share: Lanes) -> None:
    """Count a path of that many reflections to each receiver."""
    store(room.counts[order], load(room.counts[order]) + share)


@jit(inline=True)
def add_bundle(sums: Sums, block: Block, bundle: Bundle, room: Room) -> None:
    """Add what arrives at the receivers of a block to the sums."""
    total = lanes_of(0.0)
    for k in range(len(room.counts)):
        total = total + load(room.counts[k])
    if not any_of(total > 0.0):
        return
    rows = room.rows
    for k, part in enumerate(bundle):
        store(rows[k], part)
    for j in range(block.n):
        r = room.receivers[j]
        sums.field[r] += complex(rows[0, j], rows[1, j])
        sums.power[r] += rows[2, j]
        moments = sums.moments[r]
        for k in range(DETOUR, STRONGEST):
            moments[k] += rows[3 + k, j]
        moments[STRONGEST] = max(moments[STRONGEST], rows[7, j])
        for k in range(len(room.counts)):
            sums.n_paths[r, k] += room.counts[k, j]


@jit(inner=True)
def strong(
    trace: Trace, sums: Sums, room: Room, bound: Lanes, share: Lanes, n_paths: float
) -> Lanes:
    """Shares of paths that may be strong enough; of the others it is noted that they are left out.

    Parameters
    ----------
    trace, sums, room
        The trace, what to note it in, and at which receivers.
    bound, share, n_paths
        Bounds on the powers, the paths' shares, and how many there are at each receiver.
    """
    for j in range(WIDTH):
        power, left = lane(bound, j), n_paths * lane(share, j)
        if power < trace.least_power and left > 0.0:
            sums.left_out[room.receivers[j]] += left * power
            if math.isinf(trace.least_power):
                level = int(-10.0 * math.log10(max(power, 1e-39)))
                sums.bins[max(level, 0)] += left
    return where(bound < trace.least_power, 0.0, share)


@jit(inner=True, fast=True)
def leg_bound(trace: Trace, leg: Leg, n: int, length: Lanes, order: int) -> Lanes:
    """Bound on the share of the power that the walls on legs reflect.

    Parameters
    ----------
    trace
        The trace.
    leg, n, length
        The legs, their items, their horizontal lengths [m].
    order
        Their reflections at walls; what is left to floor and ceiling bounds their slopes.
    """
    rise = (trace.max_order - order + 1) * trace.radio.height
    cos_el = length / sqrt(length * length + rise * rise)
    rows, bound = trace.radio.slab_rows, lanes_of(1.0)
    for k in range(n):
        if leg.marks[k, KIND] == REFLECT_WALL:
            at = absolute(load(leg.items[k, NORMAL])) * cos_el * (rows - 2.0)
            row = floor(maximum(minimum(at, rows - 2.0), 0.0))
            highest, _ = gather_pairs1(trace.radio.highest, row + leg.marks[k, WHAT] * float(rows))
            bound = bound * highest
    return bound


@jit(inline=True)
def free_space(trace: Trace, length: Lanes) -> Lanes:
    """Bound on the received share of the power over distances [m]."""
    size = (trace.radio.wavelength / (4.0 * math.pi)) / length
    return size * size * trace.radio.peak


@jit(inner=True)
def recorded(
    record: Record,
    block: tuple[int, int],
    leg: int,
    images: tuple[int, int, int],
    gain: ComplexLanes,
    share: Lanes,
) -> None:
    """Write paths down if there is room: those of a block's first hit, and so many.

    `images` are the height images and the look, see `Record`.
    """
    for j in range(block[1]):
        if lane(share, j) == 0.0:
            continue
        k = record.used[0]
        if k < len(record.gain):
            record.key[k, 0], record.key[k, 1] = block[0] + j, leg
            record.key[k, 2], record.key[k, 3], record.key[k, 4] = images
            record.gain[k] = complex(lane(real_of(gain), j), lane(imag_of(gain), j))
            record.share[k] = lane(share, j)
        record.used[0] = k + 1
