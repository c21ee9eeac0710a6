"""What is flown: frozen within a version, so that results of different people compare.

A change of anything here, of the buildings or of the stepping kernel's flights raises
`BENCHMARK_VERSION`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from rssnav.benchmark.buildings import GOAL, N_BUILDINGS, Split
from rssnav.discrete_states import Fluctuation
from rssnav.missions import Mission, ModeProcess, MultirotorEnergy, Observation, Task

BENCHMARK_VERSION = 1

MAX_STEPS = 400
"""Seconds after which a flight ends without success."""

CONFIRMATIONS = 16
"""Readings that confirm the goal where readings fluctuate, one a second."""


@dataclass(frozen=True)
class Condition:
    """A task of the benchmark.

    Parameters
    ----------
    name : str
        In tables and files.
    sigma_db : float
        Standard deviation of the fluctuation of readings, independent from second to second [dB].
    jump_probability : float
        Probability that the transmitter is drawn anew among the building's places, per second.
    """

    name: str
    sigma_db: float = 0.0
    jump_probability: float = 0.0

    @property
    def task(self) -> Task:
        """Goal, limits, and the energy that is reported."""
        goal = replace(GOAL, confirmations=CONFIRMATIONS) if self.sigma_db > 0.0 else GOAL
        return Task(goal, "none", energy=MultirotorEnergy(), max_steps=MAX_STEPS)

    @property
    def observation(self) -> Observation:
        """RSS and the UAV's own cell."""
        return Observation(None, cell=True, fluctuation=Fluctuation(self.sigma_db))

    def world(self, mission: Mission) -> Mission:
        """Mission whose transmitter moves as in this task."""
        if self.jump_probability == 0.0:
            return mission
        return mission.with_modes(ModeProcess.jumping(mission.n_modes, self.jump_probability))


CONDITIONS = (
    Condition("static"),
    Condition("2 dB", sigma_db=2.0),
    Condition("4 dB", sigma_db=4.0),
    Condition("jumps", jump_probability=0.01),
)
"""The tasks."""


@dataclass(frozen=True)
class Extent:
    """How much is flown.

    Parameters
    ----------
    split : {"train", "validation", "test"}
        Buildings.
    buildings : int
        How many of them, the first.
    seeds : int
        Seeds, from 0.
    flights : int
        Flights of each seed in each building and task.
    """

    split: Split = "test"
    buildings: int = N_BUILDINGS["test"]
    seeds: int = 10
    flights: int = 3


FULL = Extent()
QUICK = Extent(buildings=6, seeds=2)
