"""The least loss of beams while they grow: what every ray within a beam loses at least.

A beam whose rays are all weaker than a given power is not grown (docs/theory.md, section 16).
"""

import math
from typing import NamedTuple

from raytrace.arrays import Floats
from raytrace.kernels.compiling import jit
from raytrace.kernels.edge_losses import Directions, EdgeWays, largest_amplitude
from raytrace.kernels.plan_view import PlanView, cross

COSINE_BINS = 64
"""Intervals of the cosine of incidence, in which slabs have a least loss."""

ROUNDING = 1e-6
"""Intervals of cosines are widened by this fraction of a bin."""

NEGLIGIBLE = 0.1
"""Ways to an edge that bring less than this times the power limit are not examined further."""

UNLIMITED = 1 << 20
"""A number of transmissions that no path has."""

PASSES, IS_MIRRORED, IS_TRANSMITTED = 0, 1, 2
"""What becomes of a beam at an edge."""


class LossLimit(NamedTuple):
    """Which beams are too weak to be grown.

    Attributes
    ----------
    is_active
        Whether there is a limit.
    least
        (n_edges,) power below which beams do not go on from an edge of the plan view into its cell
        [fraction of the transmitted].
    power_at_1m
        Largest received fraction of the power at 1 m in free space, both antennas included [m^2].
    height, most_reflections
        Of the ceiling [m], and the reflections of whole paths.
    wavelength
        [m]
    reflectance, transmittance, shadow
        (n_slabs, COSINE_BINS, COSINE_BINS) largest fraction of the power that a slab reflects or
        transmits, and largest |1 - T'|^2 of its shadow, between the cosines of one interval and of
        another.
    is_alone
        Whether single paths are compared with `least`, and not all of a beam together.
    roots
        (max_reflections + 1, 2) by the wall reflections of a beam from the transmitter: the
        fraction of the power at the root that is compared with `least`, and the number of paths
        that the beam may continue to (`solver.loss_limits`).
    most_behind_edge
        Largest power behind an edge, as a fraction of that of a free path as long.
    edge_ways
        Ways from the transmitter to a vertical edge.
    ranks
        (n, 4) of the ways to an edge, by rising number of reflections and then by falling strength:
        strength, that is fraction over squared length [1/m^2]; the sum of strengths from here to
        the last way of as many reflections; its number plus 1; and the largest length of them [m].
    ways
        (n, 6) ways from the transmitter to a horizontal edge: wall reflections, shortest length
        [m], largest fraction of the power behind the edge, where along the edge the transmitter's
        image is, and the interval of the edge that the way meets [m]; n = 0 for other roots.
    across
        (n, max_reflections + 1, 2) for these ways, by the reflections left to floor and ceiling:
        least and largest distance of the images from the edge's line [m].
    rises
        (max_reflections + 1,) most that a path rises behind a horizontal edge [m], the same way.
    over_edge
        (n, max_reflections + 1, DISTANCES + 1) for these ways, see `bounds_over_edge`.
    further
        (max_reflections + 1,) most paths that a beam from an edge continues to, by the reflections
        left.
    """

    is_active: bool
    least: Floats
    power_at_1m: float
    height: float
    most_reflections: int
    wavelength: float
    reflectance: Floats
    transmittance: Floats
    shadow: Floats
    is_alone: bool
    roots: Floats
    most_behind_edge: float
    edge_ways: EdgeWays
    ranks: Floats
    ways: Floats
    across: Floats
    rises: Floats
    over_edge: Floats
    further: Floats


class Limits(NamedTuple):
    """How far beams are grown.

    Attributes
    ----------
    max_reflections, max_transmissions
        Maximum numbers of reflections, those required at floor and ceiling included, and of
        transmissions through solid walls.
    loss
        The limit by loss.
    """

    max_reflections: int
    max_transmissions: int
    loss: LossLimit


class Incidence(NamedTuple):
    """How a beam meets an edge of the plan view.

    Attributes
    ----------
    nearest
        Lower bound on the horizontal distance from the root [m].
    least, largest
        Bounds on the cosine of the angle between its rays and the edge's normal, in the plan view.
    """

    nearest: float
    least: float
    largest: float


@jit(inline=True)
def incidence(
    off: float, normal: tuple[float, float], one: tuple[float, float], other: tuple[float, float]
) -> Incidence:
    """Incidence of rays between two directions on a line.

    Parameters
    ----------
    off
        Distance of the root's image from the line [m].
    normal
        Unit normal of the line.
    one, other
        The outermost directions, of any length.
    """
    size_1, size_2 = math.hypot(one[0], one[1]), math.hypot(other[0], other[1])
    if size_1 == 0.0 or size_2 == 0.0:
        return Incidence(0.0, 0.0, 1.0)
    cos_1 = abs(normal[0] * one[0] + normal[1] * one[1]) / size_1
    cos_2 = abs(normal[0] * other[0] + normal[1] * other[1]) / size_2
    skew_1 = cross(normal[0], normal[1], one[0], one[1])
    skew_2 = cross(normal[0], normal[1], other[0], other[1])
    along_1 = normal[0] * one[0] + normal[1] * one[1]
    along_2 = normal[0] * other[0] + normal[1] * other[1]
    least, largest = min(cos_1, cos_2), max(cos_1, cos_2)
    if along_1 * along_2 <= 0.0:
        least = 0.0
    if skew_1 * skew_2 <= 0.0:
        largest = 1.0
    nearest = abs(off) / largest if largest > 1e-9 else 0.0
    return Incidence(nearest, least, largest)


@jit(inner=True)
def largest_fraction(
    limits: Limits, view: PlanView, e: int, how: int, met: Incidence, order: int
) -> float:
    """Largest fraction of the power that a beam keeps at edge e.

    Parameters
    ----------
    limits, view, e, how
        Limits, plan view, edge, and what becomes of the beam there.
    met, order
        How the beam meets it, and its wall reflections so far.
    """
    loss, profile = limits.loss, view.profile[e]
    if not loss.is_active or profile < 0 or how == PASSES:
        return 1.0
    rise = (limits.max_reflections - order + 1) * loss.height
    cos_elevation = met.nearest / math.sqrt(met.nearest * met.nearest + rise * rise)
    low = cosine_bin(met.least * cos_elevation)
    high = min(int(met.largest * COSINE_BINS + ROUNDING), COSINE_BINS - 1)
    table = loss.reflectance if how == IS_MIRRORED else loss.transmittance
    largest = 0.0
    for k in range(view.profile_intervals[profile], view.profile_intervals[profile + 1]):
        slab = view.interval_slab[k]
        if slab >= 0:
            largest = max(largest, table[slab, low, high])
    return largest


@jit(inner=True)
def is_strong(
    limits: Limits,
    order: int,
    entry: int,
    kept: tuple[float, float],
    directions: Directions,
    left_out: Floats,
) -> bool:
    """Whether a beam is grown; if not, all that it may continue to is added to `left_out`.

    Parameters
    ----------
    limits, order, entry
        Limits, the beam's wall reflections, and the edge that it enters its cell from.
    kept
        Largest fraction of the power that it keeps, and its shortest length [m], from the root on.
    directions
        In which it leaves a vertical edge; not read for the transmitter.
    left_out
        (1,) bound on the power of all paths within beams that are not grown.
    """
    loss = limits.loss
    if not loss.is_active:
        return True
    if len(loss.edge_ways.order) > 0:
        return is_strong_behind_edge(limits, order, entry, kept, directions, left_out)
    length = max(kept[1], 1e-9)
    power = kept[0] * loss.power_at_1m / (length * length)
    if power * loss.roots[order, 0] >= loss.least[entry]:
        return True
    left_out[0] += power * loss.roots[order, 1]
    return False


@jit(inner=True)
def is_strong_behind_edge(
    limits: Limits,
    order: int,
    entry: int,
    kept: tuple[float, float],
    directions: Directions,
    left_out: Floats,
) -> bool:
    """`is_strong` for a beam from a vertical edge, by the ways to it."""
    loss, ways, (fraction, distance) = limits.loss, limits.loss.edge_ways, kept
    least, together, k = loss.least[entry], 0.0, 0
    while k < len(ways.order):
        left = loss.most_reflections - order - int(ways.order[k])
        if left < 0:
            break
        rest, skips = all_from(loss, k, fraction * loss.most_behind_edge, distance, least)
        if skips:
            together += rest * loss.further[left]
            k = int(loss.ranks[k, 2])
            continue
        length = max(ways.length[k] + distance, 1e-9)
        free = fraction * ways.fraction[k] * loss.power_at_1m / (length * length)
        power = free * loss.most_behind_edge
        if power >= NEGLIGIBLE * least:
            amplitude = amplitude_over_edge(loss, k, distance, left, directions)
            power = free * amplitude * amplitude
        together += power * loss.further[left]
        if (power if loss.is_alone else together) >= least:
            return True
        k += 1
    left_out[0] += together
    return False


@jit(inline=True)
def all_from(
    loss: LossLimit, k: int, kept: float, distance: float, least: float
) -> tuple[float, bool]:
    """Bound on the power by way k and all weaker ones of as many reflections, if it is negligible.

    `kept` is the largest fraction of the power behind the edge; also returns whether it is.
    """
    longest = loss.ranks[k, 3]
    nearer = longest / (longest + distance)
    power = kept * loss.power_at_1m * nearer * nearer
    return power * loss.ranks[k, 1], power * loss.ranks[k, 0] < NEGLIGIBLE * least


@jit(inner=True)
def amplitude_over_edge(
    loss: LossLimit, k: int, distance: float, left: int, directions: Directions
) -> float:
    """Bound on the field behind a vertical edge, over that of a free path as long on way k.

    Parameters
    ----------
    loss, k
        The limit, and the way.
    distance, left
        Least length behind the edge [m], and the reflections left to floor and ceiling.
    directions
        Behind the edge.
    """
    ways, wedge = loss.edge_ways, loss.edge_ways.wedge
    total, rise = max(ways.length[k] + distance, 1e-9), (left + 1.0) * loss.height
    sin_beta = total / math.sqrt(total * total + rise * rise)
    product = max(ways.length[k] * distance, 1e-18)
    size = math.sqrt(loss.wavelength * total / (product * sin_beta)) / (4.0 * math.pi * wedge.n)
    o_low = cosine_bin(sin_beta * math.sqrt(directions.o_sine * ways.sines[k, 0]))
    n_low = cosine_bin(sin_beta * math.sqrt(directions.n_sine * ways.sines[k, 1]))
    reflected = (
        math.sqrt(loss.reflectance[wedge.o_slab, o_low, COSINE_BINS - 1]),
        math.sqrt(loss.reflectance[wedge.n_slab, n_low, COSINE_BINS - 1]),
    )
    through = 1.0
    if wedge.is_sheet:
        through = math.sqrt(loss.shadow[wedge.o_slab, o_low, COSINE_BINS - 1])
    incoming = (ways.parts[k, 0], ways.parts[k, 1])
    return largest_amplitude(wedge, incoming, directions, reflected, through, size)


@jit(inline=True)
def cosine_bin(cosine: float) -> int:
    """Interval that a cosine of incidence lies in, or the one below if rounding could tell."""
    return min(max(int(cosine * COSINE_BINS - ROUNDING), 0), COSINE_BINS - 1)
