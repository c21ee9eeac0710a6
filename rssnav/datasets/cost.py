"""What a data set will cost, estimated before it is begun."""

from __future__ import annotations

import shutil
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from floorplans import PlanError
from raytrace import Grid, SceneError, Transmitter, estimate_cost
from rssnav.cost_notice import duration
from rssnav.datasets.configuration import Configuration
from rssnav.datasets.errors import DatasetError
from rssnav.datasets.plans import PLANS_A_FOLDER, PlanSource
from rssnav.datasets.strongest import most_interactions, path_shapes
from rssnav.datasets.tracing import placed_transmitters
from rssnav.scenes import scene_of

SAMPLED = 4
"""Plans whose maps are estimated."""

BYTES_A_VALUE = {"path_count": 1.4}
"""Bytes of a compressed value of a layer; see docs/million_maps.md."""
_BYTES_A_VALUE = 2.8
_OF_PATHS = 0.5
"""Compressed size of the arrays of paths, as a fraction."""
BYTES_A_PLAN = 60_000
"""Scales, attributes and the plan's text, twice."""
INODES_A_PLAN = 2
_SPARE = 1.05


@dataclass(frozen=True)
class DatasetCost:
    """What is left to be made of a data set.

    Attributes
    ----------
    n_plans, n_maps
        How many.
    core_s
        Processor time [s].
    n_bytes, n_inodes
        On the disk.
    is_rough
        Whether the time had to be extrapolated from fewer reflections.
    """

    n_plans: int
    n_maps: int
    core_s: float
    n_bytes: float
    n_inodes: int
    is_rough: bool = False

    def sentence(self, workers: int) -> str:
        """Return it in words, with the time that so many workers take."""
        about = "on the order of " if self.is_rough else "about "
        return (
            f"estimate: {self.n_maps} maps of {self.n_plans} plans, {about}"
            f"{self.core_s / 3600:.2g} core-hours ({duration(self.core_s / workers)} with "
            f"{workers} at once), {_size(self.n_bytes)} and {self.n_inodes} files"
        )


def estimated(sources: Sequence[PlanSource], configuration: Configuration) -> DatasetCost:
    """Estimate what plans will cost from a few of them.

    A plan that cannot be traced counts as nothing.
    """
    chosen = np.unique(np.linspace(0, len(sources) - 1, min(SAMPLED, len(sources))).astype(int))
    found = [_of_plan(sources[int(k)], configuration) for k in chosen]
    each = [np.mean([cost[k] for cost in found]) for k in range(3)]
    n = len(sources)
    return DatasetCost(
        n_plans=n,
        n_maps=round(n * float(each[0])),
        core_s=n * float(each[1]),
        n_bytes=n * float(each[2]),
        n_inodes=INODES_A_PLAN * n + n // PLANS_A_FOLDER + 8,
        is_rough=any(cost[3] for cost in found),
    )


def _of_plan(source: PlanSource, configuration: Configuration) -> tuple[float, float, float, bool]:
    """Return maps, core-seconds and bytes of a plan, and whether they are extrapolated."""
    try:
        plan = source.plan()
        placed = placed_transmitters(plan, configuration)
        scene = scene_of(plan, configuration.edition)
        transmitter = Transmitter(
            placed[0].position,
            configuration.power_dbm,
            configuration.frequencies_hz[0],
            configuration.antennas[0].antenna(placed[0].direction),
        )
        grid = Grid.over(plan.bounds, configuration.cell_size_m, configuration.heights_m[0])
        costs = [
            estimate_cost(scene, transmitter, grid, config, threads=1)
            for config in configuration.presets.values()
        ]
    except (PlanError, SceneError, ValueError):
        return 0.0, 0.0, 0.0, False
    n_maps = len(placed) * configuration.maps_a_transmitter
    seconds = n_maps * float(np.mean([cost.seconds for cost in costs]))
    n_bytes = n_maps * grid.x.size * grid.y.size * bytes_a_cell(configuration) + BYTES_A_PLAN
    return n_maps, seconds, n_bytes, any(cost.is_extrapolated for cost in costs)


def bytes_a_cell(configuration: Configuration) -> float:
    """Return the compressed bytes of a cell of one map, about."""
    found = sum(BYTES_A_VALUE.get(name, _BYTES_A_VALUE) for name in configuration.layers)
    if configuration.strongest_paths:
        most = max(map(most_interactions, configuration.presets.values()))
        for shape, dtype in path_shapes(configuration.strongest_paths, most).values():
            found += _OF_PATHS * float(np.prod(shape)) * np.dtype(dtype).itemsize
    return found


def check_disk(cost: DatasetCost, folder: Path) -> None:
    """Raise DatasetError where a data set is larger than what is free on its disk."""
    existing = next(path for path in (folder, *folder.absolute().parents) if path.exists())
    free = shutil.disk_usage(existing).free
    if _SPARE * cost.n_bytes > free:
        raise DatasetError(
            f"the data set needs about {_size(cost.n_bytes)}, but {_size(free)} are free: expected "
            "a larger disk, larger cells, or fewer plans, maps or layers",
            folder,
        )


def _size(n_bytes: float) -> str:
    for unit, size in (("TB", 1e12), ("GB", 1e9), ("MB", 1e6)):
        if n_bytes >= size:
            return f"{n_bytes / size:.3g} {unit}"
    return f"{n_bytes / 1e3:.0f} kB"
