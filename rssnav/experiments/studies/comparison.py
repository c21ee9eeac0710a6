"""Oracles, learners and searchers side by side, on the same worlds and the same budget.

The budget of a configuration is the largest number of steps that any realisation of Q-learning
flew until it converged; SARSA and Double Q-learning get as many and no more. Searchers do not
learn: each has one flight, as long as the cap of an episode.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from rssnav.agents import Agent, DecisionProcess, QLearning
from rssnav.baselines import ParticleFilter, RandomWalk, RssAscent, Searcher, search
from rssnav.experiments.paper.data import AGENT_LABELS, AGENTS, flights
from rssnav.experiments.paper.printed_values import EPISODE_LIMIT
from rssnav.experiments.studies.common import Progress, Study, load_worlds, no_progress, write_study
from rssnav.experiments.tables import Cell, Column, Table
from rssnav.planning import (
    Path as Flight,
)
from rssnav.planning import (
    discounted_return,
    greedy_path,
    shortest_path,
    value_iteration,
)
from rssnav.results import NO_STEP_LIMIT, TrainingResult
from rssnav.states import Fluctuation
from rssnav.training import train
from rssnav.world import GridWorld

RUNS = 50
QUICK_RUNS = 3
NOISE = Fluctuation(sigma_db=2.0)
SEARCHERS: tuple[tuple[Searcher, Fluctuation], ...] = (
    (RandomWalk(), Fluctuation()),
    (RssAscent(escape_steps=0), Fluctuation()),
    (RssAscent(), Fluctuation()),
    (ParticleFilter(), Fluctuation()),
    (RssAscent(), NOISE),
    (RssAscent(readings=8), NOISE),
    (ParticleFilter(), NOISE),
)
_RULES = {
    "Q-learning": QLearning(),
    "SARSA": QLearning(rule="sarsa"),
    "Double Q-learning": QLearning(rule="double_q"),
}
_TOLERANCE = 1e-6


@dataclass(frozen=True)
class Place:
    """Scenario and speed."""

    scenario: int
    speed: int


@dataclass(frozen=True, eq=False)
class Method:
    """What a method flies in the end, over R runs of which A arrive.

    Attributes
    ----------
    kind : str
        "oracle", "learner" or "searcher".
    name, knows : str
        What it is, and what it goes by.
    runs : int
        R.
    steps, length_m : (A,) float64
        Of the flights that arrive; seconds, and metres.
    converged : int or None
        Runs that converged, for learners.
    training_steps : (R,) float64
        Steps flown before; empty where nothing is learnt.
    regret : (A,) float64
        Optimal return minus the flight's; empty where there is no return.
    sigma_db : float
        Fluctuation of the readings [dB].
    false_alarms : float or None
        Share of the runs that ended by a reading that wrongly said "found", for searchers.
    """

    kind: str
    name: str
    knows: str
    runs: int
    steps: NDArray[np.float64]
    length_m: NDArray[np.float64]
    converged: int | None
    training_steps: NDArray[np.float64]
    regret: NDArray[np.float64]
    sigma_db: float = 0.0
    false_alarms: float | None = None


@dataclass(frozen=True, eq=False)
class _Task:
    """An agent's decision process in a world, and the flight that is optimal in it."""

    world: GridWorld
    agent: Agent
    process: DecisionProcess
    optimum: Flight

    @classmethod
    def of(cls, world: GridWorld, agent: Agent) -> _Task:
        learning = QLearning()
        process = agent.decision_process(world, learning)
        solution = value_iteration(process, learning.gamma, tolerance=_TOLERANCE)
        return cls(world, agent, process, greedy_path(world, process, solution.q))

    def regret(self, states: NDArray[np.int32]) -> float:
        """Optimal return from the start minus that of a flight."""
        gamma = QLearning().gamma
        best = discounted_return(self.process, self.optimum.states, gamma)
        return best - discounted_return(self.process, states, gamma)


def run(
    out: str | Path = "results",
    *,
    quick: bool = False,
    seed: int = 0,
    threads: int | None = None,
    progress: Progress | None = None,
) -> Study:
    """Fly all methods in both scenarios at all speeds; write one table below ``out``.

    Parameters
    ----------
    out : str or Path
        Folder of the maps, which are traced when missing, and of ``tables/``.
    quick : bool
        Three realisations in place of fifty.
    seed : int
        Same seed, same results, for any number of threads.
    threads : int, optional
        Threads; all cores by default.
    progress : callable, optional
        Called as ``progress(stage, done, total)``.

    Raises
    ------
    TrainingInterrupted
        On Ctrl-C while training.
    """
    out, tell = Path(out), progress or no_progress
    worlds = load_worlds(out, threads, tell)
    runs = QUICK_RUNS if quick else RUNS
    rows: list[tuple[Cell, ...]] = []
    total = len(worlds) * (2 + len(AGENTS) * (1 + len(_RULES)) + len(SEARCHERS))
    for (scenario, speed), world in worlds.items():
        shortest_m = _shortest(world).length_m
        for method in _methods(world, runs, seed, threads):
            rows.append(_row(Place(scenario, speed), method, shortest_m))
            tell("comparison", len(rows), total)
    return write_study(out, (comparison_table(rows),), {})


def _methods(world: GridWorld, runs: int, seed: int, threads: int | None) -> Iterator[Method]:
    """Fly all methods in a world."""
    terminal = AGENTS["location"].decision_process(world, QLearning()).terminal
    fewest = shortest_path(world, terminal, "steps")
    yield _oracle("fewest steps (Dijkstra)", "the plan", fewest)
    yield _oracle("fewest metres (Dijkstra)", "the plan", _shortest(world))
    for name, agent in AGENTS.items():
        task = _Task.of(world, agent)
        label = f"{AGENT_LABELS[name]} rewards"
        yield _oracle(f"value iteration, {label}", "plan and rewards", task.optimum)
        budget = NO_STEP_LIMIT
        for rule, learning in _RULES.items():
            result = train(
                world,
                agent,
                runs=runs,
                episodes=EPISODE_LIMIT,
                seed=seed,
                learning=learning,
                until_converged=True,
                min_episodes=1,
                max_total_steps=budget,
                threads=threads,
            )
            method = _learner(f"{rule}, {AGENT_LABELS[name]}", task, result)
            budget = min(budget, int(method.training_steps.max()))
            yield method
    for searcher, fluctuation in SEARCHERS:
        yield _searcher(world, searcher, fluctuation, runs, seed, threads)


def _shortest(world: GridWorld) -> Flight:
    terminal = AGENTS["location"].decision_process(world, QLearning()).terminal
    return shortest_path(world, terminal, "metres")


def _oracle(name: str, knows: str, flight: Flight) -> Method:
    none = np.empty(0)
    steps, length_m = np.array([float(flight.steps)]), np.array([flight.length_m])
    return Method("oracle", name, knows, 1, steps, length_m, None, none, none)


def _learner(name: str, task: _Task, result: TrainingResult) -> Method:
    arrived = result.reached
    knows = "own and victim's place" if task.agent.name == "location" else "RSS"
    flown = np.array([row[row > 0].sum() for row in result.steps], dtype=np.float64)
    return Method(
        kind="learner",
        name=name,
        knows=knows,
        runs=arrived.size,
        steps=result.path_steps[arrived].astype(np.float64),
        length_m=result.path_length_m[arrived],
        converged=int(np.count_nonzero(result.converged_episode >= 0)),
        training_steps=flown,
        regret=np.array([task.regret(states) for states in flights(result)]),
    )


def _searcher(
    world: GridWorld,
    searcher: Searcher,
    fluctuation: Fluctuation,
    runs: int,
    seed: int,
    threads: int | None,
) -> Method:
    result = search(world, searcher, runs=runs, seed=seed, fluctuation=fluctuation, threads=threads)
    found = result.found
    knows = "RSS"
    if isinstance(searcher, RandomWalk):
        knows = "RSS at the goal"
    elif isinstance(searcher, ParticleFilter):
        knows = "RSS, plan, own place"
    return Method(
        kind="searcher",
        name=searcher.name,
        knows=knows,
        runs=runs,
        steps=result.steps[found].astype(np.float64),
        length_m=result.length_m[found],
        converged=None,
        training_steps=np.empty(0),
        regret=np.empty(0),
        sigma_db=fluctuation.sigma_db,
        false_alarms=float(result.false_alarm.mean()),
    )


def comparison_table(rows: list[tuple[Cell, ...]]) -> Table:
    """Make the table of all methods, from rows of cells."""
    return Table(
        "comparison",
        "Oracles, learners and searchers",
        "Success: runs whose final flight (learners: the greedy one after training; searchers: the "
        "only one) reaches the source. Steps, metres and regret are over those. Detour: metres "
        "over the fewest possible. Regret: optimal discounted return minus the flight's. The "
        f"σ = {NOISE.sigma_db:g} dB rows have readings that fluctuate; a false alarm is a reading "
        "above −21 dBm elsewhere, which ends the flight.",
        (
            Column("scenario", "Scenario"),
            Column("speed_mps", "Speed [m/s]"),
            Column("kind", "Kind"),
            Column("method", "Method"),
            Column("knows", "Goes by"),
            Column("sigma_db", "σ [dB]"),
            Column("runs", "Runs"),
            Column("converged", "Converge"),
            Column("training_steps", "Steps flown before"),
            Column("success", "Success", 2),
            Column("false_alarms", "False alarms", 2),
            Column("mean_steps", "Steps", 1),
            Column("sd_steps", "± sd", 1),
            Column("mean_m", "Length [m]", 1),
            Column("sd_m", "± sd [m]", 1),
            Column("detour", "Detour", 3),
            Column("mean_regret", "Regret", 2),
            Column("sd_regret", "± sd", 2),
        ),
        tuple(rows),
    )


def _row(place: Place, method: Method, shortest_m: float) -> tuple[Cell, ...]:
    return (
        place.scenario,
        place.speed,
        method.kind,
        method.name,
        method.knows,
        method.sigma_db,
        method.runs,
        method.converged,
        *_mean_and_sd(method.training_steps)[:1],
        method.length_m.size / method.runs,
        method.false_alarms,
        *_mean_and_sd(method.steps),
        *_mean_and_sd(method.length_m),
        float(method.length_m.mean()) / shortest_m if method.length_m.size else None,
        *_mean_and_sd(method.regret),
    )


def _mean_and_sd(values: NDArray[np.float64]) -> tuple[float | None, float | None]:
    """Mean and standard deviation, each None where there are too few values for it."""
    return (
        float(values.mean()) if values.size else None,
        float(values.std(ddof=1)) if values.size > 1 else None,
    )
