"""The whole paper: maps, trainings, figures, tables, claims, report."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import floorplans
from rssnav.experiments.paper import trainings
from rssnav.experiments.paper.claims import Finding, claims_table, examine
from rssnav.experiments.paper.data import (
    AGENTS,
    SHOWN_EPISODES,
    SPEEDS,
    VISIT_EPISODES,
    Configuration,
    PaperData,
    Scenario,
)
from rssnav.experiments.paper.figures import visits
from rssnav.experiments.paper.first_episodes import FirstEpisodes, first_episodes
from rssnav.experiments.paper.interpretation import parameters, readings
from rssnav.experiments.paper.printed_values import RUNS
from rssnav.experiments.paper.provenance import Record, scenario_facts
from rssnav.experiments.paper.registry import FIGURES, TABLES
from rssnav.experiments.paper.report import Picture, Report, save_report, save_summary
from rssnav.experiments.paper.trainings import TrainingPlan
from rssnav.experiments.tables import Table
from rssnav.maps import make_map
from rssnav.pictures.style import save_figure
from rssnav.results import TrainingResult

Progress = Callable[[str, int, int], None]
Notice = Callable[[str], None]

QUICK_RUNS = 8
PLANS = ("scenario1", "scenario2")


@dataclass(frozen=True, eq=False)
class Paper:
    """A finished run of the paper.

    Attributes
    ----------
    report : Path
        The report.
    data : PaperData
        Plans, maps and trainings.
    tables : tuple of Table
        Its tables.
    findings : tuple of Finding
        How the claims came out.
    record : Record
        How the run was made.
    """

    report: Path
    data: PaperData
    tables: tuple[Table, ...]
    findings: tuple[Finding, ...]
    record: Record


@dataclass(frozen=True)
class _Run:
    """Settings that the stages share."""

    out: Path
    plan: TrainingPlan
    record: Record
    threads: int | None
    progress: Progress
    notice: Notice

    def counter(self, stage: str, part: int, parts: int) -> Callable[[int, int], None]:
        """Return the progress of one of the equally long parts of a stage."""
        return lambda done, size: self.progress(stage, part * size + done, parts * size)


@dataclass
class _MapCounter:
    """Progress of one map, whose length only its tracer knows."""

    progress: Progress
    stage: str
    total: int = 1

    def __call__(self, done: int, total: int) -> None:
        """Report progress."""
        self.total = total
        self.progress(self.stage, done, total)


def run_paper(
    out: str | Path = "results",
    *,
    quick: bool = False,
    runs: int | None = None,
    seed: int = 0,
    threads: int | None = None,
    resume: bool = True,
    plans: Sequence[str | Path] = PLANS,
    progress: Progress | None = None,
    notice: Notice | None = None,
) -> Paper:
    """Run the whole paper, and write everything below one folder.

    ``maps/``, ``training/100-runs/``, ``figures/`` (PNG and PDF), ``tables/`` (CSV),
    ``summary.json`` and ``report.html``. Maps and trainings that are already there and were made
    with the same plan, parameters, seed and number of realisations are taken over.

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
    resume : bool
        Take over trainings that are already there; otherwise train again.
    plans : sequence of str or Path
        Floor plans of Scenarios 1 and 2: built-in names or files.
    progress : callable, optional
        Called as ``progress(stage, done, total)``; a stage is done when ``done == total``. The
        stages are "map of <plan>" for each plan, "training", "first episodes", "figures" and
        "tables and report", one after the other.
    notice : callable, optional
        Called with sentences for people: what is taken over, what is made again and why.

    Returns
    -------
    Paper

    Raises
    ------
    ValueError
        When there are not two plans, or for a parameter out of range.
    PlanError, SceneError, WorldError, MapFileError
        For a plan or map that cannot be used.
    TrainingInterrupted
        On Ctrl-C while training; finished realisations are saved, and the next call goes on.
    """
    if len(plans) != 2:
        raise ValueError(f"plans: {len(plans)} given; the paper needs two")
    out, tell = Path(out), notice or _ignore
    runs = (QUICK_RUNS if quick else RUNS) if runs is None else runs
    record = Record(seed, runs, quick, tuple(str(plan) for plan in plans))
    plan = TrainingPlan(out / "training" / f"{runs}-runs", runs, seed, threads, resume, tell)
    run = _Run(out, plan, record, threads, progress or _ignore, tell)
    scenarios = _make_maps(run, plans)
    results = _train(run, scenarios)
    data = PaperData(scenarios, results, _fly_first_episodes(run, results))
    pictures = _draw(run, data)
    return _write(run, data, pictures)


def report_again(
    out: str | Path = "results",
    *,
    threads: int | None = None,
    progress: Progress | None = None,
    notice: Notice | None = None,
) -> Paper:
    """Make figures, tables and report anew from the maps and trainings of an earlier run.

    Raises
    ------
    FileNotFoundError
        When there is no earlier run in ``out``.
    """
    summary = Path(out) / "summary.json"
    if not summary.is_file():
        raise FileNotFoundError(
            f"{summary}: there is no run of the paper here; `rssnav experiments` makes one"
        )
    settings = json.loads(summary.read_text(encoding="utf-8"))["run"]
    return run_paper(
        out,
        quick=settings["quick"],
        runs=settings["runs"],
        seed=settings["seed"],
        plans=settings["plans"],
        threads=threads,
        progress=progress,
        notice=notice,
    )


def _ignore(*_: object) -> None:
    """Drop a progress or a notice."""


def _make_maps(run: _Run, plans: Sequence[str | Path]) -> dict[int, Scenario]:
    """Load the plans, and load or trace their maps."""
    loaded = [floorplans.load(plan) for plan in plans]
    scenarios: dict[int, Scenario] = {}
    with run.record.stage("maps"):
        for number, plan in enumerate(loaded, start=1):
            counter = _MapCounter(run.progress, f"map of {plan.name}")
            counter(0, 1)
            radio_map = make_map(
                plan,
                run.out / "maps" / f"{plan.name}.h5",
                threads=run.threads,
                progress=counter,
                notice=run.notice,
            )
            counter(counter.total, counter.total)
            scenarios[number] = Scenario(plan, radio_map)
    return scenarios


def _train(run: _Run, scenarios: dict[int, Scenario]) -> dict[Configuration, TrainingResult]:
    """Train all configurations."""
    keys = trainings.configurations(scenarios, SPEEDS)
    worlds = trainings.worlds(scenarios, SPEEDS)
    results: dict[Configuration, TrainingResult] = {}
    with run.record.stage("compilation"):
        trainings.compile_loop(next(iter(worlds.values())))
    with run.record.stage("training"):
        for k, key in enumerate(keys):
            counter = run.counter("training", k, len(keys))
            begin_s = time.perf_counter()
            results[key], trained = run.plan.result(key, worlds[key.scenario, key.speed], counter)
            if trained:
                run.record.trained[key.label] = time.perf_counter() - begin_s
            counter(run.plan.runs, run.plan.runs)
    if kept := len(keys) - len(run.record.trained):
        run.notice(f"{kept} of {len(keys)} trainings were taken over from {run.plan.folder}")
    return results


def _fly_first_episodes(
    run: _Run, results: dict[Configuration, TrainingResult]
) -> dict[Configuration, FirstEpisodes]:
    """Repeat the first episodes of the trainings whose visits the paper shows."""
    keys = [Configuration(visits.SCENARIO, agent, visits.SPEED) for agent in AGENTS]
    first: dict[Configuration, FirstEpisodes] = {}
    with run.record.stage("first episodes"):
        for k, key in enumerate(keys):
            first[key] = first_episodes(
                results[key],
                VISIT_EPISODES[0],
                SHOWN_EPISODES,
                threads=run.threads,
                progress=run.counter("first episodes", k, len(keys)),
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
        settings = (readings(), parameters(data))
        for table in (*tables, claims_table(findings), *settings):
            table.save_csv(run.out / "tables")
    report = Report(pictures, tables, findings, settings, scenario_facts(data), run.record)
    path = run.out / "report.html"
    save_summary(report, run.out / "summary.json")
    save_report(report, path)
    run.progress(stage, 1, 1)
    return Paper(path, data, tables, findings, run.record)
