"""Train the paper's configurations, continuing from the files of an earlier run."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from rssnav.experiments.paper.data import (
    AGENTS,
    SHOWN_EPISODES,
    VISIT_EPISODES,
    Configuration,
)
from rssnav.experiments.training_store import TrainingStore
from rssnav.learning_parameters import QLearning
from rssnav.results import TrainingResult
from rssnav.schedule import Schedule
from rssnav.training import train
from rssnav.world import GridWorld

EPISODE_LIMIT = 20_000
"""Episodes a run may take to converge; the paper does not state a limit."""

STEP_LIMIT = 25_000_000
"""Steps after which runs of other plans and choices stop; ours converge within 10 million."""


@dataclass(frozen=True)
class TrainingPlan:
    """How the configurations are trained, and where the results are stored.

    Attributes
    ----------
    store : TrainingStore
        Folder of the results, a file per configuration.
    runs, seed : int
        Realisations of each, and the seed of all.
    """

    store: TrainingStore
    runs: int
    seed: int

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
        return self.store.train(
            key.name, world, AGENTS[key.agent], QLearning(), self.schedule, progress
        )


def compile_loop(world: GridWorld) -> None:
    """Compile the learning loop, so that CPU times measure learning alone."""
    train(world, AGENTS["location"], runs=1, episodes=1, learning=QLearning(max_steps=1))
