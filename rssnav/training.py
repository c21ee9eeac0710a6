"""Training: many independent realisations of Q-learning on all cores.

Realisation ``k`` of seed ``s`` draws from its own xoshiro256++ stream, seeded by
``numpy.random.SeedSequence(s, spawn_key=(k,))``, and shares no array that it writes with another.
So a result does not depend on the number of threads, and any realisation can be repeated alone.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from concurrent.futures import FIRST_COMPLETED, ThreadPoolExecutor, wait
from dataclasses import dataclass
from itertools import islice
from threading import Event

import numpy as np
from numpy.typing import NDArray

from raytrace.threads import n_threads
from rssnav.agents import Agent
from rssnav.arguments import require
from rssnav.kernels import common
from rssnav.learning_parameters import QLearning
from rssnav.learning_rules import LearningProblem
from rssnav.optimal_flights import Flight, greedy_path
from rssnav.progress import Progress
from rssnav.results import TrainingResult, padded
from rssnav.schedule import MAX_EPISODES, MAX_RUNS, NO_STEP_LIMIT, Schedule
from rssnav.world import GridWorld

Checkpoint = Callable[[TrainingResult], None]

_CHUNK_EPISODES = 64  # between two checks for an interrupt
_LONGEST_END_S = 0.3  # longest wait for threads after an interrupt
_AHEAD = 4  # realisations submitted for each thread
_CHECKPOINT_S = 3.0
_CHECKPOINT_FRACTION = 0.05  # of the time, at most


class TrainingInterrupted(KeyboardInterrupt):
    """Ctrl-C during training; ``result`` holds the finished realisations (None without any).

    Save it, and pass it to :func:`train` as ``resume`` to train the missing ones.
    """

    def __init__(self, result: TrainingResult | None) -> None:
        done = 0 if result is None else result.run_ids.size
        super().__init__(f"training was interrupted with {done} finished realisations")
        self.result = result


@dataclass(frozen=True, eq=False)
class _Realisation:
    """One finished run."""

    run_id: int
    episodes: NDArray[np.int32]  # (episodes flown, 3)
    snapshots: NDArray[np.int32]  # (K, C) visits of each of the world's C cells
    counters: NDArray[np.int64]
    converged_cpu_s: float
    cpu_s: float
    flight: Flight
    n_discrete_states: int
    q: NDArray[np.float64] | None


def train(
    world: GridWorld,
    agent: Agent,
    *,
    runs: int = 100,
    episodes: int = 1000,
    seed: int = 0,
    learning: QLearning | None = None,
    until_converged: bool = False,
    min_episodes: int = 1000,
    snapshot_episodes: Sequence[int] = (200, 500, 1000),
    max_total_steps: int = NO_STEP_LIMIT,
    keep_q: bool = False,
    threads: int | None = None,
    progress: Progress | None = None,
    checkpoint: Checkpoint | None = None,
    only_runs: Sequence[int] | None = None,
    resume: TrainingResult | None = None,
) -> TrainingResult:
    """Train an agent in a world, in many independent realisations.

    Parameters
    ----------
    world : GridWorld
        Where it flies.
    agent : Agent
        Defines state, reward and goal: an RssAgent, a LocationAgent or one of your own.
    runs : int
        Realisations.
    episodes : int
        Episodes of each; with ``until_converged`` the largest number.
    seed : int
        Same seed, same result, for any number of threads.
    learning : QLearning, optional
        Parameters of Algorithm 1.
    until_converged : bool
        Stop a run once it flies the same path in three consecutive episodes, but not before
        ``min_episodes``. One such training serves both the figures over the first ``min_episodes``
        episodes and the convergence figure.
    min_episodes : int
        Episodes a run flies even when it converges earlier.
    snapshot_episodes : sequence of int
        Episodes after which visit counts are stored; those that a run may not reach are ignored.
    max_total_steps : int
        A run that has flown this many steps starts no further episode, or at most 63 more: a limit
        for parameters with which it might never converge. With it no visit counts are stored.
    keep_q : bool
        Store the final Q-tables.
    threads : int, optional
        Number of threads; all cores by default.
    progress : callable, optional
        Called as ``progress(done, runs)`` whenever realisations finish.
    checkpoint : callable, optional
        Called every few seconds with all finished realisations, `resume` included, to save them;
        less often if that takes more than a twentieth of the time.
    only_runs : sequence of int, optional
        Train only these of the realisations 0..runs-1; each is the same as in the full training.
    resume : TrainingResult, optional
        Finished realisations of the same training, which are not trained again.

    Returns
    -------
    TrainingResult

    Raises
    ------
    ValueError
        For a parameter out of range, or a ``resume`` of another training.
    WorldError
        When the agent cannot learn in this world.
    TrainingInterrupted
        On Ctrl-C, with the finished realisations.
    """
    learning = QLearning() if learning is None else learning
    if max_total_steps < NO_STEP_LIMIT:
        snapshot_episodes = ()
    schedule = _schedule(
        runs, episodes, seed, until_converged, min_episodes, snapshot_episodes, max_total_steps
    )
    run_ids = _wanted_runs(runs, only_runs)
    trainer = _Trainer(world, LearningProblem.of(world, agent, learning), schedule, Event(), keep_q)
    if resume is not None:
        resume.check_same_training(world, agent, learning, schedule)
        run_ids = [k for k in run_ids if k not in resume.run_ids]

    def combined(realisations: Sequence[_Realisation]) -> TrainingResult:
        trained = _collect(trainer, agent, realisations)
        return trained if resume is None else resume.merged(trained)

    monitor = _Monitor(runs - len(run_ids), runs, progress, checkpoint, combined)
    realisations, interrupted = _on_threads(trainer, run_ids, n_threads(threads), monitor)
    result = combined(realisations) if realisations else resume
    if interrupted or result is None:
        raise TrainingInterrupted(result)
    return result


def _schedule(
    runs: int,
    episodes: int,
    seed: int,
    until_converged: bool,
    min_episodes: int,
    snapshot_episodes: Sequence[int],
    max_total_steps: int,
) -> Schedule:
    for name, value, least, most in (
        ("runs", runs, 1, MAX_RUNS),
        ("episodes", episodes, 1, MAX_EPISODES),
        ("min_episodes", min_episodes, 1, MAX_EPISODES),
        ("seed", seed, 0, NO_STEP_LIMIT),
        ("max_total_steps", max_total_steps, 1, NO_STEP_LIMIT),
    ):
        fits = not isinstance(value, bool) and least <= value <= most and int(value) == value
        require(fits, name, value, f"a whole number of at least {least}, at most {most}")
    guaranteed = min(episodes, min_episodes) if until_converged else episodes
    snapshots = tuple(sorted({int(k) for k in snapshot_episodes if k <= guaranteed}))
    if snapshots:
        require(snapshots[0] >= 1, "snapshot_episodes", snapshots[0], "at least 1")
    return Schedule(
        int(runs),
        int(episodes),
        int(seed),
        until_converged,
        int(min_episodes),
        snapshots,
        int(max_total_steps),
    )


def _wanted_runs(runs: int, only_runs: Sequence[int] | None) -> list[int]:
    if only_runs is None:
        return list(range(runs))
    wanted = sorted({int(k) for k in only_runs})
    if not wanted or wanted[0] < 0 or wanted[-1] >= runs:
        raise ValueError(f"only_runs: {only_runs!r} must name some of the runs 0 to {runs - 1}")
    return wanted


def generator_states(seed: int, run: int) -> NDArray[np.uint64]:
    """States (8,) of the two xoshiro256++ generators that realisation ``run`` starts from."""
    words = np.random.SeedSequence(seed, spawn_key=(run,)).generate_state(8, np.uint64)
    return words.astype(np.uint64)


@dataclass(frozen=True, eq=False)
class _Trainer:
    """Trains one realisation; called on many threads at once."""

    world: GridWorld
    problem: LearningProblem
    schedule: Schedule
    stop: Event
    keep_q: bool

    def __call__(self, run_id: int) -> _Realisation | None:
        """Train a realisation; None when it is stopped before the end."""
        schedule, process = self.schedule, self.problem.process
        n_cells = self.world.n_states
        learner = self.problem.learner(generator_states(schedule.seed, run_id), schedule.episodes)
        counters = learner.run.counters
        snapshots = np.zeros((len(schedule.snapshot_episodes), n_cells), dtype=np.int32)
        begin_s = time.thread_time()
        converged_s = 0.0
        while counters[common.EPISODE] < (limit := self._limit(counters)):
            if self.stop.is_set():
                return None
            undecided = counters[common.CONVERGED_EPISODE] < 0
            learner.advance(self._next_stop(int(counters[common.EPISODE]), limit))
            if undecided:
                converged_s = time.thread_time() - begin_s
            if (flown := int(counters[common.EPISODE])) in schedule.snapshot_episodes:
                visits = process.per_cell(learner.run.visits, n_cells)
                snapshots[schedule.snapshot_episodes.index(flown)] = visits
        cpu_s = time.thread_time() - begin_s
        q = learner.state_values()
        return _Realisation(
            run_id=run_id,
            episodes=learner.run.episodes[: counters[common.EPISODE]].copy(),
            snapshots=snapshots,
            counters=counters,
            converged_cpu_s=converged_s,
            cpu_s=cpu_s,
            flight=greedy_path(self.world, process, q),
            n_discrete_states=learner.n_discrete_states(),
            q=q if self.keep_q else None,
        )

    def _next_stop(self, episode: int, limit: int) -> int:
        """Episode up to which to fly before the next snapshot or check for an interrupt."""
        snapshots = [k for k in self.schedule.snapshot_episodes if k > episode]
        return min(limit, episode + _CHUNK_EPISODES, *snapshots)

    def _limit(self, counters: NDArray[np.int64]) -> int:
        """Episode at which the run ends, by what it has flown so far."""
        if counters[common.TOTAL_STEPS] >= self.schedule.max_total_steps:
            return int(counters[common.EPISODE])
        if self.schedule.until_converged and counters[common.CONVERGED_EPISODE] >= 0:
            return self.schedule.guaranteed_episodes
        return self.schedule.episodes


class _Monitor:
    """Reports finished realisations, and hands them over to be saved.

    Parameters
    ----------
    before, runs
        Realisations that are finished before, and all that are wanted.
    progress, checkpoint
        As of :func:`train`.
    combined
        Makes a result of realisations.
    """

    def __init__(
        self,
        before: int,
        runs: int,
        progress: Progress | None,
        checkpoint: Checkpoint | None,
        combined: Callable[[Sequence[_Realisation]], TrainingResult],
    ) -> None:
        self._before, self._runs = before, runs
        self._progress, self._checkpoint = progress, checkpoint
        self._combined = combined
        self._finished: list[_Realisation] = []
        self._next_s = time.monotonic() + _CHECKPOINT_S

    def __call__(self, realisation: _Realisation) -> None:
        """Note that a realisation is finished."""
        self._finished.append(realisation)
        done = self._before + len(self._finished)
        if self._progress is not None:
            self._progress(done, self._runs)
        begin_s = time.monotonic()
        if self._checkpoint is not None and done < self._runs and begin_s >= self._next_s:
            self._checkpoint(self._combined(self._finished))
            end_s = time.monotonic()
            self._next_s = end_s + max(_CHECKPOINT_S, (end_s - begin_s) / _CHECKPOINT_FRACTION)


def _on_threads(
    trainer: _Trainer, run_ids: Sequence[int], threads: int, monitor: _Monitor
) -> tuple[list[_Realisation], bool]:
    """Train realisations on a pool; returns the finished ones, and whether Ctrl-C stopped it."""
    finished: list[_Realisation] = []
    interrupted = False
    waiting = iter(run_ids)
    pool = ThreadPoolExecutor(threads)
    running = {pool.submit(trainer, run_id) for run_id in islice(waiting, _AHEAD * threads)}
    try:
        while running:
            done, _ = wait(running, return_when=FIRST_COMPLETED)
            for future in done:
                running |= {pool.submit(trainer, run_id) for run_id in islice(waiting, 1)}
                running.remove(future)
                if (realisation := future.result()) is not None:
                    finished.append(realisation)
                    monitor(realisation)
    except KeyboardInterrupt:
        interrupted = True
    finally:
        trainer.stop.set()
        pool.shutdown(wait=False, cancel_futures=True)
        done, _ = wait(running, _LONGEST_END_S)
    late = [future.result() for future in done if not future.cancelled()]
    return finished + [realisation for realisation in late if realisation is not None], interrupted


def _collect(
    trainer: _Trainer, agent: Agent, realisations: Sequence[_Realisation]
) -> TrainingResult:
    """Combine finished realisations, in the order of their numbers."""
    ordered = sorted(realisations, key=lambda realisation: realisation.run_id)
    counters = np.array([r.counters for r in ordered])
    snapshots = np.array([r.snapshots for r in ordered])  # (R, K, C)
    return TrainingResult(
        world=trainer.world,
        agent=agent,
        learning=trainer.problem.learning,
        schedule=trainer.schedule,
        cell_of_state=trainer.problem.process.cell_of_state,
        run_ids=np.array([r.run_id for r in ordered], dtype=np.int64),
        steps=_column(ordered, common.STEPS),
        diagonal_steps=_column(ordered, common.DIAGONAL_STEPS),
        truncated=_column(ordered, common.TRUNCATED) == 1,
        episodes_flown=counters[:, common.EPISODE],
        visit_counts=np.asarray(snapshots.sum(axis=0, dtype=np.int64)),
        converged_episode=counters[:, common.CONVERGED_EPISODE],
        converged_steps=counters[:, common.CONVERGED_STEPS],
        converged_cpu_s=np.array([r.converged_cpu_s for r in ordered]),
        cpu_s=np.array([r.cpu_s for r in ordered]),
        trajectories=padded([r.flight.cells for r in ordered], -1),
        reached=np.array([r.flight.reached for r in ordered]),
        path_steps=np.array([r.flight.steps for r in ordered], dtype=np.int64),
        path_length_m=np.array([r.flight.length_m for r in ordered]),
        n_discrete_states=np.array([r.n_discrete_states for r in ordered], dtype=np.int64),
        q=np.stack([r.q for r in ordered if r.q is not None]) if ordered[0].q is not None else None,
    )


def _column(realisations: Sequence[_Realisation], column: int) -> NDArray[np.int32]:
    """One column of the episode logs, shape (R, E); -1 after a run's last episode."""
    return padded([r.episodes[:, column] for r in realisations], -1)
