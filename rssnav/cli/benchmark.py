"""``rssnav benchmark``: policies in buildings that they have not seen."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from rssnav.cli.console import print_table, say, stage_progress
from rssnav.cli.options import Threads, examples


def add_to(parent: typer.Typer) -> None:
    """Add the command ``benchmark``."""
    parent.command(
        "benchmark",
        epilog=examples(
            "rssnav benchmark --quick",
            "rssnav benchmark --out benchmark",
            "rssnav benchmark --policy mine:make_policy --track RSS --out mine",
        ),
    )(run_benchmark)


def run_benchmark(
    quick: Annotated[
        bool, typer.Option("--quick", help="6 buildings and 2 seeds instead of 50 and 10.")
    ] = False,
    out: Annotated[Path, typer.Option(metavar="FOLDER", help="Output folder.")] = Path("benchmark"),
    policy: Annotated[
        str | None,
        typer.Option(
            metavar="MODULE:FUNCTION",
            help="Fly this policy alone: a function that takes a Briefing and returns a policy.",
        ),
    ] = None,
    track: Annotated[
        str,
        typer.Option(metavar="RSS|plan|maps", help="What the policy of --policy is told."),
    ] = "RSS",
    beside: Annotated[
        list[Path] | None,
        typer.Option("--with", metavar="FILE", help="Add the scores of other results.json files."),
    ] = None,
    resume: Annotated[
        bool, typer.Option("--resume/--no-resume", help="Resume from saved flights, or start over.")
    ] = True,
    threads: Threads = None,
) -> None:
    """Fly policies in generated buildings that they have not seen, and score them.

    Writes results.json, table.md and page.html. Finished flights are saved, so that the same command
    resumes after Ctrl-C or a crash.
    """
    from rssnav.benchmark.entrants import ENTRANTS, entrant_of
    from rssnav.benchmark.page import load_scores, table_rows, write
    from rssnav.benchmark.protocol import FULL, QUICK
    from rssnav.benchmark.running import run
    from rssnav.benchmark.scores import scores

    entrants = ENTRANTS if policy is None else (entrant_of(policy, track),)
    others = [score for path in beside or () for score in load_scores(path)]
    extent = QUICK if quick else FULL
    try:
        with stage_progress() as show:
            records = run(entrants, extent, out, threads=threads, resume=resume, show=show)
    except KeyboardInterrupt as interrupt:
        raise KeyboardInterrupt(
            f"interrupted; finished flights are saved in {out}; run the same command again to "
            "resume"
        ) from interrupt
    found = [*scores(records), *others]
    files = write(out, found, extent)
    print_table(("task", "policy", "knows", "success", "SPL (95 %)"), table_rows(found))
    for file in files:
        say(str(file))
