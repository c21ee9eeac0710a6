"""The strongest paths of each cell, as arrays of one shape."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from raytrace import Antenna, Grid, Paths, Scene, TraceConfig, Transmitter, trace_paths
from raytrace.arrays import Bools
from raytrace.solver.workers import Stop

PATH_ARRAYS: dict[str, tuple[str, str]] = {
    "path_power_dbm": ("dBm", "power of the path; -inf where there is none"),
    "path_phase_deg": ("deg", "phase of the path's gain"),
    "path_weight": ("1", "what the path counts for in sums; below 1 where it grazes an edge"),
    "path_delay_s": ("s", "delay of the path"),
    "path_departure_deg": ("deg", "azimuth from +x and zenith angle at the transmitter"),
    "path_arrival_deg": ("deg", "azimuth and zenith angle of where it comes from, at the receiver"),
    "path_interactions": ("1", "1 reflection, 2 diffraction, 3 transmission, 0 after the last"),
    "path_points": ("m", "points of the interactions, 0 after the last"),
}
"""Arrays of paths by name: units and description."""

PATH_DIMENSIONS = {
    "path_departure_deg": ("path", "angle"),
    "path_arrival_deg": ("path", "angle"),
    "path_interactions": ("path", "interaction"),
    "path_points": ("path", "interaction", "axis"),
}
"""Dimensions of the arrays of a cell; of all others ("path",)."""
PATH_LABELS = {"angle": ("azimuth", "zenith"), "axis": ("x", "y", "z")}
"""Names along dimensions; numbers along all others."""


def path_shapes(count: int, most: int) -> dict[str, tuple[tuple[int, ...], type[np.generic]]]:
    """Return the shape of each array for one cell, and its type.

    Parameters
    ----------
    count
        Paths of a cell.
    most
        Most interactions of a path.
    """
    return {
        "path_power_dbm": ((count,), np.float32),
        "path_phase_deg": ((count,), np.float32),
        "path_weight": ((count,), np.float32),
        "path_delay_s": ((count,), np.float64),
        "path_departure_deg": ((count, 2), np.float32),
        "path_arrival_deg": ((count, 2), np.float32),
        "path_interactions": ((count, most), np.int8),
        "path_points": ((count, most, 3), np.float32),
    }


def most_interactions(config: TraceConfig) -> int:
    """Most interactions of a path; 20 transmissions where only their loss limits them."""
    transmissions = 20 if config.max_transmissions is None else config.max_transmissions
    return config.max_reflections + config.max_diffractions + transmissions


def strongest_paths(
    scene: Scene,
    transmitter: Transmitter,
    grid: Grid,
    config: TraceConfig,
    receive_antenna: Antenna,
    inside: Bools,
    count: int,
    most: int,
    stop: Stop | None = None,
) -> dict[str, NDArray[Any]]:
    """Trace the strongest paths to the cells inside a building.

    Parameters
    ----------
    inside
        (n_y, n_x) which cells are.
    count, most
        Paths of each cell, and most interactions of a path; later ones are left out.

    Returns
    -------
    dict of ndarray
        (n_y, n_x, count, ...) by name, see `PATH_ARRAYS`.
    """
    cells = np.flatnonzero(inside)
    paths = trace_paths(
        scene,
        transmitter,
        grid.points()[cells],
        config,
        receive_antenna=receive_antenna,
        strongest=count,
        stop=stop,
    )
    found = {
        name: np.zeros((inside.size, *shape), dtype=dtype)
        for name, (shape, dtype) in path_shapes(count, most).items()
    }
    found["path_power_dbm"][:] = -np.inf
    rank = np.arange(len(paths)) - np.searchsorted(paths.receiver, paths.receiver)
    place = cells[paths.receiver], rank
    for name, values in _values(paths, transmitter.power_dbm, most).items():
        found[name][place] = values
    return {name: v.reshape(*inside.shape, *v.shape[1:]) for name, v in found.items()}


def _values(paths: Paths, power_dbm: float, most: int) -> dict[str, NDArray[Any]]:
    """Values of n paths by name, (n, ...)."""
    held = min(most, paths.interactions.shape[1])
    interactions = np.zeros((len(paths), most), np.int8)
    interactions[:, :held] = paths.interactions[:, :held]
    points = np.zeros((len(paths), most, 3))
    points[:, :held] = paths.vertices[:, 1 : 1 + held]
    points[interactions == 0] = 0.0
    return {
        "path_power_dbm": power_dbm + paths.gain_db,
        "path_phase_deg": np.degrees(np.angle(paths.gain)),
        "path_weight": paths.weight,
        "path_delay_s": paths.delay_s,
        "path_departure_deg": np.degrees(paths.departure),
        "path_arrival_deg": np.degrees(paths.arrival),
        "path_interactions": interactions,
        "path_points": points,
    }
