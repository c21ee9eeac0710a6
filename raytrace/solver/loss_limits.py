"""Limits by loss: which beams are too weak to be grown, and how many paths these may hold.

See `raytrace.kernels.losses` and docs/theory.md, section 16.
"""

import math
from typing import NamedTuple

import numpy as np

from raytrace.arrays import Floats, Ints
from raytrace.config import TraceConfig
from raytrace.kernels.bounds import SHEET_POWER, SHEET_POWER_THROUGH_WALLS, WEDGE_POWER
from raytrace.kernels.building import image_bounces, image_heights
from raytrace.kernels.edge_losses import EdgeWays
from raytrace.kernels.horizontal_edge_bounds import EdgeHeights, bounds_over_edge
from raytrace.kernels.horizontal_edge_legs import HorizontalEdgeArrays
from raytrace.kernels.losses import UNLIMITED, Limits
from raytrace.kernels.plan_view import PlanView, distances_to_cells
from raytrace.kernels.turns import Heights
from raytrace.kernels.vertical_edge_legs import LegsIn, VerticalEdgeArrays
from raytrace.kernels.wedge import new_wedge
from raytrace.scene import Scene
from raytrace.solver.path_class import Evaluation
from raytrace.solver.setup import limits_by_number
from raytrace.solver.slab_bounds import reflection_of, slab_bounds, transmission_of


class Continuations(NamedTuple):
    """Most paths from a beam to one receiver, by the reflections that it may still have.

    Attributes
    ----------
    plain
        (max_reflections + 1,) paths without a further diffraction, one height for all of a path.
    from_horizontal
        (max_reflections + 1,) the same behind a horizontal edge, before which heights vary too.
    """

    plain: Floats
    from_horizontal: Floats


def continuations(scene: Scene, config: TraceConfig) -> Continuations:
    """Count most paths: a sequence of reflecting lines and a height give one path at most."""
    sequences, heights, pairs = _choices(scene, config)
    order = config.max_reflections
    return Continuations(
        np.convolve(sequences, heights)[: order + 1], np.convolve(sequences, pairs)[: order + 1]
    )


def _choices(scene: Scene, config: TraceConfig) -> tuple[Floats, Floats, Floats]:
    """Sequences of so many lines; heights, and pairs of heights, of so many reflections."""
    view, order = scene.view, config.max_reflections
    n_lines = len(np.unique(view.line[view.profile >= 0]))
    sequences = np.array([1.0] + [n_lines * (n_lines - 1.0) ** q for q in range(order)])
    left = np.arange(order + 1.0)
    return sequences, 2.0 * left + 1.0, 2.0 * left * (left + 1.0) + 1.0


def _with_edges(scene: Scene, config: TraceConfig) -> Floats:
    """Most paths from the transmitter, each diffracted one with the largest gain of its edge."""
    sequences, heights, pairs = _choices(scene, config)
    size = config.max_reflections + 1
    found = np.convolve(sequences, heights)[:size]
    if config.max_diffractions:
        legs = np.convolve(sequences, sequences)[:size]
        wedges = [new_wedge(e.wedge_n, e.o_slab, e.n_slab) for e in scene.vertical_edges]
        vertical = sum(edge_power(config, wedge.is_sheet) for wedge in wedges)
        horizontal = 2.0 * len(scene.horizontal_edges) * edge_power(config, True)
        found += vertical * np.convolve(legs, heights)[:size]
        found += horizontal * np.convolve(legs, pairs)[:size]
    return found


def edge_power(config: TraceConfig, is_sheet: bool) -> float:
    """Largest power behind an edge, as a fraction of that of a free path as long."""
    if not is_sheet:
        return WEDGE_POWER
    return SHEET_POWER if config.max_transmissions == 0 else SHEET_POWER_THROUGH_WALLS


def limits_from_transmitter(
    scene: Scene, config: TraceConfig, evaluation: Evaluation, least: Floats | None = None
) -> Limits:
    """Return the limits of beams from the transmitter.

    Parameters
    ----------
    scene, config
        What is traced, and the limits by number.
    evaluation
        Materials, antennas, and the power below which beams are not grown.
    least
        (n_edges,) such a power for each edge of the plan view instead (see `losses.LossLimit`).

    Where transmissions are limited by their number, a beam is not grown where all of its paths
    together are below that power; otherwise, where each one is.
    """
    limits = limits_by_number(scene, config)
    if least is None:
        least = np.full(len(limits.loss.least), evaluation.min_power)
    if not least.any():
        return limits
    tables, alone = evaluation.tables, is_alone(limits)
    continued = _with_edges(scene, config)[::-1]
    reflectance = slab_bounds(tables, *reflection_of(tables))
    transmittance = np.zeros_like(reflectance)
    if len(tables.transmission):
        transmittance = slab_bounds(tables, *transmission_of(tables))
    loss = limits.loss._replace(
        is_active=True,
        least=least,
        power_at_1m=(tables.wavelength / (4.0 * math.pi)) ** 2 * tables.peak_gain,
        wavelength=tables.wavelength,
        reflectance=reflectance,
        transmittance=transmittance,
        shadow=evaluation.shadow if alone else np.maximum(evaluation.shadow, 1.0),
        is_alone=alone,
        roots=np.column_stack([np.ones_like(continued) if alone else continued, continued]),
    )
    return limits._replace(loss=loss)


def shadow_of(limits: Limits, evaluation: Evaluation, slab: int) -> Floats:
    """Largest |1 - T'|^2 (COSINE_BINS + 1,) of a sheet's shadow at a cosine of incidence or above.

    Where the number of transmissions ends paths, the shadow may also lack the transmitted field.
    """
    found = evaluation.shadow[slab, :, -1]
    found = np.append(found, found[-1])
    return found if is_alone(limits) else np.maximum(found, 1.0)


class AtHorizontalEdge(NamedTuple):
    """How ways arrive at a horizontal edge.

    Attributes
    ----------
    sines
        (n, 2) the interval of the sines between the directions of arrival and the edge's normal in
        the plan view.
    off
        (n,) distance of the transmitter's image in the plan view [m], negative on the other side
        than the receivers.
    meets
        (n, 3) where along the edge the image is, and the interval that the way meets [m].
    across
        (n, max_reflections + 1, 2) see `losses.LossLimit`.
    """

    sines: Floats
    off: Floats
    meets: Floats
    across: Floats


class Arrivals(NamedTuple):
    """Ways from the transmitter to an edge.

    Attributes
    ----------
    order, length, fraction
        (n,) wall reflections, shortest horizontal length [m], and largest fraction of the power
        behind the edge.
    at
        Of a horizontal edge.
    """

    order: Ints
    length: Floats
    fraction: Floats
    at: AtHorizontalEdge | None = None


def strong_arrivals(
    arrivals: Arrivals, limits: Limits, counts: Floats, view: PlanView, place: tuple[Floats, Floats]
) -> tuple[Ints, float]:
    """Ways on which enough power arrives for some cell of the plan.

    Parameters
    ----------
    arrivals, limits
        All ways to an edge, and the limits from the transmitter.
    counts
        (max_reflections + 1,) see `Continuations`.
    view
        The plan view.
    place
        Both ends of the edge in the plan view, equal for a vertical one [m].

    Returns
    -------
    kept, left_out
        Which of the ways, by rising order and then by falling strength, and a bound on the power of
        all paths over the others.
    """
    loss = limits.loss
    if not loss.is_active:
        return np.arange(len(arrivals.order)), 0.0
    power = arrivals.fraction * loss.power_at_1m
    further = counts[limits.max_reflections - arrivals.order]
    distances = distances_to_cells(view, *place)
    length = np.maximum(arrivals.length[:, None] + distances, 1e-9)
    compared = (power if loss.is_alone else power * further)[:, None] / length**2
    least = np.minimum.reduceat(loss.least, view.cell_edges[:-1])
    is_strong = (compared >= least).any(axis=1)
    together = power * further / np.maximum(arrivals.length, 1e-9) ** 2
    kept = np.flatnonzero(is_strong)
    strength = arrivals.fraction[kept] / np.maximum(arrivals.length[kept], 1e-9) ** 2
    by_strength = np.lexsort((-strength, arrivals.order[kept]))
    return kept[by_strength], float(together[~is_strong].sum())


def limits_from_horizontal_edge(
    arrivals: Arrivals, limits: Limits, counts: Floats, heights: EdgeHeights | None
) -> Limits:
    """Limits of beams from a horizontal edge that power arrives at."""
    order = limits.max_reflections - int(arrivals.order.min())
    loss = limits.loss._replace(further=counts)
    if heights is not None and arrivals.at is not None:
        at, left = arrivals.at, limits.max_reflections - arrivals.order
        ways = np.column_stack([arrivals.order, arrivals.length, arrivals.fraction, at.meets])
        sin_beta = np.sqrt(np.maximum(1.0 - (at.sines**2).max(axis=1), 0.0))
        rise = np.maximum(np.abs(heights.low), np.abs(heights.high))
        loss = loss._replace(
            ranks=ranks_of(arrivals.order, arrivals.length, arrivals.fraction),
            ways=np.ascontiguousarray(ways),
            across=at.across,
            rises=np.maximum.accumulate([rise[0], *rise[1:].reshape(-1, 2).max(axis=1)]),
            over_edge=bounds_over_edge(heights, left, at.off, arrivals.length, sin_beta),
        )
    return limits._replace(max_reflections=order, loss=loss)


def edge_heights(
    scene: Scene, ends: Heights, edge: HorizontalEdgeArrays, limits: Limits, most: float
) -> EdgeHeights | None:
    """Heights of paths over an edge, most power behind it included; None without a limit."""
    if not limits.loss.is_active:
        return None
    images = [
        image_heights(end, scene.height_m, limits.max_reflections) - edge.z
        for end in (ends.start, ends.low, ends.high)
    ]
    reflectance, slab = limits.loss.reflectance[:, :, -1], edge.wedge.o_slab
    return EdgeHeights(
        image_bounces(limits.max_reflections),
        images[0],
        np.minimum(images[1], images[2]),
        np.maximum(images[1], images[2]),
        reflectance[[scene.floor_slab, scene.ceiling_slab]].max(axis=0),
        np.sqrt(reflectance[slab]),
        np.sqrt(limits.loss.shadow[slab, :, -1]),
        limits.loss.wavelength,
        most,
    )


def limits_from_vertical_edge(
    edge: VerticalEdgeArrays, legs: LegsIn, limits: Limits, counts: Floats
) -> Limits:
    """Limits of beams from a vertical edge, by the legs to it."""
    order = limits.max_reflections - int(legs.order.min())
    loss = limits.loss._replace(further=counts)
    if loss.is_active:
        n, half = edge.wedge.n, legs.angles[:, 1:3]
        phi = 2.0 * np.arctan2(half[:, 1], half[:, 0])
        ways = EdgeWays(
            edge.wedge,
            (math.cos(edge.o_face), math.sin(edge.o_face)),
            legs.order,
            legs.length,
            legs.fraction,
            np.column_stack([np.cos(phi / (2.0 * n)), np.sin(phi / (2.0 * n))]),
            legs.angles[:, 5:7] ** 2,
        )
        most = WEDGE_POWER
        if edge.wedge.is_sheet:
            most = 0.25 * (1.0 + math.sqrt(loss.shadow[edge.wedge.o_slab].max())) ** 2
        ranks = ranks_of(legs.order, legs.length, legs.fraction)
        loss = loss._replace(most_behind_edge=most, edge_ways=ways, ranks=ranks)
    return limits._replace(max_reflections=order, loss=loss)


def ranks_of(order: Ints, length: Floats, fraction: Floats) -> Floats:
    """Return `LossLimit.ranks` of ways to an edge, by rising order and falling strength."""
    strength = fraction / np.maximum(length, 1e-9) ** 2
    ends = np.searchsorted(order, order, side="right")
    sums = np.append(np.cumsum(strength[::-1])[::-1], 0.0)
    starts = np.searchsorted(order, order, side="left")
    first = np.flatnonzero(starts == np.arange(len(order)))
    longest = np.maximum.reduceat(length, first)[np.searchsorted(first, starts)]
    rest = np.maximum(sums[:-1] - sums[ends], strength)
    columns = strength, rest, ends.astype(np.float64), np.maximum(longest, 1e-9)
    return np.column_stack(columns)


def is_alone(limits: Limits) -> bool:
    """Whether single paths are compared with the limit, and not all of a beam together."""
    return limits.max_transmissions == UNLIMITED
