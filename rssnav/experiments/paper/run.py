"""Run the whole paper: maps, trainings, figures, tables, claims, report."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from rssnav.experiments.paper import trainings
from rssnav.experiments.paper.claims import ClaimResult, claims_table, examine
from rssnav.experiments.paper.counting import SUPPORTED_COUNT, Count
from rssnav.experiments.paper.data import (
    CONFIGURATIONS,
    SHOWN_EPISODES,
    VISIT_EPISODES,
    VISITS_CONFIGURATIONS,
    Configuration,
    PaperData,
)
from rssnav.experiments.paper.figures import FIGURES
from rssnav.experiments.paper.first_episodes import FirstEpisodes, first_episodes
from rssnav.experiments.paper.interpretation import interpretations
from rssnav.experiments.paper.printed_values import RUNS
from rssnav.experiments.paper.provenance import Record, parameters, scenario_facts
from rssnav.experiments.paper.report import Picture, Report, save_report, save_summary
from rssnav.experiments.paper.scenarios import PLANS, Scenario, load_scenarios, make_worlds
from rssnav.experiments.paper.tables import TABLES
from rssnav.experiments.paper.trainings import TrainingPlan
from rssnav.experiments.progress import Notice, StageProgress, ignore
from rssnav.experiments.tables import Table
from rssnav.experiments.training_store import TrainingStore
from rssnav.pictures.style import save_figure
from rssnav.result_file import ResultFileError
from rssnav.results import TrainingResult

QUICK_RUNS = 8


@dataclass(frozen=True, eq=False)
class Paper:
    """A finished run of the paper.

    Attributes
    ----------
    report : Path
        The report's file.
    data : PaperData
        Plans, maps and trainings.
    tables : tuple of Table
        Its tables.
    findings : tuple of ClaimResult
        Claims with their verdicts.
    record : Record
        How the run was made.
    """

    report: Path
    data: PaperData
    tables: tuple[Table, ...]
    findings: tuple[ClaimResult, ...]
    record: Record


@dataclass(frozen=True)
class _Run:
    """Settings shared by the stages."""

    out: Path
    plan: TrainingPlan
    record: Record
    threads: int | None
    max_memory_bytes: int | None
    progress: StageProgress
    notice: Notice

    def counter(self, stage: str, part: int, parts: int) -> Callable[[int, int], None]:
        """Return the progress callback of one of the equally long parts of a stage."""
        return lambda done, size: self.progress(stage, part * size + done, parts * size)


def run_paper(
    out: str | Path = "results",
    *,
    quick: bool = False,
    runs: int | None = None,
    seed: int = 0,
    threads: int | None = None,
    max_memory_bytes: int | None = None,
    resume: bool = True,
    plans: Sequence[str | Path] = PLANS,
    count: Count = SUPPORTED_COUNT,
    progress: StageProgress | None = None,
    notice: Notice | None = None,
) -> Paper:
    """Run the whole paper, and write everything below one folder.

    ``maps/``, ``training/100-runs/``, ``figures/`` (PNG and PDF), ``tables/`` (CSV),
    ``summary.json`` and ``report.html``. Existing maps and trainings are reused if they were made
    with the same plan, parameters, seed and number of realisations.

    Parameters
    ----------
    out : str or Path
        The folder.
    quick : bool
        Eight realisations in place of a hundred.
    runs : int, optional
        Realisations of each configuration; 100 by default.
    seed : int
        Same seed, same results, for any number of threads.
    threads : int, optional
        Threads for maps and trainings; all cores by default.
    max_memory_bytes : int, optional
        Most memory that tracing may take; by default half of what is free.
    resume : bool
        Reuse existing trainings; otherwise train again.
    plans : sequence of str or Path
        Floor plans of Scenarios 1 and 2: built-in names or files.
    count : Count
        Which steps a length counts that is compared with the paper's.
    progress : callable, optional
        Called as ``progress(stage, done, total)``; a stage is done when ``done == total``. The
        stages are "map of <plan>" for each plan, "training", "first episodes", "figures" and
        "tables and report", one after the other.
    notice : callable, optional
        Called with sentences: what is reused, what is recomputed and why.

    Returns
    -------
    Paper

    Raises
    ------
    ValueError
        When there are not two plans, or for a parameter out of range.
    PlanError, SceneError, WorldError, MapFileError
        For a plan or map that cannot be used.
    MemoryLimitError
        Where tracing needs more memory than it may take.
    TrainingInterrupted
        On Ctrl-C while training. Finished realisations are saved every few seconds and then, and
        the next call continues from there.
    """
    if len(plans) != 2:
        raise ValueError(f"plans: {len(plans)} given; the paper needs two")
    out, progress, notice = Path(out), progress or ignore, notice or ignore
    runs = (QUICK_RUNS if quick else RUNS) if runs is None else runs
    record = Record(seed, runs, quick, tuple(str(plan) for plan in plans), count)
    store = TrainingStore(out / "training" / f"{runs}-runs", threads, resume, notice)
    plan = TrainingPlan(store, runs, seed)
    run = _Run(out, plan, record, threads, max_memory_bytes, progress, notice)
    scenarios = _load_scenarios(run, plans)
    results = _train(run, scenarios)
    data = PaperData(scenarios, results, _fly_first_episodes(run, results), count)
    pictures = _draw(run, data)
    return _write(run, data, pictures)


def report_again(
    out: str | Path = "results",
    *,
    threads: int | None = None,
    max_memory_bytes: int | None = None,
    progress: StageProgress | None = None,
    notice: Notice | None = None,
) -> Paper:
    """Regenerate figures, tables and report from the maps and training of an earlier run.

    Raises
    ------
    FileNotFoundError
        When there is no earlier run in ``out``.
    ResultFileError
        When its summary is damaged.
    """
    settings = _settings(Path(out) / "summary.json")
    return run_paper(
        out,
        quick=settings.quick,
        runs=settings.runs,
        seed=settings.seed,
        plans=settings.plans,
        count=settings.count,
        threads=threads,
        max_memory_bytes=max_memory_bytes,
        progress=progress,
        notice=notice,
    )


def _settings(summary: Path) -> Record:
    """Read what an earlier run was made with from its summary."""
    if not summary.is_file():
        raise FileNotFoundError(
            f"{summary}: there is no run of the paper here; `rssnav experiments` makes one"
        )
    try:
        found = json.loads(summary.read_text(encoding="utf-8"))["run"]
        values = found["seed"], found["runs"], found["quick"], tuple(found["plans"])
        count = Count(found["count"])
        types = [type(value) for value in (*values, *values[3])]
    except (ValueError, LookupError, TypeError, RecursionError) as error:
        raise ResultFileError(f"{summary} is damaged ({error}); run the paper again") from error
    if types != [int, int, bool, tuple, str, str] or min(values[:2]) < 0 or values[1] < 1:
        raise ResultFileError(
            f"{summary} is damaged: run = {found!r:.200}, expected seed, runs, quick, two plans "
            "and a count"
        )
    return Record(*values, count)


def _load_scenarios(run: _Run, plans: Sequence[str | Path]) -> dict[int, Scenario]:
    """Load the plans, and load or trace their maps."""
    with run.record.stage("maps"):
        return load_scenarios(
            plans,
            run.out / "maps",
            threads=run.threads,
            max_memory_bytes=run.max_memory_bytes,
            progress=run.progress,
            notice=run.notice,
        )


def _train(run: _Run, scenarios: dict[int, Scenario]) -> dict[Configuration, TrainingResult]:
    """Train all configurations."""
    worlds = make_worlds(scenarios)
    results: dict[Configuration, TrainingResult] = {}
    with run.record.stage("compilation"):
        trainings.compile_loop(next(iter(worlds.values())))
    with run.record.stage("training"):
        for k, key in enumerate(CONFIGURATIONS):
            counter = run.counter("training", k, len(CONFIGURATIONS))
            begin_s = time.perf_counter()
            results[key], trained = run.plan.result(key, worlds[key.scenario, key.speed], counter)
            if trained:
                run.record.trained[key.label] = time.perf_counter() - begin_s
            counter(run.plan.runs, run.plan.runs)
    if reused := len(results) - len(run.record.trained):
        run.notice(f"{reused} of {len(results)} trainings were reused from {run.plan.store.folder}")
    return results


def _fly_first_episodes(
    run: _Run, results: dict[Configuration, TrainingResult]
) -> dict[Configuration, FirstEpisodes]:
    """Repeat the first episodes of the trainings whose visits the paper shows."""
    first: dict[Configuration, FirstEpisodes] = {}
    with run.record.stage("first episodes"):
        for k, key in enumerate(VISITS_CONFIGURATIONS):
            first[key] = first_episodes(
                results[key],
                VISIT_EPISODES[0],
                SHOWN_EPISODES,
                threads=run.threads,
                progress=run.counter("first episodes", k, len(VISITS_CONFIGURATIONS)),
            )
    return first


def _draw(run: _Run, data: PaperData) -> tuple[Picture, ...]:
    """Draw all figures into files and for the report."""
    pictures: list[Picture] = []
    with run.record.stage("figures"):
        for done, figure in enumerate(FIGURES):
            run.progress("figures", done, len(FIGURES))
            png = save_figure(figure.draw(data), run.out / "figures" / figure.key)
            caption = figure.caption(data)
            pictures.append(Picture(figure.key, figure.title, figure.of_paper, caption, png))
        run.progress("figures", len(FIGURES), len(FIGURES))
    return tuple(pictures)


def _write(run: _Run, data: PaperData, pictures: tuple[Picture, ...]) -> Paper:
    """Write tables, summary and report."""
    stage = "tables and report"
    run.progress(stage, 0, 1)
    with run.record.stage("claims and tables"):
        findings = examine(data)
        tables = tuple(make(data) for make in TABLES)
        settings = (interpretations(), parameters(data))
        for table in (*tables, claims_table(findings), *settings):
            table.save_csv(run.out / "tables")
    report = Report(pictures, tables, findings, settings, scenario_facts(data), run.record)
    path = run.out / "report.html"
    save_summary(report, run.out / "summary.json")
    save_report(report, path)
    run.progress(stage, 1, 1)
    return Paper(path, data, tables, findings, run.record)
