"""How a run of the paper was made: seeds, versions, hashes, and the time each stage took."""

from __future__ import annotations

import os
import platform
import time
from collections.abc import Generator
from contextlib import contextmanager
from dataclasses import dataclass, field
from datetime import UTC, datetime
from importlib.metadata import version
from typing import Any

from rssnav.experiments.paper.data import PaperData

_PACKAGES = (
    "rssnav",
    "numpy",
    "numba",
    "scipy",
    "shapely",
    "trimesh",
    "h5py",
    "matplotlib",
    "jinja2",
)


@dataclass
class Record:
    """What is known about a run apart from its results.

    Attributes
    ----------
    seed, runs : int
        Seed of all trainings, realisations of each.
    quick : bool
        Whether it was a quick run with few realisations.
    plans : tuple of str
        Plans of the scenarios: built-in names or files.
    stages : dict of str to float
        Wall time of each stage [s].
    trained : dict of str to float
        Wall time of each training [s]; one taken over from an earlier run is not in it.
    started : str
        Date and time (UTC).
    """

    seed: int
    runs: int
    quick: bool
    plans: tuple[str, ...]
    stages: dict[str, float] = field(default_factory=dict[str, float])
    trained: dict[str, float] = field(default_factory=dict[str, float])
    started: str = field(default_factory=lambda: datetime.now(UTC).strftime("%Y-%m-%d %H:%M UTC"))

    @contextmanager
    def stage(self, name: str) -> Generator[None]:
        """Measure the time of a stage."""
        begin_s = time.perf_counter()
        yield
        self.stages[name] = time.perf_counter() - begin_s

    @property
    def versions(self) -> dict[str, str]:
        """Versions of Python and of the packages that results depend on."""
        return {"python": platform.python_version()} | {name: version(name) for name in _PACKAGES}

    @property
    def machine(self) -> str:
        """Machine, as far as run times depend on it."""
        return f"{platform.system()} {platform.machine()}, {os.cpu_count()} processors"


def scenario_facts(data: PaperData) -> dict[str, dict[str, Any]]:
    """Plan, hash and map of each scenario."""
    return {
        f"Scenario {number}": {
            "plan": scenario.plan.name,
            "plan_sha256": scenario.plan.sha256,
            "cells": int(scenario.radio_map.rss_dbm.size),
            "paths": int(scenario.radio_map.path_count.sum()),
            "map_made_with": {
                key: value if isinstance(value, int | float | str) else str(value)
                for key, value in scenario.radio_map.provenance.items()
            },
        }
        for number, scenario in data.scenarios.items()
    }
