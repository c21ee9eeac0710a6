"""How well agents that are trained in a floor plan fly the paper's lengths."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np

import floorplans
from floorplans import FloorPlan
from raytrace import RadioMap
from rssnav.experiments.paper.claims.flights import turns
from rssnav.experiments.paper.counting import SUPPORTED_COUNT, counted_lengths_m
from rssnav.experiments.paper.data import AGENTS, Configuration, flights
from rssnav.experiments.paper.printed_values import PATH_LENGTH_M
from rssnav.experiments.paper.scenarios import SPEEDS
from rssnav.experiments.paper.trainings import EPISODE_LIMIT, STEP_LIMIT
from rssnav.experiments.studies.plan_search.constraints import (
    allows_printed_flights,
    has_the_stated_map,
)
from rssnav.experiments.studies.plan_search.families import draw
from rssnav.experiments.studies.study import Conditions
from rssnav.experiments.training_store import TrainingStore
from rssnav.maps import make_map
from rssnav.results import TrainingResult
from rssnav.world import GridWorld

BLOCK = 250
"""Plans that one piece of the search draws."""

CLOSE = 0.05
"""A length within this fraction of the printed one counts as met."""

BUILT_IN = -1
"""Block of the built-in plan, which the drawn ones are compared with."""


@dataclass(frozen=True)
class Piece:
    """Plans of a scenario that are drawn and tried together."""

    scenario: int
    block: int

    @property
    def label(self) -> str:
        """Name of the block in files and tables."""
        return "built-in" if self.block == BUILT_IN else f"block {self.block}"


@dataclass(frozen=True, eq=False)
class Fit:
    """A plan and the flights that were learned in it.

    Attributes
    ----------
    piece : Piece
        Where it was drawn.
    number : int
        Its number within the block; -1 for a piece in which no plan remained.
    toml : str
        The plan.
    deviation : mapping of Configuration to float
        Mean counted length over the paper's, less 1; NaN where no flight arrived.
    turns : mapping of Configuration to float
        Mean number of changes of heading.
    steps : mapping of Configuration to float
        Mean number of steps.
    """

    piece: Piece
    number: int
    toml: str
    deviation: Mapping[Configuration, float]
    turns: Mapping[Configuration, float]
    steps: Mapping[Configuration, float]

    def worst(self, accept: Callable[[Configuration], bool] = lambda _: True) -> float:
        """Return the largest deviation among configurations; inf where no flight arrived."""
        found = [abs(value) for key, value in self.deviation.items() if accept(key)]
        return max(np.inf if np.isnan(value) else value for value in found)

    @property
    def score(self) -> int:
        """Number of the paper's statements that are met: six lengths and six claims."""
        return self.lengths() + self.claims()

    def lengths(self) -> int:
        """Return how many of the six lengths are within :data:`CLOSE` of the printed ones."""
        return sum(abs(value) <= CLOSE for value in self.deviation.values())

    def claims(self) -> int:
        """Return at how many speeds the RSS agent flies farther, and with more turns."""
        at = [
            [Configuration(self.piece.scenario, agent, speed) for agent in AGENTS]
            for speed in SPEEDS
        ]
        longer = sum(self._length_m(rss) > self._length_m(location) for rss, location in at)
        return longer + sum(self.turns[rss] > self.turns[location] for rss, location in at)

    def _length_m(self, key: Configuration) -> float:
        return PATH_LENGTH_M[key] * (1.0 + self.deviation[key])


def measure(piece: Piece, conditions: Conditions) -> list[Fit]:
    """Draw the plans of a piece, and train in those that meet all conditions.

    They allow the printed flights and have a map such as the paper says.

    Raises
    ------
    TrainingInterrupted
        On Ctrl-C.
    """
    fits: list[Fit] = []
    for number, plan in _plans(piece, conditions.seed):
        radio_map = _kept_map(piece, number, plan, conditions.store)
        if has_the_stated_map(plan, radio_map):
            fits.append(_fit(piece, number, plan, radio_map, conditions))
    return fits


def _plans(piece: Piece, seed: int) -> Iterator[tuple[int, FloorPlan]]:
    """Plans of a piece that allow the printed flights, or the built-in plan as it is."""
    if piece.block == BUILT_IN:
        yield 0, floorplans.load(f"scenario{piece.scenario}")
        return
    rng = np.random.default_rng((seed, piece.scenario, piece.block))
    for number in range(BLOCK):
        plan = draw(piece.scenario, rng)
        if plan is not None and allows_printed_flights(plan, piece.scenario):
            yield number, plan


def _kept_map(piece: Piece, number: int, plan: FloorPlan, store: TrainingStore) -> RadioMap:
    name = store.file_name(f"{piece.label} {number} scenario {piece.scenario} map")
    return make_map(plan, store.folder / name, threads=store.threads, force=not store.resume)


def _fit(
    piece: Piece, number: int, plan: FloorPlan, radio_map: RadioMap, conditions: Conditions
) -> Fit:
    trained: dict[Configuration, TrainingResult] = {}
    for speed in SPEEDS:
        world = GridWorld.from_map(plan, radio_map, speed)
        for agent in AGENTS:
            key = Configuration(piece.scenario, agent, speed)
            trained[key] = conditions.train(
                f"{piece.label} {number} {key.name}",
                world,
                AGENTS[agent],
                EPISODE_LIMIT,
                until_converged=True,
                max_total_steps=STEP_LIMIT,
            )
    return Fit(
        piece,
        number,
        floorplans.dumps(plan),
        {key: _mean(counted_lengths_m(r, SUPPORTED_COUNT)) / PATH_LENGTH_M[key] - 1.0
         for key, r in trained.items()},
        {key: _mean([turns(r.world, flight) for flight in flights(r)])
         for key, r in trained.items()},
        {key: _mean(r.path_steps[r.reached]) for key, r in trained.items()},
    )  # fmt: skip


def _mean(values: object) -> float:
    array = np.asarray(values, np.float64)
    return float(array.mean()) if array.size else float("nan")
