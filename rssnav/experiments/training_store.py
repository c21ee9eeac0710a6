"""Trainings kept in files as their runs finish, from which the next call continues."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from rssnav.agents import Agent
from rssnav.experiments.progress import Notice
from rssnav.interrupts import INTERRUPTS
from rssnav.keeping import lenient
from rssnav.learning_parameters import QLearning
from rssnav.result_file import ResultFileError
from rssnav.results import TrainingResult
from rssnav.schedule import Schedule
from rssnav.training import TrainingInterrupted, train
from rssnav.world import GridWorld


@dataclass(frozen=True)
class TrainingStore:
    """A folder of trainings.

    Attributes
    ----------
    folder : Path
        Folder of the results, a file per training.
    threads : int or None
        Threads; all cores for None.
    resume : bool
        Whether finished runs of the same training in ``folder`` are reused.
    notice : callable
        Called with what is reused or trained again, and why.
    """

    folder: Path
    threads: int | None
    resume: bool
    notice: Notice

    @staticmethod
    def file_name(name: str) -> str:
        """Name of the file of a training: its name without what not every system allows."""
        return re.sub(r"[^\w.]+", "-", name) + ".h5"

    def train(
        self,
        name: str,
        world: GridWorld,
        agent: Agent,
        learning: QLearning,
        schedule: Schedule,
        progress: Callable[[int, int], None] | None = None,
    ) -> tuple[TrainingResult, bool]:
        """Return a training, and whether any run had to be trained.

        Parameters
        ----------
        name : str
            Says completely what is trained; the name of its file follows from it.
        world, agent, learning, schedule, progress
            As of :func:`rssnav.train`.

        Raises
        ------
        TrainingInterrupted
            On Ctrl-C, after the finished realisations are saved.
        """
        path = self.folder / self.file_name(name)
        earlier = self._earlier(path, world, agent, learning, schedule)
        if earlier is not None and earlier.complete:
            return earlier, False
        try:
            result = train(
                world,
                agent,
                learning=learning,
                threads=self.threads,
                progress=progress,
                checkpoint=lenient(lambda finished: finished.save(path), self.notice),
                resume=earlier,
                **dataclasses.asdict(schedule),
            )
        except TrainingInterrupted as interrupt:
            if interrupt.result is not None:
                with INTERRUPTS.keeping():
                    interrupt.result.save(path)
            raise
        result.save(path)
        return result, True

    def _earlier(
        self, path: Path, world: GridWorld, agent: Agent, learning: QLearning, schedule: Schedule
    ) -> TrainingResult | None:
        """Return the finished realisations of the same training, if the file has any."""
        if not self.resume or not path.exists():
            return None
        try:
            earlier = TrainingResult.load(path)
            earlier.check_same_training(world, agent, learning, schedule)
        except ResultFileError:
            self.notice(f"{path} cannot be read; training from scratch")
            return None
        except ValueError as difference:
            self.notice(f"{path}: {difference}".split(": train ")[0])
            return None
        if not earlier.complete:
            self.notice(f"{path}: resuming from {earlier.run_ids.size} of {schedule.runs} runs")
        return earlier
