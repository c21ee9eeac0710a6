"""Which printed lengths an interpretation allows."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from rssnav.experiments.paper.counting import Count
from rssnav.experiments.paper.data import CONFIGURATIONS, Configuration
from rssnav.experiments.studies.readings.empty_floor import FLOORS, Arrivals, arrivals, lattice
from rssnav.experiments.studies.readings.interpretations import Geometry
from rssnav.experiments.studies.readings.lengths import supposed_counts


@dataclass(frozen=True, eq=False)
class Outcome:
    """What an interpretation of the geometry allows on the empty floor.

    Attributes
    ----------
    geometry : Geometry
        The interpretation.
    possible : mapping of Count to tuple of bool
        Whether the flight of each configuration exists, in the order of `CONFIGURATIONS`.
    least_steps : mapping of Configuration to int
        Fewest steps of any flight; -1 where the goal cannot be reached.
    """

    geometry: Geometry
    possible: Mapping[Count, tuple[bool, ...]]
    least_steps: Mapping[Configuration, int]

    def n_possible(self, count: Count) -> int:
        """Return how many of the configurations' flights exist."""
        return sum(self.possible[count])


def measure(geometry: Geometry) -> Outcome:
    """Search the flights of all configurations."""
    counts = supposed_counts()
    most = {
        (key.scenario, key.speed): max(
            c.steps for k, c in counts.items() if (k.scenario, k.speed) == (key.scenario, key.speed)
        )
        for key in CONFIGURATIONS
    }
    found: dict[tuple[int, int], Arrivals] = {
        (scenario, speed): arrivals(lattice(FLOORS[scenario], geometry, speed), steps)
        for (scenario, speed), steps in most.items()
    }
    of = {key: found[key.scenario, key.speed] for key in CONFIGURATIONS}
    return Outcome(
        geometry,
        {c: tuple(of[key].has(counts[key], c) for key in CONFIGURATIONS) for c in Count},
        {key: of[key].least_steps for key in CONFIGURATIONS},
    )
