"""Missions whose transmitter may be at several places, for which a map each is computed."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import shapely
from numpy.typing import NDArray

from floorplans import FloorPlan
from raytrace import Antenna, Grid, HalfWaveDipole, TraceConfig, Transmitter
from rssnav.arguments import is_whole, require
from rssnav.maps import CELL_SIZE_M, HEIGHT_M
from rssnav.missions.layout import Layout, WorldError
from rssnav.missions.mission import Mission
from rssnav.missions.modes import ModeProcess
from rssnav.progress import Progress
from rssnav.transmitter_maps import make_transmitter_maps

_BESIDE_M = (0.2, 0.15)  # from a cell's centre, where 1 / D would be infinite
_TURNS = np.array([(1, 1), (-1, 1), (1, -1), (-1, -1)])
_SHARES = (1.0, 0.5, 0.25, 0.1)


def reachable_layout(plan: FloorPlan, speed: int = 1, cell_size_m: float = CELL_SIZE_M) -> Layout:
    """Cells that can be reached from a plan's start, numbered row by row.

    Raises
    ------
    WorldError
        When the start is not in a cell that can be left.
    """
    grid = Grid.over(plan.bounds, cell_size_m, HEIGHT_M)
    whole = Layout.of_plan(plan, grid, speed)
    start = whole.nearest(*plan.require_start())
    kept = np.sort(whole.reachable(start))
    if kept.size < 2:
        raise WorldError(f"plan {plan.name!r}: at speed {speed} the start cannot be left")
    return whole.part(kept)


def are_in_sight(
    plan: FloorPlan, one: NDArray[np.float64], other: NDArray[np.float64], height_m: float
) -> NDArray[np.bool_]:
    """Whether the straight ways (n,) between points (n, 2) [m] stay in the building, off walls."""
    walls = shapely.multilinestrings(plan.solid_segments(height_m))
    ways = shapely.linestrings(np.stack([one, other], axis=1))
    inside, blocked = shapely.covers(plan.outline, ways), shapely.intersects(ways, walls)
    return np.asarray(inside) & ~np.asarray(blocked)


def places_beside(
    plan: FloorPlan, centres: NDArray[np.float64], offset_m: tuple[float, float], height_m: float
) -> NDArray[np.float64]:
    """Places (n, 2) [m] beside the centres (n, 2) of cells, where transmitters can be.

    Parameters
    ----------
    plan : FloorPlan
        Walls and outline; each place is in sight of its centre.
    centres : (n, 2) float64
        [m]
    offset_m : (float, float)
        From each centre, along both axes; where a wall is in the way, to the other side along one
        or both of them, or less far.
    height_m : float
        Of the places.
    """
    offsets = np.concatenate([share * _TURNS * offset_m for share in _SHARES])
    places = centres + offsets[0]
    hidden = np.flatnonzero(~are_in_sight(plan, centres, places, height_m))
    for offset in offsets[1:]:
        nearby = centres[hidden] + offset
        seen = are_in_sight(plan, centres[hidden], nearby, height_m)
        places[hidden[seen]] = nearby[seen]
        hidden = hidden[~seen]
    return places


def spread_places(
    plan: FloorPlan, n: int, speed: int = 1
) -> tuple[tuple[float, float, float], ...]:
    """Places of the transmitter, far from each other and from the start: the plan's own first.

    Each is the one farthest from those before; none is nearer than 4 m to the start.

    Parameters
    ----------
    plan : FloorPlan
        With source and start; the height is the source's.
    n : int
        Number of places.
    speed : int
        The places can be reached at this speed.

    Raises
    ------
    ValueError
        For n below 1, and where the plan has no room for so many places.
    """
    require(is_whole(n, 1, 2**31), "n", n, "a whole number of at least 1")
    layout = reachable_layout(plan, speed)
    x, y, z = plan.require_source()
    candidates = places_beside(plan, layout.position, _BESIDE_M, z)
    places = [(x, y, z)]
    nearest = np.hypot(*(candidates - (x, y)).T)
    nearest[np.hypot(*(candidates - plan.require_start()).T) < 4.0] = -1.0
    for _ in range(n - 1):
        farthest = int(np.argmax(nearest))
        if nearest[farthest] <= 0.0:
            raise ValueError(f"places: {n} are more than plan {plan.name!r} has room for")
        px, py = candidates[farthest].tolist()
        places.append((px, py, z))
        nearest = np.minimum(nearest, np.hypot(*(candidates - (px, py)).T))
    return tuple(places)


def mission_of_places(
    plan: FloorPlan,
    places: Sequence[tuple[float, float, float]],
    speed: int = 1,
    *,
    modes: ModeProcess | None = None,
    config: TraceConfig | None = None,
    receive_antenna: Antenna | None = None,
    threads: int | None = None,
    progress: Progress | None = None,
) -> Mission:
    """Mission of a transmitter at any of some places; the steps are found once for all.

    Parameters
    ----------
    plan : FloorPlan
        With a start.
    places : sequence of (float, float, float)
        Places [m], one a mode.
    speed : int
        Cells moved along an axis in one step.
    modes : ModeProcess, optional
        How it moves; by default a place is drawn for each episode.
    config, receive_antenna, threads, progress
        As for `rssnav.maps.make_map`. The transmitter has the same antenna as the receivers.
    """
    layout = reachable_layout(plan, speed)
    rss_dbm = fields_of_places(
        plan,
        layout,
        places,
        config=config,
        antenna=receive_antenna or HalfWaveDipole(),
        threads=threads,
        progress=progress,
    )
    return mission_of_fields(plan, (layout,), rss_dbm, places, modes)


def fields_of_places(
    plan: FloorPlan,
    layout: Layout,
    places: Sequence[tuple[float, float, float]],
    *,
    config: TraceConfig | None,
    antenna: Antenna,
    threads: int | None,
    progress: Progress | None = None,
    path: Path | None = None,
) -> NDArray[np.float64]:
    """RSS of each cell for a transmitter at each place, shape (M, S) [dBm].

    Parameters
    ----------
    plan : FloorPlan
        Walls and materials.
    layout : Layout
        Its S cells.
    places : sequence of (float, float, float)
        M places [m].
    antenna : Antenna
        At both ends.
    config, threads, progress
        As for `rssnav.maps.make_map`.
    path : Path, optional
        File that the maps are kept in, as by `make_transmitter_maps`.
    """
    senders = {
        f"{k}": Transmitter(position=place, antenna=antenna) for k, place in enumerate(places)
    }
    maps = make_transmitter_maps(
        plan,
        senders,
        path,
        config=config,
        receive_antenna=antenna,
        threads=threads,
        progress=progress,
    )
    return np.stack([layout.on_cells(maps[name].rss_dbm) for name in senders])


def mission_of_fields(
    plan: FloorPlan,
    layouts: tuple[Layout, ...],
    rss_dbm: NDArray[np.float64],
    places: Sequence[tuple[float, float, float]],
    modes: ModeProcess | None = None,
    starts: NDArray[np.integer] | None = None,
) -> Mission:
    """Mission of G layouts, a field (M, S) and a place for each mode.

    The first M / G modes have the first layout, and so on. Flights begin in any of the given
    cells, by default at the plan's start.
    """
    layout, n = layouts[0], len(places)
    if starts is None:
        starts = np.array([layout.nearest(*plan.require_start())])
    return Mission(
        layouts=layouts,
        layout_of_mode=np.arange(n, dtype=np.int64) * len(layouts) // n,
        rss_dbm=rss_dbm,
        distance_m=np.stack([layout.distance_m(x, y) for x, y, _ in places]),
        modes=modes or ModeProcess.steady(n),
        starts=starts.astype(np.int32),
        start_probability=np.full(starts.size, 1.0 / starts.size),
        source=np.array([place[:2] for place in places], dtype=np.float64),
        name=plan.name,
    )
