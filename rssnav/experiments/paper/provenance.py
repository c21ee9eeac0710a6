"""How a run of the paper was made: parameters, seed, versions, hashes, and run times."""

from __future__ import annotations

import dataclasses
import os
import platform
import time
from collections.abc import Generator
from contextlib import contextmanager
from dataclasses import dataclass, field
from datetime import UTC, datetime
from importlib.metadata import version
from typing import Any

from rssnav.agent_description import describe, flat_parameters
from rssnav.experiments.paper.counting import SUPPORTED_COUNT, Count
from rssnav.experiments.paper.data import PaperData
from rssnav.experiments.tables import Column, Table
from rssnav.schedule import NO_STEP_LIMIT

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
    """Seed, versions and run times of a run of the paper.

    Attributes
    ----------
    seed, runs : int
        Seed of all trainings, realisations of each.
    quick : bool
        Whether it was a quick run with few realisations.
    plans : tuple of str
        Plans of the scenarios: built-in names or files.
    count : Count
        Which steps a length counts that is compared with the paper's.
    stages : dict of str to float
        Wall time of each stage [s].
    trained : dict of str to float
        Wall time of each training [s]; those reused from an earlier run are not listed.
    started : str
        Date and time (UTC).
    """

    seed: int
    runs: int
    quick: bool
    plans: tuple[str, ...]
    count: Count = SUPPORTED_COUNT
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
        """Operating system, architecture and number of processors."""
        return f"{platform.system()} {platform.machine()}, {os.cpu_count()} processors"


def scenario_facts(data: PaperData) -> dict[str, dict[str, Any]]:
    """Return plan, hash and map of each scenario."""
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


def parameters(data: PaperData) -> Table:
    """Make a row per parameter of maps, learning and schedule."""
    result = next(iter(data.results.values()))
    radio_map = next(iter(data.scenarios.values())).radio_map
    groups: dict[str, dict[str, object]] = {
        "trace": dataclasses.asdict(radio_map.config),
        "transmitter": {
            "power_dbm": radio_map.transmitter.power_dbm,
            "frequency_hz": radio_map.transmitter.frequency_hz,
        },
        "grid": {
            "cell_size_m": radio_map.grid.cell_size_m,
            "height_m": radio_map.grid.height_m,
        },
        "learning": dataclasses.asdict(result.learning),
        "schedule": dataclasses.asdict(result.schedule),
    }
    for each in data.results.values():
        groups[f"{each.agent.name} agent"] = flat_parameters(describe(each.agent))
    rows = [
        (group, name, _text(value))
        for group, values in groups.items()
        for name, value in values.items()
    ]
    return Table(
        "parameters",
        "Parameters",
        "Every parameter of maps and trainings, in the unit that its name ends in.",
        (Column("group", "Part"), Column("name", "Parameter"), Column("value", "Value")),
        tuple(rows),
    )


def _text(value: object) -> str:
    """Return a parameter as the report shows it."""
    if value is None or value == NO_STEP_LIMIT:
        return "none"
    return f"{value:.9g}" if isinstance(value, float) else str(value)
