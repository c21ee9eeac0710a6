"""Searchers that do not learn from flight to flight, as baselines for reinforcement learning.

Each flies once from the start, at most ``max_steps`` seconds, until a reading exceeds the level
at which the RSS agent's episodes end. :class:`RandomWalk` and :class:`RssAscent` know only their
readings; :class:`ParticleFilter` also knows the floor plan, its own position in it, and a model of
how RSS falls with distance.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from raytrace.threads import n_threads
from rssnav.agents import RssAgent
from rssnav.arguments import require
from rssnav.discrete_states import AGENT_SENSITIVITY_DBM, Fluctuation
from rssnav.kernels import particle_filter, searchers
from rssnav.kernels.particle_filter import Belief, Chart, Model
from rssnav.kernels.searchers import FlightLog
from rssnav.kernels.stepping import Moves, Receiver
from rssnav.learning_parameters import QLearning
from rssnav.learning_rules import process_moves
from rssnav.optimal_flights import path_length_m
from rssnav.training import generator_states
from rssnav.world import GridWorld

_STREAM = 1 << 32  # added to the run numbers of searches: streams that no training uses


@dataclass(frozen=True)
class RandomWalk:
    """Every possible step is equally likely."""

    @property
    def name(self) -> str:
        """Short name for tables and files."""
        return "random walk"


@dataclass(frozen=True)
class RssAscent:
    """Greedy ascent of the RSS: move to the first neighbour tried that reads more than here.

    A neighbour is tried by flying there (and back, if it does not read more), the one straight
    ahead first, the others in random order.

    Parameters
    ----------
    readings : int
        Readings averaged in each cell against fluctuation; each takes a second.
    escape_steps : int
        Random steps flown from a local maximum; with 0 the flight ends there.
    """

    readings: int = 1
    escape_steps: int = 30

    def __post_init__(self) -> None:
        for name, least in (("readings", 1), ("escape_steps", 0)):
            value = getattr(self, name)
            require(value >= least, name, value, f"at least {least}")

    @property
    def name(self) -> str:
        """Short name for tables and files."""
        averaged = f", mean of {self.readings} readings" if self.readings > 1 else ""
        kind = "with escapes" if self.escape_steps else "alone"
        return f"RSS ascent {kind}{averaged}"


@dataclass(frozen=True)
class ParticleFilter:
    """Bayesian search with a log-distance path-loss model, p - 10 n log10(d / 1 m).

    Parameters
    ----------
    particles : int
        Number of hypotheses.
    power_dbm : (float, float)
        Range of p, the reading at 1 m [dBm]. 25 dBm at 2.4 GHz are -15 dBm in free space.
    exponent : (float, float)
        Range of the path-loss exponent n.
    sigma_db : float
        Standard deviation of readings about the model: shadowing, multipath and fluctuation [dB].
    fresh_fraction : float
        Fraction of new hypotheses at each resampling.
    steps_to_draw : int
        Steps flown towards a drawn hypothesis before another is drawn.
    """

    particles: int = 500
    power_dbm: tuple[float, float] = (-20.0, -10.0)
    exponent: tuple[float, float] = (1.5, 5.0)
    sigma_db: float = 8.0
    fresh_fraction: float = 0.1
    steps_to_draw: int = 40

    def __post_init__(self) -> None:
        power, exponent, fresh = self.power_dbm, self.exponent, self.fresh_fraction
        rising, positive = "a lower and a higher", "a positive, finite number [dB]"
        require(self.particles >= 2, "particles", self.particles, "at least 2")
        require(power[0] < power[1], "power_dbm", power, f"{rising} level [dBm]")
        both = 0.0 < exponent[0] < exponent[1]
        require(both, "exponent", exponent, f"{rising} exponent, both positive")
        require(0.0 < self.sigma_db < math.inf, "sigma_db", self.sigma_db, positive)
        require(0.0 <= fresh < 1.0, "fresh_fraction", fresh, "a number in [0, 1)")
        require(self.steps_to_draw >= 1, "steps_to_draw", self.steps_to_draw, "at least 1")

    @property
    def name(self) -> str:
        """Short name for tables and files."""
        return "particle filter"


_JITTER = np.array([0.5, 0.5, 0.3, 0.05])  # x, y [m], p [dB], n

Searcher = RandomWalk | RssAscent | ParticleFilter


@dataclass(frozen=True, eq=False)
class SearchResult:
    """Flights of a searcher (R of them).

    Attributes
    ----------
    found : (R,) bool
        Whether the flight ended in a cell whose RSS without fluctuation exceeds the level.
    false_alarm : (R,) bool
        Whether it ended elsewhere, by a fluctuation of the reading.
    steps : (R,) int64
        Seconds flown, including those spent on further readings in a cell.
    length_m : (R,) float64
        Length flown [m].
    flights : tuple of (n + 1,) int32
        State at each second, the start first.
    """

    found: NDArray[np.bool_]
    false_alarm: NDArray[np.bool_]
    steps: NDArray[np.int64]
    length_m: NDArray[np.float64]
    flights: tuple[NDArray[np.int32], ...]


def search(
    world: GridWorld,
    searcher: Searcher,
    *,
    runs: int = 100,
    max_steps: int = 20_000,
    seed: int = 0,
    terminal_dbm: float = -21.0,
    fluctuation: Fluctuation | None = None,
    sensitivity_dbm: float = AGENT_SENSITIVITY_DBM,
    threads: int | None = None,
) -> SearchResult:
    """Fly a searcher from the start, in many independent runs.

    Parameters
    ----------
    world : GridWorld
        Where it flies.
    searcher : RandomWalk, RssAscent or ParticleFilter
        Rule that it flies by.
    runs : int
        Flights.
    max_steps : int
        Seconds after which a flight ends without success.
    seed : int
        Same seed, same flights, for any number of threads.
    terminal_dbm : float
        Reading above which the transmitter is found [dBm].
    fluctuation : Fluctuation, optional
        How readings differ from the map; not at all by default.
    sensitivity_dbm : float
        Readings that are not above it are "no signal", as for :class:`RssAgent` [dBm].
    threads : int, optional
        Number of threads; all cores by default.

    Raises
    ------
    ValueError
        For a number out of range.
    WorldError
        When an RSS agent cannot fly in this world.
    """
    for name, value in (("runs", runs), ("max_steps", max_steps)):
        require(value >= 1, name, value, "at least 1")
    agent = RssAgent(terminal_dbm=terminal_dbm, sensitivity_dbm=sensitivity_dbm)
    process = agent.decision_process(world, QLearning())
    receiver = _receiver(world, fluctuation or Fluctuation(), agent)
    fly = _flying(searcher, world, process_moves(process), sensitivity_dbm)

    def one(run: int) -> tuple[NDArray[np.int32], bool]:
        states = np.full(max_steps + 1, world.start_state, dtype=np.int32)
        generator = generator_states(seed, _STREAM + run)[:4].copy()
        flight = FlightLog(states, np.zeros(1, dtype=np.int64), generator, np.zeros(1))
        claimed = fly(receiver, flight)
        return states[: int(flight.seconds[0]) + 1].copy(), claimed

    with ThreadPoolExecutor(n_threads(threads)) as pool:
        flown = list(pool.map(one, range(runs)))
    flights = tuple(states for states, _ in flown)
    claimed = np.array([claim for _, claim in flown])
    there = np.array([process.terminal[states[-1]] for states in flights])
    return SearchResult(
        found=claimed & there,
        false_alarm=claimed & ~there,
        steps=np.array([states.size - 1 for states in flights], dtype=np.int64),
        length_m=np.array([path_length_m(world, states) for states in flights]),
        flights=flights,
    )


Fly = Callable[[Receiver, FlightLog], bool]


def _receiver(world: GridWorld, fluctuation: Fluctuation, agent: RssAgent) -> Receiver:
    return Receiver(
        world.rss_dbm,
        float(fluctuation.sigma_db),
        float(fluctuation.correlation),
        float(agent.terminal_dbm),
        float(agent.sensitivity_dbm),
    )


def _flying(searcher: Searcher, world: GridWorld, moves: Moves, sensitivity_dbm: float) -> Fly:
    """Function that flies a searcher and logs the flight."""
    if isinstance(searcher, RandomWalk):
        return lambda receiver, flight: searchers.walk(
            moves, receiver, flight, flight.states.size - 1
        )
    if isinstance(searcher, RssAscent):
        return lambda receiver, flight: searchers.ascend(
            moves, receiver, flight, searcher.readings, searcher.escape_steps
        )
    model = _model(searcher, world, sensitivity_dbm)
    count, size = searcher.particles, world.n_states

    def track(receiver: Receiver, flight: FlightLog) -> bool:
        belief = Belief(np.empty((count, 4)), np.empty(count), np.empty((count, 4)))
        hops, queue = np.empty(size, dtype=np.int32), np.empty(size, dtype=np.int32)
        chart = Chart(world.position, hops, queue)
        return particle_filter.track(moves, receiver, flight, model, belief, chart)

    return track


def _model(searcher: ParticleFilter, world: GridWorld, sensitivity_dbm: float) -> Model:
    """Prior over the reachable part of the plan, and the likelihood."""
    low_xy, high_xy = world.position.min(axis=0), world.position.max(axis=0)
    ranges = (searcher.power_dbm, searcher.exponent)
    return Model(
        low=np.array([*low_xy, *(low for low, _ in ranges)]),
        high=np.array([*high_xy, *(high for _, high in ranges)]),
        jitter=_JITTER,
        sigma_db=float(searcher.sigma_db),
        fresh_fraction=float(searcher.fresh_fraction),
        found_m=2.0,
        steps_to_draw=searcher.steps_to_draw,
        sensitivity_dbm=float(sensitivity_dbm),
    )
