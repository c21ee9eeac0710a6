"""Train the paper's configurations, continuing from the files of an earlier run."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from rssnav.agents import Agent
from rssnav.experiments.paper.data import (
    AGENTS,
    SHOWN_EPISODES,
    VISIT_EPISODES,
    Configuration,
)
from rssnav.experiments.progress import Notice
from rssnav.learning_parameters import QLearning
from rssnav.result_file import ResultFileError
from rssnav.results import TrainingResult
from rssnav.schedule import Schedule
from rssnav.training import TrainingInterrupted, train
from rssnav.world import GridWorld

EPISODE_LIMIT = 20_000
"""Episodes a run may take to converge; the paper does not state a limit."""


@dataclass(frozen=True)
class TrainingPlan:
    """How the configurations are trained, and where the results are stored.

    Attributes
    ----------
    folder : Path
        Folder of the results, a file per configuration.
    runs, seed : int
        Realisations of each, and the seed of all.
    threads : int or None
        Threads; all cores for None.
    resume : bool
        Whether finished runs of the same training in ``folder`` are reused.
    notice : callable
        Called with what is reused or trained again, and why.
    """

    folder: Path
    runs: int
    seed: int
    threads: int | None
    resume: bool
    notice: Notice

    @property
    def schedule(self) -> Schedule:
        """Length and seed of each training."""
        return Schedule(self.runs, EPISODE_LIMIT, self.seed, True, SHOWN_EPISODES, VISIT_EPISODES)

    def result(
        self,
        key: Configuration,
        world: GridWorld,
        progress: Callable[[int, int], None] | None = None,
    ) -> tuple[TrainingResult, bool]:
        """Return a configuration's training, and whether any run had to be trained.

        Raises
        ------
        TrainingInterrupted
            On Ctrl-C, after the finished realisations are saved.
        """
        path = self.folder / f"{key.name}.h5"
        earlier = self._earlier(path, key, world)
        if earlier is not None and earlier.complete:
            return earlier, False
        if earlier is not None:
            self.notice(f"{key.label}: continuing from {earlier.run_ids.size} of {self.runs} runs")
        result = self._train(path, AGENTS[key.agent], world, earlier, progress)
        result.save(path)
        return result, True

    def _train(
        self,
        path: Path,
        agent: Agent,
        world: GridWorld,
        earlier: TrainingResult | None,
        progress: Callable[[int, int], None] | None,
    ) -> TrainingResult:
        schedule = self.schedule
        try:
            return train(
                world,
                agent,
                runs=schedule.runs,
                episodes=schedule.episodes,
                seed=schedule.seed,
                until_converged=schedule.until_converged,
                min_episodes=schedule.min_episodes,
                snapshot_episodes=schedule.snapshot_episodes,
                threads=self.threads,
                progress=progress,
                resume=earlier,
            )
        except TrainingInterrupted as interrupt:
            if interrupt.result is not None:
                interrupt.result.save(path)
            raise

    def _earlier(self, path: Path, key: Configuration, world: GridWorld) -> TrainingResult | None:
        """Return the finished realisations of the same training, if the folder has any."""
        if not self.resume or not path.exists():
            return None
        try:
            result = TrainingResult.load(path)
            result.check_same_training(world, AGENTS[key.agent], QLearning(), self.schedule)
        except ResultFileError:
            self.notice(f"{key.label}: {path} cannot be read; training again")
            return None
        except ValueError as difference:
            self.notice(f"{key.label}: {path}: {difference}".split("; ")[0].split(": train ")[0])
            return None
        return result


def compile_loop(world: GridWorld) -> None:
    """Compile the learning loop, so that CPU times measure learning alone."""
    train(world, AGENTS["location"], runs=1, episodes=1, learning=QLearning(max_steps=1))
