"""``rssnav experiments`` and ``rssnav report``: the paper, and studies beyond it."""

from __future__ import annotations

from collections import Counter
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from rssnav.cli.console import note, print_table, say, stage_progress
from rssnav.cli.options import MAX_RUNS, MaxMemory, Seed, Style, Threads, examples, in_bytes

if TYPE_CHECKING:
    from rssnav.experiments.paper import Paper

Out = Annotated[Path, typer.Option(metavar="FOLDER", help="Output folder.")]
RESULTS = Path("results")
OUR_PLANS = ("scenario1", "scenario2")


class What(StrEnum):
    """What `rssnav experiments` runs."""

    PAPER = "paper"
    SENSITIVITY = "sensitivity"
    NOISE = "noise"
    COMPARISON = "comparison"
    READINGS = "readings"
    PLANS = "plans"


class StepCount(StrEnum):
    """Names of :class:`rssnav.experiments.paper.counting.Count` on the command line."""

    ALL = "all"
    WITHOUT_LAST = "without-last"
    WITHOUT_FIRST = "without-first"


def add_to(parent: typer.Typer) -> None:
    """Add the commands ``experiments`` and ``report``."""
    parent.command(
        "experiments",
        epilog=examples(
            "rssnav experiments --quick",
            "rssnav experiments --out results",
            "rssnav experiments sensitivity",
        ),
    )(run_experiments)
    parent.command("report", epilog=examples("rssnav report", "rssnav report --out results"))(
        remake_report
    )


def run_experiments(
    what: Annotated[
        What,
        typer.Argument(
            help="paper, or a study: choices that the paper does not specify (sensitivity), "
            "fluctuating RSS readings (noise), other methods and the optimum (comparison), "
            "flights that have the printed lengths (readings), or floor plans that have such "
            "flights (plans)."
        ),
    ] = What.PAPER,
    quick: Annotated[
        bool,
        typer.Option("--quick", help="8 realisations instead of 100: all figures in a minute."),
    ] = False,
    out: Out = RESULTS,
    runs: Annotated[
        int | None,
        typer.Option(
            metavar="N",
            min=1,
            max=MAX_RUNS,
            help="Realisations of each configuration.",
            show_default="100, or 8 with --quick",
        ),
    ] = None,
    seed: Seed = 0,
    resume: Annotated[
        bool,
        typer.Option("--resume/--no-resume", help="Resume from saved runs, or start over."),
    ] = True,
    count: Annotated[
        StepCount,
        typer.Option(
            help="Steps that a length counts which is compared with the paper's: all, or all but "
            "the last or the first. Flights of all its lengths exist if one is left out."
        ),
    ] = StepCount.WITHOUT_LAST,
    plans: Annotated[
        tuple[str, str],
        typer.Option(
            metavar="PLAN PLAN",
            help="Floor plans of Scenarios 1 and 2: built-in names or TOML files.",
        ),
    ] = OUR_PLANS,
    style: Style = None,
    max_memory: MaxMemory = None,
    threads: Threads = None,
) -> None:
    """Reproduce the paper, or run a further study: maps, training, figures, tables, report.

    Results that are up to date are reused. Finished runs are saved every few seconds, so that the
    same command resumes after Ctrl-C or a crash.
    """
    only_defaults = runs is None and count is StepCount.WITHOUT_LAST and plans == OUR_PLANS
    if what is not What.PAPER and not only_defaults:
        raise typer.BadParameter("--runs, --count and --plans apply to the paper only.")
    max_memory_bytes = in_bytes(max_memory)
    try:
        if what is What.PAPER:
            _run_paper(
                out, quick, runs, seed, threads, max_memory_bytes, resume, count, plans, style
            )
        else:
            _run_study(what, out, quick, seed, threads, max_memory_bytes, resume, style)
    except KeyboardInterrupt as interrupt:
        raise KeyboardInterrupt(
            f"interrupted; finished maps and runs are saved in {out}; run the same command "
            "again to resume"
        ) from interrupt


def _run_paper(
    out: Path,
    quick: bool,
    runs: int | None,
    seed: int,
    threads: int | None,
    max_memory_bytes: int | None,
    resume: bool,
    count: StepCount,
    plans: tuple[str, str],
    style: str | None,
) -> None:
    from rssnav.experiments.paper import run_paper
    from rssnav.experiments.paper.counting import Count
    from rssnav.pictures.style import chosen_style

    with stage_progress() as show, chosen_style(style):
        paper = run_paper(
            out,
            quick=quick,
            runs=runs,
            seed=seed,
            threads=threads,
            max_memory_bytes=max_memory_bytes,
            resume=resume,
            plans=plans,
            count=Count[count.name],
            progress=show,
            notice=note,
        )
    _print(paper)


def _run_study(
    what: What,
    out: Path,
    quick: bool,
    seed: int,
    threads: int | None,
    max_memory_bytes: int | None,
    resume: bool,
    style: str | None,
) -> None:
    from rssnav.experiments.studies import STUDIES, run_study
    from rssnav.pictures.style import chosen_style

    with stage_progress() as show, chosen_style(style):
        result = run_study(
            STUDIES[what],
            out,
            quick=quick,
            seed=seed,
            threads=threads,
            max_memory_bytes=max_memory_bytes,
            resume=resume,
            progress=show,
            notice=note,
        )
    for file in result.files:
        say(str(file))


def remake_report(
    out: Out = RESULTS,
    style: Style = None,
    max_memory: MaxMemory = None,
    threads: Threads = None,
) -> None:
    """Regenerate figures, tables and report from the maps and training of an earlier run."""
    from rssnav.experiments.paper import report_again
    from rssnav.pictures.style import chosen_style

    with stage_progress() as show, chosen_style(style):
        paper = report_again(
            out,
            threads=threads,
            max_memory_bytes=in_bytes(max_memory),
            progress=show,
            notice=note,
        )
    _print(paper)


def _print(paper: Paper) -> None:
    """Print the verdicts on the paper's claims, and the report's path."""
    print_table(
        ("claim", "verdict"),
        [(finding.claim.key, finding.verdict) for finding in paper.findings],
    )
    count = Counter(str(finding.verdict) for finding in paper.findings)
    say(", ".join(f"{n} {verdict}" for verdict, n in count.most_common()))
    say(f"report: {paper.report}")
