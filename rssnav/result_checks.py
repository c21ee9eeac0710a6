"""Whether the arrays of a result file fit together."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from raytrace.results.hdf5_content import MAX_VALUES, Hdf5ContentError
from rssnav.schedule import Schedule
from rssnav.world import GridWorld


def check_world(world: GridWorld) -> None:
    """Raise Hdf5ContentError unless the arrays of a world fit together."""
    size, cell = world.n_states, world.cell
    n_y, n_x = world.shape
    _require(n_y * n_x <= MAX_VALUES, "world/shape", f"at most {MAX_VALUES} cells")
    _require(size >= 1, "world/next_state", "at least one state")
    _require(world.start_state < size, "world/start_state", f"one of {size} states")
    _require((world.next_state < size).all(), "world/next_state", f"states below {size} or -1")
    _require((cell < world.shape).all(), "world/cell", f"cells within {world.shape}")
    flat = cell[:, 0].astype(np.int64) * n_x + cell[:, 1]
    _require(np.unique(flat).size == size, "world/cell", "a cell of its own for each state")
    _require((world.step_length_m > 0.0).all(), "world/step_length_m", "positive lengths")


def check_result(arrays: Mapping[str, NDArray[Any]], world: GridWorld, schedule: Schedule) -> None:
    """Raise Hdf5ContentError unless the arrays of a result fit together.

    Parameters
    ----------
    arrays
        The arrays of a :class:`~rssnav.TrainingResult`, by name.
    world, schedule
        What it was trained with.
    """
    snapshots, run_ids = schedule.snapshot_episodes, arrays["run_ids"]
    ordered = bool((np.diff(run_ids) > 0).all()) and run_ids.size > 0
    _require(ordered and run_ids[-1] < schedule.runs, "run_ids", f"ascending, of {schedule.runs}")
    _require(
        (arrays["cell_of_state"] < world.n_states).all(), "cell_of_state", "cells of the world"
    )
    _require(
        bool((np.diff((0, *snapshots)) > 0).all())
        and len(snapshots) == len(arrays["visit_counts"])
        and max(snapshots, default=0) <= schedule.episodes,
        "visit_counts",
        "a row for each of the ascending snapshot_episodes",
    )
    _check_episodes(arrays, schedule)
    _check_convergence(arrays)
    _check_flights(arrays, world)


def _check_episodes(arrays: Mapping[str, NDArray[Any]], schedule: Schedule) -> None:
    steps, diagonal = arrays["steps"], arrays["diagonal_steps"]
    count, most = arrays["episodes_flown"], min(steps.shape[1], schedule.episodes)
    _require((count <= most).all(), "episodes_flown", f"at most {most} episodes")
    flown = np.arange(steps.shape[1]) < count[:, None]
    _require(((steps >= 0) == flown).all(), "steps", "-1 after the last episode only")
    fits = ((diagonal >= 0) == flown) & (diagonal <= steps)
    _require(fits.all(), "diagonal_steps", "at most the steps, -1 after the last episode only")
    _require((flown | ~arrays["truncated"]).all(), "truncated", "False after the last episode")


def _check_convergence(arrays: Mapping[str, NDArray[Any]]) -> None:
    episode, steps = arrays["converged_episode"], arrays["converged_steps"]
    within = (episode <= arrays["episodes_flown"]) & (episode != 0)
    _require(within.all(), "converged_episode", "an episode that was flown, or -1")
    _require(((steps >= 0) == (episode >= 0)).all(), "converged_steps", "-1 without convergence")


def _check_flights(arrays: Mapping[str, NDArray[Any]], world: GridWorld) -> None:
    cells, steps = arrays["trajectories"], arrays["path_steps"]
    _require((cells < world.n_states).all(), "trajectories", "cells of the world, or -1")
    flown = np.arange(cells.shape[1]) <= steps[:, None]
    fits = (steps < cells.shape[1])[:, None] & ((cells >= 0) == flown)
    _require(cells.shape[1] > 0 and fits.all(), "trajectories", "path_steps + 1 cells, then -1")


def _require(holds: bool | np.bool_, name: str, right: str) -> None:
    if not holds:
        raise Hdf5ContentError(f"{name!r}: expected {right}")
