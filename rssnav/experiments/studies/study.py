"""What a study is, and the one function that runs it.

A study is data: its pieces of work, and functions that measure a piece and that make tables and
figures of all outcomes. A piece is a hashable value that says completely what is measured. Its
trainings and searches are kept in files, so a study that was interrupted or killed continues where
it was. To add a study, describe it and list it in :mod:`rssnav.experiments.studies`.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Generic, TypeVar

from matplotlib.figure import Figure

from atomicfiles import atomic_write
from rssnav.agents import Agent
from rssnav.experiments.paper.scenarios import (
    PLANS,
    Scenario,
    Worlds,
    load_scenarios,
    make_worlds,
)
from rssnav.experiments.progress import Notice, StageProgress, ignore
from rssnav.experiments.tables import Table
from rssnav.experiments.training_store import TrainingStore
from rssnav.learning_parameters import QLearning
from rssnav.pictures.style import save_figure
from rssnav.results import TrainingResult
from rssnav.schedule import NO_STEP_LIMIT, Schedule
from rssnav.world import GridWorld

PieceT = TypeVar("PieceT", bound=Hashable)
OutcomeT = TypeVar("OutcomeT")


@dataclass(frozen=True, eq=False)
class Conditions:
    """What all pieces of a study are measured with.

    Attributes
    ----------
    scenarios : dict of int to Scenario
        Plans and maps, by the scenario's number.
    worlds : dict of (int, int) to GridWorld
        Worlds by (scenario, speed).
    runs : int
        Realisations of each training.
    seed : int
        Seed of all trainings.
    store : TrainingStore
        Where trainings are kept.
    """

    scenarios: dict[int, Scenario]
    worlds: Worlds
    runs: int
    seed: int
    store: TrainingStore

    def train(
        self,
        name: str,
        world: GridWorld,
        agent: Agent,
        episodes: int,
        *,
        learning: QLearning | None = None,
        until_converged: bool = False,
        max_total_steps: int = NO_STEP_LIMIT,
    ) -> TrainingResult:
        """Train an agent, or continue a training; see :func:`rssnav.train`.

        Parameters
        ----------
        name : str
            Says completely what is trained, apart from runs and seed.
        world, agent, episodes, learning, until_converged, max_total_steps
            As of :func:`rssnav.train`; a run that converges stops at once.

        Raises
        ------
        TrainingInterrupted
            On Ctrl-C.
        """
        schedule = Schedule(self.runs, episodes, self.seed, until_converged, 1, (), max_total_steps)
        return self.store.train(name, world, agent, learning or QLearning(), schedule)[0]


@dataclass(frozen=True)
class Study(Generic[PieceT, OutcomeT]):
    """Description of a study.

    Attributes
    ----------
    name : str
        Name for the command line and for progress.
    runs, quick_runs : int
        Realisations of each training, in full and in a quick run.
    pieces : tuple of PieceT
        The work, in the order in which it is done.
    measure : callable
        From a piece and the conditions to the piece's outcomes.
    tables : callable
        From all outcomes to the tables.
    figures : callable
        From all outcomes to the figures, by the name of their files.
    texts : callable
        From all outcomes to further text files, by their paths below the output folder.
    needs_maps : bool
        Whether a piece uses the scenarios; otherwise there are none in its conditions.
    """

    name: str
    runs: int
    quick_runs: int
    pieces: tuple[PieceT, ...]
    measure: Callable[[PieceT, Conditions], Sequence[OutcomeT]]
    tables: Callable[[Sequence[OutcomeT]], tuple[Table, ...]]
    figures: Callable[[Sequence[OutcomeT]], dict[str, Figure]]
    texts: Callable[[Sequence[OutcomeT]], dict[str, str]] = lambda _: {}
    needs_maps: bool = True


@dataclass(frozen=True, eq=False)
class StudyResult:
    """A finished study.

    Attributes
    ----------
    tables : tuple of Table
        What it measured.
    files : tuple of Path
        Every file it wrote: the tables as CSV and Markdown, the figures as PNG, and texts.
    """

    tables: tuple[Table, ...]
    files: tuple[Path, ...]


def run_study(
    study: Study[PieceT, OutcomeT],
    out: str | Path = "results",
    *,
    quick: bool = False,
    seed: int = 0,
    threads: int | None = None,
    max_memory_bytes: int | None = None,
    resume: bool = True,
    progress: StageProgress | None = None,
    notice: Notice | None = None,
) -> StudyResult:
    """Measure every piece of a study; write its tables and figures below ``out``.

    Parameters
    ----------
    study : Study
        The study.
    out : str or Path
        Folder of ``maps/``, which are traced when missing, of ``training/``, from which finished
        runs and searches are reused, and of ``tables/`` and ``figures/``.
    quick : bool
        Few realisations.
    seed : int
        Same seed, same results, for any number of threads.
    threads : int, optional
        Threads; all cores by default.
    max_memory_bytes : int, optional
        Most memory that tracing may take; by default half of what is free.
    resume : bool
        Reuse existing trainings and searches; otherwise train and search again.
    progress : callable, optional
        Called as ``progress(stage, done, total)``, with a stage per map and one for the study.
    notice : callable, optional
        Called with sentences: what is continued or trained again, and why.

    Returns
    -------
    StudyResult

    Raises
    ------
    PlanError, SceneError, WorldError, MapFileError
        For a plan or map that cannot be used.
    MemoryLimitError
        Where tracing needs more memory than it may take.
    TrainingInterrupted
        On Ctrl-C while training. Finished realisations are saved every few seconds and then, and
        the next call continues from there.
    """
    out, progress, notice = Path(out), progress or ignore, notice or ignore
    scenarios = load_scenarios(
        PLANS if study.needs_maps else (),
        out / "maps",
        threads=threads,
        max_memory_bytes=max_memory_bytes,
        progress=progress,
        notice=ignore,
    )
    runs = study.quick_runs if quick else study.runs
    store = TrainingStore(out / "training" / f"{study.name}-{runs}-runs", threads, resume, notice)
    conditions = Conditions(scenarios, make_worlds(scenarios), runs, seed, store)
    outcomes: list[OutcomeT] = []
    for done, piece in enumerate(study.pieces):
        progress(study.name, done, len(study.pieces))
        outcomes += study.measure(piece, conditions)
    progress(study.name, len(study.pieces), len(study.pieces))
    return _write(study, out, outcomes)


def _write(study: Study[PieceT, OutcomeT], out: Path, outcomes: Sequence[OutcomeT]) -> StudyResult:
    """Write the tables below ``tables/``, the figures below ``figures/``, and the texts."""
    tables = study.tables(outcomes)
    files: list[Path] = []
    for table in tables:
        files += [table.save_csv(out / "tables"), table.save_markdown(out / "tables")]
    for key, figure in study.figures(outcomes).items():
        save_figure(figure, out / "figures" / key)
        files.append(out / "figures" / f"{key}.png")
    for name, text in study.texts(outcomes).items():
        with atomic_write(out / name) as temporary:
            temporary.write_text(text, encoding="utf-8")
        files.append(out / name)
    return StudyResult(tables, tuple(files))
