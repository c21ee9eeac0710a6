"""Announcing that maps, or the paths to points, will take long."""

import math
from dataclasses import replace

import numpy as np

from raytrace import CostEstimate, Grid, Scene, TraceConfig, Transmitter, estimate_cost
from raytrace.arrays import Floats

UNITS_S = {"years": 3.156e7, "days": 86400.0, "hours": 3600.0, "minutes": 60.0}

LONG_S = 60.0
"""A map that takes longer is announced [s]."""

LEAST_CELLS = 100
"""Larger cells are proposed where as many remain."""

LONG_PATHS_S = 10.0
"""Paths to points that take longer are announced [s]: they show little progress."""

CELLS_OF_BEAMS = 1000
"""Beams are grown for one receiver too: as much work as the paths to about so many cells."""

BYTES_A_PATH = 100
"""Memory for each vertex of a listed path, copies included, about."""

MANY_WALLS = 5
"""Walls on a path whose transmissions are limited by loss alone, in `work`."""

MAX_SILENT_WORK = 2e6
"""Maps of less `work` are not estimated: the largest of them take some seconds."""


def work(scene: Scene, grid: Grid, config: TraceConfig) -> float:
    """Return a rough measure of a map's work.

    Cells times edges times one more than the transmissions, doubled by every reflection.
    """
    n_edges = len(scene.vertical_edges) + len(scene.horizontal_edges)
    edges = 1 + n_edges * config.max_diffractions
    most = MANY_WALLS if config.max_transmissions is None else config.max_transmissions
    cells, walls = grid.x.size * grid.y.size, 1 + most
    return cells * edges * walls * 2.0 ** (config.max_reflections - 6)


def announcement(
    scene: Scene,
    transmitter: Transmitter,
    grid: Grid,
    config: TraceConfig,
    threads: int | None = None,
    max_memory_bytes: int | None = None,
    n_transmitters: int = 1,
) -> str | None:
    """Return what a map will take, in words, if that is long; otherwise None.

    An estimate that had to be extrapolated is always announced: it is too rough to keep silent.
    `max_memory_bytes` is the most memory that the estimate may take itself. Of several transmitters
    each is taken to cost as much as the given one.

    Raises
    ------
    SceneError
        Where the transmitter is not inside the building.
    """
    if n_transmitters * work(scene, grid, config) < MAX_SILENT_WORK:
        return None
    cost = estimate_cost(
        scene, transmitter, grid, config, threads=threads, max_memory_bytes=max_memory_bytes
    )
    cost = _if_long(cost, n_transmitters, LONG_S)
    return None if cost is None else sentence(cost, grid, n_transmitters)


def paths_announcement(
    scene: Scene,
    transmitter: Transmitter,
    receiver: tuple[float, float, float],
    config: TraceConfig,
    max_memory_bytes: int | None = None,
) -> str | None:
    """Return what the paths to a point [m] will take, in words, if that is long; otherwise None.

    An estimate that had to be extrapolated is always announced: it is too rough to keep silent.

    Raises
    ------
    SceneError
        Where the transmitter is not inside the building.
    """
    return points_announcement(
        scene,
        transmitter,
        np.array([receiver]),
        config,
        1,
        max_memory_bytes,
        bytes_a_vertex=BYTES_A_PATH,
    )


def points_announcement(
    scene: Scene,
    transmitter: Transmitter,
    points: Floats,
    config: TraceConfig,
    threads: int | None = None,
    max_memory_bytes: int | None = None,
    n_transmitters: int = 1,
    bytes_a_vertex: int = 0,
) -> str | None:
    """Return what the paths to points (n, 3) [m] will take, as `paths_announcement`.

    They are estimated for a grid of about as many points in the same part of the building.
    `bytes_a_vertex` is what is kept of each vertex of a path; nothing where powers are summed.
    """
    grid = _grid_like(points)
    if n_transmitters * work(scene, grid, config) * CELLS_OF_BEAMS < MAX_SILENT_WORK:
        return None
    cost = estimate_cost(
        scene, transmitter, grid, config, threads=threads, max_memory_bytes=max_memory_bytes
    )
    cost = _if_long(cost, n_transmitters, LONG_PATHS_S)
    if cost is None:
        return None
    memory = _memory(cost.memory_bytes + cost.paths * bytes_a_vertex * (config.max_reflections + 3))
    return (
        f"estimate: {_count(cost.paths)} paths{_from(n_transmitters)}, "
        f"{_roughly(cost, memory)}; fewer reflections reduce all three"
    )


def sentence(cost: CostEstimate, grid: Grid, n_transmitters: int = 1) -> str:
    """Return an estimate in words."""
    cells = grid.x.size * grid.y.size
    return (
        f"estimate: {_count(cost.paths)} paths to {_count(cells)} cells{_from(n_transmitters)}, "
        f"{_roughly(cost, _memory(cost.memory_bytes))}; "
        "larger cells, fewer reflections, --min-power or --max-paths reduce them"
        f"{_affordable(cost, grid)}"
    )


def _grid_like(points: Floats) -> Grid:
    """Return a grid over the bounds of points, of about as many cells."""
    side = math.ceil(math.sqrt(len(points)))
    low, high = points.min(axis=0), points.max(axis=0)
    x, y = (np.unique(np.linspace(low[axis], high[axis], side)) for axis in (0, 1))
    return Grid(x, y, float(np.median(points[:, 2])), 1.0)


def _if_long(cost: CostEstimate, n: int, long_s: float) -> CostEstimate | None:
    """Return the cost of n transmitters of the same cost, if it is long or too rough to tell."""
    of_all = replace(
        cost,
        paths=n * cost.paths,
        seconds=n * cost.seconds,
        seconds_for_beams=n * cost.seconds_for_beams,
        seconds_of_lower_orders=tuple(n * seconds for seconds in cost.seconds_of_lower_orders),
    )
    is_short = of_all.seconds <= long_s and not of_all.is_extrapolated
    return None if is_short else of_all


def _from(n_transmitters: int) -> str:
    return f" from {n_transmitters} transmitters" if n_transmitters > 1 else ""


def _roughly(cost: CostEstimate, memory: str) -> str:
    """Return time and memory in words, and how far they may be off."""
    words = f"{duration(cost.seconds)} and {memory} of memory"
    if not cost.is_extrapolated:
        return f"about {words}"
    return f"on the order of {words} (extrapolated from fewer reflections: may be far off)"


def _memory(n_bytes: float) -> str:
    unit, name = (1e9, "GB") if n_bytes >= 1e9 else (1e6, "MB")
    value = max(n_bytes / unit, 1.0)
    return f"{value:.1f} {name}" if value < 10.0 else f"{_count(round(value))} {name}"


def _affordable(cost: CostEstimate, grid: Grid) -> str:
    """Return the options with which the map takes at most about `LONG_S`, in words."""
    options: list[str] = []
    orders = [n for n, seconds in enumerate(cost.seconds_of_lower_orders) if seconds <= LONG_S]
    if orders:
        options.append(f"--reflections {orders[-1]}")
    left_s = LONG_S - cost.seconds_for_beams
    if left_s > 0.0:
        larger = math.sqrt((cost.seconds - cost.seconds_for_beams) / left_s)
        if larger**2 < grid.x.size * grid.y.size / LEAST_CELLS:
            options.append(f"--cell-size {1.05 * larger * grid.cell_size_m:.2g}")
    return f"; a minute or less with {' or '.join(options)}" if options else ""


def duration(seconds: float) -> str:
    """Return a time [s] in words, in the largest unit of which it has two."""
    for unit, length in UNITS_S.items():
        if seconds >= 2.0 * length:
            return f"{seconds / length:.0f} {unit}"
    return f"{seconds:.0f} seconds"


def _count(number: int) -> str:
    if number >= 10**12:
        return f"{number:.1e}"
    if number >= 10_000_000:
        return f"{number / 1e6:.0f} million"
    return f"{number:,}".replace(",", " ")
