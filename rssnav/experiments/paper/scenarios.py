"""The paper's two scenarios: floor plans, radio maps, and a world per speed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import floorplans
from rssnav.experiments.progress import Notice, StageProgress
from rssnav.first_use import compile_kernels
from rssnav.maps import make_map
from rssnav.world import GridWorld

if TYPE_CHECKING:
    from floorplans import FloorPlan
    from raytrace import RadioMap

PLANS = ("scenario1", "scenario2")
"""Built-in plans of Scenarios 1 and 2."""

SPEEDS = (1, 2, 4)
"""Speeds the paper flies at [cells per step; m/s on its 1 m grid]."""

Worlds = dict[tuple[int, int], GridWorld]
"""Worlds by (scenario, speed)."""


@dataclass(frozen=True, eq=False)
class Scenario:
    """A floor plan and its radio map."""

    plan: FloorPlan
    radio_map: RadioMap


@dataclass
class _MapProgress:
    """Progress of one map; only the tracer knows the total."""

    progress: StageProgress
    stage: str
    total: int = 1

    def __call__(self, done: int, total: int) -> None:
        """Report progress."""
        self.total = total
        self.progress(self.stage, done, total)


def load_scenarios(
    plans: Sequence[str | Path],
    folder: Path,
    *,
    threads: int | None,
    max_memory_bytes: int | None,
    progress: StageProgress,
    notice: Notice,
) -> dict[int, Scenario]:
    """Load floor plans, and load or trace their radio maps.

    Parameters
    ----------
    plans : sequence of str or Path
        Built-in names or files, numbered from 1 in this order.
    folder : Path
        Folder of the maps, a file per plan.
    threads : int or None
        Threads for the tracer; all cores for None.
    max_memory_bytes : int or None
        Most memory that tracing may take; half of what is free for None.
    progress, notice : callable
        Called with the stage "map of <plan>", and with what is reused or recomputed.

    Returns
    -------
    dict of int to Scenario

    Raises
    ------
    PlanError, SceneError, MapFileError
        For a plan or map that cannot be used.
    MemoryLimitError
        Where tracing needs more memory than it may take.
    """
    loaded = [floorplans.load(plan) for plan in plans]
    compile_kernels("paper", threads=threads)
    scenarios: dict[int, Scenario] = {}
    for number, plan in enumerate(loaded, start=1):
        map_progress = _MapProgress(progress, f"map of {plan.name}")
        map_progress(0, 1)
        radio_map = make_map(
            plan,
            folder / f"{plan.name}.h5",
            threads=threads,
            max_memory_bytes=max_memory_bytes,
            progress=map_progress,
            notice=notice,
        )
        map_progress(map_progress.total, map_progress.total)
        scenarios[number] = Scenario(plan, radio_map)
    return scenarios


def make_worlds(scenarios: Mapping[int, Scenario], speeds: Sequence[int] = SPEEDS) -> Worlds:
    """Make the world of each (scenario, speed). Raises :class:`~rssnav.world.WorldError`."""
    return {
        (number, speed): GridWorld.from_map(scenario.plan, scenario.radio_map, speed)
        for number, scenario in scenarios.items()
        for speed in speeds
    }
