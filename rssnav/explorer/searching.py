"""Two searchers that fly for the same transmitter, one beside the other."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from raytrace import RadioMap
from raytrace.constants import SPEED_OF_LIGHT
from rssnav.discrete_states import Fluctuation
from rssnav.explorer.background import SupersededError
from rssnav.explorer.fair_turns import TabTurns
from rssnav.explorer.live_work import LiveWork
from rssnav.explorer.tracing import TracedMap
from rssnav.kernels import stepping
from rssnav.missions import Layout, Observation, Policy, RandomPolicy, ReadingAbove, Task
from rssnav.missions.energy import MultirotorEnergy
from rssnav.missions.flights import Flyer
from rssnav.optimal_flights import shortest_path
from rssnav.policies import DistanceSearch, FrontierSearch, GaussianProcessSearch
from rssnav.training import generator_states
from rssnav.world import GridWorld

MAX_STEPS = 2000
MOST_GAUSSIAN_CELLS = 1000
"""Cells whose covariances are kept at most."""

KEPT_BELIEFS = 1 << 20
"""Probabilities that are kept of a flight at most; of longer flights those of every k-th step."""

STEPS_A_TURN = 20

Searcher = Callable[[Layout, RadioMap], Policy]


def power_at_1m_dbm(radio_map: RadioMap) -> float:
    """RSS at 1 m from a map's transmitter in free space, without gains of antennas [dBm]."""
    transmitter = radio_map.transmitter
    wavelength_m = SPEED_OF_LIGHT / transmitter.frequency_hz
    return transmitter.power_dbm + 20.0 * math.log10(wavelength_m / (4.0 * math.pi))


def _gaussian(layout: Layout, _map: RadioMap) -> Policy:
    cells = math.prod(layout.shape)
    if cells > MOST_GAUSSIAN_CELLS:
        raise ValueError(
            f"Gaussian process: the map has {cells} cells; this searcher takes at most "
            f"{MOST_GAUSSIAN_CELLS}: choose larger cells"
        )
    return GaussianProcessSearch(layout)


SEARCHERS: dict[str, Searcher] = {
    "Bayesian, plan unknown": lambda layout, at: DistanceSearch(
        layout, power_dbm=power_at_1m_dbm(at)
    ),
    "Bayesian, plan known": lambda layout, at: DistanceSearch(
        layout, plan_known=True, power_dbm=power_at_1m_dbm(at)
    ),
    "Gaussian process": _gaussian,
    "Frontier": lambda layout, _map: FrontierSearch(layout),
    "Random walk": lambda _layout, _map: RandomPolicy(),
}
BELIEVERS = ("Bayesian, plan unknown", "Bayesian, plan known")
"""Those that keep a belief of where the source is."""


@dataclass(frozen=True)
class SearchSettings:
    """Who searches, and for what.

    Attributes
    ----------
    searchers : (str, str)
        Two names of `SEARCHERS`.
    goal_rss_dbm : float
        The source is found by a reading above this [dBm].
    sigma_db : float
        Standard deviation of readings about the map [dB].
    confirmations : int
        Readings whose mean must be above the goal.
    battery_kj : float
        Energy after which a flight ends [kJ], by the model `MultirotorEnergy`.
    speed : int
        Cells per step along an axis.
    max_steps : int
        Seconds after which a flight ends: each step takes one, and each reading in place.
    seed : int
    """

    searchers: tuple[str, str]
    goal_rss_dbm: float = -21.0
    sigma_db: float = 0.0
    confirmations: int = 1
    battery_kj: float = 1000.0
    speed: int = 1
    max_steps: int = 1000
    seed: int = 0

    def __post_init__(self) -> None:
        """Check names and numbers that only this part knows."""
        for name in self.searchers:
            if name not in SEARCHERS:
                raise ValueError(f"searcher: {name!r} must be one of {', '.join(SEARCHERS)}")
        if not 1 <= self.max_steps <= MAX_STEPS:
            raise ValueError(f"max_steps: {self.max_steps} must be 1 to {MAX_STEPS}")


@dataclass(eq=False)
class SearchFlight:
    """A flight so far.

    Attributes
    ----------
    name : str
        Of the searcher.
    position : list of (2,) float64
        Cell centres [m], the start first.
    beliefs : list of (n_y, n_x) float32
        Probability of each cell, after every `every`-th step; empty for searchers without one.
    every : int
        See `beliefs`.
    energy_kj : float
        Used so far [kJ].
    end : str
        How it ended; empty while it goes on.
    """

    name: str
    position: list[NDArray[np.float64]] = field(default_factory=list)
    beliefs: list[NDArray[np.float32]] = field(default_factory=list)
    every: int = 1
    energy_kj: float = 0.0
    end: str = ""

    @property
    def steps(self) -> int:
        """Number of steps so far."""
        return max(len(self.position) - 1, 0)

    def belief(self, step: int) -> NDArray[np.float32] | None:
        """Return the newest belief that is kept at a step."""
        if not self.beliefs:
            return None
        return self.beliefs[min(step // self.every, len(self.beliefs) - 1)]


class LiveSearch(LiveWork):
    """Two flights in a worker thread that can be watched and stopped.

    Both have the same random numbers of the world, and take turns step by step.

    Parameters
    ----------
    traced : TracedMap
        Map that the UAV flies in.
    settings : SearchSettings
    turns : TabTurns, optional
        Turns of its tab.

    Attributes
    ----------
    flights : (SearchFlight, SearchFlight)
    shortest_steps : int or None
        Fewest steps to the goal; None until known.
    """

    def __init__(
        self, traced: TracedMap, settings: SearchSettings, turns: TabTurns | None = None
    ) -> None:
        super().__init__("search", turns)
        self.traced, self.settings = traced, settings
        self.flights = tuple(SearchFlight(name) for name in settings.searchers)
        self.shortest_steps: int | None = None

    @property
    def steps(self) -> int:
        """Steps of the longer flight so far."""
        return max(flight.steps for flight in self.flights)

    def _work(self) -> None:
        try:
            self._fly()
        except SupersededError:
            for flight in self.flights:
                flight.end = flight.end or "stopped"
            raise

    def _fly(self) -> None:
        settings, radio_map = self.settings, self.traced.radio_map
        with self._turns.turn(self._check):
            world = GridWorld.from_map(self.traced.plan, radio_map, settings.speed)
            mission = world.mission()
            goal = ReadingAbove(settings.goal_rss_dbm, settings.confirmations)
            task = Task(
                goal,
                "none",
                energy=MultirotorEnergy(),
                battery_kj=settings.battery_kj,
                max_steps=settings.max_steps,
            )
            sight = Observation(None, cell=True, fluctuation=Fluctuation(settings.sigma_db))
            at_goal = goal.cells(mission)[0]
            if not at_goal.any():
                largest_dbm = float(np.max(world.rss_dbm))
                raise ValueError(
                    f"no cell has an RSS above {settings.goal_rss_dbm:g} dBm, the largest is "
                    f"{largest_dbm:.1f} dBm: choose a lower goal"
                )
            self.shortest_steps = shortest_path(world, at_goal).steps
            flying = [
                self._steps(flight, Flyer(mission, task, sight), world, number)
                for number, flight in enumerate(self.flights)
            ]
        while flying:
            with self._turns.turn(self._check):
                for _ in range(STEPS_A_TURN):
                    flying = [each for each in flying if next(each, None) is not None]

    def _steps(
        self, flight: SearchFlight, flyer: Flyer, world: GridWorld, number: int
    ) -> Iterator[int]:
        """Fly, a step each time."""
        settings = self.settings
        policy: Any = SEARCHERS[flight.name](world.layout, self.traced.radio_map)
        believes = flight.name in BELIEVERS
        policy.begin(np.random.default_rng((settings.seed, number)))
        flight.every = math.ceil(math.prod(world.shape) * settings.max_steps / KEPT_BELIEFS)
        seen = flyer.begin(generator_states(settings.seed, 0)[:4])
        flight.position.append(world.position[seen.cell])
        status = stepping.RUNNING
        while status == stepping.RUNNING:
            action = policy.act(seen, flyer.mask())
            if believes and flight.steps % flight.every == 0:
                flight.beliefs.append(np.array(policy.belief, dtype=np.float32))
            _, status = flyer.step(action)
            seen = flyer.seen()
            flight.energy_kj = flyer.energy_kj
            flight.position.append(world.position[seen.cell])
            yield status
        here = world.rss_dbm[seen.cell] > settings.goal_rss_dbm
        is_empty = flight.energy_kj >= settings.battery_kj
        flight.end = "battery is empty" if is_empty else "time is over"
        if status == stepping.FOUND:
            flight.end = "found" if here else "false alarm"
