"""What is flown: frozen within a version, so that results of different people compare.

A change of anything here, of the buildings or of the stepping kernel's flights raises
`BENCHMARK_VERSION`. `docs/benchmark.md` states the protocol in words.
"""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any, get_args

import floorplans
from rssnav.benchmark.buildings import GOAL, Building, Site
from rssnav.benchmark.errors import check
from rssnav.benchmark.frozen import FINGERPRINTS, Split
from rssnav.discrete_states import Fluctuation
from rssnav.missions import Mission, ModeProcess, MultirotorEnergy, Observation, Task

BENCHMARK_VERSION = 2
"""Version 2 has the condition "doors" besides; flights in the other conditions are those of 1."""

MAX_STEPS = 400
"""Seconds after which a flight ends without success."""

CONFIRMATIONS, ERROR = 64, 0.002
"""Most readings of the sequential test that confirms the goal, one a second, where readings
fluctuate, and the probability of a false alarm when a cell is visited."""

BATTERY_KJ = 8.0
"""Energy after which a flight ends in the condition "battery" [kJ]."""


@dataclass(frozen=True)
class Condition:
    """What the task, to find the transmitter, is done under.

    Parameters
    ----------
    name : str
        In tables and files.
    sigma_db : float
        Standard deviation of the fluctuation of readings, independent from second to second [dB].
    jump_probability : float
        Probability that the transmitter is drawn anew among the building's places, per second.
    battery_kj : float
        Energy after which a flight ends without success [kJ].
    doors : bool
        Whether doors are closed or open by chance in each flight (`Building.with_doors`).
    """

    name: str
    sigma_db: float = 0.0
    jump_probability: float = 0.0
    battery_kj: float = math.inf
    doors: bool = False

    @property
    def task(self) -> Task:
        """Goal, limits, and the energy that is reported."""
        goal = GOAL
        if self.sigma_db > 0.0:
            goal = replace(GOAL, confirmations=CONFIRMATIONS, error=ERROR)
        return Task(
            goal,
            "none",
            energy=MultirotorEnergy(),
            battery_kj=self.battery_kj,
            max_steps=MAX_STEPS,
        )

    def observation(self, *, world_seen: bool = False) -> Observation:
        """RSS and the UAV's own cell; for oracles also heading, doors and the mode."""
        return Observation(
            None,
            cell=True,
            heading=world_seen,
            doors=world_seen,
            mode=world_seen,
            fluctuation=Fluctuation(self.sigma_db),
        )

    def building(self, building: Building) -> Building:
        """Building whose doors are as in this condition."""
        return building.with_doors if self.doors else building

    def world(self, mission: Mission) -> Mission:
        """Mission whose transmitter moves as in this condition."""
        if self.jump_probability == 0.0:
            return mission
        return mission.with_modes(ModeProcess.jumping(mission.n_modes, self.jump_probability))


CONDITIONS = (
    Condition("static"),
    Condition("2 dB", sigma_db=2.0),
    Condition("4 dB", sigma_db=4.0),
    Condition("jumps", jump_probability=0.01),
    Condition("battery", battery_kj=BATTERY_KJ),
    Condition("doors", doors=True),
)
"""All conditions."""


def conditions_of(site: Site) -> tuple[Condition, ...]:
    """Conditions in the buildings of a site: the paper's have no doors that open and close."""
    return tuple(each for each in CONDITIONS if not (each.doors and site == "paper"))


@dataclass(frozen=True)
class Extent:
    """How much is flown.

    Parameters
    ----------
    split : {"train", "validation", "test"}
        Of the generated buildings.
    generated : int
        How many of them, the first.
    paper : bool
        Whether the paper's two buildings are flown in, too.
    plans : tuple of str
        Hashes of further plans: extents are the same if the plans' contents are.
    seeds : int
        Seeds, from 0.
    plan_files : tuple of str
        Names or files of these plans.
    """

    split: Split = "test"
    generated: int = 50
    paper: bool = True
    plans: tuple[str, ...] = ()
    seeds: int = 10
    plan_files: tuple[str, ...] = field(default=(), compare=False)

    @property
    def written(self) -> dict[str, Any]:
        """What is written to files, and compared; the same on any machine."""
        content = json.loads(json.dumps(asdict(self)))
        del content["plan_files"]
        return content

    @property
    def buildings_of(self) -> dict[Site, int]:
        """Number of buildings of each site."""
        return {self.split: self.generated, "paper": 2 * self.paper, "own": len(self.plans)}

    @property
    def buildings(self) -> int:
        """Number of buildings."""
        return sum(self.buildings_of.values())


FULL = Extent()
QUICK = Extent(generated=6, paper=False, seeds=2)


def extent_of(
    whole: Extent,
    split: str,
    generated: int | None,
    plans: Sequence[str | Path],
    seeds: int | None = None,
) -> Extent:
    """Part of an extent, and further plans.

    Parameters
    ----------
    whole : Extent
        `FULL` or `QUICK`.
    split : str
        Another split.
    generated : int or None
        Another number of generated buildings.
    plans : sequence of str or Path
        Names of built-in plans, or files, of further plans.
    seeds : int, optional
        Another number of seeds.

    Raises
    ------
    BenchmarkError
        For an unknown split, or more buildings than it has.
    """
    check(split in get_args(Split), "split", split, " or ".join(get_args(Split)))
    known: Split = next(name for name in get_args(Split) if name == split)
    most = len(FINGERPRINTS[known])
    count = min(whole.generated, most) if generated is None else generated
    check(0 <= count <= most, "buildings", count, f"0 to {most} in the split {split}")
    extent = replace(
        whole,
        paper=whole.paper and known == "test",
        split=known,
        generated=count,
        plans=tuple(floorplans.load(str(plan)).sha256 for plan in plans),
        plan_files=tuple(map(str, plans)),
        seeds=seeds or whole.seeds,
    )
    check(extent.buildings > 0, "buildings", count, "at least 1, or a plan")
    return extent


def flights_of_a_seed(site: Site) -> int:
    """Flights of each seed in each building and condition."""
    return 5 if site == "paper" else 3
