"""Limits by loss: which beams are too weak to be grown, and how many paths these may hold.

See `raytrace.kernels.losses` and docs/theory.md, section 16.
"""

import math
from typing import NamedTuple

import numpy as np

from raytrace.arrays import Floats, Ints
from raytrace.config import TraceConfig
from raytrace.kernels.bounds import SHEET_POWER, SHEET_POWER_THROUGH_WALLS, WEDGE_POWER
from raytrace.kernels.field_tables import FieldTables
from raytrace.kernels.losses import COSINE_BINS, UNLIMITED, Limits, LossLimit
from raytrace.kernels.wedge import new_wedge
from raytrace.scene import Scene
from raytrace.solver.path_class import Evaluation
from raytrace.solver.setup import limits_by_number

INTERPOLATION = 1.001
"""Bounds on slabs are enlarged by this factor: tables are interpolated between their rows."""


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
        (n_cells,) such a power for each cell of the plan instead [fraction of the transmitted].

    Where transmissions are limited by their number, a beam is not grown where all of its paths
    together are below that power; otherwise, where each one is.
    """
    limits = limits_by_number(scene, config)
    if least is None:
        least = np.full(len(limits.loss.least), evaluation.min_power)
    if not least.any():
        return limits
    tables, roots = evaluation.tables, np.zeros((config.max_reflections + 1, 3))
    roots[:, 2] = _with_edges(scene, config)[::-1]
    roots[:, 1] = 1.0 if config.max_transmissions is None else roots[:, 2]
    loss = LossLimit(
        True,
        least,
        (tables.wavelength / (4.0 * math.pi)) ** 2 * tables.peak_gain,
        scene.height_m,
        config.max_reflections,
        slab_bounds(tables, tables.reflection, -1.0),
        slab_bounds(tables, tables.transmission, 1.0),
        roots,
        np.zeros((0, 5)),
        np.zeros(0),
    )
    return limits._replace(loss=loss)


def slab_bounds(tables: FieldTables, table: Floats, sign: float) -> Floats:
    """Largest fraction of the power between intervals of the cosine of incidence.

    Parameters
    ----------
    tables, table
        All tables, and that of the reflections or transmissions.
    sign
        Of the TM coefficient in the other one: TE is (the difference of the table) sin^2 + sign TM.

    Returns
    -------
    ndarray
        (n_slabs, COSINE_BINS, COSINE_BINS), see `losses.LossLimit`.
    """
    columns = table.reshape(-1, tables.slab_rows, 4)[:, :-1]
    tm, mix = columns[..., 0] + 1j * columns[..., 1], columns[..., 2] + 1j * columns[..., 3]
    sine_squared = 1.0 - np.linspace(0.0, 1.0, columns.shape[1]) ** 2
    te = mix * sine_squared + sign * tm
    power = INTERPOLATION * np.maximum(np.abs(tm), np.abs(te)) ** 2
    each = (columns.shape[1] - 1) // COSINE_BINS
    steps = [power[:, k * each : (k + 1) * each + 1] for k in range(COSINE_BINS)]
    within = np.stack([step.max(axis=1) for step in steps], axis=1)
    found = np.zeros((len(within), COSINE_BINS, COSINE_BINS))
    for low in range(COSINE_BINS):
        found[:, low, low:] = np.maximum.accumulate(within[:, low:], axis=1)
    return found


class Arrivals(NamedTuple):
    """Ways from the transmitter to an edge.

    Attributes
    ----------
    order, length, fraction
        (n,) wall reflections, shortest horizontal length [m], and largest fraction of the power
        behind the edge.
    sines
        (n, 2) for a horizontal edge: the interval of the sines between the directions of arrival
        and the edge's normal in the plan view.
    """

    order: Ints
    length: Floats
    fraction: Floats
    sines: Floats | None = None

    def at(self, kept: Ints) -> "Arrivals":
        """Return some of the ways."""
        sines = None if self.sines is None else self.sines[kept]
        return Arrivals(self.order[kept], self.length[kept], self.fraction[kept], sines)


def strong_arrivals(arrivals: Arrivals, limits: Limits, counts: Floats) -> tuple[Ints, float]:
    """Ways on which enough power arrives.

    Parameters
    ----------
    arrivals, limits
        All ways to an edge, and the limits from the transmitter.
    counts
        (max_reflections + 1,) see `Continuations`.

    Returns
    -------
    kept, left_out
        Which of the ways, and a bound on the power of all paths over the others.
    """
    loss = limits.loss
    if not loss.is_active:
        return np.arange(len(arrivals.order)), 0.0
    power = arrivals.fraction * loss.power_at_1m / np.maximum(arrivals.length, 1e-9) ** 2
    together = power * counts[limits.max_reflections - arrivals.order]
    compared = power if is_alone(limits) else together
    is_strong = compared >= loss.least.min()
    return np.flatnonzero(is_strong), float(together[~is_strong].sum())


def limits_from_edge(arrivals: Arrivals, limits: Limits, counts: Floats) -> Limits:
    """Limits of beams from an edge that power arrives at, as for `strong_arrivals`."""
    order = limits.max_reflections - int(arrivals.order.min())
    roots = np.zeros((order + 1, 3))
    if limits.loss.is_active:
        for n in range(order + 1):
            mine = arrivals.at(np.flatnonzero(arrivals.order <= limits.max_reflections - n))
            further = counts[limits.max_reflections - n - mine.order]
            together = (mine.fraction * further).sum()
            alone = mine.fraction.max() if is_alone(limits) else together
            roots[n] = mine.length.min(), alone, together
    ways = limits.loss.ways
    if limits.loss.is_active and arrivals.sines is not None and is_alone(limits):
        columns = [arrivals.order, arrivals.length, arrivals.fraction, arrivals.sines]
        ways = np.column_stack(columns)
    loss = limits.loss._replace(roots=roots, ways=np.ascontiguousarray(ways), further=counts)
    return limits._replace(max_reflections=order, loss=loss)


def is_alone(limits: Limits) -> bool:
    """Whether single paths are compared with the limit, and not all of a beam together."""
    return limits.max_transmissions == UNLIMITED
